#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

using namespace osgTerrainLight;

namespace
{
template <class Real>
class LineHistory : public testing::Test
{
};
TYPED_TEST_SUITE(LineHistory, Precisions);

constexpr double step = 2.0, width = 0.25; // [m], [rad]

/// Moments of a segment of radiance 1 between two slopes.
template <class Real>
double upwardMoment(double from, double to)
{
    CheckedGlsl<double> glsl;
    return glsl.sliceMoments(from, width).x - glsl.sliceMoments(to, width).x;
}
} // namespace

// Two faces in sight, 3 m and 1 m high: as one piece they send 3 and 1 parts of their radiances.
// The line that fits a quarter of one light below three quarters of another best rises by 6 · 1/4 ·
// 3/4 of their difference, but by no more than three times their mean.
TYPED_TEST(LineHistory, APieceSendsWhatItsStepsSendByTheirRise)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    const typename G::vec3 even(0, 0, 0);
    const auto far = glsl.passedStep(TypeParam(4), TypeParam(0), TypeParam(3),
                                     typename G::vec3(1, 0, 8), even, TypeParam(step));
    const auto near = glsl.passedStep(TypeParam(1), TypeParam(1), TypeParam(1),
                                      typename G::vec3(5, 4, 0), even, TypeParam(step));
    const auto joined = glsl.joinPassed(far, near, TypeParam(step));
    EXPECT_EQ(joined.light, (typename G::vec4(2, 1, 6, 4)));
    EXPECT_EQ(joined.end, (typename G::vec2(4, 0)));
    EXPECT_EQ(joined.tilt, (typename G::vec3(-4.5, -3, 9)));
}

// Eight steps of any rise and light, joined in pairs: the tilt is that of the least-squares line
// over all of their heights: 12 ∫ light · (height - middle) over the square of their rise. Light is
// so even that no tilt is bounded.
TYPED_TEST(LineHistory, TiltsAddUpToTheBestLine)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    std::mt19937 random(6);
    std::uniform_real_distribution<double> uniform(0.1, 3.0);
    for (int trial = 0; trial < 50; ++trial)
    {
        std::array<double, 8> rises, means, tilts; // from the nearest, the lowest
        double rise = 0.0;
        for (std::size_t i = 0; i < 8; ++i)
        {
            rises[i] = uniform(random);
            means[i] = 1.0 + uniform(random);
            tilts[i] = uniform(random) - 1.5;
            rise += rises[i];
        }
        double moment = 0.0, from = -0.5 * rise;
        for (std::size_t i = 0; i < 8; ++i)
        {
            moment += means[i] * rises[i] * (from + 0.5 * rises[i]) +
                      tilts[i] * rises[i] * rises[i] / 12.0;
            from += rises[i];
        }
        std::vector<decltype(glsl.passedNothing())> pieces;
        for (std::size_t i = 0; i < 8; ++i)
            pieces.push_back(glsl.passedStep(
                TypeParam(0), TypeParam(-static_cast<double>(i)), TypeParam(rises[i]),
                typename G::vec3(TypeParam(means[i]), TypeParam(0), TypeParam(0)),
                typename G::vec3(TypeParam(tilts[i]), TypeParam(0), TypeParam(0)),
                TypeParam(step)));
        while (pieces.size() > 1)
        {
            for (std::size_t i = 0; 2 * i < pieces.size(); ++i)
                pieces[i] = glsl.joinPassed(pieces[2 * i + 1], pieces[2 * i], TypeParam(step));
            pieces.resize(pieces.size() / 2);
        }
        EXPECT_NEAR(static_cast<double>(pieces[0].tilt.x), 12.0 * moment / (rise * rise),
                    64.0 * 4.0 * roundoff<TypeParam>);
    }
}

// The horizon caps a piece, and what stands before hides it.
TYPED_TEST(LineHistory, APieceIsSeenBetweenWhatHidesItAndTheHorizon)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    const typename G::vec3 white(1, 1, 1);
    const auto piece = glsl.passedStep(TypeParam(4), TypeParam(0), TypeParam(4), white,
                                       typename G::vec3(0, 0, 0), TypeParam(step));
    const auto from = [&](double plane)
    { return glsl.startGather(TypeParam(plane), typename G::vec3(0, 0, 0), TypeParam(width)); };
    const auto seen = [&](double plane, double cap)
    {
        const auto slice =
            glsl.addPassed(from(plane), piece, TypeParam(1), TypeParam(0), TypeParam(1),
                           TypeParam(step), TypeParam(cap), TypeParam(width));
        return static_cast<double>(slice.upward.x);
    };
    const double bound = 16.0 * roundoff<TypeParam>;
    EXPECT_NEAR(seen(1.0, 10.0), upwardMoment<TypeParam>(1.0, 2.0), bound);
    EXPECT_NEAR(seen(1.0, 1.5), upwardMoment<TypeParam>(1.0, 1.5), bound);
    EXPECT_EQ(seen(2.5, 10.0), 0.0);
}

