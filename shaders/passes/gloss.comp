// Light that glossy posts send, in spherical harmonics of order 4, as a function of the direction that it
// leaves in (exit radiance): the Phong lobe over the incident light, from slices in normalised Legendre
// polynomials (Nowrouzezahrai and Snyder 2009, sections 4, 6, 7), turned by 180 degrees about the normal
// (glossyExit). DIRECT: of the sky above the horizon (HARMONICS: of any radiance), of KEY_LIGHTS, and for
// other terrain of the sun. Else of the terrain below the horizon, sampled as bounce.comp does; from what
// that sends diffusely and, unless SCALAR, by gloss, which lights the post diffusely too (section 5.3: two
// pyramids; one).
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D heights;      // R32F [m], framed by `frame` void posts, row 0 south
uniform sampler2D eastSpacings; // R32F [m], one texel per row
uniform sampler2D material;     // x gloss, y exponent; one texel per post, or one for all
uniform sampler2DArray horizon; // elevation codes, layer k looks towards 2*pi*k/m from east

// Layers 0 ... 11: coefficients 4j ... 4j + 3 of colour c in layer 4c + j; 12 of glossLight: the normal's
// parts to the east and north, gloss, exponent.
layout(rgba16f, binding = 0) writeonly uniform image2DArray glossLight; // for the viewer: of all bounces, no sun
layout(rgba16f, binding = 1) writeonly uniform image2DArray exitLight; // for other terrain: of this bounce

uniform ivec2 size; // posts
uniform int frame;
uniform int azimuths;
uniform float northSpacing; // [m]

#ifdef DIRECT
uniform sampler2D shading; // of which alpha is read, the sun's visible fraction
uniform bool hasSky;
#ifdef HARMONICS
uniform vec3 harmonics[16]; // of the sky's radiance, (l, m) at l (l + 1) + m
#else
uniform vec3 skyRadiance;
#endif
uniform vec3 sunIrradiance; // 0 where there is none
uniform vec3 sunDirection;

