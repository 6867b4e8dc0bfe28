// Heights that change, into the framed texture that all passes read. Posts that are not finite or
// beyond the limit of DemTile become void, and so is the frame.
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D posts; // R32F [m], one texel per post, row 0 south
layout(r32f, binding = 0) writeonly uniform image2D heights;

uniform sampler2D eastSpacings; // R32F [m], one texel per row
uniform ivec2 size; // posts
uniform float northSpacing; // [m]
uniform float curvature; // of the planet [1 / m], 0: flat
uniform int frame;

// By the bits: a compiler may drop a test for NaN, whose bits are beyond those of every number.
bool isHeight(float height)
{
    return (floatBitsToUint(height) & 0x7fffffffu) <= floatBitsToUint(1.0e6);
}

void main()
{
    ivec2 texel = ivec2(INVOCATION.xy);
    if (texel.x >= size.x + 2 * frame || texel.y >= size.y + 2 * frame)
        return;
    ivec2 post = texel - frame;
    float height = VOID_HEIGHT;
    if (all(greaterThanEqual(post, ivec2(0))) && all(lessThan(post, size)))
    {
        float given = texelFetch(posts, post, 0).x;
        // Below the plane that touches the planet in the tile's middle, like DemTile::sinkAt().
        vec2 place = (vec2(post) - 0.5 * vec2(size - 1)) *
                     vec2(texelFetch(eastSpacings, ivec2(0, post.y), 0).x, northSpacing);
        if (isHeight(given))
            height = given - 0.5 * curvature * dot(place, place);
    }
    imageStore(heights, texel, vec4(height));
}