// An upright wall 4 m high whose light rises evenly from 1 at its foot to 3 at its top: who looks
// from its foot's height sees all of it, who sees the upper half has 2 to 3. Expected: the graded
// segment.
TYPED_TEST(LineHistory, OfAWallTheUpperPartIsSeen)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    const auto light = [](double value)
    { return typename G::vec3(TypeParam(value), TypeParam(value), TypeParam(value)); };
    const auto wall = glsl.passedStep(TypeParam(4), TypeParam(0), TypeParam(4), light(2.0),
                                      light(2.0), TypeParam(step));
    for (const auto& [plane, lowest] : {std::pair{0.0, 1.0}, {1.0, 2.0}, {-1.0, 1.0}})
    {
        const auto start = glsl.startGather(TypeParam(plane), light(0.0), TypeParam(width));
        const auto seen =
            glsl.addPassed(start, wall, TypeParam(0), TypeParam(0), TypeParam(1), TypeParam(step),
                           TypeParam(9), TypeParam(width)); // up to slope 4 / 2
        const auto expected = glsl.addGradedSegment(start, TypeParam(2), light(lowest), light(3.0),
                                                    TypeParam(9), TypeParam(width));
        const double bound = 64.0 * roundoff<TypeParam>;
        EXPECT_NEAR(static_cast<double>(seen.upward.x), static_cast<double>(expected.upward.x),
                    bound);
        EXPECT_NEAR(static_cast<double>(seen.outward.x), static_cast<double>(expected.outward.x),
                    bound);
    }
}

// A slope of 45 degrees, 7 to 9 steps away, whose light rises from 0 to 2: its upper half is
// farther, so that the mean of what is seen of it is below 1. Expected from 4,000 thin pieces of
// it, which the first order meets to a hundredth of the change.
TYPED_TEST(LineHistory, OfASlopeTheNearerPartIsSeenBetter)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    CheckedGlsl<double> exact;
    using Vec3 = CheckedGlsl<double>::vec3;
    const typename G::vec3 one(1, 1, 1), none(0, 0, 0);
    const auto slope = glsl.passedStep(TypeParam(5.0 * step), TypeParam(0), TypeParam(2.0 * step),
                                       one, one * TypeParam(2), TypeParam(step));
    const double low = 3.0 / 7.0, high = 5.0 / 9.0;
    const auto seen = glsl.addPassed(glsl.startGather(TypeParam(low), none, TypeParam(width)),
                                     slope, TypeParam(2), TypeParam(0), TypeParam(9),
                                     TypeParam(step), TypeParam(9), TypeParam(width));
    auto expected = exact.startGather(low, Vec3(0, 0, 0), width);
    for (int i = 0; i < 4000; ++i)
    {
        const double end = 2.0 * (i + 1) / 4000.0;
        expected = exact.addSegment(expected, (3.0 + end) / (7.0 + end),
                                    Vec3(2.0 * (i + 0.5) / 4000.0), 9.0, width);
    }
    const double even = upwardMoment<TypeParam>(low, high);
    EXPECT_LT(expected.upward.x, 0.97 * even);
    EXPECT_NEAR(static_cast<double>(seen.upward.x), expected.upward.x, 0.01 * even);
}

// Ground that falls away, seen from above, counts alike, whatever its fall.
TYPED_TEST(LineHistory, FallingGroundCountsAlike)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    const auto far =
        glsl.passedStep(TypeParam(-9), TypeParam(0), TypeParam(-7), typename G::vec3(1, 1, 1),
                        typename G::vec3(0, 0, 0), TypeParam(step));
    const auto near =
        glsl.passedStep(TypeParam(-2), TypeParam(1), TypeParam(-1), typename G::vec3(3, 3, 3),
                        typename G::vec3(0, 0, 0), TypeParam(step));
    const auto joined = glsl.joinPassed(far, near, TypeParam(step));
    EXPECT_NEAR(static_cast<double>(joined.light.x), 2.0, 8.0 * roundoff<TypeParam>);
    // 7 m lower, 2 m farther: a view of slope -1 loses the far end behind the near one.
    EXPECT_EQ(joined.end, (typename G::vec2(-2, 1)));
}

// What is void neither sends nor hides, and takes nothing from what it is joined with.
TYPED_TEST(LineHistory, NothingIsSeenOfVoids)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    const auto nothing = glsl.passedNothing();
    const auto ground =
        glsl.passedStep(TypeParam(4), TypeParam(2), TypeParam(1), typename G::vec3(1, 2, 3),
                        typename G::vec3(0, 0, 0), TypeParam(step));
    const auto start = glsl.startGather(TypeParam(-1), typename G::vec3(0, 0, 0), TypeParam(width));
    for (const auto& piece : {nothing, glsl.joinPassed(nothing, nothing, TypeParam(step))})
    {
        const auto seen = glsl.addPassed(start, piece, TypeParam(1), TypeParam(0), TypeParam(0),
                                         TypeParam(step), TypeParam(1), TypeParam(width));
        EXPECT_EQ(seen.highest, start.highest);
        EXPECT_EQ(seen.upward, start.upward);
    }
    for (const auto& piece : {glsl.joinPassed(nothing, ground, TypeParam(step)),
                              glsl.joinPassed(ground, nothing, TypeParam(step))})
    {
        EXPECT_EQ(piece.light, ground.light);
        EXPECT_EQ(piece.end, ground.end);
    }
}
