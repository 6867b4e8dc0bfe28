#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;

namespace
{
template <class Real>
class Rays : public testing::Test
{
};
TYPED_TEST_SUITE(Rays, Precisions);

constexpr int width = 9, height = 7, frame = 2;

/// Heights of the bilinear surface 3 x − 2 y + x y / 2 + 100, which a crossing of a line of posts
/// hits exactly.
template <class Real>
Real surfaceAt(Real x, Real y)
{
    return Real(3) * x - Real(2) * y + Real(0.5) * x * y + Real(100);
}

template <class Real>
Raster<Real> surface()
{
    Raster<Real> heights(width + 2 * frame, height + 2 * frame, CheckedGlsl<Real>::VOID_HEIGHT);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            heights.at(x + frame, y + frame) = surfaceAt(Real(x), Real(y));
    return heights;
}
} // namespace

TYPED_TEST(Rays, GoOnePostAlongTheMajorAxisAndDriftAlongTheOther)
{
    CheckedGlsl<TypeParam> glsl;
    for (const bool north : {false, true})
        for (const int look : {1, -1})
            for (const double turn : {0.0, 0.25, -0.75, 1.0})
            {
                const auto ray = glsl.gridRay(TypeParam(turn), look, north);
                const double drift = turn * look;
                EXPECT_EQ(ray.drift, TypeParam(drift));
                EXPECT_EQ(ray.step.x, TypeParam(north ? drift : look));
                EXPECT_EQ(ray.step.y, TypeParam(north ? look : drift));
                EXPECT_EQ(ray.major, north ? glm::ivec2(0, look) : glm::ivec2(look, 0));
                EXPECT_EQ(ray.minor, north ? glm::ivec2(1, 0) : glm::ivec2(0, 1));
                EXPECT_EQ(ray.side, drift < 0.0 ? -ray.minor : ray.minor);
            }
}

TYPED_TEST(Rays, ReadTheSurfaceWhereTheyCrossALineOfPosts)
{
    CheckedGlsl<TypeParam> glsl;
    const Raster<TypeParam> heights = surface<TypeParam>();
    const glm::ivec2 post(4, 3), size(width, height);
    int inside = 0, outside = 0;
    for (const bool north : {false, true})
        for (const int look : {1, -1})
            for (const double turn : {0.0, 0.25, -0.75, 0.5, -1.0})
                for (int steps = 0; steps <= 5; ++steps)
                {
                    const auto ray = glsl.gridRay(TypeParam(turn), look, north);
                    // The turns are exact in binary, and so are the places and the heights.
                    const double x = post.x + steps * static_cast<double>(ray.step.x);
                    const double y = post.y + steps * static_cast<double>(ray.step.y);
                    const double found = static_cast<double>(
                        glsl.heightAtStep(heights, post, ray, steps, size, frame));
                    const bool within =
                        x >= 0.0 && y >= 0.0 && x <= width - 1.0 && y <= height - 1.0;
                    if (within)
                        EXPECT_EQ(found, surfaceAt(x, y)) << x << " " << y;
                    else
                        EXPECT_TRUE(glsl.isVoid(TypeParam(found))) << x << " " << y;
                    ++(within ? inside : outside);
                }
    EXPECT_GT(inside, 50);
    EXPECT_GT(outside, 10);
}

TYPED_TEST(Rays, AreVoidBesideAVoid)
{
    CheckedGlsl<TypeParam> glsl;
    Raster<TypeParam> heights = surface<TypeParam>();
    heights.at(5 + frame, 4 + frame) = glsl.VOID_HEIGHT;
    const glm::ivec2 post(4, 3), size(width, height);
    const auto between = glsl.gridRay(TypeParam(0.5), 1, false);
    EXPECT_EQ(glsl.heightAtStep(heights, post, between, 1, size, frame), glsl.VOID_HEIGHT);
    EXPECT_EQ(glsl.ownCellSlope(heights, glm::ivec2(4 + frame, 4 + frame), TypeParam(0), between),
              glsl.NO_HORIZON);
    const auto along = glsl.gridRay(TypeParam(0), 1, false);
    EXPECT_EQ(glsl.heightAtStep(heights, post, along, 1, size, frame),
              surfaceAt(TypeParam(5), TypeParam(3)));
}

// The derivative of the bilinear surface along the step, at the post.
TYPED_TEST(Rays, OwnCellRisesAsItsTangent)
{
    CheckedGlsl<TypeParam> glsl;
    const Raster<TypeParam> heights = surface<TypeParam>();
    const int x = 4, y = 3;
    for (const bool north : {false, true})
        for (const int look : {1, -1})
            for (const double turn : {0.0, 0.25, -0.75})
            {
                const auto ray = glsl.gridRay(TypeParam(turn), look, north);
                const TypeParam tangent = (TypeParam(3) + TypeParam(0.5) * y) * ray.step.x +
                                          (TypeParam(-2) + TypeParam(0.5) * x) * ray.step.y;
                EXPECT_EQ(glsl.ownCellSlope(heights, glm::ivec2(x + frame, y + frame),
                                            surfaceAt(TypeParam(x), TypeParam(y)), ray),
                          tangent);
            }
}

