#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace osgTerrainLight;

namespace
{
template <class Real>
class ShadowFunctions : public testing::Test
{
};
TYPED_TEST_SUITE(ShadowFunctions, Precisions);

constexpr double pi = 3.14159265358979323846;

/// The area of a circular segment over the disc's.
double segmentFraction(double above)
{
    const double x = std::clamp(above, -1.0, 1.0);
    return 0.5 + (std::asin(x) + x * std::sqrt(1.0 - x * x)) / pi;
}
} // namespace

// Three crests 10, 20, 30 m away, 8, 12, 10 m high, under a sun of slope 0.5: their shadows are 3,
// 2 and -5 m high.
TYPED_TEST(ShadowFunctions, TheHighestShadowCounts)
{
    CheckedGlsl<TypeParam> glsl;
    auto shadow = glsl.noShadow();
    EXPECT_TRUE(glsl.isVoid(shadow.height));
    for (const auto& [crest, away] : {std::pair{8, 10}, {12, 20}, {10, 30}})
        shadow = glsl.addCrest(shadow, TypeParam(crest), TypeParam(away), TypeParam(0.5));
    EXPECT_EQ(shadow.height, TypeParam(3));
    EXPECT_EQ(shadow.distance, TypeParam(10));
    const auto same = glsl.addCrest(shadow, glsl.VOID_HEIGHT, TypeParam(1), TypeParam(0.5));
    EXPECT_EQ(same.height, shadow.height);
}

TYPED_TEST(ShadowFunctions, BetweenTwoShadowsItIsLinearAndBesideNoneTheOther)
{
    CheckedGlsl<TypeParam> glsl;
    const auto none = glsl.noShadow();
    const auto a = glsl.addCrest(none, TypeParam(4), TypeParam(10), TypeParam(0));
    const auto b = glsl.addCrest(none, TypeParam(8), TypeParam(30), TypeParam(0));
    const auto between = glsl.mixShadows(a, b, TypeParam(0.25));
    EXPECT_EQ(between.height, TypeParam(5));
    EXPECT_EQ(between.distance, TypeParam(15));
    EXPECT_EQ(glsl.mixShadows(a, none, TypeParam(0.75)).height, TypeParam(4));
    EXPECT_EQ(glsl.mixShadows(none, b, TypeParam(0.25)).height, TypeParam(8));
    EXPECT_TRUE(glsl.isVoid(glsl.mixShadows(none, none, TypeParam(0.5)).height));
}

// The ratio is the angle between the disc's centre and the crest, in radii: found here from the
// crest's elevation.
TYPED_TEST(ShadowFunctions, HeightOverSoftnessIsTheAngleOverTheCrestInRadii)
{
    CheckedGlsl<TypeParam> glsl;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int trial = 0; trial < 500; ++trial)
    {
        const double elevation = (1.0 + 84.0 * uniform(random)) * pi / 180.0;
        const double radius = (0.1 + 5.0 * uniform(random)) * pi / 180.0;
        const double here = 200.0 * uniform(random), away = 1.0 + 500.0 * uniform(random);
        // A crest at up to 20 degrees beside the disc's centre.
        const double crestAt =
            std::max(elevation + (uniform(random) - 0.5) * 0.7, -0.5 * uniform(random));
        if (crestAt > 1.45)
            continue;
        const double crest = here + away * std::tan(crestAt);
        const auto slope = static_cast<TypeParam>(std::tan(elevation));
        const auto shadow =
            glsl.addCrest(glsl.noShadow(), TypeParam(crest), TypeParam(away), slope);
        const auto over = glsl.overShadow(shadow, TypeParam(here), TypeParam(elevation), slope,
                                          TypeParam(radius), TypeParam(1e6));
        ASSERT_GT(over.y, TypeParam(0));
        const double expected = (elevation - crestAt) / radius;
        // Heights and products of them round; the difference of two of them is seen over `away`,
        // and elevationOfSlope() is within 2e-8. Below 1e-3 the angle is that of its first order,
        // which is off by up to 1e-3 of it times twice the slope.
        const double size = std::abs(here) + std::abs(crest) + away * double(slope);
        const double bound =
            (8.0 * roundoff<TypeParam> * (size / away + double(slope) + 2.0) + 4e-8) / radius +
            4e-3 * std::abs(expected) * (1.0 + double(slope)) *
                (std::abs(elevation - crestAt) < 1.1e-3 ? 1.0 : 0.0);
        EXPECT_NEAR(static_cast<double>(over.x / over.y), expected,
                    bound + 16.0 * roundoff<TypeParam> * std::abs(expected) * (1.0 + size / away));
    }
}

