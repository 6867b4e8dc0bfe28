// The order of composition: the one list, read by the C++ compiler and by ShaderLibrary.
#include "angle.glsl"
#include "surface.glsl"
#include "subsampling.glsl"
#include "horizon.glsl"
#include "sky.glsl"
#include "clear_sky.glsl"
#include "legendre.glsl"
#include "environment.glsl"