// The sky above a slope in one azimuth, per colour.
vec4[3] skySlices(Slope slope, float cosine, float sine)
{
#ifdef HARMONICS
    // Gauss-Legendre: the integrand is a trigonometric polynomial of elevation of degree 7, over 90
    // degrees at most; what eight nodes leave of it is below rounding.
    const vec4 nodes = vec4(0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363);
    const vec4 weights =
        vec4(0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763);
    Angle lowest = elevationOfSlope(slope);
    Angle halfRange = 0.5 * (HALF_PI - lowest);
    vec4 slices[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
    for (int i = 0; i < 8; ++i)
    {
        Angle elevation = lowest + halfRange * (1.0 + (i < 4 ? nodes[i % 4] : -nodes[i % 4]));
        float across = cos(elevation);
        ShVector basis = shBasis(vec3(across * cosine, across * sine, sin(elevation)));
        vec3 radiance = vec3(0.0);
        for (int j = 0; j < 16; ++j)
            radiance += harmonics[j] * basis.c[j / 4][j % 4];
        vec4 share = legendre(sin(elevation)) * (weights[i % 4] * halfRange * across);
        for (int c = 0; c < 3; ++c)
            slices[c] += radiance[c] * share;
    }
    return slices;
#else
    vec4 visible = visibleAbove(risingDirection(slope));
    return vec4[3](skyRadiance.r * visible, skyRadiance.g * visible, skyRadiance.b * visible);
#endif
}
#else
uniform sampler2DArray lightBefore; // glossLight up to this bounce
#ifndef SCALAR
uniform sampler2D diffuse; // irradiance / pi of this bounce by what is sent diffusely
layout(rgba16f, binding = 2) writeonly uniform image2D light; // irradiance / pi of this bounce
#endif
uniform sampler2D stepLengths;   // R32F [m]: ground length of a step of azimuth x in row y
uniform sampler2D radiance;      // rgb = what cells send diffusely, a = 1 where valid
uniform sampler2D heightPyramid; // RG32F: height times weight, weight
uniform sampler2D radiancePyramid;    // RGBA16F: radiance times weight, weight
uniform sampler2DArray lastExit;      // layers as above: what posts sent by gloss in the last bounce
uniform sampler2DArray exitPyramid;   // times the weight that heightPyramid has
layout(std140, binding = 0) uniform Rays // as in bounce.comp
{
    vec4 directions[256]; // drift along the minor axis per step, look, 1 where north, -
    vec4 samples[128];
};
uniform int sampleCount;
uniform ivec4 heightLevels[16];
uniform ivec4 radianceLevels[16];

// rise times weight, weight: of the surface at a place [posts], above `here`.
vec2 riseAt(vec2 place, int number, float here)
{
    if (number == 0)
        return riseBetweenPosts(heights, place, size, frame, here);
    ivec4 level = heightLevels[number];
    vec2 texel = clamp(place * exp2(-float(number)), vec2(0.0), vec2(level.zw - 1));
    vec2 height = textureLod(heightPyramid,
                             (vec2(level.xy) + texel + 0.5) / vec2(textureSize(heightPyramid, 0)), 0.0).xy;
    return vec2(height.x - here * height.y, height.y);
}

vec3 diffuseAt(vec2 place, int number)
{
    if (number == 0)
        return texelFetch(radiance, clamp(ivec2(floor(place)), ivec2(0), size - 2), 0).rgb;
    ivec4 level = radianceLevels[number];
    vec2 texel = clamp(place * exp2(-float(number)), vec2(0.5), vec2(level.zw) - 0.5);
    vec4 sent = textureLod(radiancePyramid,
                           (vec2(level.xy) + texel) / vec2(textureSize(radiancePyramid, 0)), 0.0);
    return sent.rgb / max(sent.a, 1.0e-3);
}

// What the surface there sends towards a direction by gloss.
vec3 glossyAt(vec2 place, int number, vec3 towards)
{
    place = clamp(place, vec2(0.0), vec2(size - 1));
    ShVector basis = shBasis(towards);
    ivec4 level = heightLevels[number];
    vec2 texel = clamp(place * exp2(-float(number)), vec2(0.0), vec2(level.zw - 1)) + 0.5;
    vec2 fine = texel / vec2(size);
    vec2 coarse = (vec2(level.xy) + texel) / vec2(textureSize(exitPyramid, 0).xy);
    vec3 sent = vec3(0.0);
    for (int c = 0; c < 3; ++c)
        for (int j = 0; j < 4; ++j)
        {
            float layer = float(4 * c + j);
            vec4 part = number == 0 ? textureLod(lastExit, vec3(fine, layer), 0.0)
                                    : textureLod(exitPyramid, vec3(coarse, layer), 0.0);
            sent[c] += dot(part, basis.c[j]);
        }
    return sent / max(riseAt(place, number, 0.0).y, 1.0e-3);
}
#endif

vec4 halves(vec4 x)
{
    return vec4(roundedToHalf(x.rgb), roundedToHalf(x.aaa).x);
}

void main()
{
    ivec2 post = ivec2(gl_GlobalInvocationID.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    Length here = postHeight(heights, post + frame);
    if (isVoid(here))
    {
        for (int layer = 0; layer < 12; ++layer)
        {
            imageStore(glossLight, ivec3(post, layer), vec4(0.0));
            imageStore(exitLight, ivec3(post, layer), vec4(0.0));
        }
        imageStore(glossLight, ivec3(post, 12), vec4(0.0, 0.0, 0.0, 1.0));
#if !defined(DIRECT) && !defined(SCALAR)
        imageStore(light, post, vec4(0.0));
#endif
        return;
    }
    vec3 normal = postNormal(heights, post + frame, texelFetch(eastSpacings, ivec2(0, post.y), 0).x,
                             northSpacing);
    vec2 own = texelFetch(material, min(post, textureSize(material, 0) - 1), 0).xy;
    float width = 2.0 * PI / float(azimuths);
#ifdef DIRECT
    ShVector incident[3] = ShVector[3](shZero(), shZero(), shZero());
    for (int k = 0; k < (hasSky ? azimuths : 0); ++k)
    {
        float cosine = cos(width * float(k));
        float sine = sin(width * float(k));
        Angle elevation = elevationOfCode(texelFetch(horizon, ivec3(post, k), 0).x);
        Slope plane = -(normal.x * cosine + normal.y * sine) / normal.z;
        Slope highest = max(tan(clamp(elevation, 0.0, 1.57)), plane);
        vec4 slices[3] = skySlices(highest, cosine, sine);
        AzimuthTerms terms = azimuthTerms(cosine, sine);
        for (int c = 0; c < 3; ++c)
            incident[c] = addSlice(incident[c], slices[c], terms);
    }
    // What a function of azimuth is, times cos or sin, integrates to: the sum over azimuths, all but
    // exactly where it is smooth. So slices need no blend and no weights.
    for (int c = 0; c < 3; ++c)
        incident[c] = shScaleBands(incident[c], vec4(width));
#ifdef KEY_LIGHTS
    int layer = 0;
    for (int i = 0; i < keyCount; ++i)
        for (int slice = 0; slice < int(keyRadiances[i].a); ++slice)
        {
            float across = keyPlaces[i].y;
            float phi = keyPlaces[i].x - across * float(slice);
            Slope plane = -(normal.x * cos(phi) + normal.y * sin(phi)) / normal.z;
            Angle elevation = elevationOfCode(texelFetch(keyHorizon, ivec3(post, layer), 0).x);
            vec2 hidden = risingDirection(max(tan(clamp(elevation, -1.57, 1.57)), plane));
            vec2 lowest = vec2(cos(keyPlaces[i].z), sin(keyPlaces[i].z));
            vec2 highest = vec2(cos(keyPlaces[i].w), sin(keyPlaces[i].w));
            // Integrals of cos(m azimuth) over the slice's width.
            vec4 even = vec4(across, 2.0 * sin(0.5 * across), sin(across), 2.0 / 3.0 * sin(1.5 * across));
            AzimuthTerms terms = weighTerms(azimuthTerms(cos(phi), sin(phi)), even, vec4(0.0));
            vec4 visible = visibleBetween(hidden, lowest, highest);
            for (int c = 0; c < 3; ++c)
                incident[c] = addSlice(incident[c], keyRadiances[i][c] * visible, terms);
            ++layer;
        }
#endif
    ShVector sun = shScaleBands(shOfKernel(phongEigenvalues(own.y), mirrored(sunDirection, normal)),
                                vec4(own.x * (dot(normal, sunDirection) > 0.0
                                                  ? texelFetch(shading, post, 0).a
                                                  : 0.0)));
    for (int c = 0; c < 3; ++c)
    {
        incident[c] = glossyExit(incident[c], normal, own.x, own.y);
        for (int j = 0; j < 4; ++j)
        {
            vec4 sent = incident[c].c[j];
            imageStore(glossLight, ivec3(post, 4 * c + j), halves(sent));
            imageStore(exitLight, ivec3(post, 4 * c + j), halves(sent + sunIrradiance[c] * sun.c[j]));
        }
    }
    imageStore(glossLight, ivec3(post, 12), halves(vec4(normal.xy, own)));
#else
    ShVector incident[3] = ShVector[3](shZero(), shZero(), shZero());
    mat3 received = mat3(0.0); // a vector per colour, of glossy light alone
    for (int k = 0; k < azimuths; ++k)
    {
        vec4 direction = directions[k];
        float look = direction.y;
        float drift = direction.x * look;
        vec2 step = direction.z != 0.0 ? vec2(drift, look) : vec2(look, drift);
        Length stepLength = texelFetch(stepLengths, ivec2(k, post.y), 0).x;
        float code = texelFetch(horizon, ivec3(post, k), 0).x;
        Angle elevation = elevationOfCode(max(code, 1.0 / 65535.0));
        Slope cap = tan(clamp(elevation, -1.57, 1.57));
        float cosine = cos(width * float(k));
        float sine = sin(width * float(k));
        Slope highest = -(normal.x * cosine + normal.y * sine) / normal.z;
        vec4 below = occlusionBelow(risingDirection(highest));
        vec2 momentsBelow = sliceMoments(highest, width);
        vec4 slices[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
        vec2 lastPlace = vec2(post);
        int lastNumber = 0;
        // The last round reaches up to the crest, which coarse samples under-estimate.
        for (int i = 0; i <= sampleCount; ++i)
        {
            bool crest = i == sampleCount;
            vec4 s = samples[min(i, sampleCount - 1)];
            vec2 place = vec2(post) + s.x * step;
            bool inside = all(greaterThan(place, vec2(-1.0e-3))) &&
                          all(lessThan(place, vec2(size) - 0.999));
            vec2 rise = riseAt(clamp(place, vec2(0.0), vec2(size - 1)), int(s.y), here);
            Slope slope = rise.x / (max(rise.y, 1.0e-3) * s.x * stepLength);
            bool seen = inside && rise.y > 0.5 && slope > highest;
            Slope next = crest  ? max(highest, cap)
                         : seen ? max(highest, min(slope, cap))
                                : highest;
            if (!crest)
            {
                if (!seen)
                    continue;
                lastPlace = vec2(post) + s.z * step;
                lastNumber = int(s.w);
            }
            vec3 sent = diffuseAt(lastPlace, lastNumber);
            vec2 moments = sliceMoments(next, width);
#ifndef SCALAR
            vec2 up = risingDirection(0.5 * (highest + next));
            vec3 glossy = glossyAt(lastPlace, lastNumber, -vec3(cosine * up.x, sine * up.x, up.y));
            vec2 piece = momentsBelow - moments;
            for (int c = 0; c < 3; ++c)
                received[c] += glossy[c] * vec3(cosine * piece.y, sine * piece.y, piece.x);
            sent += glossy;
#endif
            vec4 above = occlusionBelow(risingDirection(next));
            for (int c = 0; c < 3; ++c)
                slices[c] += sent[c] * (above - below);
            highest = next;
            below = above;
            momentsBelow = moments;
        }
        AzimuthTerms terms = azimuthTerms(cosine, sine);
        for (int c = 0; c < 3; ++c)
            incident[c] = addSlice(incident[c], slices[c], terms);
    }
    for (int c = 0; c < 3; ++c)
    {
        ShVector sent = glossyExit(shScaleBands(incident[c], vec4(width)), normal, own.x, own.y);
        for (int j = 0; j < 4; ++j)
        {
            ivec3 texel = ivec3(post, 4 * c + j);
            imageStore(exitLight, texel, halves(sent.c[j]));
            imageStore(glossLight, texel, halves(texelFetch(lightBefore, texel, 0) + sent.c[j]));
        }
    }
    imageStore(glossLight, ivec3(post, 12), halves(vec4(normal.xy, own)));
#ifndef SCALAR
    vec3 irradiance = normal * received / PI;
    imageStore(light, post, vec4(roundedToHalf(texelFetch(diffuse, post, 0).rgb + irradiance), 1.0));
#endif
#endif
}
