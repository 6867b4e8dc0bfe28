// Bounces on hostile ground. With albedo 1 below a white sky of radiance 1 nothing may get more
// than 1, voids get nothing, and every number is one.
#include "core/SyntheticTerrain.h"
#include "lighting/TileLight.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

using namespace osgTerrainLight;

TEST(Bounces, MakeNoLightOnHostileGround)
{
    OTL_NEED_GL(context);
    DemTile holes = *generateTerrain(TerrainKind::Cliffs, 29, 26, 10.0, 2);
    for (int row = 0; row < holes.height(); ++row)
        for (int column = 0; column < holes.width(); ++column)
            if ((column * 7 + row * 3) % 5 == 0 || column > 24)
                holes.setVoid(column, row);
    const std::vector<std::pair<std::string, DemTile>> grounds = {
        {"checkerboard", analytic::checkerboard(23, 22, 10.0, 100.0)},
        {"cliffs", *generateTerrain(TerrainKind::Cliffs, 33, 30, 10.0, 1)},
        {"spikes", *generateTerrain(TerrainKind::Spikes, 31, 33, 10.0, 1)},
        {"holes", holes},
        {"two rows",
         analytic::makeTile(40, 2, 10.0,
                            [](int column, int row) { return row * 50.0 + (column % 3) * 20.0; })},
        {"two posts",
         analytic::makeTile(2, 2, 10.0, [](int column, int row) { return 10.0 * column * row; })}};
    for (const auto& [name, tile] : grounds)
    {
        LightingSettings settings;
        settings.albedo = {1.0f, 1.0f, 1.0f};
        settings.bounces = 8;
        SkyLight sky;
        sky.sunEnabled = false;
        sky.skyRadiance = {1.0f, 1.0f, 1.0f};
        const osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
        ASSERT_TRUE(lighting->update(context->state()).ok()) << name;
        const auto shading = lighting->readShading(context->state());
        float most = 0.0f;
        for (std::size_t i = 0; i < shading.size(); ++i)
        {
            const float light = shading.values()[i].g();
            ASSERT_TRUE(std::isfinite(light)) << name << ' ' << i;
            if (!tile.validity()[i])
            {
                EXPECT_EQ(light, 0.0f) << name << ' ' << i;
            }
            most = std::max(most, light);
        }
        std::cout << name << ": at most " << most << '\n';
        EXPECT_LE(most, 1.01f) << name;
        EXPECT_GT(most, 0.5f) << name;
        lighting->releaseGLObjects(&context->state());
    }
}
