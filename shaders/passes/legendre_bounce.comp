// One bounce of diffuse light by the scheme of Nowrouzezahrai and Snyder 2009: per azimuth a casting set
// over pyramid samples (sections 3 and 5), the light of its slice in normalised Legendre polynomials
// (section 4), slices joined to spherical harmonics of order 4 (section 6), and the clamped cosine about
// the normal (section 7).
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D heights;         // R32F [m], framed by `frame` void posts, row 0 south
uniform sampler2D eastSpacings;    // R32F [m], one texel per row
uniform sampler2D stepLengths;     // R32F [m]: ground length of a step of azimuth x in row y
uniform sampler2D radiance;        // what posts send out: radiance times weight, weight
uniform sampler2D heightPyramid;   // RG32F: height times weight, weight
uniform sampler2D radiancePyramid; // RGBA16F, likewise
layout(rgba16f, binding = 0) uniform image2D shading; // += irradiance / pi
layout(rgba16f, binding = 1) writeonly uniform image2D light; // irradiance / pi of this bounce

uniform ivec2 size; // posts
uniform int frame;
uniform int azimuths;
uniform float northSpacing; // [m]
layout(std140, binding = 0) uniform Rays
{
    vec4 directions[256]; // a step: posts to the east, to the north; the unit vector on the ground
};
uniform float samplesPerOctave;
uniform float offset; // [octaves] that a level is finer than the distance
uniform int sampleCount;
uniform int levelCount;
uniform ivec4 levels[16];  // x, y, width, height in the pyramids' textures; the first is not used
uniform vec4 orderWeights; // what the blend between azimuths leaves of each |m| (WedgeMatrices)

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
    vec3 normal = postNormal(heights, post + frame, texelFetch(eastSpacings, ivec2(0, post.y), 0).x,
                             northSpacing);
    vec2 scale = 1.0 / vec2(textureSize(heightPyramid, 0));
    ShVector red = shZero();
    ShVector green = shZero();
    ShVector blue = shZero();
    for (int k = 0; k < azimuths; ++k)
    {
        vec4 direction = directions[k];
        Length stepLength = texelFetch(stepLengths, ivec2(k, post.y), 0).x;
        // The surface's own horizon. The paper has -asin of the cosine between normal and azimuth, which
        // is right only where the normal lies in the slice.
        Slope highest = -dot(normal.xy, direction.zw) / normal.z;
        vec4 below = occlusionBelow(risingDirection(highest));
        vec4 redSlice = vec4(0.0);
        vec4 greenSlice = vec4(0.0);
        vec4 blueSlice = vec4(0.0);
        for (int i = 0; i < sampleCount; ++i)
        {
            float octaves = float(i) / samplesPerOctave;
            float distance = exp2(octaves); // [steps]
            vec2 place = vec2(post) + distance * direction.xy;
            // Room for rounding: the last post of a ray along an edge is inside.
            if (any(lessThan(place, vec2(-1.0e-3))) || any(greaterThan(place, vec2(size) - 0.999)))
                break;
            place = clamp(place, vec2(0.0), vec2(size - 1));
            // The nearest level; a half is up, whichever way the division was rounded.
            int number = clamp(int(floor(octaves - offset + 0.5001)), 0, levelCount - 1);
            vec2 texel = place / float(1 << number) + 0.5;
            ivec4 level = levels[number];
            vec2 rise;
            if (number == 0)
                rise = riseBetweenPosts(heights, place, size, frame, here);
            else
            {
                rise = textureLod(heightPyramid, (vec2(level.xy) + texel) * scale, 0.0).xy;
                rise.x -= here * rise.y;
            }
            Slope slope = rise.x / (max(rise.y, 1.0e-3) * distance * stepLength);
            if (rise.y <= 0.5 || slope <= highest)
                continue;
            vec4 sent = number == 0 ? textureLod(radiance, texel / vec2(size), 0.0)
                                    : textureLod(radiancePyramid, (vec2(level.xy) + texel) * scale, 0.0);
            // The paper's sum over differences of radiance, by differences of elevation.
            vec4 above = occlusionBelow(risingDirection(slope));
            vec4 piece = (above - below) / max(sent.a, 1.0e-3);
            redSlice += sent.r * piece;
            greenSlice += sent.g * piece;
            blueSlice += sent.b * piece;
            highest = slope;
            below = above;
        }
        AzimuthTerms terms = azimuthTerms(direction.z, direction.w);
        red = addSlice(red, redSlice, terms);
        green = addSlice(green, greenSlice, terms);
        blue = addSlice(blue, blueSlice, terms);
    }
    ShVector kernel = shWeighOrders(shOfKernel(lambertEigenvalues(), normal), orderWeights);
    vec3 sum = vec3(shDot(red, kernel), shDot(green, kernel), shDot(blue, kernel)) / PI;
    // Order 4 rings, so the light of a bounce may be below 0; what it is added to stays a radiance.
    vec4 before = imageLoad(shading, post);
    imageStore(shading, post, vec4(roundedToHalf(max(before.rgb + sum, 0.0)), before.a));
    imageStore(light, post, vec4(roundedToHalf(sum), 1.0));
}
