// A map origin 1e6 and 1e7 m away, heights far above and below the datum.
#include "support/GlContext.h"
#include "support/HardCase.h"

#include <gtest/gtest.h>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

namespace
{
/// Multiples of 1/128 m: exact in double wherever the origin is; a float at 1e6 m keeps 1/16 m.
double relief(int column, int row)
{
    return ((column * column * 7 + row * 131 + column * row * 3) % 63999) / 128.0;
}

DemTile movedTile(double east, double north, double up)
{
    // Cells of 1/8 m, so that pixel centres are exact in double; a float at 1e7 m keeps 1 m.
    const MemoryDem dem(81, 70, {east, north, 0.125, 0.125, "", false},
                        [&](int x, int y) { return up + relief(x, y) / 512.0; });
    DemTile tile = dem.read();
    EXPECT_EQ(tile.mapOriginX, east + 0.0625);
    EXPECT_EQ(tile.mapOriginY, north + 0.0625);
    EXPECT_EQ(tile.northSpacing, 0.125);
    EXPECT_EQ(tile.eastSpacings.front(), 0.125);
    return tile;
}
} // namespace

// Map coordinates and datum are double and are taken off before anything becomes a float. What a
// whole number of metres moves is therefore the same to the last bit: the bound is 0.
TEST(Origin, MovedByMillionsOfMetresChangesNoBit)
{
    OTL_NEED_GL(context);
    const DemTile here = movedTile(0.0, 0.0, 0.0);
    checkHardCase(context->state(), {"origin", here});
    for (const double far : {1.0e6, 1.0e7})
        for (const double up : {-9.9e5, 0.0, 9.9e5})
        {
            const DemTile there = movedTile(far, -far, up);
            EXPECT_EQ(there.heights(), here.heights()) << far << ' ' << up;
            expectSameLight(context->state(), here, there);
        }
}

// A datum beyond the range of heights can only come from a host, which sets heightOrigin itself.
TEST(Origin, DatumOfAHostChangesNoBit)
{
    OTL_NEED_GL(context);
    const DemTile here = movedTile(0.0, 0.0, 0.0);
    for (const double datum : {1.0e6, 1.0e7})
    {
        DemTile there = here;
        there.heightOrigin = datum;
        there.mapOriginX = there.mapOriginY = datum;
        expectSameLight(context->state(), here, there);
    }
}
