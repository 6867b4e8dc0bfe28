// Sines at and near the sampling frequency. What stood between the posts is not to be had: the
// surface is bilinear between them, and its light is that of the wave that the posts show.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardCase.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

namespace
{
constexpr double spacing = 25.0, amplitude = 40.0;
constexpr int width = 129, height = 64;

/// Periods per post; heights rounded to 1/1024 m, so that waves that the posts cannot tell apart
/// have the same bits.
DemTile wave(double frequency)
{
    return analytic::makeTile(width, height, spacing,
                              [&](int x, int)
                              {
                                  return std::round(
                                             1024.0 * amplitude *
                                             std::cos(2.0 * 3.14159265358979 * frequency * x)) /
                                         1024.0;
                              });
}
} // namespace

// One period per post: every post at the same height, so level ground.
TEST(AliasedSine, AtTheSamplingFrequency)
{
    OTL_NEED_GL(context);
    const HardCase sine = {"sine, 1 period per post", wave(1.0)};
    checkHardCase(context->state(), sine);
    expectHorizons(context->state(), sine, [](int, int, const MapDirection&) { return 0.0; });
}

// Half a period per post, Nyquist's: troughs between crests 80 m above them. Mainly east or west
// the next crest is a column crossing one step away: exact.
TEST(AliasedSine, AtHalfTheSamplingFrequency)
{
    OTL_NEED_GL(context);
    const HardCase sine = {"sine, 1/2 period per post", wave(0.5)};
    checkHardCase(context->state(), sine);
    expectHorizons(context->state(), sine,
                   [](int x, int y, const MapDirection& d) -> std::optional<double>
                   {
                       if (std::abs(d.north) > std::abs(d.east) || x < 2 || x > width - 3 ||
                           y < 1 || y > height - 2)
                           return std::nullopt;
                       return x % 2 == 0 ? 0.0 : 2.0 * amplitude * std::abs(d.east) / spacing;
                   });
}

// 63/64 of a period per post is, to the posts, a wave of 64 posts: the same bits of light.
TEST(AliasedSine, BesideTheSamplingFrequency)
{
    OTL_NEED_GL(context);
    const DemTile fast = wave(63.0 / 64.0), slow = wave(1.0 / 64.0);
    ASSERT_EQ(fast.heights(), slow.heights());
    expectSameLight(context->state(), fast, slow);
    checkHardCase(context->state(), {"sine, 63/64 per post", fast});
}
