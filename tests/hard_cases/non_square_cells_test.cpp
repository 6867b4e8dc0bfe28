// Cells four times as long as wide, both ways.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardCase.h"

#include "core/SyntheticTerrain.h"

#include <gtest/gtest.h>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

namespace
{
DemTile withCells(DemTile tile, double east, double north)
{
    tile.eastSpacings = {east};
    tile.northSpacing = north;
    return tile;
}
} // namespace

// Rays are straight on the ground, not on the grid, and distances are metres: bounds as for
// squares.
TEST(NonSquareCells, FractalOneToFour)
{
    OTL_NEED_GL(context);
    const DemTile fractal = generateTerrain(TerrainKind::Fractal, 97, 81, 20.0, 6).value();
    checkHardCase(context->state(), {"cells 10 x 40 m", withCells(fractal, 10.0, 40.0)});
    checkHardCase(context->state(), {"cells 40 x 10 m", withCells(fractal, 40.0, 10.0)});
}

// A plane of slope 1/2 eastwards and 1/4 northwards, in metres: exact for the method, and heights
// are whole numbers. With the spacings swapped it would be 2 and 1/16.
TEST(NonSquareCells, PlaneOneToFour)
{
    OTL_NEED_GL(context);
    for (const double east : {10.0, 40.0})
    {
        const double north = 400.0 / east;
        const DemTile tile = withCells(
            analytic::makeTile(70, 65, 1.0,
                               [&](int x, int y) { return 0.5 * east * x + 0.25 * north * y; }),
            east, north);
        expectHorizons(context->state(), {"plane, non-square cells", tile},
                       [](int x, int y, const MapDirection& d) -> std::optional<double>
                       {
                           if (x < 1 || y < 1 || x > 68 || y > 63)
                               return std::nullopt;
                           return analytic::rampHorizon(0.5, 0.25, d);
                       });
    }
}
