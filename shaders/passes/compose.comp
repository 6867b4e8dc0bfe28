// The shading of posts that light bounces to: direct light and the light of each bounce, one
// dispatch per bounce. Each sum is rounded to half floats.
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D direct;  // rgb = irradiance / pi, a = visible fraction of the sun
uniform sampler2D bounced; // irradiance / pi of one bounce
layout(rgba16f, binding = 0) uniform image2D shading; // as direct

uniform ivec2 size; // posts
uniform bool first; // nothing is in the shading yet
uniform float least; // that a sum may become

void main()
{
    ivec2 post = ivec2(gl_GlobalInvocationID.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    vec4 before = first ? texelFetch(direct, post, 0) : imageLoad(shading, post);
    vec3 light = texelFetch(bounced, post, 0).rgb;
    imageStore(shading, post, vec4(roundedToHalf(max(before.rgb + light, least)), before.a));
}
