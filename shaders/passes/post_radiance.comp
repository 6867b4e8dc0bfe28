// What posts send out, for bounces in Legendre polynomials: of one post per block of stride *
// stride, rgb = albedo * irradiance / pi, a = 1; a block of void posts: all 0.
layout(local_size_x = 8, local_size_y = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D albedo;  // one texel per post, or one for all
uniform sampler2D light;   // irradiance / pi, a texel per post or, where byBlock, per block
layout(rgba16f, binding = 0) writeonly uniform image2D radiance; // a texel per block

uniform ivec2 size; // posts
uniform int frame;
uniform int stride;
uniform bool byBlock;

void main()
{
    ivec2 block = ivec2(INVOCATION.xy);
    if (block.x * stride >= size.x || block.y * stride >= size.y)
        return;
    ivec2 post = postOfBlock(heights, block, stride, size, frame);
    bool valid = !isVoid(postHeight(heights, post + frame));
    vec3 colour = texelFetch(albedo, min(post, textureSize(albedo, 0) - 1), 0).rgb;
    vec3 sent = colour * texelFetch(light, byBlock ? block : post, 0).rgb;
    imageStore(radiance, block, valid ? vec4(roundedToHalf(sent), 1.0) : vec4(0.0));
}
