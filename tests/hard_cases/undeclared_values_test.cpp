// NaN, infinities, 3.4e38 and the like, in a raster that declares no nodata value, or set by a
// host.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardCase.h"

#include "core/SyntheticTerrain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

namespace
{
const double values[] = {std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::infinity(),
                         -std::numeric_limits<double>::infinity(),
                         3.4e38,
                         -3.4e38,
                         3.4028234663852886e38,
                         -3.4028234663852886e38,
                         1e30,
                         -1e30, // what stands for a void in the height texture
                         1000001.0,
                         -1000001.0,
                         -32768.0,
                         -99999.0};

/// A value for about one post in nine, else nothing.
const double* valueAt(int x, int y)
{
    const int at = (x * 31 + y * 17 + x * y) % 117;
    return at < 13 ? &values[at] : nullptr;
}
} // namespace

// Each of them is a void, so the light is that of the tile with these posts void, to the last bit.
TEST(UndeclaredValues, InARaster)
{
    OTL_NEED_GL(context);
    const DemTile fractal = generateTerrain(TerrainKind::Fractal, 64, 55, 30.0, 14).value();
    for (const bool floatValues : {false, true})
    {
        // Whole metres: the origin that the reader takes off changes no bit.
        const auto heightOf = [&](int x, int y)
        { return std::round(static_cast<double>(fractal.heightAt(x, y))); };
        const MemoryDem dem(64, 55, {0.0, 0.0, 30.0, 30.0, "", floatValues},
                            [&](int x, int y)
                            { return valueAt(x, y) ? *valueAt(x, y) : heightOf(x, y); });
        const DemTile found = dem.read();
        DemTile expected(64, 55, 30.0);
        for (int y = 0; y < 55; ++y)
            for (int x = 0; x < 64; ++x)
                if (!valueAt(x, y))
                    expected.setHeight(x, y,
                                       static_cast<float>(heightOf(x, y) - found.heightOrigin));
        EXPECT_EQ(found.validity(), expected.validity());
        EXPECT_EQ(found.heights(), expected.heights());
        expectSameLight(context->state(), found, expected);
        checkHardCase(context->state(), {"undeclared values, raster", found});
    }
}

// A host hands heights over one by one; -32768 m is then a height like another, deep as it is, and
// what cannot be one is void.
TEST(UndeclaredValues, SetByAHost)
{
    OTL_NEED_GL(context);
    DemTile tile = generateTerrain(TerrainKind::Fractal, 64, 55, 30.0, 14).value();
    DemTile expected = tile;
    for (int y = 0; y < 55; ++y)
        for (int x = 0; x < 64; ++x)
            if (const double* value = valueAt(x, y))
            {
                tile.setHeight(x, y, static_cast<float>(*value));
                if (*value >= -1e6 && *value <= 1e6)
                    expected.setHeight(x, y, static_cast<float>(*value));
                else
                    expected.setVoid(x, y);
            }
    EXPECT_EQ(tile.validity(), expected.validity());
    EXPECT_EQ(tile.heights(), expected.heights());
    checkHardCase(context->state(), {"undeclared values, host", tile});
}
