#include "core/EdgeBlend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace osgTerrainLight;

namespace
{
/// Light of a level at posts of the whole terrain: each level has its own.
float lightAt(int level, int column, int row)
{
    const int step = 1 << level;
    return 1.0f + 0.25f * static_cast<float>(level) +
           0.3f * std::sin(0.7f * static_cast<float>(column * step) +
                           0.4f * static_cast<float>(row * step));
}

Raster<float> lightOf(int level, const PostRect& place)
{
    Raster<float> light(place.width, place.height);
    for (int row = 0; row < place.height; ++row)
        for (int column = 0; column < place.width; ++column)
            light.at(column, row) = lightAt(level, place.column + column, place.row + row);
    return light;
}

/// What a tile of `level` shows at a post of level 0, bilinear.
float shown(int level, int column, int row)
{
    const int step = 1 << level;
    const auto floored = [step](int post) { return (post - ((post % step) + step) % step) / step; };
    const int i = floored(column);
    const int j = floored(row);
    const float x = static_cast<float>(column - i * step) / static_cast<float>(step);
    const float y = static_cast<float>(row - j * step) / static_cast<float>(step);
    const float south = (1.0f - x) * lightAt(level, i, j) + x * lightAt(level, i + 1, j);
    const float north = (1.0f - x) * lightAt(level, i, j + 1) + x * lightAt(level, i + 1, j + 1);
    return (1.0f - y) * south + y * north;
}

float smooth(float x)
{
    return x * x * (3.0f - 2.0f * x);
}
} // namespace

TEST(EdgeBlend, IsOneWithoutCoarserNeighbours)
{
    const Raster<float> weights = edgeBlend(11, 7, {});
    for (const float weight : weights.values())
        EXPECT_EQ(weight, 1.0f);
}

// Along one edge: 0 on it, a smooth step over 8 posts, 1 beyond.
TEST(EdgeBlend, RisesSmoothlyFromAnEdge)
{
    CoarserNeighbours coarser;
    coarser.east = true;
    const Raster<float> weights = edgeBlend(33, 20, coarser);
    for (int row = 0; row < 20; ++row)
        for (int column = 0; column < 33; ++column)
        {
            const float away = std::min(static_cast<float>(32 - column) / 8.0f, 1.0f);
            EXPECT_FLOAT_EQ(weights.at(column, row), smooth(away));
        }
}

// Two edges: the lesser. A corner alone: round.
TEST(EdgeBlend, CornersAreTheLesserOrRound)
{
    CoarserNeighbours edges;
    edges.south = true;
    edges.west = true;
    CoarserNeighbours corner;
    corner.southWest = true;
    const Raster<float> lesser = edgeBlend(40, 30, edges);
    const Raster<float> round = edgeBlend(40, 30, corner);
    for (int row = 0; row < 30; ++row)
        for (int column = 0; column < 40; ++column)
        {
            const auto part = [](float away) { return smooth(std::min(away / 8.0f, 1.0f)); };
            const float x = static_cast<float>(column);
            const float y = static_cast<float>(row);
            EXPECT_FLOAT_EQ(lesser.at(column, row), std::min(part(x), part(y)));
            EXPECT_FLOAT_EQ(round.at(column, row), part(std::hypot(x, y)));
        }
    EXPECT_EQ(lesser.at(0, 29), 0.0f);
    EXPECT_EQ(round.at(0, 0), 0.0f);
    EXPECT_EQ(round.at(0, 8), 1.0f);
}

// All ways in which the neighbours of two tiles at the same level can be coarser: both have the
// same weights along their common edge.
TEST(EdgeBlend, SameLevelNeighboursAgree)
{
    constexpr int size = 13;
    for (unsigned pattern = 0; pattern < 1u << 10; ++pattern)
    {
        // Two tiles, (1, 1) and (2, 1) of 4 x 3, and the 10 around them.
        const auto isCoarser = [pattern](int x, int y)
        {
            if (y == 1 && (x == 1 || x == 2))
                return false;
            const int at = 4 * y + x;
            return ((pattern >> (at > 6 ? at - 2 : at > 4 ? at - 1 : at)) & 1u) != 0u;
        };
        const auto of = [&isCoarser](int x, int y)
        {
            CoarserNeighbours coarser;
            coarser.west = isCoarser(x - 1, y);
            coarser.east = isCoarser(x + 1, y);
            coarser.south = isCoarser(x, y - 1);
            coarser.north = isCoarser(x, y + 1);
            coarser.southWest = isCoarser(x - 1, y - 1);
            coarser.southEast = isCoarser(x + 1, y - 1);
            coarser.northWest = isCoarser(x - 1, y + 1);
            coarser.northEast = isCoarser(x + 1, y + 1);
            return edgeBlend(size, size, coarser);
        };
        const Raster<float> west = of(1, 1);
        const Raster<float> east = of(2, 1);
        for (int row = 0; row < size; ++row)
            ASSERT_EQ(west.at(size - 1, row), east.at(0, row)) << pattern << ", " << row;
    }
}

