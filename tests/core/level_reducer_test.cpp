#include "core/LevelReducer.h"

#include "support/DirectLevels.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <tuple>

using namespace osgTerrainLight;

namespace
{
constexpr float missing = std::numeric_limits<float>::quiet_NaN();

/// Seeded heights of a kilometre, of which a share is void.
Raster<float> heightsOf(int width, int height, double voids)
{
    std::mt19937 random(static_cast<unsigned>(width * 1000 + height));
    std::uniform_real_distribution<float> heights(0.0f, 1000.0f);
    std::bernoulli_distribution isVoid(voids);
    Raster<float> posts(width, height);
    for (float& post : posts.values())
        post = isVoid(random) ? missing : heights(random);
    return posts;
}

/// By level and row, as they were given out.
std::map<std::pair<int, int>, std::array<std::vector<float>, 2>> reduce(const Raster<float>& posts,
                                                                        int levels)
{
    std::map<std::pair<int, int>, std::array<std::vector<float>, 2>> result;
    std::map<int, int> next;
    LevelReducer reducer(posts.width(), posts.height(), levels,
                         [&](int level, int row, const auto& heights)
                         {
                             EXPECT_EQ(row, next[level]++) << "level " << level;
                             result[{level, row}] = heights;
                         });
    for (int row = 0; row < posts.height(); ++row)
        reducer.addRow(&posts.at(0, row));
    return result;
}

void expectDirect(const Raster<float>& posts, int levels)
{
    const auto found = reduce(posts, levels);
    const DirectLevels direct(posts);
    std::size_t rows = 0;
    for (int level = 1; level <= levels; ++level)
    {
        rows += static_cast<std::size_t>(LevelReducer::posts(posts.height(), level));
        for (int row = 0; row < LevelReducer::posts(posts.height(), level); ++row)
            for (const CrestAxis axis : {CrestAxis::East, CrestAxis::North})
            {
                const auto at = found.find({level, row});
                ASSERT_NE(at, found.end()) << "level " << level << ", row " << row;
                const std::vector<float>& heights = at->second[static_cast<std::size_t>(axis)];
                ASSERT_EQ(heights.size(),
                          static_cast<std::size_t>(LevelReducer::posts(posts.width(), level)));
                for (int column = 0; column < static_cast<int>(heights.size()); ++column)
                {
                    const float expected = direct.post(level, axis, column, row);
                    const float height = heights[static_cast<std::size_t>(column)];
                    EXPECT_TRUE(height == expected || (std::isnan(height) && std::isnan(expected)))
                        << "level " << level << ", column " << column << ", row " << row << ": "
                        << height << " instead of " << expected;
                }
            }
    }
    EXPECT_EQ(found.size(), rows);
}
} // namespace

class LevelReducerOf : public ::testing::TestWithParam<std::tuple<int, int, double>>
{
};

// The same float operations on the same numbers, so equal to the last bit.
TEST_P(LevelReducerOf, EqualsTheDefinition)
{
    const auto [width, height, voids] = GetParam();
    expectDirect(heightsOf(width, height, voids), 6);
}

INSTANTIATE_TEST_SUITE_P(Sizes, LevelReducerOf,
                         ::testing::Values(std::tuple(1, 1, 0.0), std::tuple(1, 9, 0.0),
                                           std::tuple(9, 1, 0.0), std::tuple(2, 2, 0.0),
                                           std::tuple(17, 17, 0.0), std::tuple(16, 33, 0.0),
                                           std::tuple(37, 22, 0.0), std::tuple(37, 22, 0.3),
                                           std::tuple(22, 41, 0.9), std::tuple(7, 5, 1.0)));

// 3 x 3 posts worked out by hand. East: cells are mean(max of south pair, max of north pair).
TEST(LevelReducer, HandWorkedExample)
{
    Raster<float> posts(3, 3);
    posts.values() = {1, 2, 8, 3, 4, 0, 9, 6, 5}; // row 0 south
    const auto found = reduce(posts, 1);
    using Row = std::vector<float>;
    // C0 = {(2 + 4) / 2, (8 + 4) / 2; (4 + 9) / 2, (4 + 6) / 2}; its corners are the corner posts.
    EXPECT_EQ(found.at({1, 0})[0], (Row{3.0f, 6.0f}));
    EXPECT_EQ(found.at({1, 1})[0], (Row{6.5f, 5.0f}));
    // Along north: {(3 + 4) / 2, (4 + 8) / 2; (9 + 6) / 2, (6 + 5) / 2}.
    EXPECT_EQ(found.at({1, 0})[1], (Row{3.5f, 6.0f}));
    EXPECT_EQ(found.at({1, 1})[1], (Row{7.5f, 5.5f}));
}

// From the definition of posts: those of level k reach the last post of level 0 or just beyond.
TEST(LevelReducer, PostsReachTheEnd)
{
    for (int count = 1; count < 70; ++count)
        for (int level = 0; level < 8; ++level)
        {
            const int last = (LevelReducer::posts(count, level) - 1) << level;
            EXPECT_GE(last, count - 1);
            EXPECT_LT(last, count - 1 + (1 << level));
        }
}
