#include "core/MemorySource.h"

#include "support/DirectLevels.h"

#include <gtest/gtest.h>

using namespace osgTerrainLight;

namespace
{
DemTile hills(int width, int height)
{
    DemTile tile(width, height, 30.0);
    tile.heightOrigin = 700.0;
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
            if ((column + 3 * row) % 7 != 0)
                tile.setHeight(column, row, static_cast<float>((column * 37 + row * 91) % 113));
    return tile;
}
} // namespace

// Posts are those of the tile, NaN beyond it and where it is void.
TEST(MemorySource, PostsAreTheTilesOwn)
{
    MemorySource source(hills(13, 9));
    EXPECT_EQ(source.heightOrigin(), 700.0);
    EXPECT_EQ(source.northSpacing(), 30.0);
    const Raster<float> expected = heightsOf(source.whole());
    const PostRect rect{-3, -2, 20, 14};
    const Result<Raster<float>> posts = source.readPosts(rect);
    ASSERT_TRUE(posts);
    ASSERT_EQ(posts->width(), rect.width);
    ASSERT_EQ(posts->height(), rect.height);
    for (int row = 0; row < rect.height; ++row)
        for (int column = 0; column < rect.width; ++column)
        {
            const int x = column + rect.column;
            const int y = row + rect.row;
            EXPECT_TRUE(same(posts->at(column, row), expected.contains(x, y)
                                                         ? expected.at(x, y)
                                                         : std::numeric_limits<float>::quiet_NaN()))
                << x << ", " << y;
        }
}

// Levels by their definition (DirectLevels); the last has at most 2 posts a side.
TEST(MemorySource, LevelsFollowTheDefinition)
{
    MemorySource source(hills(45, 18));
    const Raster<float> posts = heightsOf(source.whole());
    const DirectLevels direct(posts);
    ASSERT_EQ(source.lastLevel(), 6); // 44 / 2^6 <= 1
    for (int level = 1; level <= source.lastLevel(); ++level)
        for (const CrestAxis axis : {CrestAxis::East, CrestAxis::North})
        {
            const PostRect extent = source.extent(level);
            const Result<Raster<float>> found = source.readLevel(level, axis, extent.grownBy(1));
            ASSERT_TRUE(found);
            for (int row = 0; row < extent.height; ++row)
                for (int column = 0; column < extent.width; ++column)
                    EXPECT_TRUE(
                        same(found->at(column + 1, row + 1), direct.post(level, axis, column, row)))
                        << "level " << level << ": " << column << ", " << row;
            EXPECT_TRUE(std::isnan(found->at(0, 0)));
        }
    EXPECT_EQ(source.extent(6).width, 2);
    EXPECT_EQ(source.extent(6).height, 2);
}

// One post has no coarser level. Rows beyond the terrain have the nearest row's spacing.
TEST(MemorySource, SmallestTilesAndRowsBeyond)
{
    MemorySource one(DemTile(1, 1, 5.0));
    EXPECT_EQ(one.lastLevel(), 0);
    EXPECT_TRUE(std::isnan(one.readPosts({0, 0, 1, 1})->at(0, 0)));
    EXPECT_EQ(one.readPosts({4, 4, 0, 0})->size(), 0u);

    DemTile rows(2, 3, 10.0);
    rows.eastSpacings = {7.0, 8.0, 9.0};
    MemorySource source(rows);
    EXPECT_EQ(source.lastLevel(), 1);
    EXPECT_EQ(source.eastSpacing(-5), 7.0);
    EXPECT_EQ(source.eastSpacing(1), 8.0);
    EXPECT_EQ(source.eastSpacing(40), 9.0);
}