// Far below a wall's shadow, or over everything, no more than the relief and the softness is left.
TYPED_TEST(ShadowFunctions, TheHeightIsBoundedByTheRelief)
{
    CheckedGlsl<TypeParam> glsl;
    const auto elevation = static_cast<TypeParam>(pi / 4.0);
    const auto radius = static_cast<TypeParam>(0.005);
    const TypeParam sun(1), relief(2);
    const auto over = [&](double crest)
    {
        const auto shadow =
            glsl.addCrest(glsl.noShadow(), TypeParam(crest), TypeParam(1), TypeParam(1));
        return glsl.overShadow(shadow, TypeParam(0), elevation, sun, radius, relief);
    };
    for (const double crest : {100.0, -100.0})
        EXPECT_NEAR(static_cast<double>(over(crest).x),
                    (crest > 0.0 ? -1.0 : 1.0) * (2.0 + static_cast<double>(over(crest).y)),
                    8.0 * roundoff<TypeParam> * 100.0);
    const auto open =
        glsl.overShadow(glsl.noShadow(), TypeParam(0), elevation, sun, radius, relief);
    EXPECT_GE(open.x, open.y); // the whole disc
}

TYPED_TEST(ShadowFunctions, DiscFractionIsNearTheCircularSegment)
{
    CheckedGlsl<TypeParam> glsl;
    double worst = 0.0;
    for (int i = -150; i <= 150; ++i)
        worst =
            std::max(worst, std::abs(static_cast<double>(glsl.discFraction(TypeParam(i / 100.0))) -
                                     segmentFraction(i / 100.0)));
    EXPECT_LE(worst, 0.0032);
    EXPECT_NEAR(static_cast<double>(glsl.discFraction(TypeParam(-1))), 0.0,
                8 * roundoff<TypeParam>);
    EXPECT_NEAR(static_cast<double>(glsl.discFraction(TypeParam(1))), 1.0, 8 * roundoff<TypeParam>);
}

// Expected: the mean of discFraction() at 20,000 places of the way.
TYPED_TEST(ShadowFunctions, MeanDiscFractionIsItsMean)
{
    CheckedGlsl<TypeParam> glsl;
    CheckedGlsl<double> exact;
    std::mt19937 random(8);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int trial = 0; trial < 200; ++trial)
    {
        const double size = std::exp2(6.0 * uniform(random)); // ways of 1/64 … 64 radii
        const double from = 1.5 * uniform(random) - size * std::max(0.0, uniform(random));
        const double to = from + size;
        double mean = 0.0;
        for (int i = 0; i < 20000; ++i)
            mean += exact.discFraction(from + (to - from) * (i + 0.5) / 20000.0) / 20000.0;
        // Where the way is short, the middle's: off by the second derivative, 0.7, times 0.1² / 24,
        // and by the kink at ±1, a change of slope of 0.16, times 0.1 / 8.
        const double bound = (size > 0.1 ? 0.0 : 3e-4 + 2e-3) + 1e-5 +
                             16.0 * roundoff<TypeParam> * (1.0 + 2.0 / size);
        EXPECT_NEAR(static_cast<double>(glsl.meanDiscFraction(TypeParam(from), TypeParam(to))),
                    mean, bound)
            << from << " to " << to;
        EXPECT_NEAR(static_cast<double>(glsl.meanDiscFraction(TypeParam(to), TypeParam(from))),
                    mean, bound);
    }
    EXPECT_EQ(glsl.meanDiscFraction(TypeParam(3e4), TypeParam(3.0001e4)), TypeParam(1));
    EXPECT_EQ(glsl.meanDiscFraction(TypeParam(-3e4), TypeParam(-3.0001e4)), TypeParam(0));
    // A hard edge: what is beyond the crossing.
    EXPECT_NEAR(static_cast<double>(glsl.meanDiscFraction(TypeParam(-3e4), TypeParam(1e4))), 0.25,
                1e-6 + 4.0 * roundoff<TypeParam>);
}

TYPED_TEST(ShadowFunctions, AShadowCrossesWhereTheSignChanges)
{
    CheckedGlsl<TypeParam> glsl;
    EXPECT_EQ(glsl.shadowCrossing(TypeParam(-1), TypeParam(3)), TypeParam(0.25));
    EXPECT_EQ(glsl.shadowCrossing(TypeParam(3), TypeParam(-1)), TypeParam(0.75));
    EXPECT_EQ(glsl.shadowCrossing(TypeParam(3), TypeParam(1)), TypeParam(1));
    EXPECT_EQ(glsl.shadowCrossing(TypeParam(-3), TypeParam(-1)), TypeParam(1));
    EXPECT_EQ(glsl.shadowCrossing(TypeParam(0), TypeParam(0)), TypeParam(1));
}