// A fine tile whose eastern and northern neighbours are coarser: on the common edges it shows what
// they show, posts of theirs or not, and no jump comes in elsewhere.
TEST(EdgeBlend, ATileMeetsItsCoarserNeighbours)
{
    for (const int levels : {1, 2})
    {
        const PostRect place{-32, 64, 33, 33};
        const int step = 1 << levels;
        const PostRect parentPlace{-64 / step, 64 / step, 96 / step + 1, 64 / step + 1};
        CoarserNeighbours coarser;
        coarser.east = true;
        coarser.north = true;
        const Raster<float> weights = edgeBlend(place.width, place.height, coarser);
        const Raster<float> own = lightOf(0, place);
        Raster<float> light = own;
        blendToParent(light, place, lightOf(levels, parentPlace), parentPlace, levels, weights);
        for (int i = 0; i < 33; ++i)
        {
            EXPECT_NEAR(light.at(32, i), shown(levels, place.column + 32, place.row + i), 1e-6);
            EXPECT_NEAR(light.at(i, 32), shown(levels, place.column + i, place.row + 32), 1e-6);
        }
        float greatest = 0.0f; // jump that the mixture adds, over the difference of the two
        for (int row = 0; row < 33; ++row)
            for (int column = 0; column < 33; ++column)
            {
                const float coarse = shown(levels, place.column + column, place.row + row);
                const float part = weights.at(column, row);
                EXPECT_NEAR(light.at(column, row),
                            part * own.at(column, row) + (1.0f - part) * coarse, 1e-6);
                if (column < 24 && row < 24)
                {
                    EXPECT_EQ(light.at(column, row), own.at(column, row));
                }
                if (column > 0)
                    greatest = std::max(greatest, std::abs(part - weights.at(column - 1, row)));
                if (row > 0)
                    greatest = std::max(greatest, std::abs(part - weights.at(column, row - 1)));
            }
        EXPECT_LE(greatest, 1.5f / 8.0f); // the steepest of a smooth step
    }
}

// On an edge the parent's light is exact; voids of either leave the tile's own.
TEST(EdgeBlend, KeepsColoursAndVoids)
{
    const PostRect place{8, 8, 9, 9};
    const PostRect parentPlace{4, 4, 5, 5};
    const float none = std::numeric_limits<float>::quiet_NaN();
    Raster<Rgb> light(9, 9, Rgb{1.0f, 2.0f, 3.0f});
    Raster<Rgb> parent(5, 5, Rgb{0.1f, 0.2f, 0.7f});
    light.at(0, 0) = {none, none, none};
    parent.at(4, 4) = {none, none, none};
    CoarserNeighbours coarser;
    coarser.west = coarser.east = coarser.south = coarser.north = true;
    blendToParent(light, place, parent, parentPlace, 1, edgeBlend(9, 9, coarser));
    EXPECT_TRUE(std::isnan(light.at(0, 0)[0]));
    EXPECT_EQ(light.at(8, 8), (Rgb{1.0f, 2.0f, 3.0f}));
    EXPECT_EQ(light.at(7, 8), (Rgb{1.0f, 2.0f, 3.0f})); // beside the parent's void
    EXPECT_EQ(light.at(6, 8), (Rgb{0.1f, 0.2f, 0.7f}));
    EXPECT_EQ(light.at(0, 5), (Rgb{0.1f, 0.2f, 0.7f}));
    const float part = smooth(0.5f); // half way in from all edges
    const Rgb middle = light.at(4, 4);
    EXPECT_FLOAT_EQ(middle[0], (1.0f - part) * 0.1f + part * 1.0f);
    EXPECT_FLOAT_EQ(middle[1], (1.0f - part) * 0.2f + part * 2.0f);
    EXPECT_FLOAT_EQ(middle[2], (1.0f - part) * 0.7f + part * 3.0f);
}
