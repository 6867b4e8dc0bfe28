// A cube map of an environment convolved with a kernel, from its spherical harmonics of order
// ORDER: the second of King's two passes (King 2005, section 10.3.2).
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D harmonics; // RGBA32F, column i: coefficient i
layout(rgba16f, binding = 0) writeonly uniform imageCube map;
uniform float bands[6]; // what the kernel multiplies each band by
#ifdef DISC
// Elevation of the horizon [rad] towards the disc's left, centre and right: three texels.
uniform sampler2D sunHorizon;

float alpha()
{
    vec3 above;
    for (int i = 0; i < 3; ++i)
        above[i] = sunElevation - max(texelFetch(sunHorizon, ivec2(i, 0), 0).x, 0.0);
    return visibleDiscFractionAcross(above.x, above.y, above.z, sunRadius);
}
#else

float alpha()
{
    return sunOff;
}
#endif

void main()
{
    ivec3 texel = ivec3(INVOCATION.xyz);
    ivec2 size = imageSize(map).xy;
    if (texel.x >= size.x || texel.y >= size.y)
        return;
    vec2 place = (2.0 * vec2(texel.xy) + 1.0) / vec2(size) - 1.0;
    ShTerms terms = shTerms(normalize(cubeDirection(texel.z, place.x, place.y)));
    vec3 sum = vec3(0.0);
    for (int l = 0; l < ORDER; ++l)
        for (int i = l * l; i < (l + 1) * (l + 1); ++i)
            sum += bands[l] * terms.y[i] * texelFetch(harmonics, ivec2(i, 0), 0).rgb;
    // Harmonics of a limited order ring below 0.
    imageStore(map, texel, vec4(roundedToHalf(max(sum, 0.0)), roundedToHalf(vec3(alpha())).x));
}
