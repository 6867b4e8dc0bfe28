// Stairs: treads of four posts, risers of 8 m in one cell of 10 m.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardCase.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

// The horizon of a tread is the next riser's edge, from an edge itself all further edges at once:
// the hull's comparisons are all ties. A ray that goes mainly east crosses edges in columns, where
// it is sampled: exact for the method. To the west everything lies below.
//
// Not so where a ray leaves by the side before its line does: of edges that tie the hull names the
// farthest, the ray is measured at its own exit instead, and between two edges that is up to 1.15
// degrees lower (draft). So the form speaks of rays that reach the eastern edge.
TEST(Staircase, EdgesInOneLine)
{
    OTL_NEED_GL(context);
    constexpr int tread = 4, width = 98, height = 71;
    const HardCase stairs = {"staircase",
                             analytic::staircase(width, height, 10.0, tread, 8.0),
                             16,
                             {{90.0, 11.31}, {90.0, 38.66}, {135.0, 20.0}}};
    checkHardCase(context->state(), stairs);
    expectHorizons(context->state(), stairs,
                   [](int x, int y, const MapDirection& d) -> std::optional<double>
                   {
                       const int edge = tread - x % tread;
                       const double exit = y + (width - 1 - x) * d.north / d.east;
                       if (std::abs(d.north) > std::abs(d.east) || x < 1 || x + edge >= width ||
                           y <= tread || y >= height - 1 - tread ||
                           (d.east > 0.0 && (exit < 1.0 || exit > height - 2.0)))
                           return std::nullopt;
                       return analytic::staircaseHorizon(10.0, tread, 8.0, x, d);
                   });
}
