// Layers of heights that lie over each other, against closed forms at each post.
#include "io/CompositeDem.h"
#include "support/MapTransform.h"
#include "support/MemoryRaster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

using namespace osgTerrainLight;

namespace
{
double plane(double x, double y)
{
    return 100.0 + 0.02 * (x - 500000.0) + 0.03 * (y - 4000000.0);
}

const std::vector<double> placeOfBase = {500000, 10, 0, 4000400, 0, -10};

std::string base()
{
    return rasterOfPlaces(30, 40, placeOfBase, plane);
}

CompositeDem composed(const std::vector<std::string>& paths, int maxSide = 2048)
{
    std::vector<DemLayer> layers;
    for (const std::string& path : paths)
        layers.push_back({path, {}});
    CompositeDem result = readComposite(layers, maxSide);
    EXPECT_TRUE(result.tile);
    if (!result.tile)
        result.tile.emplace(1, 1, 1.0);
    return result;
}

double heightAt(const DemTile& tile, int column, int row)
{
    return tile.isValid(column, row) ? tile.heightOrigin + double(tile.heightAt(column, row))
                                     : std::nan("");
}

/// Every post against expected(x, y) of its map place; NaN: void.
void expectHeights(const DemTile& tile, const std::function<double(double x, double y)>& expected,
                   double tolerance = 1.0e-3)
{
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column)
        {
            const double x = tile.mapOriginX + column * tile.mapStepX;
            const double y = tile.mapOriginY + row * tile.mapStepY;
            const double wanted = expected(x, y);
            const double found = heightAt(tile, column, row);
            ASSERT_EQ(std::isnan(found), std::isnan(wanted)) << x << ", " << y;
            if (!std::isnan(wanted))
            {
                ASSERT_NEAR(found, wanted, tolerance) << x << ", " << y;
            }
        }
}
} // namespace

// Expected: the later layer where it has heights, else the earlier one; its voids let that through.
TEST(CompositeDem, ALaterLayerCoversAnEarlierOneButForItsVoids)
{
    const auto inset = [](double x, double y)
    { return x > 500120.0 && x < 500140.0 && y > 4000150.0 && y < 4000170.0 ? -9999.0 : 800.0; };
    const std::string over = rasterOfPlaces(10, 10, {500100, 10, 0, 4000200, 0, -10}, inset);
    const CompositeDem made = composed({base(), over});
    EXPECT_TRUE(made.leftOut.empty());
    ASSERT_EQ(made.tile->width(), 30);
    ASSERT_EQ(made.tile->height(), 40);
    EXPECT_EQ(made.tile->mapOriginX, 500005.0);
    EXPECT_EQ(made.tile->mapOriginY, 4000005.0);
    expectHeights(*made.tile,
                  [&](double x, double y)
                  {
                      const bool isIn =
                          x > 500100.0 && x < 500200.0 && y > 4000100.0 && y < 4000200.0;
                      return isIn && inset(x, y) > 0.0 ? 800.0 : plane(x, y);
                  });
    // The other way round nothing of the inset is seen.
    expectHeights(*composed({over, base()}).tile, plane);
}

// Expected: rasters side by side make one terrain; between them and beyond them it is void.
TEST(CompositeDem, SpansAllLayers)
{
    const std::string other = rasterOfPlaces(20, 10, {500350, 10, 0, 4000500, 0, -10}, plane);
    const CompositeDem made = composed({base(), other});
    ASSERT_EQ(made.tile->width(), 55);
    ASSERT_EQ(made.tile->height(), 50);
    expectHeights(*made.tile,
                  [](double x, double y)
                  {
                      const bool inBase = x < 500300.0 && y < 4000400.0;
                      const bool inOther = x > 500350.0 && y > 4000400.0;
                      return inBase || inOther ? plane(x, y) : std::nan("");
                  });
    const CompositeDem west = composed({other, base()});
    EXPECT_EQ(west.tile->mapOriginX, 500005.0);
    EXPECT_EQ(west.tile->mapOriginY, 4000005.0);
    EXPECT_EQ(west.tile->validCount(), made.tile->validCount());
}

// Expected: posts are as dense as the densest layer's; a plane stays one between posts, and within
// half a post of the first layer's edge it is level.
TEST(CompositeDem, TheDensestLayerSetsTheSpacing)
{
    const std::string fine = rasterOfPlaces(40, 40, {500100, 2.5, 0, 4000200, 0, -2.5}, plane);
    const CompositeDem made = composed({base(), fine});
    ASSERT_EQ(made.tile->width(), 120);
    ASSERT_EQ(made.tile->height(), 160);
    EXPECT_DOUBLE_EQ(made.tile->northSpacing, 2.5);
    expectHeights(
        *made.tile, [](double x, double y)
        { return plane(std::clamp(x, 500005.0, 500295.0), std::clamp(y, 4000005.0, 4000395.0)); });
}

// Expected: means of the cells; that of a plane is the plane in the middle of the cell.
TEST(CompositeDem, HasAtMostSoManyPostsASide)
{
    const std::string fine = rasterOfPlaces(80, 80, {500100, 1.25, 0, 4000200, 0, -1.25}, plane);
    const CompositeDem made = composed({base(), fine}, 20);
    EXPECT_EQ(made.tile->height(), 20);
    EXPECT_EQ(made.tile->width(), 15);
    EXPECT_DOUBLE_EQ(made.tile->northSpacing, 20.0);
    expectHeights(*made.tile, plane);
}

