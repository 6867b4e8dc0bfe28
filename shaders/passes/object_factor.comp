// What placed objects leave of the light of the ground around them: a texel is a place on the
// ground, much nearer to the next than posts are. rgb: of the light of the shading texture; a: of
// the visible fraction of the sun. Exactly 1 where no cone meets an object.
//
// Each kind of light has a part of its own: the sky above the terrain's horizon through cones, each
// cut by that horizon, what comes from terrain below it likewise, and the sun by a ray.
layout(local_size_x = 8, local_size_y = 8) in;

layout(rgba16f, binding = 0) writeonly uniform image2D factor;
uniform bool known; // whether the volume is there

uniform vec2 first;   // centre of texel (0, 0) [m from post (0, 0)]
uniform float pitch;  // of texels [m]
uniform ivec2 texels; // of this volume ...
uniform int row;      // ... from this row on

void main()
{
    ivec2 texel = ivec2(INVOCATION.xy);
    if (texel.x >= texels.x || texel.y >= texels.y)
        return;
    vec2 metres = first + vec2(texel) * pitch;
    vec2 rise = riseBetweenPosts(heights, postsOf(metres), size, frame, 0.0);
    ivec2 to = texel + ivec2(0, row);
    if (rise.y <= 0.5 || !known)
    {
        imageStore(factor, to, vec4(1.0));
        return;
    }
    // The last texels lead over to ground that knows of no object.
    vec2 inside = min(vec2(texel), vec2(texels - 1 - texel)) / 8.0;
    float part = clamp(min(inside.x, inside.y), 0.0, 1.0);
    imageStore(factor, to, mix(vec4(1.0), shareOfGround(metres, rise.x / rise.y), part));
}
