// From the deepest trench to the highest summit in one tile: -11,000 ... 8,849 m.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardCase.h"

#include <gtest/gtest.h>

#include <random>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

// Neighbours up to 19,849 m apart. Heights are exact in float (H = 11,000 keeps 1/1024 m); the
// bounds of HardCase.h hold with D = 19,849 m, so beyond the near field they say little off the
// axes and the diagonals. Near by, slopes of 200 and more leave no room: rounding moves them by
// 1e-4 degrees.
TEST(HeightRange, NoiseFromTrenchToSummit)
{
    OTL_NEED_GL(context);
    std::mt19937 random(1);
    const DemTile tile = analytic::makeTile(
        96, 77, 90.0,
        [&](int x, int y)
        {
            if (x == 40 && y == 40)
                return -11000.0;
            return x == 41 && y == 40 ? 8849.0 : -11000.0 + static_cast<double>(random() % 19850);
        });
    checkHardCase(context->state(), {"trench and summit, noise", tile});
}

// One plane over all of it, by 204 m per post of 90 m: exact for the method, and whole metres are
// exact in float. The last column stands at the summit, 61 m above its neighbour, and hides
// nothing.
TEST(HeightRange, PlaneFromTrenchToSummit)
{
    OTL_NEED_GL(context);
    const HardCase plane = {"trench to summit, plane",
                            analytic::makeTile(99, 64, 90.0,
                                               [](int x, int)
                                               { return x < 98 ? -11000.0 + 204.0 * x : 8849.0; })};
    checkHardCase(context->state(), plane);
    expectHorizons(context->state(), plane,
                   [](int x, int y, const MapDirection& d) -> std::optional<double>
                   {
                       if (x < 1 || x > 96 || y < 1 || y > 62)
                           return std::nullopt;
                       return analytic::rampHorizon(204.0 / 90.0, 0.0, d);
                   });
}
