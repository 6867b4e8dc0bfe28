#include "core/SyntheticTerrain.h"
#include "reference/ReferenceLight.h"
#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

using namespace osgTerrainLight;

namespace
{
template <class Real>
class SurfaceFunctions : public testing::Test
{
};
TYPED_TEST_SUITE(SurfaceFunctions, Precisions);

using Vector = std::array<double, 3>;

Vector unit(const Vector& v)
{
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return {v[0] / length, v[1] / length, v[2] / length};
}

/// The definition, word by word: cross products of a cell's two edges at the post, summed over the
/// complete cells.
template <class Real>
Vector crossProductNormal(const Raster<Real>& heights, int x, int y, double eastSpacing,
                          double northSpacing)
{
    Vector sum = {0.0, 0.0, 0.0};
    const auto height = [&](int i, int j) { return static_cast<double>(heights.at(x + i, y + j)); };
    for (const int i : {-1, 1})
        for (const int j : {-1, 1})
        {
            if (height(i, 0) < -1e20 || height(0, j) < -1e20 || height(i, j) < -1e20)
                continue;
            const Vector a = {i * eastSpacing, 0.0, height(i, 0) - height(0, 0)};
            const Vector b = {0.0, j * northSpacing, height(0, j) - height(0, 0)};
            const double up = i * j;
            sum[0] += up * (a[1] * b[2] - a[2] * b[1]);
            sum[1] += up * (a[2] * b[0] - a[0] * b[2]);
            sum[2] += up * (a[0] * b[1] - a[1] * b[0]);
        }
    return sum[2] > 0.0 ? unit(sum) : Vector{0.0, 0.0, 1.0};
}

template <class Real, class Vector3>
void expectNear(const Vector3& found, const Vector& expected, double bound)
{
    EXPECT_NEAR(static_cast<double>(found.x), expected[0], bound);
    EXPECT_NEAR(static_cast<double>(found.y), expected[1], bound);
    EXPECT_NEAR(static_cast<double>(found.z), expected[2], bound);
}
} // namespace

TYPED_TEST(SurfaceFunctions, NormalOfAPlane)
{
    CheckedGlsl<TypeParam> glsl;
    // Steps of 1/8 m and spacings that differ: every height and difference is exact.
    Raster<TypeParam> heights(5, 7);
    for (int y = 0; y < 7; ++y)
        for (int x = 0; x < 5; ++x)
            heights.at(x, y) = static_cast<TypeParam>(1000.0 + 0.375 * x - 1.25 * y);
    const Vector expected = unit({-0.375 / 3.0, 1.25 / 7.0, 1.0});
    // Eight roundings: two products, the squares' sum, its root and the quotient.
    for (int y = 1; y < 6; ++y)
        for (int x = 1; x < 4; ++x)
            expectNear<TypeParam>(
                glsl.postNormal(heights, glm::ivec2(x, y), TypeParam(3), TypeParam(7)), expected,
                8.0 * roundoff<TypeParam>);
}

TYPED_TEST(SurfaceFunctions, NormalOfABilinearPatch)
{
    CheckedGlsl<TypeParam> glsl;
    // z = x·y/4 in posts: at (x, y) the gradient is (y/4, x/4) whatever the cell.
    Raster<TypeParam> heights(6, 5);
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 6; ++x)
            heights.at(x, y) = static_cast<TypeParam>(0.25 * x * y);
    for (int y = 1; y < 4; ++y)
        for (int x = 1; x < 5; ++x)
            expectNear<TypeParam>(
                glsl.postNormal(heights, glm::ivec2(x, y), TypeParam(2), TypeParam(0.5)),
                unit({-0.25 * y / 2.0, -0.25 * x / 0.5, 1.0}), 8.0 * roundoff<TypeParam>);
}

