// IEC 61966-2-1. 0 <= colour <= 1.
vec3 linearOfSrgb(vec3 colour)
{
    return mix(colour / 12.92, pow((colour + 0.055) / 1.055, vec3(2.4)),
               vec3(greaterThan(colour, vec3(0.04045))));
}

// Colours beyond 1 are cut.
vec3 srgbOfLinear(vec3 colour)
{
    vec3 inside = clamp(colour, 0.0, 1.0);
    return mix(inside * 12.92, 1.055 * pow(inside, vec3(1.0 / 2.4)) - 0.055,
               vec3(greaterThan(inside, vec3(0.0031308))));
}
