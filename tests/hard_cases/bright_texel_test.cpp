// An environment that is dark but for one texel of 1e6. The library has no environments yet: this
// holds the reference path tracer, which they will be compared with. When they exist, the same
// environment goes through TileLight, whose shading saturates at 65,504
// (light_extremes_test.cpp).
#include "support/AnalyticTerrain.h"

#include "reference/PathTracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr int columns = 128, rows = 64; // of 2.8 degrees
constexpr int brightColumn = 40, brightRow = 44;

reference::LinearRgb radianceFrom(const reference::Vector3& direction)
{
    const double elevation = std::asin(std::max(-1.0, std::min(1.0, direction[2])));
    const double azimuth = std::atan2(direction[1], direction[0]);
    const double turn = azimuth / (2.0 * pi) - std::floor(azimuth / (2.0 * pi));
    const bool bright = static_cast<int>(turn * columns) == brightColumn &&
                        static_cast<int>((elevation / pi + 0.5) * rows) == brightRow;
    const double radiance = bright ? 1e6 : 0.5;
    return {radiance, radiance, radiance};
}
} // namespace

// On level ground E/pi is 0.5 of the dark part and, of the texel, L/pi times its width in azimuth
// times (sin² of its upper minus sin² of its lower elevation)/2. By the cosine alone a path finds
// the texel once in 1,800 times; by the table half of them do. The variance of the weighed estimate
// stays below that of the table alone, whose samples differ by the cosine over the texel, a few per
// cent: the relative error of 4,096 paths is below 1 %, and the mean within 5 standard errors
// (Student's t, 31 degrees of freedom: 2 in 100,000).
TEST(BrightTexel, ConvergesByImportanceSampling)
{
    reference::SceneDescription scene;
    scene.tile = analytic::plane(9, 9, 10.0, 100.0);
    const auto tracer = reference::PathTracer::build(scene);
    ASSERT_TRUE(tracer) << tracer.error().message;
    reference::Illumination illumination;
    illumination.light.sunEnabled = false;
    illumination.environment = radianceFrom;
    illumination.importance = reference::importanceOf(radianceFrom, columns, rows);
    reference::PathTracerOptions options;
    options.samples = 4096;
    options.threads = 2;
    const auto light = tracer->trace(illumination, {{4, 4}}, options);
    ASSERT_TRUE(light) << light.error().message;

    const auto sineSquared = [](int row)
    { return std::pow(std::sin(pi * (static_cast<double>(row) / rows - 0.5)), 2); };
    const double share =
        2.0 * pi / columns / pi * 0.5 * (sineSquared(brightRow + 1) - sineSquared(brightRow));
    const double expected = 0.5 * (1.0 - share) + 1e6 * share;
    const reference::Estimate& total = light->front().total;
    std::printf("bright texel: %.2f +- %.2f, closed form %.2f\n", total.mean[0],
                total.standardError[0], expected);
    EXPECT_NEAR(total.mean[0], expected, 5.0 * total.standardError[0]);
    EXPECT_LT(total.standardError[0], 0.01 * expected);
}
