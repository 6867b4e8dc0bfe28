#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace osgTerrainLight;

namespace
{

template <class Real>
class NormalSampled : public testing::Test
{
};
TYPED_TEST_SUITE(NormalSampled, Precisions);

constexpr int voxels = 32; ///< of 1 m
constexpr double reach = 32.0;

/// Distances above level ground at z = 8 m and before a wall that fills x >= wall [m].
template <class Real>
Volume<Real> distances(double wall)
{
    Volume<Real> volume(voxels, voxels, voxels);
    for (int z = 0; z < voxels; ++z)
        for (int y = 0; y < voxels; ++y)
            for (int x = 0; x < voxels; ++x)
                volume.at(x, y, z) = Real(std::min(z + 0.5 - 8.0, wall - (x + 0.5)) / reach);
    return volume;
}

template <class Real>
typename CheckedGlsl<Real>::NormalSamples samplesOf(double tilt, double own, double expected,
                                                    const glm::dvec4& weights)
{
    typename CheckedGlsl<Real>::NormalSamples samples;
    samples.size = glm::vec<3, Real>(Real(voxels));
    samples.reach = Real(reach);
    samples.spacing = Real(0.5);
    samples.tilt = Real(tilt);
    samples.own = Real(own);
    samples.weights = glm::vec<4, Real>(weights);
    samples.expected = Real(expected);
    samples.contrast = Real(0.25);
    samples.brightness = Real(1);
    return samples;
}

/// Distances of up to 24 m round by 2^-24 of 32 m in float, five of them, times 0.25.
template <class Real>
constexpr double room = 5.0 * 32.0 * roundoff<Real>;

} // namespace

// The text's form without a tilt: above a plane S(P + d N) = -d, so C is exactly 1.
TYPED_TEST(NormalSampled, TheTextsOpenGroundIsOne)
{
    CheckedGlsl<TypeParam> glsl;
    using vec3 = glm::vec<3, TypeParam>;
    const auto open = distances<TypeParam>(1000.0);
    const auto samples = samplesOf<TypeParam>(0.0, 1.0, 1.0, {1, 1, 1, 1});
    EXPECT_NEAR(double(glsl.normalSamplesLight(open, open, open, open, samples, vec3(16, 16, 8),
                                               vec3(0, 0, 1))),
                1.0, room<TypeParam>);
}

// Before the half space of a wall 3 m away the samples at 0.5, 1 and 2 m see the ground, that at 4
// m sees the wall, at 3 m: C = exp(-0.25 * 1), darker than 1 with the sign of this library.
TYPED_TEST(NormalSampled, AWallTakesWhatTheTextSays)
{
    CheckedGlsl<TypeParam> glsl;
    using vec3 = glm::vec<3, TypeParam>;
    const auto walled = distances<TypeParam>(19.0);
    const auto samples = samplesOf<TypeParam>(0.0, 1.0, 1.0, {1, 1, 1, 1});
    EXPECT_NEAR(double(glsl.normalSamplesLight(walled, walled, walled, walled, samples,
                                               vec3(16, 16, 8), vec3(0, 0, 1))),
                std::exp(-0.25), room<TypeParam>);
}

// The listing: samples at (N + U) d, weights 1, 1.2, 1.4, 1.8, nothing expected. Above level ground
// these are 1, 2, 4 and 8 m high: exp(0.25 * (1 + 2.4 + 5.6 + 14.4)).
TYPED_TEST(NormalSampled, TheListingsSamplesAreTiltedAndWeighted)
{
    CheckedGlsl<TypeParam> glsl;
    using vec3 = glm::vec<3, TypeParam>;
    const auto open = distances<TypeParam>(1000.0);
    auto samples = samplesOf<TypeParam>(1.0, 0.0, 0.0, {1, 1.2, 1.4, 1.8});
    const double expected = std::exp(0.25 * 23.4);
    samples.brightness = TypeParam(1.0 / expected);
    EXPECT_NEAR(double(glsl.normalSamplesLight(open, open, open, open, samples, vec3(16, 16, 8),
                                               vec3(0, 0, 1))),
                1.0, 2.0 * room<TypeParam>);
    // A wall's face samples at (N + U) d: all as far from the wall's plane as above the ground.
    const auto walled = distances<TypeParam>(17.0);
    EXPECT_NEAR(double(glsl.normalSamplesLight(walled, walled, walled, walled, samples,
                                               vec3(17, 16, 12), vec3(-1, 0, 0))),
                std::exp(0.25 * (0.5 + 1.2 + 2.8 + 7.2)) / expected, room<TypeParam>);
}

// Each sample has the volume of its own: stored 1, 2, 3 and 4 in place of distances.
TYPED_TEST(NormalSampled, EachSampleReadsItsVolume)
{
    using Counting = Glsl<TypeParam, true, true>;
    Counting glsl;
    using vec3 = glm::vec<3, TypeParam>;
    const auto filled = [](int value) { return Volume<TypeParam>(2, 2, 2, TypeParam(value)); };
    const auto one = filled(1), two = filled(2), three = filled(3), four = filled(4);
    typename Counting::NormalSamples samples;
    samples.size = vec3(2);
    samples.reach = TypeParam(1);
    samples.spacing = TypeParam(1);
    samples.tilt = samples.expected = TypeParam(0);
    samples.own = TypeParam(1);
    samples.weights = glm::vec<4, TypeParam>(1, 10, 100, 1000);
    samples.contrast = TypeParam(0.001);
    samples.brightness = TypeParam(1);
    Counting::volumeReads = 0;
    EXPECT_NEAR(
        double(glsl.normalSamplesLight(one, two, three, four, samples, vec3(1), vec3(0, 0, 1))),
        std::exp(4.322), 100.0 * 16.0 * roundoff<TypeParam>);
    EXPECT_EQ(Counting::volumeReads, 5u);
    samples.own = TypeParam(0);
    Counting::volumeReads = 0;
    glsl.normalSamplesLight(one, two, three, four, samples, vec3(1), vec3(0, 0, 1));
    EXPECT_EQ(Counting::volumeReads, 4u);
}
