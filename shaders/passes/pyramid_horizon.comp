// Horizons of all posts from a pyramid of heights (Nowrouzezahrai and Snyder 2009, section 5.2):
// samples at 2^(i/k) steps, their elevations joined by a cubic B-spline of the sample's number, and
// its maximum at knots and midpoints. One invocation per post and direction.
layout(local_size_x = 8, local_size_y = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D eastSpacings;  // R32F [m], one texel per row
uniform sampler2D heightPyramid; // RG32F: height times weight, weight
layout(r16, binding = 0) writeonly uniform image2DArray horizon; // elevation codes

uniform ivec2 size; // posts
uniform int frame;
uniform float northSpacing; // [m]
layout(std140, binding = 0) uniform Rays
{
    vec4 directions[256]; // a step: posts to the east, to the north; the unit vector on the ground
};
uniform float samplesPerOctave;
uniform float offset; // [octaves] that a level is finer than the distance
uniform int sampleCount;
uniform int levelCount;
uniform ivec4 levels[16]; // x, y, width, height in the pyramid's texture; the first is not used
uniform bool smoothly;    // false: the highest sample, and no B-spline

// (height above `here` times weight, weight), from a level of the pyramid.
vec2 riseAt(vec2 place, int number, Length here)
{
    vec2 scale = 1.0 / vec2(textureSize(heightPyramid, 0));
    vec2 texel = pyramidTexel(levels[number], place, number);
    return pyramidRise(textureLod(heightPyramid, texel * scale, 0.0).xy, here);
}

void main()
{
    ivec3 place3 = ivec3(INVOCATION);
    ivec2 post = place3.xy;
    if (post.x >= size.x || post.y >= size.y)
        return;
    Length here = postHeight(heights, post + frame);
    if (isVoid(here))
    {
        imageStore(horizon, place3, vec4(VOID_CODE));
        return;
    }
    vec4 direction = directions[place3.z];
    Length east = texelFetch(eastSpacings, ivec2(0, post.y), 0).x;
    Length stepLength = length(direction.xy * vec2(east, northSpacing));
    // The last four samples. The spline has its first and last one twice more, so that it ends in
    // them.
    vec4 last = vec4(0.0);
    // The paper starts from the surface's own horizon. That is the consumer's part: with a normal
    // that is its neighbours' mean it is wrong by more than what is missing nearer than the first
    // sample.
    Angle highest = -HALF_PI;
    bool started = false;
    for (int i = 0; i < sampleCount + 2; ++i)
    {
        Angle elevation = last.w;
        float octaves = float(i) / samplesPerOctave;
        float distance = exp2(octaves); // [steps]
        vec2 place = vec2(post) + distance * direction.xy;
        if (i < sampleCount && onSurface(place, size, 1.0e-3))
        {
            place = clamp(place, vec2(0.0), vec2(size - 1));
            int number = pyramidLevel(octaves - offset, levelCount);
            vec2 rise = number == 0 ? riseBetweenPosts(heights, place, size, frame, here)
                                    : riseAt(place, number, here);
            // A void casts nothing: the spline goes on as before.
            if (rise.y > 0.5)
            {
                elevation = elevationOfSlope(slopeOfRise(rise, distance, stepLength));
                last = started ? last : vec4(elevation);
                started = true;
                highest = smoothly ? highest : max(highest, elevation);
            }
        }
        if (!started)
            continue;
        last = vec4(last.yzw, elevation);
        if (smoothly)
        {
            float knot = dot(last, vec4(0.0, 1.0, 4.0, 1.0)) / 6.0;
            float midpoint = dot(last, vec4(1.0, 23.0, 23.0, 1.0)) / 48.0;
            highest = max(highest, max(knot, midpoint));
        }
    }
    imageStore(horizon, place3, vec4(codeOfElevation(highest)));
}
