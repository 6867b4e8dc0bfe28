// Suns at 0.01 degrees, at the zenith, below the horizon, exactly along the grid and its diagonals.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardCase.h"

#include "core/Raster.h"
#include "core/SyntheticTerrain.h"
#include "lighting/TileLight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double leastHalf = 1.0 / (1 << 24);

Raster<osg::Vec4f> shadingOf(osg::State& state, const DemTile& tile, HorizonQuality quality,
                             const SkyLight& sky)
{
    LightingSettings settings;
    settings.quality = quality;
    osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
    EXPECT_TRUE(lighting->update(state));
    return lighting->readShading(state);
}

SkyLight sunAt(double azimuth, double elevation)
{
    SkyLight sky;
    sky.sunAzimuth = azimuth;
    sky.sunElevation = elevation;
    return sky;
}
} // namespace

// On level ground the visible part is the circular segment above the horizontal, the light that
// part times the sine of the elevation. Bounds: half a unit of a half float, 2^-11 of the value;
// and the elevation in float, u·e over the radius r (see HardCase.h), which at 0.01 degrees is
// nothing, plus the horizon code's decoding, 3.8e-7 rad/r·2/pi = 5e-5.
TEST(Sun, LowOverLevelGround)
{
    OTL_NEED_GL(context);
    const DemTile tile = analytic::plane(48, 40, 30.0, 500.0);
    double worst = 0.0;
    for (const HorizonQuality quality : allQualities())
        for (const double elevation : {-0.2667, -0.2665, -0.2, -0.01, 0.0, 0.01, 0.2, 0.2667})
        {
            SkyLight sky = sunAt(123.0, elevation);
            sky.skyEnabled = false;
            const double expected = reference::segmentFraction(elevation, 0.0, 0.2666);
            const double facing = static_cast<double>(sky.sunIrradiance[0]) / pi *
                                  std::max(0.0, std::sin(elevation * pi / 180.0));
            const Raster<osg::Vec4f> shading = shadingOf(context->state(), tile, quality, sky);
            for (const osg::Vec4f& found : shading.values())
            {
                const double visible = static_cast<double>(found.a());
                const double bound = expected / 2048.0 + 5e-5;
                worst = std::max(worst, std::abs(visible - expected));
                ASSERT_NEAR(visible, expected, bound) << elevation;
                ASSERT_NEAR(static_cast<double>(found.r()), facing * expected,
                            facing * bound + leastHalf)
                    << elevation;
            }
        }
    std::printf("sun over level ground: visible fraction off by %.6f\n", worst);
}

// Wholly below the horizontal it is off: whether by a hair or at the nadir, the same bits.
TEST(Sun, BelowTheHorizon)
{
    OTL_NEED_GL(context);
    const DemTile tile = generateTerrain(TerrainKind::Fractal, 64, 49, 30.0, 8).value();
    checkHardCase(
        context->state(),
        {"sun below the horizon", tile, 16, {{30.0, -0.1}, {30.0, -0.3}, {200.0, -90.0}}});
    for (const HorizonQuality quality : allQualities())
        EXPECT_TRUE(lightingBits(context->state(), tile, quality, 16, sunAt(30.0, -0.3)) ==
                    lightingBits(context->state(), tile, quality, 16, sunAt(210.0, -90.0)));
}

// At the zenith the azimuth means nothing: where no horizon reaches 89.7 degrees, the same bits for
// each.
TEST(Sun, AtTheZenith)
{
    OTL_NEED_GL(context);
    const DemTile tile = generateTerrain(TerrainKind::Fractal, 64, 49, 30.0, 9).value();
    checkHardCase(context->state(), {"sun at the zenith", tile, 16, {{0.0, 90.0}, {77.0, 89.9}}});
    for (const HorizonQuality quality : allQualities())
    {
        const Bits north = lightingBits(context->state(), tile, quality, 16, sunAt(0.0, 90.0));
        for (const double azimuth : {45.0, 123.4, 270.0})
            EXPECT_TRUE(lightingBits(context->state(), tile, quality, 16, sunAt(azimuth, 90.0)) ==
                        north)
                << azimuth;
    }
}

// Rays through posts only. On axes and diagonals of square cells the far field is exact but for the
// insides of its cells (HardCase.h), so shadows are bounded on both sides nearly everywhere. A turn
// more or less changes no bit.
TEST(Sun, AlongTheGridAndItsDiagonals)
{
    OTL_NEED_GL(context);
    const DemTile tile = generateTerrain(TerrainKind::Cliffs, 81, 80, 30.0, 10).value();
    HardCase cliffs = {"sun along the grid", tile, 8, {}};
    for (const double azimuth : {0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0})
        for (const double elevation : {0.01, 12.0})
            cliffs.suns.push_back({azimuth, elevation});
    checkHardCase(context->state(), cliffs);
    for (const double azimuth : {45.0, 90.0})
        for (const double turn : {-360.0, 360.0, 3600.0})
            EXPECT_TRUE(lightingBits(context->state(), tile, HorizonQuality::Normal, 8,
                                     sunAt(azimuth + turn, 12.0)) ==
                        lightingBits(context->state(), tile, HorizonQuality::Normal, 8,
                                     sunAt(azimuth, 12.0)))
                << azimuth << ' ' << turn;
}
