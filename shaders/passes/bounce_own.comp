// The first part of a bounce: what a post receives from the four cells that meet at it. Each has
// its own normal there: that of the post is their mean, which is not what the post sees.
layout(local_size_x = 8, local_size_y = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D eastSpacings; // R32F [m], one texel per row
// R32F [m]: ground length of a step of azimuth x in row y
layout(r32f) readonly uniform image2D stepLengths;
layout(rgba16f) readonly uniform image2D faces; // of faces.comp
// elevation codes, layer k looks towards 2*pi*k/m from east
layout(r16) readonly uniform image2DArray horizon;
#ifdef SUN
uniform sampler2D albedo; // one texel per post, or one for all
uniform sampler2D direct; // of which alpha is read, the sun's visible fraction
#endif
layout(rgba32f, binding = 0) writeonly uniform image2D sums;    // irradiance
layout(rg32f, binding = 1) writeonly uniform image2D gradients; // rise [m/m] to the east and north

uniform ivec2 size; // posts
uniform int frame;
uniform int azimuths;
uniform float northSpacing; // [m]
layout(std140, binding = 0) uniform Rays
{
    vec4 directions[256]; // drift along the minor axis per step, look, 1 where north, -
};

void main()
{
    ivec2 post = ivec2(INVOCATION.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    Length here = postHeight(heights, post + frame);
    if (isVoid(here))
        return;
    Length east = texelFetch(eastSpacings, ivec2(0, post.y), 0).x;
    vec3 normal = postNormal(heights, post + frame, east, northSpacing);
#ifdef SUN
    vec3 colour = texelFetch(albedo, min(post, textureSize(albedo, 0) - 1), 0).rgb;
    vec3 sun = colour * sunIrradiance * texelFetch(direct, post, 0).a;
#endif
    float width = 2.0 * PI / float(azimuths);
    vec3 sum = vec3(0.0);
    for (int k = 0; k < azimuths; ++k)
    {
        float cosine = cos(width * float(k));
        float sine = sin(width * float(k));
        GridRay ray = gridRay(directions[k].x, int(directions[k].y), directions[k].z != 0.0);
        ivec2 quadrant = max(ray.major + ray.side, ivec2(0));
        vec4 face = imageLoad(faces, 2 * post + quadrant);
        vec3 own = face.rgb;
#ifdef SUN
        own += sun * face.a;
#endif
        Slope cap = slopeOfCode(imageLoad(horizon, ivec3(post, k)).x);
        Length stepLength = imageLoad(stepLengths, ivec2(k, post.y)).x;
        SliceGather slice = startGather(planeSlope(normal, cosine, sine), own, width);
        Slope slope = ownCellSlope(heights, post + frame, here, ray);
        slice = addSegment(slice, slope / stepLength, own, cap, width);
        sum += received(slice, normal, cosine, sine);
    }
    imageStore(sums, post, vec4(sum, 0.0));
    imageStore(gradients, post, vec4(-normal.xy / normal.z, 0.0, 0.0));
}
