// Layers of heights that are read where they are asked for, against readComposite() of the same
// layers without a limit, which has tests of its own against closed forms.
#include "io/CompositeRaster.h"
#include "support/MemoryRaster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

using namespace osgTerrainLight;

namespace
{
constexpr int unlimited = 1 << 20;

double hills(double x, double y)
{
    return 500.0 + 80.0 * std::sin(x / 170.0) * std::cos(y / 130.0);
}

double plane(double x, double y)
{
    return 100.0 + 0.02 * (x - 500000.0) + 0.03 * (y - 4000000.0);
}

const std::vector<double> placeOfBase = {500000, 30, 0, 4009000, 0, -30};

/// Void in a lake.
double inset(double x, double y)
{
    return std::hypot(x - 504000.0, y - 4004000.0) < 400.0 ? std::nan("") : 1000.0 + hills(x, y);
}

/// The two have the same grid and the same heights. atEdges: posts that only one of them may have.
void expectSame(CompositeRaster& large, const CompositeDem& whole, double tolerance,
                std::size_t atEdges)
{
    ASSERT_TRUE(large.source && whole.tile);
    const DemTile& tile = *whole.tile;
    const PostRect all = large.source->raster();
    ASSERT_EQ(all.width, tile.width());
    ASSERT_EQ(all.height, tile.height());
    EXPECT_NEAR(large.source->frame().mapX(0), tile.mapOriginX, 1e-6);
    EXPECT_NEAR(large.source->frame().mapY(0), tile.mapOriginY, 1e-6);
    const Result<Raster<float>> posts = large.source->readPosts(all);
    ASSERT_TRUE(posts) << posts.error().message;
    std::size_t voids = 0, differ = 0;
    for (int row = 0; row < all.height; ++row)
        for (int column = 0; column < all.width; ++column)
        {
            const double height = large.source->heightOrigin() + double(posts->at(column, row));
            if (std::isnan(height) && !tile.isValid(column, row))
                ++voids;
            else if (std::isnan(height) || !tile.isValid(column, row))
                ++differ;
            else
                ASSERT_NEAR(height, tile.heightOrigin + double(tile.heightAt(column, row)),
                            tolerance)
                    << column << ", " << row;
        }
    EXPECT_LE(differ, atEdges);
    EXPECT_LT(voids, posts->values().size() / 2);
}

void expectSame(const std::vector<DemLayer>& layers, double tolerance, std::size_t atEdges = 0)
{
    std::optional<CompositeRaster> large = openComposite(layers, 100);
    ASSERT_TRUE(large);
    const CompositeDem whole = readComposite(layers, unlimited);
    expectSame(*large, whole, tolerance, atEdges);
    EXPECT_EQ(large->leftOut.size(), whole.leftOut.size());
}
} // namespace

// Tolerance: heights are floats above an origin, to 3e-5 m, in the layer and in the composite.
TEST(CompositeRaster, HeightsAreThoseOfTheWholeInEitherOrder)
{
    const DemLayer base{rasterOfPlaces(300, 300, placeOfBase, hills), {}};
    const DemLayer fine{rasterOfPlaces(310, 290, {502003, 10, 0, 4005007, 0, -10}, inset), {}};
    const DemLayer beyond{rasterOfPlaces(50, 60, {508000, 20, 0, 4001000, 0, -20}, plane), {}};
    expectSame({base, fine, beyond}, 1e-3);
    expectSame({fine, base, beyond}, 1e-3);
    expectSame({beyond, fine, base}, 1e-3);
}

// Expected: as the closed form of each layer says, and that the lake shows the layer below.
TEST(CompositeRaster, VoidsFallThrough)
{
    const std::string base = rasterOfPlaces(300, 300, placeOfBase, plane);
    const std::string over = rasterOfPlaces(100, 100, {503000, 30, 0, 4006000, 0, -30}, inset);
    std::optional<CompositeRaster> large = openComposite({{base, {}}, {over, {}}}, 100);
    ASSERT_TRUE(large && large->source);
    const RasterFrame& frame = large->source->frame();
    const auto heightAt = [&](double x, double y)
    {
        const PostRect all = large->source->raster();
        const int column = int(std::lround((x - frame.mapX(0)) / 30.0));
        const int row = int(std::lround((y - frame.mapY(0)) / 30.0));
        const auto post = large->source->readPosts({all.column + column, all.row + row, 1, 1});
        return large->source->heightOrigin() + double(post->at(0, 0));
    };
    EXPECT_NEAR(heightAt(504005, 4004005), plane(504005, 4004005), 1e-3); // in the lake
    EXPECT_NEAR(heightAt(503015, 4004995), inset(503015, 4004995), 1e-3); // on its shore
    EXPECT_NEAR(heightAt(500015, 4000015), plane(500015, 4000015), 1e-3); // beside the inset
}

