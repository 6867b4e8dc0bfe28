#include "core/PatchSource.h"

#include "support/AnalyticTerrain.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;

namespace
{
/// h = 3 x + 2 y over a place on the map.
TerrainPatch slope(double west, double south, double step, int posts)
{
    const DemTile dem =
        analytic::makeTile(posts, posts, step,
                           [&](int column, int row)
                           { return 3.0 * (west + step * column) + 2.0 * (south + step * row); });
    return {std::make_shared<const DemTile>(dem), west, south, step, step, 0.0};
}

/// The patch with a void post.
TerrainPatch without(const TerrainPatch& patch, int column, int row)
{
    DemTile dem = *patch.dem;
    dem.setVoid(column, row);
    TerrainPatch result = patch;
    result.dem = std::make_shared<const DemTile>(dem);
    return result;
}

Raster<float> around(PatchSource& source, int posts)
{
    const auto read = source.readPosts(source.place().grownBy(posts));
    EXPECT_TRUE(read);
    return *read;
}
} // namespace

// Expected: the plane, which bilinear interpolation between coarse posts gives exactly; nothing
// beyond what is there.
TEST(PatchSource, GoesOnInPatchesOfOtherSpacings)
{
    // A tile of 8 cells of 1 m; one of 4 m around it, and one of 0.5 m beside that.
    PatchSource source(slope(16.0, 16.0, 1.0, 9),
                       {slope(28.0, 16.0, 0.5, 9), slope(4.0, 4.0, 4.0, 7)});
    constexpr int grown = 14;
    const Raster<float> read = around(source, grown);
    int valid = 0;
    for (int row = 0; row < read.height(); ++row)
        for (int column = 0; column < read.width(); ++column)
        {
            const double x = 16.0 + column - grown, y = 16.0 + row - grown;
            const bool coarse = x >= 4.0 && x <= 28.0 && y >= 4.0 && y <= 28.0;
            const bool fine = x >= 28.0 && x <= 32.0 && y >= 16.0 && y <= 20.0;
            const double height = static_cast<double>(read.at(column, row));
            EXPECT_EQ(std::isnan(height), !coarse && !fine) << x << ", " << y;
            if (!coarse && !fine)
                continue;
            EXPECT_NEAR(height, 3.0 * x + 2.0 * y, 1e-4) << x << ", " << y;
            ++valid;
        }
    EXPECT_EQ(valid, 25 * 25 + 4 * 5); // the edge of 5 posts is both's
}

// Expected: ground that is void at the tile's spacing stays so, though a coarser patch has some
// there; an edge that is void in one of two neighbours has the other's heights.
TEST(PatchSource, KeepsVoids)
{
    const TerrainPatch tile = slope(16.0, 16.0, 1.0, 9);
    const TerrainPatch east = slope(24.0, 16.0, 1.0, 9);
    PatchSource source(without(tile, 8, 4),
                       {slope(4.0, 4.0, 4.0, 7), without(without(east, 3, 3), 0, 6)});
    const Raster<float> read = around(source, 6);
    EXPECT_TRUE(std::isnan(read.at(6 + 8 + 3, 6 + 3)));
    EXPECT_EQ(read.at(6 + 8, 6 + 4), 3.0f * 24.0f + 2.0f * 20.0f);
    EXPECT_EQ(read.at(6 + 8, 6 + 6), 3.0f * 24.0f + 2.0f * 22.0f);
}

// Expected: the crest of a coarse post's ground along the axis, by hand: on a plane the mean across
// and the maximum along, half a coarse post to both sides (3 or 2 per metre).
TEST(PatchSource, CoarsePostsAreCrests)
{
    PatchSource source(slope(16.0, 16.0, 1.0, 33), {});
    const PostRect inside = source.place().coarser(2);
    const PostRect post{inside.column + 4, inside.row + 4, 1, 1};
    const double x = 16.0 + 4.0 * post.column - source.place().column;
    const double y = 16.0 + 4.0 * post.row - source.place().row;
    const auto east = source.readLevel(2, CrestAxis::East, post);
    const auto north = source.readLevel(2, CrestAxis::North, post);
    ASSERT_TRUE(east && north);
    EXPECT_NEAR(static_cast<double>(east->at(0, 0)), 3.0 * (x + 2.0) + 2.0 * y, 1e-3);
    EXPECT_NEAR(static_cast<double>(north->at(0, 0)), 3.0 * x + 2.0 * (y + 2.0), 1e-3);
}
