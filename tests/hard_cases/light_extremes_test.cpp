// Light of 1e6, the greatest that settings allow, and of 0.
#include "support/GlContext.h"
#include "support/HardCase.h"

#include "core/Raster.h"
#include "core/SyntheticTerrain.h"
#include "lighting/TileLight.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

namespace
{
constexpr float most = 1.0e6f;
constexpr float greatestHalf = 65504.0f;

Raster<osg::Vec4f> shadingOf(osg::State& state, const DemTile& tile, const SkyLight& sky)
{
    osg::ref_ptr<TileLight> lighting = new TileLight(tile, LightingSettings(), sky);
    EXPECT_TRUE(lighting->update(state));
    return lighting->readShading(state);
}
} // namespace

// The shading texture is of half floats: light above 65,504 is stored as that, never as infinity.
// Below, light is linear in the sky and the sun: twice the radiance is twice the light, but for one
// unit of a half float each.
TEST(LightExtremes, StayFinite)
{
    OTL_NEED_GL(context);
    const DemTile tile = generateTerrain(TerrainKind::Cliffs, 64, 49, 30.0, 18).value();
    for (const bool sun : {false, true})
    {
        SkyLight sky;
        sky.skyEnabled = !sun;
        sky.sunEnabled = sun;
        sky.skyRadiance = {most, 0.0f, 1.0f};
        sky.sunIrradiance = {most, 0.0f, 3.0f};
        const Raster<osg::Vec4f> shading = shadingOf(context->state(), tile, sky);
        std::size_t saturated = 0;
        for (const osg::Vec4f& light : shading.values())
        {
            ASSERT_TRUE(std::isfinite(light.r()));
            ASSERT_EQ(light.g(), 0.0f);
            ASSERT_TRUE(light.b() >= 0.0f && light.b() <= 1.0f);
            saturated += light.r() == greatestHalf;
            // What is 1e6 times brighter, sun 1e6/3, is so or is saturated.
            const double blue = static_cast<double>(light.b()) * (sun ? 1e6 / 3.0 : 1e6);
            const double expected = std::min(blue, static_cast<double>(greatestHalf));
            // Of half floats below 2^-14 the unit is 2^-24 throughout.
            const double bound =
                expected / 512.0 +
                (static_cast<double>(light.b()) < 1.0 / 16384.0 ? 1e6 / 16777216.0 : 0.0);
            ASSERT_NEAR(static_cast<double>(light.r()), expected, bound);
        }
        EXPECT_GT(saturated, 0u);
    }
}

TEST(LightExtremes, NoLightIsExactlyNone)
{
    OTL_NEED_GL(context);
    const DemTile tile = generateTerrain(TerrainKind::Cliffs, 64, 49, 30.0, 18).value();
    SkyLight sky;
    sky.skyRadiance = sky.sunIrradiance = {0.0f, 0.0f, 0.0f};
    const Raster<osg::Vec4f> shading = shadingOf(context->state(), tile, sky);
    for (const osg::Vec4f& light : shading.values())
        ASSERT_TRUE(light.r() == 0.0f && light.g() == 0.0f && light.b() == 0.0f);
}
