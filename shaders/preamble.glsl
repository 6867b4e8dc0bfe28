// GLSL side of the dialect that shaders/lib shares with C++ (the other side is glsl_host.h).
// Quantities are aliases of real, so that signatures carry dimensions.
#define real float
#define Length float
#define Angle float
#define Slope float
#define Radiance float
#define GLSL_CONST const
#define GLSL_ASSERT(condition)
