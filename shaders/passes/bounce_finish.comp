// Ends a bounce: from what the lines of all azimuths added up to irradiance / pi.
layout(local_size_x = 8, local_size_y = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D sums;    // of bounce_sweep.comp
layout(rgba16f, binding = 0) writeonly uniform image2D light; // irradiance / pi; void: all 0

uniform ivec2 size; // posts
uniform int frame;

void main()
{
    ivec2 post = ivec2(INVOCATION.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    bool valid = !isVoid(postHeight(heights, post + frame));
    vec3 received = texelFetch(sums, post, 0).rgb / PI;
    imageStore(light, post, valid ? vec4(roundedToHalf(received), 1.0) : vec4(0.0));
}
