// Posts of 0 and 100 m in turn, cells of 10 m: every cell is a saddle.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardCase.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

// From a low post the four neighbours rise by 10 in 1. Along a diagonal the saddle bulges: its
// slope at the post is sqrt 2 * 10, above every crossing; it counts because the near field looks
// into its cells. From a high post the next high ones are level. All of that lies within two steps,
// which each quality scans exactly.
TEST(Checkerboard, SaddlesInEveryCell)
{
    OTL_NEED_GL(context);
    const HardCase board = {"checkerboard",
                            analytic::checkerboard(67, 64, 10.0, 100.0),
                            8,
                            {{90.0, 45.0}, {45.0, 85.0}}};
    checkHardCase(context->state(), board);
    expectHorizons(context->state(), board,
                   [](int x, int y, const MapDirection& d) -> std::optional<double>
                   {
                       if (x < 2 || y < 2 || x > 64 || y > 61)
                           return std::nullopt;
                       if ((x + y) % 2 == 1)
                           return 0.0;
                       return std::abs(d.east * d.north) < 1e-9
                                  ? 10.0
                                  : analytic::checkerboardDiagonalHorizon(10.0, 100.0);
                   });
}
