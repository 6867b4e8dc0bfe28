// Heights that are denormal floats, negative zeros among them. Hardware may take them as 0.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardCase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

// Slopes of 1e-38 and less are far below a code, 2.7e-3 degrees, and below what a normal or a sum
// of the sky can hold: the light is that of level ground, to the last bit, whether or not denormals
// are taken as 0.
TEST(Denormals, AreLevelGround)
{
    OTL_NEED_GL(context);
    const DemTile tile = analytic::makeTile(
        65, 48, 1.0,
        [](int x, int y)
        {
            const double steps = (x * 7919 + y * 104729) % 2001 - 1000;
            return steps == 0.0
                       ? -0.0
                       : steps * static_cast<double>(std::numeric_limits<float>::denorm_min());
        });
    ASSERT_EQ(std::fpclassify(tile.heightAt(3, 5)), FP_SUBNORMAL);
    checkHardCase(context->state(), {"denormals", tile});
    expectSameLight(context->state(), tile, analytic::plane(65, 48, 1.0, 0.0));
}

// Beside a real relief they are 0 m.
TEST(Denormals, BesideAWall)
{
    OTL_NEED_GL(context);
    const auto wall = [](float ground)
    {
        return analytic::makeTile(65, 48, 10.0,
                                  [&](int x, int) { return x >= 40 ? 100.0 : double(ground); });
    };
    checkHardCase(context->state(), {"denormals and a wall",
                                     wall(std::numeric_limits<float>::denorm_min() * 999.0f)});
    expectSameLight(context->state(), wall(std::numeric_limits<float>::denorm_min() * 999.0f),
                    wall(0.0f));
}
