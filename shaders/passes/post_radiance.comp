// What posts send out, for the bounces in Legendre polynomials: rgb = albedo * irradiance / pi, a = 1; a
// void post: all 0.
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D heights; // R32F [m], framed by `frame` void posts, row 0 south
uniform sampler2D albedo;  // one texel per post, or one for all
uniform sampler2D light;   // irradiance / pi
layout(rgba16f, binding = 0) writeonly uniform image2D radiance;

uniform ivec2 size; // posts
uniform int frame;

void main()
{
    ivec2 post = ivec2(gl_GlobalInvocationID.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    bool valid = !isVoid(postHeight(heights, post + frame));
    vec3 colour = texelFetch(albedo, min(post, textureSize(albedo, 0) - 1), 0).rgb;
    vec3 sent = colour * texelFetch(light, post, 0).rgb;
    imageStore(radiance, post, valid ? vec4(roundedToHalf(sent), 1.0) : vec4(0.0));
}
