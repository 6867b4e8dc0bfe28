// The shading of posts that light bounces to: direct light and the light of each bounce, added in
// this order. Each sum is rounded to half floats, as if it were stored.
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D direct; // rgb = irradiance / pi, a = visible fraction of the sun
// rgb = irradiance / pi of one bounce; those from `bounces` on are not read.
uniform sampler2D bounce0;
uniform sampler2D bounce1;
uniform sampler2D bounce2;
uniform sampler2D bounce3;
uniform sampler2D bounce4;
uniform sampler2D bounce5;
uniform sampler2D bounce6;
uniform sampler2D bounce7;
layout(rgba16f, binding = 0) writeonly uniform image2D shading; // as direct

uniform ivec2 size;  // posts
uniform int bounces; // 1 ... 8
uniform float least; // that a sum may become

vec3 bounced(int bounce, ivec2 post)
{
    switch (bounce)
    {
    case 0:
        return texelFetch(bounce0, post, 0).rgb;
    case 1:
        return texelFetch(bounce1, post, 0).rgb;
    case 2:
        return texelFetch(bounce2, post, 0).rgb;
    case 3:
        return texelFetch(bounce3, post, 0).rgb;
    case 4:
        return texelFetch(bounce4, post, 0).rgb;
    case 5:
        return texelFetch(bounce5, post, 0).rgb;
    case 6:
        return texelFetch(bounce6, post, 0).rgb;
    default:
        return texelFetch(bounce7, post, 0).rgb;
    }
}

void main()
{
    ivec2 post = ivec2(INVOCATION.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    vec4 light = texelFetch(direct, post, 0);
    for (int bounce = 0; bounce < bounces; ++bounce)
        light.rgb = roundedToHalf(max(light.rgb + bounced(bounce, post), least));
    imageStore(shading, post, light);
}