// Expected: heights that are linear in degrees, at the degrees that PROJ gives for each post; GDAL
// finds places within a hundredth of a pixel, which is 0.01 m here, and rounds less than that.
TEST(CompositeDem, ALayerOfAnotherCrsIsTakenToTheMapOfTheFirst)
{
    const auto inDegrees = [](double longitude, double latitude)
    { return 2000.0 + 1.0e4 * (longitude - 15.0) + 2.0e4 * (latitude - 36.1); };
    const auto toDegrees = transformation("EPSG:32633", "EPSG:4326");
    double west = 500000.0, south = 4000000.0;
    ASSERT_TRUE(toDegrees->Transform(1, &west, &south));
    const std::string other = rasterOfPlaces(
        80, 80, {west - 0.002, 0.0001, 0, south + 0.006, 0, -0.0001}, inDegrees, "EPSG:4326");
    const std::string under =
        rasterOfPlaces(30, 40, placeOfBase, [](double, double) { return 5.0; });
    const CompositeDem made = composed({under, other});
    EXPECT_TRUE(made.leftOut.empty());
    std::size_t seen = 0;
    expectHeights(
        *made.tile,
        [&](double x, double y)
        {
            const bool isInside = x > 500000.0 && x < 500300.0 && y > 4000000.0 && y < 4000400.0;
            double longitude = x, latitude = y;
            toDegrees->Transform(1, &longitude, &latitude);
            const int column =
                static_cast<int>(std::lround((x - made.tile->mapOriginX) / made.tile->mapStepX));
            const int row =
                static_cast<int>(std::lround((y - made.tile->mapOriginY) / made.tile->mapStepY));
            seen += isInside ? 1u : 0u;
            return isInside ? inDegrees(longitude, latitude) : heightAt(*made.tile, column, row);
        },
        0.03);
    EXPECT_GT(seen, 1000u);
}

// Expected: of the same raster twice, what it is alone, heights by the map's scale too: Web
// Mercator at 60 degrees north is twice as wide as the ground.
TEST(CompositeDem, OfEqualLayersIsWhatOneIs)
{
    const std::string path = rasterOfPlaces(
        50, 60, {1000000, 100000, 0, 9000000, 0, -100000},
        [](double x, double y) { return 1.0e-4 * x + 2.0e-4 * y; }, "EPSG:3857");
    const Result<DemFile> alone = readDem(path);
    ASSERT_TRUE(alone) << alone.error().message;
    const CompositeDem made = composed({path, path});
    ASSERT_EQ(made.tile->width(), 50);
    ASSERT_EQ(made.tile->height(), 60);
    EXPECT_EQ(made.tile->eastSpacings, alone->tile.eastSpacings);
    EXPECT_EQ(made.tile->northSpacing, alone->tile.northSpacing);
    for (int row = 0; row < 60; ++row)
        for (int column = 0; column < 50; ++column)
            ASSERT_NEAR(heightAt(*made.tile, column, row), heightAt(alone->tile, column, row),
                        1.0e-2);
}

// Expected: units and factors are each layer's own.
TEST(CompositeDem, EachLayerIsReadInItsOwnWay)
{
    DemLayer feet{rasterOfPlaces(10, 10, {500100, 10, 0, 4000200, 0, -10},
                                 [](double, double) { return 1000.0; }),
                  {}};
    feet.read.heightUnit = "ft";
    feet.read.heightFactor = 2.0;
    const CompositeDem made = readComposite({{base(), {}}, feet}, 2048);
    ASSERT_TRUE(made.tile);
    EXPECT_NEAR(heightAt(*made.tile, 15, 15), 2.0 * 304.8, 1.0e-3);
    EXPECT_NEAR(heightAt(*made.tile, 0, 0), plane(500005.0, 4000005.0), 1.0e-3);
}

// Expected: what cannot be read or placed is left out by its number, and the rest is as without it.
TEST(CompositeDem, WhatCannotBeReadOrPlacedIsLeftOut)
{
    const std::string nowhere = rasterOfPlaces(5, 5, {0, 1, 0, 5, 0, -1}, plane, "");
    const std::string empty = rasterOfPlaces(5, 5, {600000, 10, 0, 4000200, 0, -10},
                                             [](double, double) { return -9999.0; });
    const CompositeDem made = composed({"/vsimem/no_such.tif", base(), nowhere, empty});
    ASSERT_EQ(made.leftOut.size(), 3u);
    EXPECT_EQ(made.leftOut[0].first, 0u);
    EXPECT_EQ(made.leftOut[0].second.code, ErrorCode::NotFound);
    EXPECT_EQ(made.leftOut[1].first, 2u);
    EXPECT_NE(made.leftOut[1].second.message.find("needed both or none"), std::string::npos);
    EXPECT_EQ(made.leftOut[2].first, 3u);
    EXPECT_EQ(made.tile->width(), 30);
    expectHeights(*made.tile, plane);

    const CompositeDem none = readComposite({{"/vsimem/no_such.tif", {}}}, 2048);
    EXPECT_FALSE(none.tile);
    EXPECT_EQ(none.leftOut.size(), 1u);
}
