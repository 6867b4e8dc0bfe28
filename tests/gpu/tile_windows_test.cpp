// One terrain as many tiles, each with nested windows around it, against the same terrain in one
// piece and against the exhaustive reference. The bounds are those that the project promises
// (docs/methods/tiles.md has what was measured).
#include "support/GlContext.h"
#include "support/Horizons.h"
#include "support/SharedData.h"
#include "support/Tiles.h"

#include "core/MemorySource.h"
#include "core/SyntheticTerrain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{
constexpr double degrees = 180.0 / 3.14159265358979323846;

DemTile terrain(TerrainKind kind, int side)
{
    return generateTerrain(kind, side, side, 30.0, 7).value();
}

Differences measureHorizons(osg::State& state, const DemTile& tile, HorizonQuality quality,
                            int side, const char* name)
{
    const TileCase lit = underSky(32, quality);
    const std::clock_t start = std::clock();
    const std::vector<float> whole = inOnePiece(state, tile, lit, horizonsOf);
    const std::clock_t middle = std::clock();
    const std::vector<float> tiles = inTiles(state, tile, lit, side, horizonsOf);
    const double ratio =
        static_cast<double>(std::clock() - middle) / static_cast<double>(middle - start);
    const Differences found = differencesOf(whole, tiles);
    std::printf("%-10s %-6s %2d tiles: median %.5f mean %.5f p99 %.4f worst %.2f degrees, %.2f "
                "of the time\n",
                name, toString(quality), side * side, found.median, found.mean, found.p99,
                found.worst, ratio);
    return found;
}

void expectShading(osg::State& state, const DemTile& tile, int bounces, const char* name)
{
    const LightDifferences found = lightDifferences(state, tile, inTheAfternoon(16, bounces), 2);
    std::printf("%-10s 4 tiles, %d bounces: shading: median %.5f mean %.5f p99 %.5f worst %.3f; "
                "bounced light: %.2f %%\n",
                name, bounces, found.shading.median, found.shading.mean, found.shading.p99,
                found.shading.worst, found.bounced);
    EXPECT_LE(found.shading.p99, 5e-3);
    EXPECT_LE(found.bounced, 1.5);
}

void expectSkyView(osg::State& state, const DemTile& tile, int side, const char* name)
{
    const std::vector<float> whole = inOnePiece(state, tile, underSky(32), skyViewOf);
    const std::vector<float> tiles = inTiles(state, tile, underSky(32), side, skyViewOf);
    const Differences found = differencesOf(whole, tiles);
    // The jump at the same lines of the untiled light is its own.
    const double seams = seamRatio(tiles, tile.width(), tile.height(), side) /
                         seamRatio(whole, tile.width(), tile.height(), side);
    std::printf("%-10s %2d tiles: sky view: mean %.6f p99 %.5f worst %.4f, seams %.4f\n", name,
                side * side, found.mean, found.p99, found.worst, seams);
    EXPECT_LE(found.p99, 1e-3);
    EXPECT_LE(seams, 1.01);
}

/// A ridge from south to north with its crest at a column, falling by a slope to either side.
DemTile ridge(int width, int height, int crest, double top, double slope)
{
    DemTile tile(width, height, 30.0);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
            tile.setHeight(
                column, row,
                static_cast<float>(std::max(0.0, top - slope * 30.0 * std::abs(column - crest))));
    return tile;
}
} // namespace

TEST(TileWindows, OneTileWithNothingAroundItIsTheSame)
{
    OTL_NEED_GL(context);
    const Differences found = measureHorizons(context->state(), terrain(TerrainKind::Fractal, 300),
                                              HorizonQuality::Normal, 1, "fractal");
    EXPECT_LE(found.worst, 0.003); // an elevation code
}

TEST(TileWindows, HorizonsOfTilesAreThoseOfOnePiece)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const DemTile fractal = terrain(TerrainKind::Fractal, 641);
    const Differences normal =
        measureHorizons(state, fractal, HorizonQuality::Normal, 4, "fractal");
    EXPECT_LE(normal.median, 0.001);
    EXPECT_LE(normal.p99, 0.15);
    EXPECT_LE(measureHorizons(state, fractal, HorizonQuality::Best, 4, "fractal").p99, 0.05);
    const Differences cliffs = measureHorizons(state, terrain(TerrainKind::Cliffs, 641),
                                               HorizonQuality::Normal, 4, "cliffs");
    EXPECT_LE(cliffs.median, 0.001);
    EXPECT_LE(cliffs.p99, 0.6);
}

// As on a projected map: of degrees, tiles and one piece have azimuths of their own middle rows.
TEST(TileWindows, HorizonsOfTilesOfMountainsAreThoseOfOnePiece)
{
    OTL_NEED_GL(context);
    std::optional<DemTile> rainier = realDem("mt_rainier_90m.tif");
    if (!rainier)
        GTEST_SKIP() << "skipped: needs the shared data, and " << sharedData("dem")
                     << " has no mt_rainier_90m.tif (set OTL_SHARED_DIR)";
    rainier->eastSpacings = {rainier->nominalEastSpacing()};
    const Differences found =
        measureHorizons(context->state(), *rainier, HorizonQuality::Normal, 4, "rainier");
    EXPECT_LE(found.median, 0.001);
    EXPECT_LE(found.p99, 0.15);
}

