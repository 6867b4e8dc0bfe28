// Windows of coarser posts around a tile. The surface is a plane, which posts of any spacing hold
// exactly, so heights of crossings follow from where they are.
#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;

namespace
{
template <class Real>
class Windows : public testing::Test
{
};
TYPED_TEST_SUITE(Windows, Precisions);

constexpr int texelX = 5, texelY = 3, posts = 12, step = 4, firstX = -16, firstY = -8;

template <class Real>
Real planeAt(Real x, Real y)
{
    return Real(2) * x - Real(3) * y + Real(50);
}

/// A window of 12 x 12 posts, 4 posts of the tile apart, that begins at (-16, -8), in a texture.
template <class Real>
Raster<Real> texture()
{
    Raster<Real> heights(24, 20, CheckedGlsl<Real>::VOID_HEIGHT);
    for (int y = 0; y < posts; ++y)
        for (int x = 0; x < posts; ++x)
            heights.at(texelX + x, texelY + y) =
                planeAt(Real(firstX + step * x), Real(firstY + step * y));
    return heights;
}

template <class Glsl>
typename Glsl::Window window()
{
    typename Glsl::Window made;
    made.first = glm::ivec2(firstX, firstY);
    made.last = glm::ivec2(firstX + step * (posts - 1), firstY + step * (posts - 1));
    made.texel = glm::ivec2(texelX, texelY);
    made.step = step;
    return made;
}
} // namespace

TYPED_TEST(Windows, RaysLeaveThemWhereTheirEdgesAre)
{
    using Glsl = CheckedGlsl<TypeParam>;
    Glsl glsl;
    const auto around = window<Glsl>(); // to (28, 36)
    const typename Glsl::vec2 place(TypeParam(3), TypeParam(6));
    EXPECT_EQ(glsl.exitOf(around, place, glsl.gridRay(TypeParam(0), 1, false)), TypeParam(25));
    EXPECT_EQ(glsl.exitOf(around, place, glsl.gridRay(TypeParam(0), -1, false)), TypeParam(19));
    EXPECT_EQ(glsl.exitOf(around, place, glsl.gridRay(TypeParam(0), -1, true)), TypeParam(14));
    // North-west at a half: 19 posts to the west are 38 steps, 30 to the north are 30.
    EXPECT_EQ(glsl.exitOf(around, place, glsl.gridRay(TypeParam(-0.5), 1, true)), TypeParam(30));
    // South-east along the diagonal: 25 and 14.
    EXPECT_EQ(glsl.exitOf(around, place, glsl.gridRay(TypeParam(-1), 1, false)), TypeParam(14));
    // Along an edge, and from outside.
    const typename Glsl::vec2 corner(TypeParam(28), TypeParam(36));
    EXPECT_EQ(glsl.exitOf(around, corner, glsl.gridRay(TypeParam(0), -1, true)), TypeParam(44));
    const typename Glsl::vec2 outside(TypeParam(28.5), TypeParam(36));
    EXPECT_LT(glsl.exitOf(around, outside, glsl.gridRay(TypeParam(0), -1, true)), TypeParam(0));
}

TYPED_TEST(Windows, LinesCrossTheirColumnsFromFarToNear)
{
    using Glsl = CheckedGlsl<TypeParam>;
    Glsl glsl;
    const auto around = window<Glsl>();
    const typename Glsl::vec2 place(TypeParam(3), TypeParam(6));
    // Columns to the east of 3 stand at 4, 8, ... 28: 1, 5, ... 25 steps away.
    const auto east = glsl.columnsBetween(around, place, glsl.gridRay(TypeParam(0.25), 1, false),
                                          TypeParam(5), TypeParam(25));
    EXPECT_EQ(east.count, 5); // more than 5 steps: 9 ... 25
    EXPECT_EQ(east.farthest, TypeParam(25));
    // To the west at 0, -4, ... -16: 3, 7, ... 19.
    const auto west = glsl.columnsBetween(around, place, glsl.gridRay(TypeParam(0.25), -1, false),
                                          TypeParam(0), TypeParam(18));
    EXPECT_EQ(west.count, 4);
    EXPECT_EQ(west.farthest, TypeParam(15));
    EXPECT_EQ(glsl.columnsBetween(around, place, glsl.gridRay(TypeParam(0), 1, true), TypeParam(10),
                                  TypeParam(10))
                  .count,
              0);
}