TYPED_TEST(SurfaceFunctions, NormalInACell)
{
    CheckedGlsl<TypeParam> glsl;
    using Vec4 = typename CheckedGlsl<TypeParam>::vec4;
    // z = a + b·east + c·north + d·east·north in shares of a cell, spacings 2 and 0.5: the gradient
    // is ((b + d·north)/2, (c + d·east)/0.5). Eighths: all heights are exact.
    const double a = 100.0, b = 0.75, c = -0.25, d = 1.5;
    const Vec4 corners = {TypeParam(a), TypeParam(a + b), TypeParam(a + c),
                          TypeParam(a + b + c + d)};
    for (const double east : {0.0, 0.25, 0.5, 1.0})
        for (const double north : {0.0, 0.375, 1.0})
            expectNear<TypeParam>(glsl.cellNormal(corners, TypeParam(east), TypeParam(north),
                                                  TypeParam(2), TypeParam(0.5)),
                                  unit({-(b + d * north) / 2.0, -(c + d * east) / 0.5, 1.0}),
                                  8.0 * roundoff<TypeParam>);
}

TYPED_TEST(SurfaceFunctions, NormalForEveryPatternOfVoidsAround)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    std::mt19937 random(7);
    std::uniform_int_distribution<int> height(-64, 64);
    for (int pattern = 0; pattern < 256; ++pattern)
    {
        Raster<TypeParam> heights(3, 3);
        int bit = 0;
        for (int i = 0; i < 9; ++i)
        {
            const bool isVoid = i != 4 && ((pattern >> bit++) & 1) != 0;
            heights.at(i % 3, i / 3) =
                isVoid ? G::VOID_HEIGHT : static_cast<TypeParam>(0.25 * height(random));
        }
        const auto normal =
            glsl.postNormal(heights, glm::ivec2(1, 1), TypeParam(10), TypeParam(2.5));
        SCOPED_TRACE(pattern);
        expectNear<TypeParam>(normal, crossProductNormal(heights, 1, 1, 10.0, 2.5),
                              8.0 * roundoff<TypeParam>);
    }
}

TYPED_TEST(SurfaceFunctions, NormalOfOnePostIsUp)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    Raster<TypeParam> heights(3, 3, G::VOID_HEIGHT);
    heights.at(1, 1) = TypeParam(-321.5);
    const auto normal = glsl.postNormal(heights, glm::ivec2(1, 1), TypeParam(30), TypeParam(0.1));
    EXPECT_EQ(normal.x, TypeParam(0));
    EXPECT_EQ(normal.y, TypeParam(0));
    EXPECT_EQ(normal.z, TypeParam(1));
}

TYPED_TEST(SurfaceFunctions, NormalIsTheReferences)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    DemTile tile(9, 6, 25.0);
    tile.eastSpacings = {12.0};
    std::mt19937 random(3);
    std::uniform_real_distribution<float> height(-5040.0f, -4960.0f);
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 9; ++x)
            if ((3 * x + 5 * y) % 11 != 0)
                tile.setHeight(x, y, height(random));
    Raster<TypeParam> framed(11, 8, G::VOID_HEIGHT);
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 9; ++x)
            if (tile.isValid(x, y))
                framed.at(x + 1, y + 1) = static_cast<TypeParam>(tile.heightAt(x, y));
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 9; ++x)
            if (tile.isValid(x, y))
                // Differences of heights that stand within a factor 2 are exact (Sterbenz); their
                // sum of four loses up to two roundings more than the plane's.
                expectNear<TypeParam>(
                    glsl.postNormal(framed, glm::ivec2(x + 1, y + 1), TypeParam(12), TypeParam(25)),
                    reference::surfaceNormal(tile, x, y), 12.0 * roundoff<TypeParam>);
}

TYPED_TEST(SurfaceFunctions, VoidIsFarBelowEveryHeight)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    EXPECT_TRUE(glsl.isVoid(G::VOID_HEIGHT));
    for (const double height : {-1e6, -5000.0, 0.0, 1e6}) // DemTile's range
        EXPECT_FALSE(glsl.isVoid(static_cast<TypeParam>(height)));
}

