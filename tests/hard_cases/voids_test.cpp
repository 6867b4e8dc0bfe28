// Voids: at every edge, in a ring, scattered, and all but one post.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardCase.h"

#include "core/Raster.h"
#include "core/SyntheticTerrain.h"
#include "lighting/TileLight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

namespace
{
DemTile without(DemTile tile, const std::function<bool(int, int)>& isVoid)
{
    for (int y = 0; y < tile.height(); ++y)
        for (int x = 0; x < tile.width(); ++x)
            if (isVoid(x, y))
                tile.setVoid(x, y);
    return tile;
}
bool scattered(int x, int y)
{
    return (x * 7919 + y * 104729 + x * y * 31) % 97 < 32;
}
} // namespace

// Four voids deep at one edge after the other, then at all. A frame of voids is the edge of the
// data: rays through posts (axes and diagonals) must give the bits of the tile that was cut to
// size. Other lines lie elsewhere between the posts; HardCase.h bounds them.
TEST(Voids, AtEveryEdge)
{
    OTL_NEED_GL(context);
    const DemTile fractal = generateTerrain(TerrainKind::Fractal, 57, 49, 30.0, 11).value();
    for (int edge = 0; edge < 5; ++edge)
    {
        const auto isVoid = [&](int x, int y)
        {
            const bool sides[] = {x<4, x> 52, y<4, y> 44};
            return edge < 4 ? sides[edge] : sides[0] || sides[1] || sides[2] || sides[3];
        };
        const DemTile tile = without(fractal, isVoid);
        checkHardCase(context->state(), {"voids at edge " + std::to_string(edge), tile});
        if (edge < 4)
            continue;
        DemTile cut(49, 41, 30.0);
        for (int y = 0; y < 41; ++y)
            for (int x = 0; x < 49; ++x)
                cut.setHeight(x, y, tile.heightAt(x + 4, y + 4));
        for (const HorizonQuality quality : allQualities())
        {
            const Bits whole = lightingBits(context->state(), tile, quality, 8);
            const Bits part = lightingBits(context->state(), cut, quality, 8);
            for (std::size_t k = 0; k < 8; ++k)
                for (std::size_t y = 0; y < 41; ++y)
                    for (std::size_t x = 0; x < 49; ++x)
                        ASSERT_EQ(part.codes[(k * 41 + y) * 49 + x],
                                  whole.codes[(k * 49 + y + 4) * 57 + x + 4])
                            << k << ' ' << x << ' ' << y;
        }
    }
}

// A ring of voids one post wide around level ground, in level ground: it casts nothing and hides
// nothing, so no horizon stands above the horizontal.
TEST(Voids, RingOnLevelGround)
{
    OTL_NEED_GL(context);
    const auto ring = [](int x, int y)
    { return std::max(std::abs(x - 32), std::abs(y - 30)) == 12; };
    const HardCase level = {"void ring, level",
                            without(analytic::plane(65, 61, 30.0, -4000.0), ring)};
    checkHardCase(context->state(), level);
    expectHorizons(context->state(), level, [](int, int, const MapDirection&) { return 0.0; });
    checkHardCase(context->state(),
                  {"void ring, fractal",
                   without(generateTerrain(TerrainKind::Fractal, 65, 61, 30.0, 12).value(), ring)});
}

TEST(Voids, EveryThirdPost)
{
    OTL_NEED_GL(context);
    checkHardCase(
        context->state(),
        {"scattered voids",
         without(generateTerrain(TerrainKind::Cliffs, 65, 61, 30.0, 13).value(), scattered)});
}

// Rays whose drift is a fraction w/c run through posts, but in float pass them by a hair, now on
// one side, now on the other. A void beside such a post must not cast, not even where hardware that
// fuses a multiplication with an addition makes a weight negative. On level ground nothing rises,
// so the sun is the open one's: a circular segment, within one unit of a half float and the code's
// decoding (sun_test.cpp).
TEST(Voids, BesideRaysThroughPosts)
{
    OTL_NEED_GL(context);
    const DemTile tile = without(analytic::plane(61, 57, 30.0, 8000.0), scattered);
    SkyLight sky;
    sky.skyEnabled = false;
    sky.sunElevation = 0.05;
    const double expected = reference::segmentFraction(sky.sunElevation, 0.0, sky.sunAngularRadius);
    for (const HorizonQuality quality : allQualities())
    {
        LightingSettings settings;
        settings.quality = quality;
        osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
        for (int c = 2; c <= 16; ++c)
            for (int w = 1; w < c; ++w)
            {
                sky.sunAzimuth = std::atan2(w, c) * 180.0 / 3.14159265358979 + 90.0 * (c % 4);
                lighting->setSky(sky);
                ASSERT_TRUE(lighting->update(context->state()));
                const Raster<osg::Vec4f> shading = lighting->readShading(context->state());
                for (int y = 0; y < 57; ++y)
                    for (int x = 0; x < 61; ++x)
                        if (tile.isValid(x, y))
                        {
                            ASSERT_NEAR(static_cast<double>(shading.at(x, y).a()), expected,
                                        expected / 1024.0 + 5e-5)
                                << w << '/' << c << ", post " << x << ' ' << y << ", "
                                << toString(quality);
                        }
            }
    }
}

// One valid post sees the whole sky, stands level and has no horizon at all: code 1 everywhere.
TEST(Voids, OneValidPost)
{
    OTL_NEED_GL(context);
    DemTile tile(33, 29, 30.0);
    tile.setHeight(20, 7, 1234.5f);
    checkHardCase(context->state(), {"one valid post", tile, 16, {{0.0, 0.01}, {45.0, 90.0}}});
    for (const HorizonQuality quality : allQualities())
    {
        const Bits bits = lightingBits(context->state(), tile, quality);
        for (std::size_t k = 0; k < 16; ++k)
            EXPECT_EQ(bits.codes[(k * 29 + 7) * 33 + 20], 1) << k;
    }
}
