// GLSL side of the dialect that shaders/lib shares with C++ (the other side is glsl_host.h).
// Quantities are aliases of real, so that signatures carry dimensions.
#define real float
#define Length float
#define Angle float
#define Slope float
#define Radiance float
// Heights [m], R32F: software OpenGL reads an image in half the time of a texture.
#define HeightMap readonly image2D
#define DistanceVolume sampler3D
#define GLSL_CONST const
#define GLSL_ASSERT(condition)

// The greatest half float. Whether more would be stored as that or as infinity is the driver's
// choice.
const float GREATEST_LIGHT = 65504.0;

// The nearest half float: what storing does with the rest is the driver's choice too, and cutting
// it off would darken everything by 0.03 %.
vec3 roundedToHalf(vec3 x)
{
    uvec3 bits = floatBitsToUint(clamp(x, vec3(-GREATEST_LIGHT), vec3(GREATEST_LIGHT)));
    return uintBitsToFloat((bits + 0x1000u) & 0xffffe000u);
}
