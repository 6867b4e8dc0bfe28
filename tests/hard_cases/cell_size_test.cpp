// Cells of 1 mm and of 10 km.
#include "support/GlContext.h"
#include "support/HardCase.h"

#include "core/SyntheticTerrain.h"

#include <gtest/gtest.h>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

// Slopes do not depend on the size of a cell, and float has the same relative precision at each. So
// the bounds, which are in slopes, are those of any terrain of that shape.
TEST(CellSize, OneMillimetreAndTenKilometres)
{
    OTL_NEED_GL(context);
    for (const double spacing : {0.001, 10000.0})
        checkHardCase(context->state(),
                      {spacing < 1.0 ? "cells of 1 mm" : "cells of 10 km",
                       generateTerrain(TerrainKind::Fractal, 97, 65, spacing, 4).value()});
}

// A cell larger by a power of two multiplies every height and distance by it, exactly: no bit of
// the light may change, from 1/1024 m to 8192 m.
TEST(CellSize, PowersOfTwoChangeNoBit)
{
    OTL_NEED_GL(context);
    const DemTile metre = generateTerrain(TerrainKind::Cliffs, 65, 97, 1.0, 5).value();
    for (const double size : {1.0 / 1024.0, 8192.0})
    {
        DemTile tile(65, 97, size);
        for (int y = 0; y < 97; ++y)
            for (int x = 0; x < 65; ++x)
                tile.setHeight(x, y, metre.heightAt(x, y) * static_cast<float>(size));
        expectSameLight(context->state(), metre, tile);
    }
}
