#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

using namespace osgTerrainLight;

namespace
{
template <class Real>
class Gather : public testing::Test
{
};
TYPED_TEST_SUITE(Gather, Precisions);

constexpr double slices = 0.2; // width [rad]
} // namespace

TYPED_TEST(Gather, RaisesToWhatIsSeenButNotAboveTheHorizon)
{
    CheckedGlsl<TypeParam> glsl;
    const auto raised = [&](double highest, double slope, double cap)
    { return glsl.raisedSlope(TypeParam(highest), TypeParam(slope), TypeParam(cap)); };
    EXPECT_EQ(raised(1.0, 2.0, 3.0), TypeParam(2)); // seen
    EXPECT_EQ(raised(1.0, 0.5, 3.0), TypeParam(1)); // hidden
    EXPECT_EQ(raised(1.0, 4.0, 3.0), TypeParam(3)); // above the horizon
    EXPECT_EQ(raised(2.0, 4.0, 1.0), TypeParam(2)); // which the plane itself is above
}

// Where all terrain sends the same, the segments' borders do not count: the receiver has what
// sliceIrradiance() gives between its plane and the horizon.
TYPED_TEST(Gather, EvenLightIsThatOfTheWholeSlice)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const auto width = static_cast<TypeParam>(slices);
    for (int trial = 0; trial < 200; ++trial)
    {
        const typename G::vec3 normal = glsl.normalize(typename G::vec3(
            TypeParam(uniform(random)), TypeParam(uniform(random)), TypeParam(0.5)));
        const TypeParam plane = glsl.planeSlope(normal, TypeParam(1), TypeParam(0));
        const TypeParam cap = plane + TypeParam(2.0 * std::abs(uniform(random)));
        const typename G::vec3 sent(1, 2, 4);
        auto gathered = glsl.startGather(plane, sent, width);
        for (int i = 0; i < 20; ++i)
            gathered =
                glsl.addSegment(gathered, TypeParam(4.0 * uniform(random)), sent, cap, width);
        gathered = glsl.closeGather(gathered, cap, width);
        EXPECT_EQ(gathered.highest, cap);
        const auto zenith = [&](TypeParam slope)
        { return glsl.HALF_PI - glsl.elevationOfSlope(slope); };
        const TypeParam expected = glsl.sliceIrradiance(zenith(plane), normal.z, normal.x, width) -
                                   glsl.sliceIrradiance(zenith(cap), normal.z, normal.x, width);
        // Twenty sums of parts whose total is below the slice's width, each off by the polynomial
        // of elevationOfSlope (2e-8) and a few roundings.
        const double bound = 22.0 * slices * (2.0 * 2e-8 + 8.0 * roundoff<TypeParam>);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(
                static_cast<double>(normal.z * gathered.upward[c] + normal.x * gathered.outward[c]),
                static_cast<double>(sent[c] * expected), static_cast<double>(sent[c]) * bound);
    }
}

// Light that changes evenly with the slope: expected from 4,000 thin segments of one light each.
// The horizon caps it where it has come to by then.
TYPED_TEST(Gather, GradedLightIsThatOfThinSegments)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    CheckedGlsl<double> exact;
    using Vec3 = CheckedGlsl<double>::vec3;
    for (const auto& [plane, slope, cap] : std::vector<std::array<double, 3>>{{-1.0, 2.0, 9.0},
                                                                              {0.0, 12.0, 20.0},
                                                                              {0.3, 0.8, 0.5},
                                                                              {-3.0, -0.5, 1.0},
                                                                              {0.2, 0.22, 1.0}})
    {
        const auto none = typename G::vec3(0, 0, 0);
        const auto found =
            glsl.addGradedSegment(glsl.startGather(TypeParam(plane), none, TypeParam(slices)),
                                  TypeParam(slope), typename G::vec3(1, 0, 3),
                                  typename G::vec3(2, 5, 1), TypeParam(cap), TypeParam(slices));
        auto expected = exact.startGather(plane, Vec3(0, 0, 0), slices);
        const double end = std::min(slope, cap);
        for (int i = 0; i < 4000; ++i)
        {
            const double way = (end - plane) / (slope - plane) * (i + 0.5) / 4000.0;
            expected = exact.addSegment(expected, plane + (end - plane) * (i + 1) / 4000.0,
                                        Vec3(1, 0, 3) + Vec3(1, 5, -2) * way, cap, slices);
        }
        // Thin segments are off by less than 5 / 4000² of the slice. Less than LEAST_GRADED takes
        // its mean: off by half the change, 2.5, times how much the moments' density changes in it,
        // 0.02 / (1 + 0.2²), times its own, 0.02. Terms of up to 1 / LEAST_GRADED round.
        const double bound = slices * (5.0 / 4000.0 / 4000.0 + (slope - plane < 0.05 ? 1e-3 : 0.0) +
                                       5.0 / 0.05 * 16.0 * roundoff<TypeParam> + 5.0 / 0.05 * 4e-8);
        for (int c = 0; c < 3; ++c)
        {
            EXPECT_NEAR(static_cast<double>(found.upward[c]), expected.upward[c], bound) << slope;
            EXPECT_NEAR(static_cast<double>(found.outward[c]), expected.outward[c], bound) << slope;
        }
        EXPECT_NEAR(static_cast<double>(found.highest), end, 1e-6);
    }
    // Hidden, it sends nothing.
    const auto start = glsl.startGather(TypeParam(1), typename G::vec3(7, 7, 7), TypeParam(slices));
    const auto hidden =
        glsl.addGradedSegment(start, TypeParam(0.5), typename G::vec3(1, 1, 1),
                              typename G::vec3(2, 2, 2), TypeParam(3), TypeParam(slices));
    EXPECT_EQ(hidden.upward, start.upward);
    EXPECT_EQ(hidden.outward, start.outward);
    EXPECT_EQ(hidden.last, start.last);
}

