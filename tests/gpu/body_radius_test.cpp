#include "lighting/TileLight.h"

#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

using namespace osgTerrainLight;

namespace
{
constexpr double degreesPerRadian = 180.0 / 3.14159265358979323846;
constexpr double earth = 6371000.0;
} // namespace

// MATHS: over 30 km the ground drops by 61 m where light is bent as usual.
TEST(BodyRadius, GroundSinksByTheFormula)
{
    const DemTile tile(121, 121, 500.0);
    EXPECT_NEAR(tile.sinkAt(120, 60, earth / (1.0 - 0.13)), 61.4, 0.1);
    EXPECT_NEAR(tile.sinkAt(60, 0, earth / (1.0 - 0.13)), 61.4, 0.1);
    EXPECT_NEAR(tile.sinkAt(120, 120, earth), 2.0 * tile.sinkAt(120, 60, earth), 1e-9);
    EXPECT_EQ(tile.sinkAt(60, 60, earth), 0.0);
    EXPECT_EQ(tile.sinkAt(120, 60, 0.0), 0.0);
}

// A ridge of 1,000 m on a planet whose ground is level otherwise, seen from the west: its crest
// stands lower than on a plane by what the ground sinks, in closed form. Horizon codes step by
// 0.0027 degrees.
TEST(BodyRadius, DistantRidgeStandsLower)
{
    OTL_NEED_GL(context);
    constexpr int side = 161, ridge = 150;
    constexpr double spacing = 500.0, crest = 1000.0;
    const DemTile tile = analytic::makeTile(
        side, side, spacing, [](int column, int) { return column == ridge ? crest : 0.0; });
    for (const double radius : {0.0, earth, 1737400.0})
    {
        LightingSettings settings;
        settings.azimuths = 4;
        settings.quality = HorizonQuality::Best;
        settings.bodyRadius = radius;
        SkyLight sky;
        sky.sunEnabled = false;
        const osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
        ASSERT_TRUE(lighting->update(context->state()).ok());
        const HorizonMap map = lighting->readHorizons(context->state());
        for (const int column : {5, 40, 80, 120})
        {
            const double middle = 0.5 * (side - 1) * spacing;
            const double from = column * spacing - middle, to = ridge * spacing - middle;
            const double sink = radius > 0.0 ? (to * to - from * from) / (2.0 * radius) : 0.0;
            // West of the middle the ground itself rises towards it, most from one post to the
            // next.
            const double ground = radius > 0.0 ? -(2.0 * from + spacing) / (2.0 * radius) : 0.0;
            const double expected =
                std::atan(std::max((crest - sink) / (to - from), ground)) * degreesPerRadian;
            EXPECT_NEAR(map.elevationAt(column, side / 2, 0), expected, 0.005)
                << radius << ' ' << column;
        }
        // Level ground: to the north nothing rises above the plane of the middle, and no post is
        // shaded.
        EXPECT_LE(map.elevationAt(80, 80, 1), 0.003) << radius;
        lighting->releaseGLObjects(&context->state());
    }
}

// The same heights, once given and once uploaded: two ways to sink, of which one is a shader's.
TEST(BodyRadius, MovingHeightsSinkAlike)
{
    OTL_NEED_GL(context);
    const DemTile tile = analytic::makeTile(
        40, 30, 100.0, [](int column, int row) { return 30.0 * std::sin(0.4 * column) + row; });
    LightingSettings settings;
    settings.bodyRadius = 20000.0;
    const osg::ref_ptr<TileLight> still = new TileLight(tile, settings, SkyLight());
    const osg::ref_ptr<TileLight> moving = new TileLight(tile, settings, SkyLight());
    moving->setHeights(tile.heights());
    for (const auto& lighting : {still, moving})
        ASSERT_TRUE(lighting->update(context->state()).ok());
    const auto expected = still->readShading(context->state());
    const auto found = moving->readShading(context->state());
    for (std::size_t i = 0; i < expected.size(); ++i)
        for (unsigned c = 0; c < 4; ++c)
            ASSERT_NEAR(found.values()[i][c], expected.values()[i][c], 2e-3f) << i;
    settings.bodyRadius = 0.0;
    for (const auto& lighting : {still, moving})
    {
        lighting->setSettings(settings);
        ASSERT_TRUE(lighting->update(context->state()).ok());
    }
    const osg::ref_ptr<TileLight> flat = new TileLight(tile, settings, SkyLight());
    ASSERT_TRUE(flat->update(context->state()).ok());
    EXPECT_EQ(still->readShading(context->state()).values(),
              flat->readShading(context->state()).values());
    EXPECT_EQ(moving->readShading(context->state()).values(),
              flat->readShading(context->state()).values());
    for (const auto& lighting : {still, moving, flat})
        lighting->releaseGLObjects(&context->state());
}