TYPED_TEST(SurfaceFunctions, CrossingBesideAVoidIsVoid)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    std::vector<TypeParam> weights = {TypeParam(0), TypeParam(0.5)};
    for (TypeParam gap = TypeParam(0.25); gap >= TypeParam(roundoff<TypeParam>); gap = gap / 2)
    {
        weights.push_back(TypeParam(1) - gap);
        weights.push_back(std::nextafter(TypeParam(1) - gap, TypeParam(0)));
    }
    ASSERT_EQ(weights[weights.size() - 2], std::nextafter(TypeParam(1), TypeParam(0)));
    for (const double z : {-1e6, -5000.0, 0.0, 8848.0, 1e6})
    {
        const TypeParam height = static_cast<TypeParam>(z);
        for (const TypeParam weight : weights)
        {
            EXPECT_TRUE(glsl.isVoid(glsl.crossingHeight(G::VOID_HEIGHT, height, weight))) << weight;
            if (weight > TypeParam(0))
            {
                EXPECT_TRUE(glsl.isVoid(glsl.crossingHeight(height, G::VOID_HEIGHT, weight)));
            }
        }
        // On a post the other one is not asked, nor where rounding leaves the line by a little.
        for (const TypeParam slip : {TypeParam(0), TypeParam(1e-6)})
        {
            EXPECT_EQ(glsl.crossingHeight(height, G::VOID_HEIGHT, -slip), height);
            EXPECT_EQ(glsl.crossingHeight(G::VOID_HEIGHT, height, TypeParam(1) + slip), height);
        }
        // However small a weight: never above the valid post.
        for (const double weight : {1e-9, 1e-16, 1e-20, 1e-30})
            EXPECT_LE(glsl.crossingHeight(height, G::VOID_HEIGHT, static_cast<TypeParam>(weight)),
                      height);
    }
}

TYPED_TEST(SurfaceFunctions, CrossingIsLinearAndExactOnLevelGround)
{
    CheckedGlsl<TypeParam> glsl;
    for (int i = 0; i <= 64; ++i)
    {
        const TypeParam weight = static_cast<TypeParam>(i / 64.0);
        EXPECT_EQ(glsl.crossingHeight(TypeParam(-5), TypeParam(27), weight),
                  static_cast<TypeParam>(-5.0 + i * 0.5));
        EXPECT_EQ(glsl.crossingHeight(TypeParam(4807.3), TypeParam(4807.3), weight),
                  TypeParam(4807.3));
    }
}

TYPED_TEST(SurfaceFunctions, RiseBetweenPostsIsBilinearAndLeavesVoidsOut)
{
    CheckedGlsl<TypeParam> glsl;
    constexpr int frame = 2;
    Raster<TypeParam> heights(3 + 2 * frame, 2 + 2 * frame, CheckedGlsl<TypeParam>::VOID_HEIGHT);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x)
            heights.at(x + frame, y + frame) = static_cast<TypeParam>(100 + x + 10 * y + 4 * x * y);
    const auto rise = [&](double x, double y)
    {
        return glsl.riseBetweenPosts(heights,
                                     typename CheckedGlsl<TypeParam>::vec2(
                                         static_cast<TypeParam>(x), static_cast<TypeParam>(y)),
                                     glm::ivec2(3, 2), frame, TypeParam(90));
    };
    // Sums of four products of eighths: exact.
    for (double y = 0.0; y <= 1.0; y += 0.125)
        for (double x = 0.0; x <= 2.0; x += 0.125)
        {
            EXPECT_EQ(static_cast<double>(rise(x, y).x), 10.0 + x + 10.0 * y + 4.0 * x * y);
            EXPECT_EQ(rise(x, y).y, TypeParam(1));
        }
    heights.at(1 + frame, frame) = CheckedGlsl<TypeParam>::VOID_HEIGHT;
    EXPECT_EQ(rise(0.25, 0.0).y, TypeParam(0.75));
    EXPECT_EQ(rise(0.25, 0.0).x, TypeParam(7.5));
    EXPECT_EQ(rise(1.0, 0.0).y, TypeParam(0));
    // A single row.
    EXPECT_EQ(glsl.riseBetweenPosts(heights, typename CheckedGlsl<TypeParam>::vec2(2, 0),
                                    glm::ivec2(3, 1), frame, TypeParam(90))
                  .x,
              TypeParam(12));
}
