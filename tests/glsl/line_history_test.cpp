#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <cmath>

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
TYPED_TEST(LineHistory, APieceSendsWhatItsStepsSendByTheirRise)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    const auto far = glsl.passedStep(TypeParam(4), TypeParam(0), TypeParam(3),
                                     typename G::vec3(1, 0, 8), TypeParam(step));
    const auto near = glsl.passedStep(TypeParam(1), TypeParam(1), TypeParam(1),
                                      typename G::vec3(5, 4, 0), TypeParam(step));
    const auto joined = glsl.joinPassed(far, near, TypeParam(step));
    EXPECT_EQ(joined.light, (typename G::vec4(8, 4, 24, 4)));
    EXPECT_EQ(joined.end, (typename G::vec2(4, 0)));

    // From height 0, three steps of 2 m beyond its end: the piece reaches up to slope 4 / 6.
    const auto none = glsl.startGather(TypeParam(0), typename G::vec3(0, 0, 0), TypeParam(width));
    const auto seen = glsl.addPassed(none, joined, TypeParam(0), TypeParam(3), TypeParam(step),
                                     TypeParam(10), TypeParam(width));
    const double moment = upwardMoment<TypeParam>(0.0, 4.0 / 6.0);
    const double bound = 8.0 * 16.0 * roundoff<TypeParam>;
    EXPECT_NEAR(static_cast<double>(seen.upward.x), 2.0 * moment, bound);
    EXPECT_NEAR(static_cast<double>(seen.upward.y), 1.0 * moment, bound);
    EXPECT_NEAR(static_cast<double>(seen.upward.z), 6.0 * moment, bound);
    EXPECT_NEAR(static_cast<double>(seen.highest), 4.0 / 6.0, bound);
}

// The horizon caps a piece, and what stands before hides it.
TYPED_TEST(LineHistory, APieceIsSeenBetweenWhatHidesItAndTheHorizon)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    const typename G::vec3 white(1, 1, 1);
    const auto piece =
        glsl.passedStep(TypeParam(4), TypeParam(0), TypeParam(4), white, TypeParam(step));
    const auto from = [&](double plane)
    { return glsl.startGather(TypeParam(plane), typename G::vec3(0, 0, 0), TypeParam(width)); };
    const auto seen = [&](double plane, double cap)
    {
        const auto slice = glsl.addPassed(from(plane), piece, TypeParam(0), TypeParam(1),
                                          TypeParam(step), TypeParam(cap), TypeParam(width));
        return static_cast<double>(slice.upward.x);
    };
    const double bound = 16.0 * roundoff<TypeParam>;
    EXPECT_NEAR(seen(1.0, 10.0), upwardMoment<TypeParam>(1.0, 2.0), bound);
    EXPECT_NEAR(seen(1.0, 1.5), upwardMoment<TypeParam>(1.0, 1.5), bound);
    EXPECT_EQ(seen(2.5, 10.0), 0.0);
}

// Ground that falls away, seen from above, counts alike, whatever its fall.
TYPED_TEST(LineHistory, FallingGroundCountsAlike)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    const auto far = glsl.passedStep(TypeParam(-9), TypeParam(0), TypeParam(-7),
                                     typename G::vec3(1, 1, 1), TypeParam(step));
    const auto near = glsl.passedStep(TypeParam(-2), TypeParam(1), TypeParam(-1),
                                      typename G::vec3(3, 3, 3), TypeParam(step));
    const auto joined = glsl.joinPassed(far, near, TypeParam(step));
    EXPECT_NEAR(static_cast<double>(joined.light.x / joined.light.w), 2.0,
                8.0 * roundoff<TypeParam>);
    // 7 m lower, 2 m farther: a view of slope -1 loses the far end behind the near one.
    EXPECT_EQ(joined.end, (typename G::vec2(-2, 1)));
}

// What is void neither sends nor hides, and takes nothing from what it is joined with.
TYPED_TEST(LineHistory, NothingIsSeenOfVoids)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    const auto nothing = glsl.passedNothing();
    const auto ground = glsl.passedStep(TypeParam(4), TypeParam(2), TypeParam(1),
                                        typename G::vec3(1, 2, 3), TypeParam(step));
    const auto start = glsl.startGather(TypeParam(-1), typename G::vec3(0, 0, 0), TypeParam(width));
    for (const auto& piece : {nothing, glsl.joinPassed(nothing, nothing, TypeParam(step))})
    {
        const auto seen = glsl.addPassed(start, piece, TypeParam(0), TypeParam(0), TypeParam(step),
                                         TypeParam(1), TypeParam(width));
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
