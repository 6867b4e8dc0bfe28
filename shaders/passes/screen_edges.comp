// What a host's shader needs to find the sun's shadow between posts (host/terrain_shading.glsl).
layout(local_size_x = 8, local_size_y = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D eastSpacings; // R32F [m], one texel per row
// Height over the shadow and softness of its edge [m]; irradiance / pi of a post that no terrain
// shades, over sunIrradiance; 1, or 0.5 where the shadow is too high to say where beside the post
// it ends. All 0 where void.
layout(rgba16f, binding = 0) writeonly uniform image2D edges;

uniform ivec2 size; // posts
uniform int frame;
uniform float northSpacing; // [m]

void main()
{
    ivec2 post = ivec2(INVOCATION.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    vec4 edge = vec4(0.0);
#ifdef SUN
    if (!isVoid(postHeight(heights, post + frame)))
    {
        Length east = texelFetch(eastSpacings, ivec2(0, post.y), 0).x;
        vec3 normal = postNormal(heights, post + frame, east, northSpacing);
        Length spacing = max(east, northSpacing);
        Slope sun = sunDirection.z / max(length(sunDirection.xy), 1.0e-3);
        vec2 over = overSunShadow(post);
        Length most = shadowRelief(postRelief(heights, post + frame), spacing, sun) + over.y;
        float known = over.x > -0.98 * most ? 1.0 : 0.5;
        if (over.y > 1.0e4) // there is no crest: as over level ground
            over = vec2(spacing * abs(sun), 0.0);
        // A part of the disc may be below the horizontal.
        float risen = discFraction(sunElevation / sunRadius);
        edge = vec4(over, risen * max(dot(normal, sunDirection), 0.0) / PI, known);
    }
#endif
    imageStore(edges, post, edge);
}
