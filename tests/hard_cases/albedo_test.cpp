// Albedo 0 and 1. The library has no bounces yet: this holds the reference path tracer, which they
// will be compared with. When they exist, the same tiles go through TileLight with the same
// bounds.
#include "support/AnalyticTerrain.h"

#include "reference/PathTracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

using namespace osgTerrainLight;

namespace
{
/// A pit, where light bounces most.
Result<std::vector<reference::ReceivedLight>> inThePit(float albedo, int bounces, bool sun)
{
    reference::SceneDescription scene;
    scene.tile = analytic::pit(41, 41, 10.0, 20, 20, 180.0);
    scene.albedo = {albedo, albedo, albedo};
    const auto tracer = reference::PathTracer::build(scene);
    if (!tracer)
        return tracer.error();
    reference::Illumination illumination;
    illumination.light.skyRadiance = {1.0f, 1.0f, 1.0f};
    illumination.light.sunEnabled = sun;
    reference::PathTracerOptions options;
    options.samples = 2048;
    options.bounces = bounces;
    options.threads = 2;
    return tracer->trace(illumination, {{20, 20}, {28, 20}, {20, 34}, {2, 2}}, options);
}
} // namespace

// Black ground sends nothing back: the indirect part is 0, not nearly 0, in each bounce.
TEST(Albedo, BlackSendsExactlyNothing)
{
    const auto light = inThePit(0.0f, 8, true);
    ASSERT_TRUE(light) << light.error().message;
    for (const reference::ReceivedLight& received : *light)
    {
        ASSERT_EQ(received.bounces.size(), 8u);
        for (const reference::Estimate& bounce : received.bounces)
            for (std::size_t i = 0; i < 3; ++i)
            {
                EXPECT_EQ(bounce.mean[i], 0.0);
                EXPECT_EQ(bounce.standardError[i], 0.0);
            }
        EXPECT_NEAR(received.total.mean[0], received.sky.mean[0] + received.sun.mean[0], 1e-12);
    }
}

// White ground loses nothing, so under a sky of radiance 1 each path brings 1 where it leaves for
// the sky and 0 where it does not: no mean is above 1, whatever the number of bounces, and more
// bounces bring no less. With all of them it would be 1 everywhere.
TEST(Albedo, WhiteStaysBounded)
{
    double last[4] = {0.0, 0.0, 0.0, 0.0};
    for (const int bounces : {0, 1, 4, 16, 64})
    {
        const auto light = inThePit(1.0f, bounces, false);
        ASSERT_TRUE(light) << light.error().message;
        for (std::size_t i = 0; i < 4; ++i)
        {
            const reference::Estimate& total = (*light)[i].total;
            ASSERT_TRUE(std::isfinite(total.mean[0]));
            EXPECT_LE(total.mean[0], 1.0 + 1e-9) << bounces;
            EXPECT_GE(total.mean[0], last[i] - 5.0 * total.standardError[0]) << bounces;
            last[i] = total.mean[0];
        }
    }
    std::printf("white pit, 64 bounces: %.4f %.4f %.4f %.4f\n", last[0], last[1], last[2], last[3]);
}