// Two segments of different light, one sample hidden behind the first: by hand.
TYPED_TEST(Gather, HiddenSamplesSendNothing)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    const auto width = static_cast<TypeParam>(slices), cap = TypeParam(2);
    const typename G::vec3 own(1, 1, 1), near(10, 10, 10), hidden(100, 100, 100),
        far(1000, 1000, 1000);
    const auto moments = [&](double slope) { return glsl.sliceMoments(TypeParam(slope), width); };
    auto gathered = glsl.startGather(TypeParam(-0.5), own, width);
    gathered = glsl.addSegment(gathered, TypeParam(0), own, cap, width);
    gathered = glsl.addSegment(gathered, TypeParam(0.5), near, cap, width);
    gathered = glsl.addSegment(gathered, TypeParam(0.25), hidden, cap, width);
    EXPECT_EQ(gathered.last, near);
    gathered = glsl.addSegment(gathered, TypeParam(1), far, cap, width);
    const auto counted = glsl.closeGather(gathered, cap, width); // the crest sends as the last does
    const auto piece = [&](double from, double to) { return moments(from) - moments(to); };
    const auto expected =
        piece(-0.5, 0.0) + TypeParam(10) * piece(0.0, 0.5) + TypeParam(1000) * piece(0.5, 2.0);
    const double bound = 1000.0 * slices * 8.0 * roundoff<TypeParam>;
    EXPECT_NEAR(static_cast<double>(counted.upward.x), static_cast<double>(expected.x), bound);
    EXPECT_NEAR(static_cast<double>(counted.outward.x), static_cast<double>(expected.y), bound);
    // Of that, a surface that leans towards the slice by 3 in 5 receives its vertical and its
    // horizontal part.
    const auto light =
        glsl.received(counted, typename G::vec3(0.48, 0.36, 0.8), TypeParam(0.8), TypeParam(0.6));
    EXPECT_NEAR(static_cast<double>(light.x),
                0.8 * static_cast<double>(expected.x) + 0.6 * static_cast<double>(expected.y),
                2.0 * bound);
}

// Even light in Legendre polynomials: what is below the horizon less what is below the plane.
TYPED_TEST(Gather, LegendreSegmentsAddUp)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    auto slice = glsl.startLegendreGather(TypeParam(-0.3));
    const TypeParam weight(0.5);
    for (const double slope : {0.1, 0.4, 1.5})
        slice = glsl.addLegendreSegment(slice, TypeParam(slope), typename G::vec3(1, 2, 4), weight);
    const auto expected = glsl.occlusionBelow(glsl.risingDirection(TypeParam(1.5))) -
                          glsl.occlusionBelow(glsl.risingDirection(TypeParam(-0.3)));
    for (int i = 0; i < 4; ++i)
    {
        const double unit = 2.0 * static_cast<double>(expected[i]);
        const double bound = 8.0 * 2.0 * 2.0 * 8.0 * roundoff<TypeParam>; // values up to 2
        EXPECT_NEAR(static_cast<double>(slice.red[i]), unit, bound);
        EXPECT_NEAR(static_cast<double>(slice.green[i]), 2.0 * unit, 2.0 * bound);
        EXPECT_NEAR(static_cast<double>(slice.blue[i]), 4.0 * unit, 4.0 * bound);
    }
}
