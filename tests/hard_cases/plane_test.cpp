// Planes: level, gently tilted, and at 89 degrees.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardCase.h"

#include "core/Raster.h"
#include "lighting/TileLight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

namespace
{
std::optional<double> inside(int x, int y, double slope)
{
    if (x < 1 || y < 1 || x > 63 || y > 63)
        return std::nullopt;
    return slope;
}
} // namespace

// Level ground is level to the last bit at any height: code 32768 has no rounding.
TEST(Plane, LevelAtAnyHeight)
{
    OTL_NEED_GL(context);
    for (const double height : {0.0, 8848.86, -10935.0, 999999.0})
    {
        const DemTile tile = analytic::plane(65, 65, 30.0, height);
        checkHardCase(context->state(), {"level at " + std::to_string(height), tile});
        for (const HorizonQuality quality : allQualities())
        {
            const Bits bits = lightingBits(context->state(), tile, quality);
            for (std::size_t k = 0; k < 16; ++k)
                for (std::size_t y = 1; y < 64; ++y)
                    for (std::size_t x = 1; x < 64; ++x)
                        ASSERT_EQ(bits.codes[(k * 65 + y) * 65 + x], HorizonMap::levelCode)
                            << height << ' ' << toString(quality);
        }
    }
}

// Rays measure the surface at their own samples, so planes are exact for the method. The
// slopes, 57.25 = tan 88.9993 degrees and 1/8, are such that every height is exact in float.
TEST(Plane, TiltedAtEightyNineDegrees)
{
    OTL_NEED_GL(context);
    for (const auto& [east, north] :
         {std::pair{57.25, 0.0}, {0.0, -57.25}, {40.5, 40.5}, {0.125, 0.0}})
    {
        const double a = east, b = north;
        const HardCase plane = {
            "plane " + std::to_string(east) + ' ' + std::to_string(north),
            analytic::makeTile(65, 65, 10.0,
                               [&](int x, int y) { return 10.0 * (a * (x - 32) + b * (y - 32)); }),
            16,
            {{90.0, 89.5}, {270.0, 1.0}, {180.0, 89.0}}};
        checkHardCase(context->state(), plane);
        expectHorizons(context->state(), plane,
                       [&](int x, int y, const MapDirection& d)
                       { return inside(x, y, analytic::rampHorizon(a, b, d)); });
    }
}

// The sky view of a plane of angle S is (1 + cos S)/2 = 0.50873. The sum over 256 slices is a
// midpoint rule of width w for a function of azimuth that climbs from 0 (uphill) to at most pi/4
// (downhill) and back: off by no more than w/2 times its variation, pi/2, over pi: 0.0062.
TEST(Plane, SkyViewAtEightyNineDegrees)
{
    OTL_NEED_GL(context);
    const DemTile tile = analytic::ramp(65, 65, 10.0, 57.25, 0.0);
    const double expected = analytic::rampSkyView(57.25).surface;
    LightingSettings settings;
    settings.azimuths = 256;
    SkyLight sky;
    sky.sunEnabled = false;
    osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
    ASSERT_TRUE(lighting->update(context->state()));
    const double found = static_cast<double>(lighting->readSkyView(context->state()).at(32, 32));
    std::printf("plane at 89 degrees: sky view %.6f, closed form %.6f\n", found, expected);
    EXPECT_NEAR(found, expected, 0.0062);
}