TYPED_TEST(Rays, AreOnTheSurfaceUpToItsLastPosts)
{
    CheckedGlsl<TypeParam> glsl;
    using vec2 = typename CheckedGlsl<TypeParam>::vec2;
    const glm::ivec2 size(width, height);
    const auto none = TypeParam(0), little = static_cast<TypeParam>(0.01);
    EXPECT_TRUE(glsl.onSurface(vec2(0, 0), size, none));
    EXPECT_TRUE(glsl.onSurface(vec2(width - 1, height - 1), size, none));
    for (const vec2& place : {vec2(TypeParam(-0.005), 3), vec2(3, TypeParam(-0.005)),
                              vec2(TypeParam(8.005), 3), vec2(3, TypeParam(6.005))})
    {
        EXPECT_FALSE(glsl.onSurface(place, size, none));
        EXPECT_TRUE(glsl.onSurface(place, size, little));
    }
}

TYPED_TEST(Rays, FindTheirTexelInAPyramid)
{
    CheckedGlsl<TypeParam> glsl;
    using vec2 = typename CheckedGlsl<TypeParam>::vec2;
    EXPECT_EQ(glsl.pyramidLevel(TypeParam(-2), 4), 0);
    EXPECT_EQ(glsl.pyramidLevel(TypeParam(0.4), 4), 0);
    EXPECT_EQ(glsl.pyramidLevel(TypeParam(0.5), 4), 1);
    EXPECT_EQ(glsl.pyramidLevel(TypeParam(1.4999999), 4), 2); // a half, rounded down
    EXPECT_EQ(glsl.pyramidLevel(TypeParam(9), 4), 3);
    // Level 2 stands at (20, 10) and has 6 × 5 texels: on every fourth post, or of four cells a
    // side.
    const glm::ivec4 level(20, 10, 6, 5);
    EXPECT_EQ(glsl.pyramidTexel(level, vec2(8, 4), 2), vec2(22.5, 11.5));
    EXPECT_EQ(glsl.pyramidTexel(level, vec2(10, 4), 2), vec2(23.0, 11.5));
    EXPECT_EQ(glsl.cellPyramidTexel(level, vec2(10, 6), 2), vec2(22.5, 11.5));
    EXPECT_EQ(glsl.cellPyramidTexel(level, vec2(0, 90), 2), vec2(20.5, 14.5));
}

TYPED_TEST(Rays, SlopesOfPyramidReads)
{
    CheckedGlsl<TypeParam> glsl;
    using vec2 = typename CheckedGlsl<TypeParam>::vec2;
    // Height 40, three quarters of it valid.
    const vec2 read(30, TypeParam(0.75));
    EXPECT_EQ(glsl.pyramidHeight(read), TypeParam(40));
    const vec2 rise = glsl.pyramidRise(read, TypeParam(8));
    EXPECT_EQ(rise, vec2(24, TypeParam(0.75)));
    EXPECT_EQ(glsl.slopeOfRise(rise, TypeParam(4), TypeParam(2)), TypeParam(4));
    const vec2 halfVoid(30, TypeParam(0.5));
    EXPECT_EQ(glsl.pyramidHeight(halfVoid), glsl.VOID_HEIGHT);
    EXPECT_EQ(glsl.slopeOfRise(halfVoid, TypeParam(4), TypeParam(2)), glsl.NO_HORIZON);
}

TYPED_TEST(Rays, SlopesOfCodesAndPlanes)
{
    CheckedGlsl<TypeParam> glsl;
    using vec3 = typename CheckedGlsl<TypeParam>::vec3;
    // 30 degrees; half a code is 2.4e-5 rad, and the tangent's derivative there is 4/3.
    const TypeParam code = glsl.codeOfElevation(TypeParam(0.5235987755982988));
    EXPECT_NEAR(static_cast<double>(glsl.slopeOfCode(code)), std::tan(0.5235987755982988),
                2.4e-5 * 4.0 / 3.0 + 8.0 * roundoff<TypeParam>);
    EXPECT_NEAR(static_cast<double>(glsl.slopeOfCode(glsl.VOID_CODE)), std::tan(-1.57),
                4e6 * roundoff<TypeParam>); // the derivative is 1/cos², 1.6e6
    // A direction of that slope lies in the plane: at right angles to the normal.
    const vec3 normal = glsl.normalize(vec3(TypeParam(0.3), TypeParam(-0.5), TypeParam(0.9)));
    const auto cosine = static_cast<TypeParam>(0.6), sine = static_cast<TypeParam>(0.8);
    const TypeParam slope = glsl.planeSlope(normal, cosine, sine);
    EXPECT_NEAR(static_cast<double>(glsl.dot(normal, vec3(cosine, sine, slope))), 0.0,
                8.0 * roundoff<TypeParam>);
}
