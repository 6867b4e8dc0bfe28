// Odd, prime and power-of-two sizes, and one less or more.
#include "support/GlContext.h"
#include "support/HardCase.h"

#include "core/SyntheticTerrain.h"

#include <gtest/gtest.h>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

// Work groups are 32 lines, 8 x 8 and 16 x 4 blocks of eight posts; hulls are looked at every 16
// steps. Sizes stand at, before and after each of these numbers. The bounds are those of
// HardCase.h.
TEST(Sizes, OddPrimeAndPowerOfTwo)
{
    OTL_NEED_GL(context);
    for (const auto& [width, height] : {std::pair{3, 3},
                                        {7, 9},
                                        {8, 8},
                                        {15, 33},
                                        {16, 16},
                                        {17, 31},
                                        {32, 64},
                                        {61, 53},
                                        {63, 65},
                                        {64, 64},
                                        {127, 16},
                                        {128, 97},
                                        {16, 129}})
        checkHardCase(context->state(),
                      {std::to_string(width) + " x " + std::to_string(height),
                       generateTerrain(TerrainKind::Fractal, width, height, 30.0, 15).value(), 8});
}
