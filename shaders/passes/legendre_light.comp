// Light by the scheme of Nowrouzezahrai and Snyder 2009. Per azimuth the samples of a height
// pyramid are scanned (section 5), the slice goes into normalised Legendre polynomials (section 4),
// slices into spherical harmonics (SH) of order 4 (section 6), and these meet the clamped cosine
// about the normal (section 7).
//
// DIRECT: the light of sky and key lights that the terrain leaves visible. HARMONICS: of a sky in
// SH; else of a uniform one. Without DIRECT: one bounce. SENDS_ON: another bounce follows.
//
// SUBSAMPLED: light is gathered at one post of every block of stride * stride, and shaded at all
// with their own normals. A work group gathers at 8 * 8 blocks and shades the 7 * 7 of them that
// have a neighbour to the east and to the north: SH of posts never leave it.
layout(local_size_x = 8, local_size_y = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D eastSpacings;  // R32F [m], one texel per row
uniform sampler2D heightPyramid; // RG32F: height times weight, weight
#ifdef DIRECT
// irradiance / pi, visible part of the sun
layout(rgba16f, binding = 0) writeonly uniform image2D light;
#ifdef HARMONICS
// R32F: row of coefficient i; column 3 j + colour: visibility j's share in it
uniform sampler2D skyProduct;
#endif
#else
uniform sampler2D radiance; // what blocks send out: radiance times weight, weight
uniform sampler2D radiancePyramid; // RGBA16F, likewise
// irradiance / pi of this bounce, 1
layout(rgba16f, binding = 0) writeonly uniform image2D light;
// x, y, width, height in the pyramid's texture; the first is not used
uniform ivec4 radianceLevels[16];
uniform int radianceLevelCount;
#ifdef SENDS_ON
// likewise, a texel per block
layout(rgba16f, binding = 1) writeonly uniform image2D blockLight;
#endif
#endif

uniform ivec2 size; // posts
uniform int frame;
#ifdef SUBSAMPLED
uniform int stride;
#else
const int stride = 1;
#endif
uniform float northSpacing; // [m]
uniform float samplesPerOctave;
uniform float offset; // [octaves] that a level is finer than the distance
uniform int sampleCount;
uniform int levelCount;
uniform ivec4 levels[16]; // x, y, width, height in the pyramid's texture; the first is not used
uniform int azimuths;      // rays all around
uniform vec4 orderWeights; // what the blend between those leaves of each |m| (WedgeMatrices)
layout(std140, binding = 0) uniform Rays
{
#ifdef DIRECT
    // A step: posts to the east, to the north; the unit vector on the ground. Those all around,
    // then those of key lights.
    vec4 directions[340];
    // Per ray of a key light: even and odd weights; cosine and sine of its lowest and of its
    // highest elevation; radiance and, for the sun's, 1 / coefficient (0, 0) of the unoccluded
    // disc.
    vec4 keySlices[336];
#else
    vec4 directions[256];
#endif
};
#ifdef DIRECT
uniform int keyCount; // rays of key lights
#endif

// Incident light: coefficients of bands 0, 1 and 2; the clamped cosine has none in band 3.
struct Incident
{
    vec3 c[9];
    float sun; // visible part
};

float coefficient(ShVector sh, int i)
{
    return sh.c[i / 4][i % 4];
}

// (height above `here` times weight, weight) at a place [posts].
vec2 riseAt(vec2 place, int number, Length here)
{
    if (number == 0)
        return riseBetweenPosts(heights, place, size, frame, here);
    vec2 scale = 1.0 / vec2(textureSize(heightPyramid, 0));
    vec2 texel = pyramidTexel(levels[number], place, number);
    return pyramidRise(textureLod(heightPyramid, texel * scale, 0.0).xy, here);
}

// The ground length of a ray's step, and the slope of the surface's own plane. The paper has -asin
// of the cosine between normal and azimuth, which is right only where the normal lies in the slice.
Length lengthOfStep(vec4 direction, Length east)
{
    return length(direction.xy * vec2(east, northSpacing));
}

Slope ownPlane(vec4 direction, vec3 normal)
{
    return planeSlope(normal, direction.z, direction.w);
}

vec2 placeOf(ivec2 post, vec4 direction, float octaves)
{
    return vec2(post) + exp2(octaves) * direction.xy;
}

// Slope of the surface at a place 2^octaves steps away.
Slope slopeAt(vec2 place, float octaves, Length here, Length stepLength)
{
    int number = pyramidLevel(octaves - offset, levelCount);
    return slopeOfRise(riseAt(place, number, here), exp2(octaves), stepLength);
}

#ifdef DIRECT
// The horizon along a ray. All light ends at the horizontal.
Slope horizonOf(ivec2 post, Length here, Length east, vec3 normal, vec4 direction)
{
    Length stepLength = lengthOfStep(direction, east);
    Slope highest = ownPlane(direction, normal);
    for (int i = 0; i < sampleCount; ++i)
    {
        float octaves = float(i) / samplesPerOctave;
        vec2 place = placeOf(post, direction, octaves);
        if (!onSurface(place, size, 1.0e-3))
            break;
        place = clamp(place, vec2(0.0), vec2(size - 1));
        highest = max(highest, slopeAt(place, octaves, here, stepLength));
    }
    return max(highest, 0.0);
}

Incident gather(ivec2 post, Length here, Length east, vec3 normal)
{
    Incident incident;
    for (int j = 0; j < 9; ++j)
        incident.c[j] = vec3(0.0);
    incident.sun = sunOff;
    ShVector visible = shZero();
    for (int k = 0; k < azimuths + keyCount; ++k)
    {
        vec4 direction = directions[k];
        vec2 horizon = risingDirection(horizonOf(post, here, east, normal, direction));
        AzimuthTerms terms = azimuthTerms(direction.z, direction.w);
        if (k < azimuths)
        {
            visible = addSlice(visible, visibleAbove(horizon), terms);
            continue;
        }
        int key = 4 * (k - azimuths);
        vec4 range = keySlices[key + 2];
        ShVector seen = addSlice(shZero(), visibleBetween(horizon, range.xy, range.zw),
                                 weighTerms(terms, keySlices[key], keySlices[key + 1]));
        for (int j = 0; j < 9; ++j)
            incident.c[j] += keySlices[key + 3].rgb * coefficient(seen, j);
        incident.sun += keySlices[key + 3].a * seen.c[0].x;
    }
    visible = shWeighOrders(visible, orderWeights);
    for (int i = 0; i < 9; ++i)
    {
#ifdef HARMONICS
        // The product of two functions in SH is linear in either.
        for (int j = 0; j < 16; ++j)
            incident.c[i] +=
                coefficient(visible, j) * vec3(texelFetch(skyProduct, ivec2(3 * j, i), 0).x,
                                               texelFetch(skyProduct, ivec2(3 * j + 1, i), 0).x,
                                               texelFetch(skyProduct, ivec2(3 * j + 2, i), 0).x);
#else
        incident.c[i] += coefficient(visible, i) * skyRadiance;
#endif
    }
    return incident;
}
#else
// Radiance times weight, weight. Blocks are the radiance's finest level.
vec4 sentAt(vec2 place, float octaves)
{
    vec2 block = place / float(stride);
    int number = pyramidLevel(octaves - offset - log2(float(stride)), radianceLevelCount);
    if (number == 0)
        return textureLod(radiance, (block + 0.5) / vec2(textureSize(radiance, 0)), 0.0);
    vec2 texel = vec2(radianceLevels[number].xy) + block / float(1 << number) + 0.5;
    vec2 scale = 1.0 / vec2(textureSize(radiancePyramid, 0));
    return textureLod(radiancePyramid, texel * scale, 0.0);
}

LegendreGather gatherAlong(ivec2 post, Length here, Length east, vec3 normal, vec4 direction)
{
    Length stepLength = lengthOfStep(direction, east);
    Slope highest = ownPlane(direction, normal);
    LegendreGather slice = startLegendreGather(highest);
    for (int i = 0; i < sampleCount; ++i)
    {
        float octaves = float(i) / samplesPerOctave;
        vec2 place = placeOf(post, direction, octaves);
        if (!onSurface(place, size, 1.0e-3))
            break;
        place = clamp(place, vec2(0.0), vec2(size - 1));
        Slope slope = slopeAt(place, octaves, here, stepLength);
        if (slope <= highest)
            continue;
        highest = slope;
        vec4 sent = sentAt(place, octaves);
        slice = addLegendreSegment(slice, highest, sent.rgb, max(sent.a, 1.0e-3));
    }
    return slice;
}

Incident gather(ivec2 post, Length here, Length east, vec3 normal)
{
    ShVector red = shZero();
    ShVector green = shZero();
    ShVector blue = shZero();
    for (int k = 0; k < azimuths; ++k)
    {
        vec4 direction = directions[k];
        LegendreGather slice = gatherAlong(post, here, east, normal, direction);
        AzimuthTerms terms = azimuthTerms(direction.z, direction.w);
        red = addSlice(red, slice.red, terms);
        green = addSlice(green, slice.green, terms);
        blue = addSlice(blue, slice.blue, terms);
    }
    red = shWeighOrders(red, orderWeights);
    green = shWeighOrders(green, orderWeights);
    blue = shWeighOrders(blue, orderWeights);
    Incident incident;
    for (int j = 0; j < 9; ++j)
        incident.c[j] = vec3(coefficient(red, j), coefficient(green, j), coefficient(blue, j));
    incident.sun = 0.0;
    return incident;
}
#endif

// Irradiance / pi.
vec3 received(Incident incident, vec3 normal)
{
    ShVector kernel = shOfKernel(lambertEigenvalues(), normal);
    vec3 sum = vec3(0.0);
    for (int j = 0; j < 9; ++j)
        sum += incident.c[j] * coefficient(kernel, j);
    return sum / PI;
}

void shade(ivec2 post, Incident incident, vec3 normal)
{
    vec3 sum = received(incident, normal);
    // Order 4 rings, so light may be below 0; that of a bounce stays so.
#ifdef DIRECT
    imageStore(
        light, post,
        vec4(roundedToHalf(max(sum, 0.0)), roundedToHalf(clamp(vec3(incident.sun), 0.0, 1.0)).x));
#else
    imageStore(light, post, vec4(roundedToHalf(sum), 1.0));
#endif
}

#ifdef SUBSAMPLED
const int SHADED = 7; // blocks a side
shared vec4 gathered[64][7]; // 27 coefficients, then the sun's visible part
shared vec4 places[64];      // the post, its height [m], 1 where there is one

void main()
{
    ivec2 local = ivec2(gl_LocalInvocationID.xy);
    int own = int(gl_LocalInvocationIndex);
    ivec2 corner = ivec2(GROUP.xy) * SHADED;
    ivec2 last = (size - 1) / stride;
    ivec2 block = corner + local;
    places[own] = vec4(0.0);
    if (all(lessThanEqual(block, last)))
    {
        ivec2 post = postOfBlock(heights, block, stride, size, frame);
        Length here = postHeight(heights, post + frame);
        bool valid = !isVoid(here);
        if (valid)
        {
            Length east = texelFetch(eastSpacings, ivec2(0, post.y), 0).x;
            vec3 normal = postNormal(heights, post + frame, east, northSpacing);
            Incident incident = gather(post, here, east, normal);
            places[own] = vec4(vec2(post), here, 1.0);
            for (int j = 0; j < 9; ++j)
                for (int c = 0; c < 3; ++c)
                    gathered[own][(3 * j + c) / 4][(3 * j + c) % 4] = incident.c[j][c];
            gathered[own][6].w = incident.sun;
#ifdef SENDS_ON
            imageStore(blockLight, block, vec4(roundedToHalf(received(incident, normal)), 1.0));
#endif
        }
#ifdef SENDS_ON
        else
            imageStore(blockLight, block, vec4(0.0));
#endif
    }
    barrier();
    int side = SHADED * stride;
    for (int i = own; i < side * side; i += 64)
    {
        ivec2 post = corner * stride + ivec2(i % side, i / side);
        if (post.x >= size.x || post.y >= size.y)
            continue;
        Length here = postHeight(heights, post + frame);
        if (isVoid(here))
        {
            imageStore(light, post, vec4(0.0));
            continue;
        }
        Length east = texelFetch(eastSpacings, ivec2(0, post.y), 0).x;
        vec3 normal = postNormal(heights, post + frame, east, northSpacing);
        ivec2 first = post / stride;
        vec2 share = vec2(post - first * stride) / float(stride);
        vec4 sum[7];
        for (int j = 0; j < 7; ++j)
            sum[j] = vec4(0.0);
        float weights = 0.0;
        for (int n = 0; n < 4; ++n)
        {
            ivec2 towards = ivec2(n % 2, n / 2);
            ivec2 near = min(first + towards, last) - corner;
            int other = near.x + 8 * near.y;
            vec4 place = places[other];
            vec3 across = vec3((place.xy - vec2(post)) * vec2(east, northSpacing), place.z - here);
            float weight =
                place.w * blockWeight(towards, share, across, normal, max(east, northSpacing));
            for (int j = 0; j < 7; ++j)
                sum[j] += place.w > 0.0 ? weight * gathered[other][j] : vec4(0.0);
            weights += weight;
        }
        Incident incident;
        for (int j = 0; j < 9; ++j)
            for (int c = 0; c < 3; ++c)
                incident.c[j][c] = sum[(3 * j + c) / 4][(3 * j + c) % 4] / weights;
        incident.sun = sum[6].w / weights;
        shade(post, incident, normal);
    }
}
#else
void main()
{
    ivec2 post = ivec2(INVOCATION.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    Length here = postHeight(heights, post + frame);
    if (isVoid(here))
    {
        imageStore(light, post, vec4(0.0));
#ifdef SENDS_ON
        imageStore(blockLight, post, vec4(0.0));
#endif
        return;
    }
    Length east = texelFetch(eastSpacings, ivec2(0, post.y), 0).x;
    vec3 normal = postNormal(heights, post + frame, east, northSpacing);
    Incident incident = gather(post, here, east, normal);
    shade(post, incident, normal);
#ifdef SENDS_ON
    imageStore(blockLight, post, vec4(roundedToHalf(received(incident, normal)), 1.0));
#endif
}
#endif
