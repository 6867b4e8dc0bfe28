// A raster in degrees across the antimeridian.
#include "support/GlContext.h"
#include "support/HardCase.h"

#include "core/SyntheticTerrain.h"

#include <gtest/gtest.h>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

// Longitudes place a tile and nothing else: only their step is measured. Across 180 degrees,
// however it is written, the light is to the last bit that of the same raster at 10 degrees east.
TEST(Antimeridian, ChangesNoBit)
{
    OTL_NEED_GL(context);
    const DemTile fractal = generateTerrain(TerrainKind::Fractal, 65, 61, 60.0, 17).value();
    const auto at = [&](double west)
    {
        const MemoryDem dem(65, 61, {west, 52.0, 0.2 / 65.0, 0.1 / 65.0, "EPSG:4326", false},
                            [&](int x, int y)
                            { return static_cast<double>(fractal.heightAt(x, y)); });
        return dem.read();
    };
    const DemTile inland = at(10.0);
    checkHardCase(context->state(), {"antimeridian", at(179.9)});
    for (const double west : {179.9, -180.1, 180.0, -180.0, 359.9})
    {
        const DemTile tile = at(west);
        EXPECT_EQ(tile.eastSpacings, inland.eastSpacings) << west;
        EXPECT_EQ(tile.northSpacing, inland.northSpacing) << west;
        expectSameLight(context->state(), inland, tile);
    }
}
