// Posts that stand alone: 1000 m above or below a plain of 30 m cells.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardCase.h"

#include "core/SyntheticTerrain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

namespace
{
constexpr int size = 65, centre = 32;
constexpr double spacing = 30.0, rise = 1000.0;

DemTile onePost(double height)
{
    return analytic::makeTile(size, size, spacing,
                              [&](int x, int y)
                              { return x == centre && y == centre ? height : 0.0; });
}
} // namespace

// A spike of height h at distance d along a grid axis or a diagonal stands on the ray itself, and
// on the line: h/d, exact for the method. (Elsewhere a spike beyond the near field can be missed:
// by a line that passes its flank lower, and on diagonals beside it by rays that meet only the
// insides of its cells. HardCase.h bounds that; a spike of one post leaves it little to say.)
TEST(SpikeAndPit, OneSpike)
{
    OTL_NEED_GL(context);
    const HardCase spike = {"spike", onePost(rise), 8, {{90.0, 30.0}, {45.0, 30.0}, {315.0, 75.0}}};
    checkHardCase(context->state(), spike);
    expectHorizons(context->state(), spike,
                   [](int x, int y, const MapDirection& d) -> std::optional<double>
                   {
                       const int east = centre - x, north = centre - y;
                       const double distance = spacing * std::hypot(east, north);
                       // Straight towards the spike, on one of the eight directions.
                       if (distance == 0.0 ||
                           std::hypot(east * spacing - d.east * distance,
                                      north * spacing - d.north * distance) > 1e-6)
                           return std::nullopt;
                       return rise / distance;
                   });
}

// From the pit the next post is the rim; on a diagonal the bilinear wall is steepest at the pit
// itself, twice as steep as its chord: 2h/(spacing * sqrt 2). To all others the pit is nothing.
TEST(SpikeAndPit, OnePit)
{
    OTL_NEED_GL(context);
    const HardCase pit = {"pit", onePost(-rise), 8, {{90.0, 30.0}, {45.0, 89.0}}};
    checkHardCase(context->state(), pit);
    expectHorizons(context->state(), pit,
                   [](int x, int y, const MapDirection& d) -> std::optional<double>
                   {
                       if (x != centre || y != centre)
                           return 0.0;
                       const bool axis = std::abs(d.east * d.north) < 1e-9;
                       return rise / spacing * (axis ? 1.0 : std::sqrt(2.0));
                   });
}

// Many of both, up to ten cells high: where spikes hide one another.
TEST(SpikeAndPit, FieldOfSpikes)
{
    OTL_NEED_GL(context);
    checkHardCase(
        context->state(),
        {"field of spikes", generateTerrain(TerrainKind::Spikes, 129, 97, spacing, 2).value()});
}
