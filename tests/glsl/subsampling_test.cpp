#include "support/FramedHeights.h"
#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;

namespace
{
template <class Real>
class Subsampling : public testing::Test
{
};
TYPED_TEST_SUITE(Subsampling, Precisions);
} // namespace

TYPED_TEST(Subsampling, FirstValidPostStandsForItsBlock)
{
    using Host = CheckedGlsl<TypeParam>;
    Host glsl;
    DemTile tile(7, 6, 10.0); // all void
    tile.setHeight(3, 2, 1.0f);
    tile.setHeight(2, 3, 1.0f);
    tile.setHeight(6, 5, 1.0f);
    const Raster<TypeParam> heights = framedHeights<TypeParam>(tile, 1);
    const auto post = [&](int x, int y, int stride) {
        return glsl.postOfBlock(heights, {x, y}, stride, {7, 6}, 1);
    };
    using glm::ivec2;
    EXPECT_EQ(post(1, 1, 2), ivec2(3, 2)); // row by row
    EXPECT_EQ(post(0, 0, 4), ivec2(3, 2));
    EXPECT_EQ(post(0, 0, 2), ivec2(0, 0)); // none is valid
    EXPECT_EQ(post(3, 2, 2), ivec2(6, 5)); // a block that the tile's border cuts
    EXPECT_EQ(post(5, 3, 1), ivec2(5, 3));
}

TYPED_TEST(Subsampling, WeightsAreBilinearOnThePlaneAndFallOffIt)
{
    using Host = CheckedGlsl<TypeParam>;
    using vec3 = typename Host::vec3;
    Host glsl;
    const typename Host::vec2 share(TypeParam(0.25), TypeParam(0.5));
    const vec3 up(TypeParam(0), TypeParam(0), TypeParam(1));
    const auto weight = [&](int x, int y, TypeParam off)
    {
        return static_cast<double>(glsl.blockWeight(
            {x, y}, share, vec3(TypeParam(7), TypeParam(-3), off), up, TypeParam(10)));
    };
    EXPECT_EQ(weight(0, 0, TypeParam(0)), 0.375);
    EXPECT_EQ(weight(1, 0, TypeParam(0)), 0.125);
    EXPECT_EQ(weight(0, 1, TypeParam(0)), 0.375);
    EXPECT_EQ(weight(1, 1, TypeParam(0)), 0.125);
    // One spacing off the plane: 1 / (1 + 1/2).
    EXPECT_NEAR(weight(0, 0, TypeParam(10)), 0.25, 4.0 * roundoff<TypeParam>);
    EXPECT_NEAR(weight(0, 0, TypeParam(-10)), 0.25, 4.0 * roundoff<TypeParam>);
    // On top of one block the others still count a little.
    const typename Host::vec2 there(TypeParam(0), TypeParam(0));
    EXPECT_GT(glsl.blockWeight({1, 1}, there, up, up, TypeParam(10)), TypeParam(0));
}
