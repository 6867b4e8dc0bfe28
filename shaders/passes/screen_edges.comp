// What a host's shader needs to find the sun's shadow between posts (host/terrain_shading.glsl).
layout(local_size_x = 8, local_size_y = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D eastSpacings; // R32F [m], one texel per row
// Height over the shadow and softness of its edge [m]; irradiance / pi of a post that no terrain
// shades, over sunIrradiance; 1, or all 0 where void.
layout(rgba16f, binding = 0) writeonly uniform image2D edges;

uniform ivec2 size; // posts
uniform int frame;
uniform float northSpacing; // [m]

void main()
{
    ivec2 post = ivec2(gl_GlobalInvocationID.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    vec4 edge = vec4(0.0);
#ifdef SUN
    if (!isVoid(postHeight(heights, post + frame)))
    {
        vec3 normal = postNormal(heights, post + frame,
                                 texelFetch(eastSpacings, ivec2(0, post.y), 0).x, northSpacing);
        // A part of the disc may be below the horizontal.
        float risen = discFraction(sunElevation / sunRadius);
        edge = vec4(overSunShadow(post), risen * max(dot(normal, sunDirection), 0.0) / PI, 1.0);
    }
#endif
    imageStore(edges, post, edge);
}