// Each layer is read by its own options.
TEST(CompositeRaster, UnitsAndFactorsHold)
{
    DemLayer feet{rasterOfPlaces(200, 100, {502000, 30, 0, 4006000, 0, -30}, inset), {}};
    feet.read.heightUnit = "ft";
    feet.read.heightFactor = 2.0;
    expectSame({{rasterOfPlaces(300, 300, placeOfBase, hills), {}}, feet}, 1e-3);
}

// Tolerance: rows of places are out by up to 0.01 of a pixel of 100 m, and the ground is at most
// as steep as 80 / 130 + 80 / 170; both readings may be out.
TEST(CompositeRaster, LayersOfAnotherCrs)
{
    const auto there = [](double x, double y) { return plane(x - 1000.0, y - 4000000.0); };
    const DemLayer other{
        rasterOfPlaces(60, 60, {-30000, 100, 0, 4028000, 0, -100}, there, "EPSG:32634"), {}};
    expectSame({{rasterOfPlaces(300, 300, placeOfBase, hills), {}}, other}, 0.1, 100);
    // Degrees: the map's scale differs within the raster. Tolerance: twice 0.01 of a pixel of 30 m
    // on hills that are as steep as 80 / 130 + 80 / 170.
    const auto degrees = [](double x, double y)
    { return 900.0 + 50.0 * std::sin(700.0 * (x + y)); };
    const DemLayer geographic{
        rasterOfPlaces(200, 200, {15.01, 0.0003, 0, 36.18, 0, -0.0003}, degrees, "EPSG:4326"), {}};
    expectSame({geographic, {rasterOfPlaces(300, 300, placeOfBase, hills), {}}}, 0.65, 100);
}

// Expected: posts of a level are those of level 0 that stand there. On a plane the bilinear mean
// of coarser posts is the plane, but for the outermost posts.
TEST(CompositeRaster, CoarseLevelsHaveTheirPosts)
{
    const std::string west = rasterOfPlaces(1500, 1500, {500000, 30, 0, 4045000, 0, -30}, plane);
    const std::string east = rasterOfPlaces(1500, 1500, {545000, 30, 0, 4045000, 0, -30}, plane);
    std::optional<CompositeRaster> large = openComposite({{west, {}}, {east, {}}}, 2048);
    ASSERT_TRUE(large && large->source);
    OverviewSource& source = *large->source;
    const PostRect all = source.raster();
    EXPECT_EQ(all.width, 3000);
    for (const int level : {1, 3})
    {
        const int step = 1 << level;
        const PostRect extent = source.extent(level);
        const auto posts = source.readSurface(level, extent);
        ASSERT_TRUE(posts);
        for (int row = 2; row < extent.height - 2; row += 7)
            for (int column = 2; column < extent.width - 2; column += 7)
            {
                const double x = source.frame().mapX((extent.column + column) * step - all.column);
                const double y = source.frame().mapY((extent.row + row) * step - all.row);
                ASSERT_NEAR(source.heightOrigin() + double(posts->at(column, row)), plane(x, y),
                            1e-2)
                    << level << ": " << column << ", " << row;
            }
    }
}

TEST(CompositeRaster, WhatCannotBeReadIsLeftOutAsOfTheWhole)
{
    const DemLayer base{rasterOfPlaces(300, 300, placeOfBase, hills), {}};
    const DemLayer missing{"/vsimem/no_such.tif", {}};
    const DemLayer noMap{rasterOfPlaces(300, 300, placeOfBase, hills, ""), {}};
    const DemLayer fine{rasterOfPlaces(310, 290, {502003, 10, 0, 4005007, 0, -10}, inset), {}};
    const std::vector<DemLayer> layers = {missing, base, noMap, fine};
    const std::optional<CompositeRaster> large = openComposite(layers, 100);
    const CompositeDem whole = readComposite(layers, unlimited);
    ASSERT_TRUE(large && large->source);
    ASSERT_EQ(large->leftOut.size(), 2u);
    ASSERT_EQ(whole.leftOut.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i)
    {
        EXPECT_EQ(large->leftOut[i].first, whole.leftOut[i].first);
        EXPECT_EQ(large->leftOut[i].second.message, whole.leftOut[i].second.message);
    }
    // One that is left is paged alone, and none is none.
    EXPECT_TRUE(openComposite({missing, base}, 100)->source);
    EXPECT_FALSE(openComposite({missing}, 100));
}

TEST(CompositeRaster, SmallLayersAreNotOpened)
{
    const DemLayer base{rasterOfPlaces(30, 30, placeOfBase, hills), {}};
    EXPECT_FALSE(openComposite({base, base}, 30));
    EXPECT_TRUE(openComposite({base, base}, 29));
    EXPECT_FALSE(openComposite({}, 100));
}
