// Rasters in degrees at 0, 38, 60 and 80 degrees of latitude.
#include "support/GlContext.h"
#include "support/HardCase.h"

#include "core/SyntheticTerrain.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr int size = 65;
constexpr double step = 1.0 / 1200.0; // three arc seconds

/// Heights of a fractal of 90 m cells.
double fractalAt(int x, int y)
{
    static const DemTile fractal =
        generateTerrain(TerrainKind::Fractal, size, size, 90.0, 16).value();
    return static_cast<double>(fractal.heightAt(x, y));
}
} // namespace

class Geographic : public ::testing::TestWithParam<double>
{
};

// Closed form on WGS 84 (e² = 0.00669438): a degree east is N(φ) cos φ = a cos φ/√(1 − e² sin² φ),
// per row; a degree north M(φ) = a(1 − e²)/(1 − e² sin² φ)^1.5, of the middle. In double: 1e-12.
// The light against the reference, which lays rays out with the middle row's spacing, as the method
// does.
TEST_P(Geographic, SpacingsAndLight)
{
    OTL_NEED_GL(context);
    const double south = GetParam() - 0.5 * size * step;
    const MemoryDem dem(size, size, {10.0, south, step, step, "EPSG:4326", false}, fractalAt);
    const DemTile tile = dem.read();
    const double a = 6378137.0, f = 1.0 / 298.257223563, e2 = f * (2.0 - f);
    ASSERT_EQ(tile.eastSpacings.size(), static_cast<std::size_t>(size));
    for (int y = 0; y < size; ++y)
    {
        const double latitude = (south + (y + 0.5) * step) * pi / 180.0;
        const double w = std::sqrt(1.0 - e2 * std::pow(std::sin(latitude), 2));
        const double east = step * pi / 180.0 * a * std::cos(latitude) / w;
        EXPECT_NEAR(tile.eastSpacing(y) / east, 1.0, 1e-12) << y;
    }
    const double w = std::sqrt(1.0 - e2 * std::pow(std::sin(GetParam() * pi / 180.0), 2));
    EXPECT_NEAR(tile.northSpacing / (step * pi / 180.0 * a * (1.0 - e2) / (w * w * w)), 1.0, 1e-12);
    checkHardCase(context->state(), {"geographic, latitude " + std::to_string(GetParam()), tile});
}

// A slope of 1/2 eastwards in the metres of each row, 1/2 northwards in those of the middle.
// Looking east, north and back a ray stays in its row or column, so the horizon is exactly that;
// heights up to 4 km are rounded to float by 1.2e-4 m, less than 1e-5 rad over the shortest step,
// 16 m, twice.
TEST_P(Geographic, RampAlongRowsAndColumns)
{
    OTL_NEED_GL(context);
    const double south = GetParam() - 0.5 * size * step;
    const MemoryDem flat(size, size, {10.0, south, step, step, "EPSG:4326", false},
                         [](int, int) { return 0.0; });
    const DemTile metres = flat.read();
    for (const bool east : {true, false})
    {
        DemTile tile = metres;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                tile.setHeight(x, y,
                               static_cast<float>(east ? 0.5 * tile.eastSpacing(y) * (x - 32)
                                                       : 0.5 * tile.northSpacing * (y - 32)));
        expectHorizons(
            context->state(), {east ? "geographic ramp, east" : "geographic ramp, north", tile, 4},
            [&](int x, int y, const MapDirection& d) -> std::optional<double>
            {
                if (std::abs(east ? d.north : d.east) > 0.5 || x < 1 || y < 1 || x > size - 2 ||
                    y > size - 2)
                    return std::nullopt;
                return 0.5 * (east ? d.east : d.north);
            },
            2e-5 * 180.0 / pi);
    }
}

INSTANTIATE_TEST_SUITE_P(Latitudes, Geographic, ::testing::Values(0.0, 38.0, 60.0, 80.0),
                         [](const auto& latitude)
                         { return std::to_string(static_cast<int>(latitude.param)); });
