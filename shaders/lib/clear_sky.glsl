// Skies that are computed. Directions are unit vectors: x east, y north, z up, z >= 0.

// Luminance of the CIE overcast sky over that of its zenith (Moon and Spencer 1942; CIE S 011, type
// 16): a third at the horizontal.
real overcastGradation(real z)
{
    GLSL_ASSERT(z >= real(0.0) && z <= real(1.0));
    return (real(1.0) + real(2.0) * z) / real(3.0);
}

// Angle between unit vectors [rad], exact for small ones too.
Angle angleBetween(vec3 a, vec3 b)
{
    GLSL_ASSERT(isUnit(a) && isUnit(b));
    return real(2.0) * elevationOfSlope(length(a - b) / max(length(a + b), real(1.0e-6)));
}

// Relative luminance of a clear sky (Perez, Seals and Michalsky 1993, Eq. 1): darker or brighter
// towards the horizontal by abcd.x and y, brighter about the sun by abcd.z and w, and by e where
// light is scattered forwards and backwards. abcd.y < 0; z > 0; gamma: from the sun.
real perez(vec4 abcd, real e, real z, Angle gamma, real cosGamma)
{
    GLSL_ASSERT(abcd.y < real(0.0) && z > real(0.0));
    return (real(1.0) + abcd.x * exp(abcd.y / z)) *
           (real(1.0) + abcd.z * exp(abcd.w * gamma) + e * cosGamma * cosGamma);
}

// What depends on the sun and the air alone: core/ClearSky.h fills it.
struct ClearSky
{
    vec3 sun;
    // Of luminance, x and y (Preetham, Shirley and Smits 1999, appendix A.2): Perez's coefficients,
    // and what they are multiplied by, so that the zenith has its value.
    vec4 luminance;
    vec4 x;
    vec4 y;
    vec3 e;
    vec3 zenith;
    // What linear red, green and blue are multiplied by.
    vec3 gain;
};

// Radiance, in linear red, green and blue of Rec. 709; what lies outside of them is cut off.
vec3 clearSkyRadiance(ClearSky sky, vec3 direction)
{
    real z = max(direction.z, real(1.0e-3));
    Angle gamma = angleBetween(direction, sky.sun);
    real cosGamma = dot(direction, sky.sun);
    real luminance = sky.zenith.x * perez(sky.luminance, sky.e.x, z, gamma, cosGamma);
    real x = sky.zenith.y * perez(sky.x, sky.e.y, z, gamma, cosGamma);
    real y = sky.zenith.z * perez(sky.y, sky.e.z, z, gamma, cosGamma);
    vec3 rgb = vec3(
        real(3.2404542) * x - real(1.5371385) * y - real(0.4985314) * (real(1.0) - x - y),
        real(-0.9692660) * x + real(1.8760108) * y + real(0.0415560) * (real(1.0) - x - y),
        real(0.0556434) * x - real(0.2040259) * y + real(1.0572252) * (real(1.0) - x - y));
    real scale = luminance / y;
    return vec3(max(rgb.x, real(0.0)) * scale * sky.gain.x,
                max(rgb.y, real(0.0)) * scale * sky.gain.y,
                max(rgb.z, real(0.0)) * scale * sky.gain.z);
}
