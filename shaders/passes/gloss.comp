// Light that glossy posts send, in spherical harmonics of order 4, as a function of the direction
// that it leaves in (exit radiance): the Phong lobe over the incident light, from slices in
// normalised Legendre polynomials (Nowrouzezahrai and Snyder 2009, sections 4, 6, 7), turned by 180
// degrees about the normal (glossyExit). DIRECT: of the sky above the horizon (HARMONICS: of any
// radiance), of KEY_LIGHTS, and for other terrain of the sun. Else of the terrain below the
// horizon, sampled as bounce.comp does; from what that sends diffusely and, unless SCALAR, by
// gloss, which lights the post diffusely too (section 5.3: two pyramids; one).
layout(local_size_x = 8, local_size_y = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D eastSpacings; // R32F [m], one texel per row
uniform sampler2D material;     // x gloss, y exponent; one texel per post, or one for all
// elevation codes, layer k looks towards 2*pi*k/m from east
layout(r16) readonly uniform image2DArray horizon;

// Layers 0 ... 11: coefficients 4j ... 4j + 3 of colour c in layer 4c + j; 12 of glossLight: the
// normal's parts to the east and north, gloss, exponent.

// for the viewer: of all bounces, no sun
layout(rgba16f, binding = 0) writeonly uniform image2DArray glossLight;
// for other terrain: of this bounce
layout(rgba16f, binding = 1) writeonly uniform image2DArray exitLight;

uniform ivec2 size; // posts
uniform int frame;
uniform int azimuths;
uniform float northSpacing; // [m]

#ifdef DIRECT
uniform sampler2D shading; // of which alpha is read, the sun's visible fraction
#ifdef HARMONICS
uniform vec3 harmonics[16]; // of the sky's radiance, (l, m) at l (l + 1) + m
#endif

// The sky above a slope in one azimuth, per colour.
vec4[3] skySlices(Slope slope, float cosine, float sine)
{
#ifdef HARMONICS
    // Gauss-Legendre: the integrand is a trigonometric polynomial of elevation of degree 7, over 90
    // degrees at most; what eight nodes leave of it is below rounding.
    const vec4 nodes =
        vec4(0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363);
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
// layers as above: what posts sent by gloss in the last bounce
uniform sampler2DArray lastExit;
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
    vec2 texel = pyramidTexel(heightLevels[number], place, number);
    vec2 read = textureLod(heightPyramid, texel / vec2(textureSize(heightPyramid, 0)), 0.0).xy;
    return pyramidRise(read, here);
}

vec3 diffuseAt(vec2 place, int number)
{
    if (number == 0)
        return texelFetch(radiance, clamp(ivec2(floor(place)), ivec2(0), size - 2), 0).rgb;
    vec2 texel = cellPyramidTexel(radianceLevels[number], place, number);
    vec4 sent = textureLod(radiancePyramid, texel / vec2(textureSize(radiancePyramid, 0)), 0.0);
    return sent.rgb / max(sent.a, 1.0e-3);
}

// What the surface there sends towards a direction by gloss.
vec3 glossyAt(vec2 place, int number, vec3 towards)
{
    place = clamp(place, vec2(0.0), vec2(size - 1));
    ShVector basis = shBasis(towards);
    ivec4 level = number == 0 ? ivec4(0, 0, size) : heightLevels[number];
    vec2 texel = pyramidTexel(level, place, number);
    vec2 fine = texel / vec2(size);
    vec2 coarse = texel / vec2(textureSize(exitPyramid, 0).xy);
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

#ifdef DIRECT
// Light of sky and key lights as a post receives it: what a function of azimuth is, times cos or
// sin, integrates to: the sum over azimuths, all but exactly where it is smooth. So slices need no
// blend and no weights.
ShVector[3] incidentLight(ivec2 post, vec3 normal)
{
    float width = 2.0 * PI / float(azimuths);
    ShVector incident[3] = ShVector[3](shZero(), shZero(), shZero());
    for (int k = 0; k < (hasSky ? azimuths : 0); ++k)
    {
        float cosine = cos(width * float(k));
        float sine = sin(width * float(k));
        Angle elevation = elevationOfCode(imageLoad(horizon, ivec3(post, k)).x);
        Slope highest =
            max(tan(clamp(elevation, 0.0, 1.57)), planeSlope(normal, cosine, sine));
        vec4 slices[3] = skySlices(highest, cosine, sine);
        AzimuthTerms terms = azimuthTerms(cosine, sine);
        for (int c = 0; c < 3; ++c)
            incident[c] = addSlice(incident[c], slices[c], terms);
    }
    for (int c = 0; c < 3; ++c)
        incident[c] = shScaleBands(incident[c], vec4(width));
    return addDirectHarmonics(incident, post, normal);
}

// own: gloss, exponent
void sendGloss(ivec2 post, vec3 normal, vec2 own)
{
    ShVector incident[3] = incidentLight(post, normal);
    float visible = dot(normal, sunDirection) > 0.0 ? texelFetch(shading, post, 0).a : 0.0;
    ShVector sun = shScaleBands(
        shOfKernel(phongEigenvalues(own.y), mirrored(sunDirection, normal)), vec4(own.x * visible));
    for (int c = 0; c < 3; ++c)
    {
        incident[c] = glossyExit(incident[c], normal, own.x, own.y);
        for (int j = 0; j < 4; ++j)
        {
            vec4 sent = incident[c].c[j];
            imageStore(glossLight, ivec3(post, 4 * c + j), halves(sent));
            imageStore(exitLight, ivec3(post, 4 * c + j),
                       halves(sent + sunIrradiance[c] * sun.c[j]));
        }
    }
    imageStore(glossLight, ivec3(post, 12), halves(vec4(normal.xy, own)));
}
#else
// What terrain sends a post.
struct FromTerrain
{
    ShVector incident[3];
    mat3 received; // a vector per colour, of glossy light alone
};

// With one more slice of azimuth.
FromTerrain addAzimuth(FromTerrain sum, ivec2 post, Length here, vec3 normal, int k)
{
    float width = 2.0 * PI / float(azimuths);
    vec4 direction = directions[k];
    GridRay ray = gridRay(direction.x, int(direction.y), direction.z != 0.0);
    Length stepLength = texelFetch(stepLengths, ivec2(k, post.y), 0).x;
    Slope cap = slopeOfCode(imageLoad(horizon, ivec3(post, k)).x);
    float cosine = cos(width * float(k));
    float sine = sin(width * float(k));
    Slope highest = planeSlope(normal, cosine, sine);
    vec2 momentsBelow = sliceMoments(highest, width);
    LegendreGather slice = startLegendreGather(highest);
    vec2 lastPlace = vec2(post);
    int lastNumber = 0;
    // The last round reaches up to the crest, which coarse samples under-estimate.
    for (int i = 0; i <= sampleCount; ++i)
    {
        vec4 s = samples[min(i, sampleCount - 1)];
        Slope slope = cap;
        if (i < sampleCount)
        {
            vec2 place = vec2(post) + s.x * ray.step;
            vec2 rise = riseAt(clamp(place, vec2(0.0), vec2(size - 1)), int(s.y), here);
            slope =
                onSurface(place, size, 1.0e-3) ? slopeOfRise(rise, s.x, stepLength) : NO_HORIZON;
            if (slope <= highest)
                continue;
            lastPlace = vec2(post) + s.z * ray.step;
            lastNumber = int(s.w);
        }
        Slope next = raisedSlope(highest, slope, cap);
        vec3 sent = diffuseAt(lastPlace, lastNumber);
        vec2 moments = sliceMoments(next, width);
#ifndef SCALAR
        vec2 up = risingDirection(0.5 * (highest + next));
        vec3 glossy =
            glossyAt(lastPlace, lastNumber, -vec3(cosine * up.x, sine * up.x, up.y));
        vec2 piece = momentsBelow - moments;
        for (int c = 0; c < 3; ++c)
            sum.received[c] += glossy[c] * vec3(cosine * piece.y, sine * piece.y, piece.x);
        sent += glossy;
#endif
        slice = addLegendreSegment(slice, next, sent, 1.0);
        highest = next;
        momentsBelow = moments;
    }
    AzimuthTerms terms = azimuthTerms(cosine, sine);
    sum.incident[0] = addSlice(sum.incident[0], slice.red, terms);
    sum.incident[1] = addSlice(sum.incident[1], slice.green, terms);
    sum.incident[2] = addSlice(sum.incident[2], slice.blue, terms);
    return sum;
}

// own: gloss, exponent
void sendGloss(ivec2 post, vec3 normal, vec2 own)
{
    Length here = postHeight(heights, post + frame);
    FromTerrain sum;
    sum.incident = ShVector[3](shZero(), shZero(), shZero());
    sum.received = mat3(0.0);
    for (int k = 0; k < azimuths; ++k)
        sum = addAzimuth(sum, post, here, normal, k);
    float width = 2.0 * PI / float(azimuths);
    for (int c = 0; c < 3; ++c)
    {
        ShVector sent =
            glossyExit(shScaleBands(sum.incident[c], vec4(width)), normal, own.x, own.y);
        for (int j = 0; j < 4; ++j)
        {
            ivec3 texel = ivec3(post, 4 * c + j);
            imageStore(exitLight, texel, halves(sent.c[j]));
            imageStore(glossLight, texel, halves(texelFetch(lightBefore, texel, 0) + sent.c[j]));
        }
    }
    imageStore(glossLight, ivec3(post, 12), halves(vec4(normal.xy, own)));
#ifndef SCALAR
    vec3 irradiance = normal * sum.received / PI;
    imageStore(light, post,
               vec4(roundedToHalf(texelFetch(diffuse, post, 0).rgb + irradiance), 1.0));
#endif
}
#endif

void main()
{
    ivec2 post = ivec2(INVOCATION.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    if (isVoid(postHeight(heights, post + frame)))
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
    vec3 normal = postNormal(heights, post + frame,
                             texelFetch(eastSpacings, ivec2(0, post.y), 0).x, northSpacing);
    vec2 own = texelFetch(material, min(post, textureSize(material, 0) - 1), 0).xy;
    sendGloss(post, normal, own);
}
