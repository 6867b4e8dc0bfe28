// Angles, and their 16-bit code.

GLSL_CONST real PI = real(3.14159265358979323846);
GLSL_CONST real HALF_PI = real(1.57079632679489661923);

// Whether a vector, or a cosine with its sine, has unit length but for rounding: for preconditions.
bool isUnit(vec3 v)
{
    return abs(dot(v, v) - real(1.0)) < real(1.0e-4);
}

bool isUnitPair(real cosine, real sine)
{
    return abs(cosine * cosine + sine * sine - real(1.0)) < real(1.0e-4);
}

// atan(slope) [rad], any slope. Polynomial of Abramowitz and Stegun 4.4.49: error below 2e-8 rad
// plus rounding. GLSL's own atan may differ from driver to driver; this one gives the same map on
// all.
Angle elevationOfSlope(Slope slope)
{
    real size = abs(slope);
    bool steep = size > real(1.0);
    real x = steep ? real(1.0) / size : size;
    real y = x * x;
    real p = real(0.0028662257);
    p = p * y - real(0.0161657367);
    p = p * y + real(0.0429096138);
    p = p * y - real(0.0752896400);
    p = p * y + real(0.1065626393);
    p = p * y - real(0.1420889944);
    p = p * y + real(0.1999355085);
    p = p * y - real(0.3333314528);
    real angle = x + x * y * p;
    angle = steep ? HALF_PI - angle : angle;
    return slope < real(0.0) ? -angle : angle;
}

// Elevation code as R16 unorm value (HorizonMap.h): 32768/65535 is level, 1/65535 is -90 degrees,
// 1 is 90 degrees; 0 is a void post.
GLSL_CONST real VOID_CODE = real(0.0);

real codeOfElevation(Angle elevation)
{
    real level = floor(elevation * (real(32767.0) / HALF_PI) + real(0.5)) + real(32768.0);
    return clamp(level, real(1.0), real(65535.0)) / real(65535.0);
}

// code: 0 ... 1
Angle elevationOfCode(real code)
{
    GLSL_ASSERT(code >= real(0.0) && code <= real(1.0));
    return (code * real(65535.0) - real(32768.0)) * (HALF_PI / real(32767.0));
}
