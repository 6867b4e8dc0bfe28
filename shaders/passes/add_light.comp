// Adds light to light, post by post: the bounces of one update to their sum, or (SHADING) a sum of
// bounces that is kept to the direct light of a later update.
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D added; // irradiance / pi
layout(rgba16f, binding = 0) uniform image2D sum; // likewise; SHADING: alpha stays

uniform ivec2 size; // posts
#ifndef SHADING
uniform bool first; // nothing is in the sum yet
#endif

void main()
{
    ivec2 post = ivec2(gl_GlobalInvocationID.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    vec3 light = texelFetch(added, post, 0).rgb;
    vec4 before = imageLoad(sum, post);
#ifdef SHADING
    // Harmonics of order 4 ring: light of bounces may be below 0, but no radiance is.
    imageStore(sum, post, vec4(roundedToHalf(max(before.rgb + light, 0.0)), before.a));
#else
    imageStore(sum, post, vec4(first ? light : roundedToHalf(before.rgb + light), 1.0));
#endif
}