TYPED_TEST(Windows, HeightsAreThoseOfTheSurfaceWhereALineCrosses)
{
    using Glsl = CheckedGlsl<TypeParam>;
    Glsl glsl;
    const Raster<TypeParam> heights = texture<TypeParam>();
    const auto around = window<Glsl>();
    const TypeParam rounding = TypeParam(400) * std::numeric_limits<TypeParam>::epsilon();
    for (const bool north : {false, true})
        for (const int look : {1, -1})
            for (const double turn : {0.0, 0.3, -0.7, 1.0})
            {
                const auto ray = glsl.gridRay(TypeParam(turn), look, north);
                // The major coordinate is whole.
                const typename Glsl::vec2 place =
                    north ? typename Glsl::vec2(TypeParam(3.4), TypeParam(6))
                          : typename Glsl::vec2(TypeParam(3), TypeParam(6.4));
                const auto columns = glsl.columnsBetween(around, place, ray, TypeParam(0),
                                                         glsl.exitOf(around, place, ray));
                ASSERT_GT(columns.count, 0);
                for (int i = 0; i < columns.count; ++i)
                {
                    const TypeParam away = columns.farthest - TypeParam(i * step);
                    const typename Glsl::vec2 at = place + ray.step * away;
                    EXPECT_NEAR(glsl.columnHeight(heights, around, place, ray, away),
                                planeAt(at.x, at.y), rounding * TypeParam(100));
                    const auto row = glsl.rowCrossing(heights, around, place, ray, away);
                    if (glsl.isVoid(row.height))
                        continue;
                    const typename Glsl::vec2 crossing = place + ray.step * row.away;
                    EXPECT_GE(row.away, away);
                    EXPECT_LE(row.away, away + TypeParam(step));
                    EXPECT_NEAR(row.height, planeAt(crossing.x, crossing.y),
                                rounding * TypeParam(100));
                    // On a row of the window.
                    const TypeParam minor =
                        (north ? crossing.x - TypeParam(firstX) : crossing.y - TypeParam(firstY)) /
                        TypeParam(step);
                    EXPECT_NEAR(minor, std::round(minor), rounding);
                }
            }
    // Nothing lies beyond its last column, nor does a ray along the rows cross one.
    const auto ray = glsl.gridRay(TypeParam(0), 1, false);
    const typename Glsl::vec2 place(TypeParam(3), TypeParam(6.4));
    EXPECT_TRUE(glsl.isVoid(glsl.columnHeight(heights, around, place, ray, TypeParam(29))));
    EXPECT_TRUE(glsl.isVoid(glsl.rowCrossing(heights, around, place, ray, TypeParam(5)).height));
}

TYPED_TEST(Windows, MayEndBeforeTheirLastPost)
{
    using Glsl = CheckedGlsl<TypeParam>;
    Glsl glsl;
    auto around = window<Glsl>();
    around.last = glm::ivec2(26, 36); // the data end between the last two columns
    EXPECT_TRUE(glsl.hasPost(around, glm::ivec2(11, 0)));
    EXPECT_FALSE(glsl.hasPost(around, glm::ivec2(12, 0)));
    EXPECT_FALSE(glsl.hasPost(around, glm::ivec2(-1, 0)));
    const typename Glsl::vec2 place(TypeParam(3), TypeParam(6));
    EXPECT_EQ(glsl.exitOf(around, place, glsl.gridRay(TypeParam(0), 1, false)), TypeParam(23));
}
