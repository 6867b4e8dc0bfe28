// scanHorizons against the exhaustive reference: what settings are chosen by.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"

#include "core/SyntheticTerrain.h"
#include "lighting/nodes/HorizonScanPass.h"
#include "reference/ExhaustiveHorizon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

using namespace osgTerrainLight;

namespace
{
/// The axes, the diagonals, and azimuths that pass no post closely.
std::vector<MapDirection> someDirections()
{
    std::vector<MapDirection> directions;
    for (int k = 0; k < 8; ++k)
        directions.push_back(directionOfCompass(45.0 * k));
    for (int k = 0; k < 70; ++k) // more than a dispatch takes
        directions.push_back(directionOfCompass(5.123 * k + 0.37));
    return directions;
}

/// Rounding in float, in metres per step: a crossing's height and its place (slopeBound in
/// tests/glsl/horizon_test.cpp derives it), and the drift's own, `steps` large at the far end.
double boundOf(const DemTile& tile)
{
    const auto [low, high] = std::minmax_element(tile.heights().begin(), tile.heights().end());
    const double relief = static_cast<double>(*high) - static_cast<double>(*low);
    const double steps = std::max(tile.width(), tile.height());
    const double size = std::max(std::abs(static_cast<double>(*high)), relief);
    const double spacing = *std::min_element(tile.eastSpacings.begin(), tile.eastSpacings.end());
    return 0.5 * static_cast<double>(std::numeric_limits<float>::epsilon()) *
           (4.0 * size + 25.0 * relief * steps) / std::min(spacing, tile.northSpacing);
}

void expectAsReference(osg::State& state, const DemTile& tile, int count)
{
    std::vector<TilePost> posts;
    std::mt19937 random(3);
    while (posts.size() < static_cast<std::size_t>(count))
    {
        const int column = static_cast<int>(random() % static_cast<unsigned>(tile.width()));
        const int row = static_cast<int>(random() % static_cast<unsigned>(tile.height()));
        if (tile.isValid(column, row))
            posts.push_back({column, row});
    }
    const std::vector<MapDirection> directions = someDirections();
    const Result<Raster<double>> found = scanHorizons(state, tile, posts, directions);
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_EQ(found->width(), count);
    ASSERT_EQ(found->height(), static_cast<int>(directions.size()));
    const double bound = boundOf(tile);
    double worst = 0.0;
    for (int d = 0; d < found->height(); ++d)
        for (int p = 0; p < count; ++p)
        {
            const TilePost post = posts[static_cast<std::size_t>(p)];
            const double expected =
                reference::exhaustiveHorizon(tile, post.column, post.row,
                                             directions[static_cast<std::size_t>(d)])
                    .slope;
            const double slope = found->at(p, d);
            if (std::isinf(expected))
            {
                ASSERT_LT(slope, -1e9) << "post " << post.column << ' ' << post.row;
                continue;
            }
            worst = std::max(worst, std::abs(slope - expected));
            ASSERT_NEAR(slope, expected, bound)
                << "post " << post.column << ' ' << post.row << " direction " << d;
        }
    std::printf("worst difference %.2g, bound %.2g\n", worst, bound);
}
} // namespace

TEST(HorizonScan, IsTheReferenceOnFractalAndCliffs)
{
    OTL_NEED_GL(context);
    for (const TerrainKind kind : {TerrainKind::Fractal, TerrainKind::Cliffs})
        expectAsReference(context->state(), generateTerrain(kind, 150, 101, 30.0, 5).value(), 60);
}

TEST(HorizonScan, IsTheReferenceOnNonSquareCellsAndRowsOfTheirOwn)
{
    OTL_NEED_GL(context);
    DemTile tile = generateTerrain(TerrainKind::Fractal, 90, 120, 30.0, 6).value();
    tile.northSpacing = 95.0;
    expectAsReference(context->state(), tile, 40);
    tile.eastSpacings.clear();
    for (int row = 0; row < tile.height(); ++row)
        tile.eastSpacings.push_back(40.0 - 0.1 * row);
    expectAsReference(context->state(), tile, 40);
}

TEST(HorizonScan, IsTheReferenceBesideVoids)
{
    OTL_NEED_GL(context);
    DemTile tile = generateTerrain(TerrainKind::Fractal, 80, 64, 30.0, 7).value();
    std::mt19937 random(8);
    for (int i = 0; i < 300; ++i)
        tile.setVoid(static_cast<int>(random() % 80), static_cast<int>(random() % 64));
    expectAsReference(context->state(), tile, 60);
}

TEST(HorizonScan, OneRowAndOnePost)
{
    OTL_NEED_GL(context);
    expectAsReference(context->state(),
                      analytic::makeTile(40, 1, 10.0, [](int x, int) { return x % 7; }), 10);
    expectAsReference(context->state(), analytic::plane(1, 1, 10.0, 3.0), 1);
}

// Expected: no tangent above the lowest that matters changes by a bit, and none below rises above
// it.
TEST(HorizonScan, StopsWhereNothingCanMatter)
{
    OTL_NEED_GL(context);
    for (const TerrainKind kind : {TerrainKind::Fractal, TerrainKind::Cliffs})
    {
        const DemTile tile = generateTerrain(kind, 120, 97, 30.0, 11).value();
        std::vector<TilePost> posts;
        for (int i = 0; i < 400; ++i)
            posts.push_back({i * 37 % 120, i * 53 % 97});
        const std::vector<MapDirection> directions = someDirections();
        const Raster<double> all = scanHorizons(context->state(), tile, posts, directions).value();
        for (const double lowest : {0.0, 0.05, 0.3})
        {
            const Raster<double> some =
                scanHorizons(context->state(), tile, posts, directions, lowest).value();
            int below = 0;
            for (std::size_t i = 0; i < all.size(); ++i)
            {
                EXPECT_EQ(std::max(some.values()[i], lowest), std::max(all.values()[i], lowest));
                below += some.values()[i] < all.values()[i] ? 1 : 0;
            }
            if (lowest == 0.0)
            {
                EXPECT_EQ(below, 0);
            }
            if (lowest == 0.3) // it does stop: no post rises so high above all others
            {
                EXPECT_GT(below, 0);
            }
        }
    }
}
