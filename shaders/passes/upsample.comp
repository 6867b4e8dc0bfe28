// Indirect light of every post from that of every stride-th one, with the post's own normal (Nowrouzezahrai
// and Snyder 2009, section 7). Between posts of one surface it is bilinear; a post that lies off the plane
// of this one counts less, so that light does not bleed over edges.
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D heights;      // R32F [m], framed by `frame` void posts, row 0 south
uniform sampler2D eastSpacings; // R32F [m], one texel per row
uniform sampler2D redVector;    // per colour, over pi; a = 1 where valid
uniform sampler2D greenVector;
uniform sampler2D blueVector;
layout(rgba16f, binding = 0) uniform image2D shading;         // += irradiance / pi
layout(rgba16f, binding = 1) writeonly uniform image2D light; // the same

uniform ivec2 size; // posts
uniform int frame;
uniform int stride;
uniform float northSpacing; // [m]

void main()
{
    ivec2 post = ivec2(gl_GlobalInvocationID.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    Length here = postHeight(heights, post + frame);
    if (isVoid(here))
    {
        imageStore(light, post, vec4(0.0));
        return;
    }
    Length east = texelFetch(eastSpacings, ivec2(0, post.y), 0).x;
    vec3 normal = postNormal(heights, post + frame, east, northSpacing);
    ivec2 first = post / stride;
    ivec2 last = (size - 1) / stride;
    vec2 share = vec2(post - first * stride) / float(stride);
    mat3 sum = mat3(0.0);
    float weights = 0.0;
    for (int i = 0; i < 4; ++i)
    {
        ivec2 corner = ivec2(i % 2, i / 2);
        ivec2 coarse = min(first + corner, last);
        vec4 red = texelFetch(redVector, coarse, 0);
        ivec2 gathered = postOfBlock(heights, coarse, stride, size, frame);
        ivec2 away = gathered - post;
        Length height = postHeight(heights, gathered + frame);
        vec3 across = vec3(float(away.x) * east, float(away.y) * northSpacing,
                           isVoid(height) ? 0.0 : height - here);
        float weight = red.a * blockWeight(corner, share, across, normal, max(east, northSpacing));
        sum += weight * mat3(red.rgb, texelFetch(greenVector, coarse, 0).rgb,
                             texelFetch(blueVector, coarse, 0).rgb);
        weights += weight;
    }
    vec3 received = max(normal * sum / max(weights, 1.0e-6), vec3(0.0));
    vec4 before = imageLoad(shading, post);
    imageStore(shading, post, vec4(roundedToHalf(before.rgb + received), before.a));
    imageStore(light, post, vec4(roundedToHalf(received), 1.0));
}
