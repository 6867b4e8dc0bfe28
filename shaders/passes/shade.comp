// The shading texture: rgb = irradiance / pi, a = visible fraction of the sun.
layout(local_size_x = 8, local_size_y = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D eastSpacings; // R32F [m], one texel per row
// R32F, sky-view factor; SKY_TABLE: rgb = irradiance / pi. Read where hasSky
uniform sampler2D skyView;
layout(rgba16f, binding = 0) writeonly uniform image2D shading;

uniform ivec2 size; // posts
uniform int frame;
uniform float northSpacing; // [m]

void main()
{
    ivec2 post = ivec2(INVOCATION.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    if (isVoid(postHeight(heights, post + frame)))
    {
        imageStore(shading, post, vec4(0.0));
        return;
    }
    vec3 normal = postNormal(heights, post + frame,
                             texelFetch(eastSpacings, ivec2(0, post.y), 0).x, northSpacing);
    vec3 sky = vec3(0.0);
    if (hasSky)
        sky += skyRadiance * SkyShare(texelFetch(skyView, post, 0));
    float visible = sunVisible(post);
    vec3 light = directLight(post, normal, sky, visible);
    imageStore(shading, post, vec4(roundedToHalf(light), roundedToHalf(vec3(visible)).x));
}
