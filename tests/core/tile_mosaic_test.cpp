#include "core/TileMosaic.h"

#include "core/MemorySource.h"
#include "support/DirectLevels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace osgTerrainLight;

namespace
{
constexpr int cellsLog2 = 3;
constexpr int columns = 5, rows = 3;

DemTile rough(int width, int height)
{
    std::mt19937 random(5);
    DemTile tile(width, height, 20.0);
    tile.eastSpacings = {25.0};
    tile.heightOrigin = 300.0;
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
            if (random() % 11 != 0)
                tile.setHeight(column, row, static_cast<float>(random() % 1000) * 0.37f);
    return tile;
}

DemTile cut(const DemTile& whole, const PostRect& place)
{
    DemTile tile(place.width, place.height, whole.northSpacing);
    tile.heightOrigin = whole.heightOrigin;
    for (int row = 0; row < place.height; ++row)
        for (int column = 0; column < place.width; ++column)
            if (whole.isValid(place.column + column, place.row + row))
                tile.setHeight(column, row, whole.heightAt(place.column + column, place.row + row));
    return tile;
}

TileMosaic emptyMosaic()
{
    return TileMosaic(columns, rows, cellsLog2, 25.0, 20.0, 300.0);
}

void expectSame(const Result<Raster<float>>& found, const Result<Raster<float>>& expected,
                int level)
{
    ASSERT_TRUE(found && expected);
    ASSERT_EQ(found->width(), expected->width());
    ASSERT_EQ(found->height(), expected->height());
    for (int row = 0; row < found->height(); ++row)
        for (int column = 0; column < found->width(); ++column)
            ASSERT_TRUE(same(found->at(column, row), expected->at(column, row)))
                << "level " << level << ": " << column << ", " << row;
}

/// All posts of all levels, and some beyond.
void expectSame(TileMosaic& mosaic, const DemTile& whole)
{
    MemorySource source(whole);
    ASSERT_EQ(mosaic.width(), source.width());
    ASSERT_EQ(mosaic.height(), source.height());
    ASSERT_EQ(mosaic.lastLevel(), source.lastLevel());
    EXPECT_EQ(mosaic.heightOrigin(), source.heightOrigin());
    EXPECT_EQ(mosaic.northSpacing(), source.northSpacing());
    EXPECT_EQ(mosaic.eastSpacing(2), source.eastSpacing(2));
    const PostRect posts = source.extent(0).grownBy(2);
    expectSame(mosaic.readPosts(posts), source.readPosts(posts), 0);
    for (int level = 1; level <= source.lastLevel(); ++level)
        for (const CrestAxis axis : {CrestAxis::East, CrestAxis::North})
        {
            const PostRect of = source.extent(level).grownBy(2);
            expectSame(mosaic.readLevel(level, axis, of), source.readLevel(level, axis, of), level);
        }
}
} // namespace

// Whatever the order in which they come, tiles side by side are the whole terrain, bit by bit.
TEST(TileMosaic, TilesAreTheWhole)
{
    TileMosaic mosaic = emptyMosaic();
    const DemTile whole = rough(mosaic.width(), mosaic.height());
    std::vector<int> order(columns * rows);
    for (int i = 0; i < columns * rows; ++i)
        order[static_cast<std::size_t>(i)] = i;
    for (const unsigned seed : {1u, 2u, 3u})
    {
        std::shuffle(order.begin(), order.end(), std::mt19937(seed));
        TileMosaic shuffled = emptyMosaic();
        for (const int i : order)
            shuffled.set(i % columns, i / columns,
                         cut(whole, shuffled.placeOf(i % columns, i / columns)));
        expectSame(shuffled, whole);
    }
}

// Where a tile has gone, or never was, there is void, but for posts that its neighbours have too.
TEST(TileMosaic, MissingTilesAreVoid)
{
    TileMosaic mosaic = emptyMosaic();
    const DemTile all = rough(mosaic.width(), mosaic.height());
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
            if (x != 4)
                mosaic.set(x, y, cut(all, mosaic.placeOf(x, y)));
    ASSERT_TRUE(mosaic.readLevel(3, CrestAxis::East, {0, 0, 2, 2}));
    mosaic.remove(1, 1);
    EXPECT_FALSE(mosaic.has(1, 1));
    EXPECT_TRUE(mosaic.has(1, 2));

    DemTile left = all;
    const int side = 1 << cellsLog2;
    for (int row = 0; row < all.height(); ++row)
        for (int column = 0; column < all.width(); ++column)
            if (column > 4 * side ||
                (column > side && column < 2 * side && row > side && row < 2 * side))
                left.setVoid(column, row);
    const PostRect posts{0, 0, mosaic.width(), mosaic.height()};
    expectSame(mosaic.readPosts(posts), MemorySource(left).readPosts(posts), 0);
    // Between posts of its edge alone a terrain in memory has cells; a tile that is not there has
    // none. So the levels are those of the tiles.
    const Raster<float> coarse = *mosaic.readLevel(1, CrestAxis::North, mosaic.extent(1));
    EXPECT_TRUE(std::isnan(coarse.at(side / 2 + side / 4, side / 2 + side / 4)));
    EXPECT_TRUE(std::isnan(coarse.at(4 * side / 2 + 1, 3)));
    EXPECT_FALSE(std::isnan(coarse.at(3, 3)));
}

// A tile that comes again, changed, changes all levels.
TEST(TileMosaic, ChangedTile)
{
    TileMosaic mosaic = emptyMosaic();
    DemTile whole = rough(mosaic.width(), mosaic.height());
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
            mosaic.set(x, y, cut(whole, mosaic.placeOf(x, y)));
    expectSame(mosaic, whole);
    const PostRect place = mosaic.placeOf(2, 1);
    whole.setHeight(place.column + 4, place.row + 5, 5000.0f);
    mosaic.remove(2, 1);
    mosaic.set(2, 1, cut(whole, place));
    expectSame(mosaic, whole);
}