TEST(TileWindows, SkyViewHasNoSeams)
{
    OTL_NEED_GL(context);
    expectSkyView(context->state(), terrain(TerrainKind::Fractal, 641), 4, "fractal");
}

TEST(TileWindows, ShadingOfTilesIsThatOfOnePiece)
{
    OTL_NEED_GL(context);
    const DemTile fractal = terrain(TerrainKind::Fractal, 577);
    for (const int bounces : {0, 3})
        expectShading(context->state(), fractal, bounces, "fractal");
    expectShading(context->state(), terrain(TerrainKind::Cliffs, 577), 1, "cliffs");
}

// Errors of tiles beside those of one piece, both against the reference in double.
TEST(TileWindows, TilesAreAsExactAsOnePiece)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const DemTile tile = terrain(TerrainKind::Fractal, 641);
    const Differences ofWhole = errorsOf(tile, inOnePiece(state, tile, underSky(32), horizonsOf));
    const Differences ofTiles = errorsOf(tile, inTiles(state, tile, underSky(32), 4, horizonsOf));
    std::printf("one piece: mean %.4f p99 %.4f; 16 tiles: mean %.4f p99 %.4f degrees\n",
                ofWhole.mean, ofWhole.p99, ofTiles.mean, ofTiles.p99);
    EXPECT_LE(ofTiles.mean, 0.008); // HorizonAccuracy's bounds
    EXPECT_LE(ofTiles.p99, 0.15);
}

// A ridge 30 km to the east, in windows of level 4 and coarser alone. The plane of light over its
// crest meets the plain at top / tan(elevation) from it; half of the disc is seen there.
TEST(TileWindows, ShadowOfADistantRidgeEndsWhereItShould)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    constexpr int crest = 1101; // at no coarse post
    constexpr double top = 1500.0;
    const DemTile tile = ridge(1160, 96, crest, top, 1.0);
    MemorySource source(tile);
    TileCase lit = underSky(16);
    lit.sky.skyEnabled = false;
    lit.sky.sunEnabled = true;
    lit.sky.sunAzimuth = 90.0;
    const double distance = 30.0 * 1000.0;
    lit.sky.sunElevation = std::atan(top / distance) * degrees;
    const auto windows = readWindows(source, 0, {60, 16, 96, 64}, HorizonQuality::Normal);
    ASSERT_TRUE(windows);
    const int level = (*windows)->levels.back().level;
    ASSERT_GE(level, 3);
    const osg::ref_ptr<TileLight> light = new TileLight(*windows, lit.settings, lit.sky);
    ASSERT_TRUE(light->update(state));
    const std::vector<float> seen = sunOf(state, *light);
    light->releaseGLObjects(&state);
    for (int row = 0; row < 64; ++row)
    {
        double edge = 0.0; // posts in the light, west of the shadow
        for (int column = 0; column < 96; ++column)
            edge += static_cast<double>(seen[static_cast<std::size_t>(row * 96 + column)]);
        EXPECT_NEAR(60.0 + edge - 0.5, crest - 1000.0, 1 << level) << row;
    }
}

// On a planet of 6371 km the ground lies d^2 / 2R = 784.8 m lower at 100 km. Rows have ridges of
// different height, so that the rounding of horizons averages out. The ridge stands on a post of
// all coarse levels, since elsewhere its place is known to half a cell of them.
TEST(TileWindows, GroundSinksAsThePlanetDoes)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    constexpr int away = 3328; // posts: 2 * away is 13 * 512
    constexpr double distance = 100000.0;
    DemTile tile(2 * away + 1, 120, distance / away);
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column)
            tile.setHeight(column, row,
                           column == 2 * away ? 2000.0f + static_cast<float>(row) : 0.0f);
    MemorySource source(tile);
    TileCase lit = underSky(4);
    lit.settings.bodyRadius = 6371000.0;
    const auto windows = readWindows(source, 0, {away, 30, 64, 60}, HorizonQuality::Normal);
    ASSERT_TRUE(windows);
    const osg::ref_ptr<TileLight> light = new TileLight(*windows, lit.settings, lit.sky);
    ASSERT_TRUE(light->update(state));
    const HorizonMap map = light->readHorizons(state);
    light->releaseGLObjects(&state);
    double drop = 0.0;
    for (int row = 0; row < 60; ++row) // in the middle of the whole, looking east
        drop += (2000.0 + 30.0 + row - distance * std::tan(map.elevationAt(0, row, 0) / degrees)) /
                60.0;
    const double exact = distance * distance / (2.0 * 6371000.0);
    std::printf("drop at 100 km: %.2f m, %.2f by the closed form\n", drop, exact);
    EXPECT_NEAR(drop, exact, 1e-3 * exact);
}
