#include "reference/PathTracer.h"

#include "core/SyntheticTerrain.h"
#include "reference/LatinSupercube.h"
#include "support/AnalyticTerrain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <random>
#include <set>

using namespace osgTerrainLight;
using namespace osgTerrainLight::reference;

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Sanitizers make rays ten times slower and look for other faults than statistics do: a quarter of
/// the receivers and estimates. Every bound follows from how many there are.
#ifdef __SANITIZE_ADDRESS__
constexpr int thinning = 4;
#else
constexpr int thinning = 1;
#endif

PathTracer tracerOf(DemTile tile, float albedo = 0.0f)
{
    SceneDescription scene;
    scene.tile = std::move(tile);
    scene.albedo = {albedo, albedo, albedo};
    return std::move(PathTracer::build(std::move(scene)).value());
}

Illumination uniformSky(float radiance = 1.0f)
{
    Illumination illumination;
    illumination.light.skyRadiance = {radiance, radiance, radiance};
    illumination.light.sunEnabled = false;
    return illumination;
}

Illumination sunAt(double azimuth, double elevation, double radius = 0.2666)
{
    Illumination illumination;
    illumination.light.skyEnabled = false;
    illumination.light.sunAzimuth = azimuth;
    illumination.light.sunElevation = elevation;
    illumination.light.sunAngularRadius = radius;
    return illumination;
}

PathTracerOptions options(int samples, int bounces = 0, int batches = 32)
{
    PathTracerOptions options;
    options.samples = samples;
    options.bounces = bounces;
    options.batches = batches;
    return options;
}

Receiver post(int column, int row)
{
    Receiver receiver;
    receiver.column = column;
    receiver.row = row;
    return receiver;
}

std::vector<ReceivedLight> traceAll(const PathTracer& tracer, const Illumination& illumination,
                                    const std::vector<Receiver>& receivers,
                                    const PathTracerOptions& options)
{
    return tracer.trace(illumination, receivers, options).value();
}

ReceivedLight traceOne(const PathTracer& tracer, const Illumination& illumination,
                       const Receiver& receiver, const PathTracerOptions& options)
{
    return traceAll(tracer, illumination, {receiver}, options).at(0);
}

/// The mean is within 3 of its own standard errors, of a closed form known to within `slack`.
void expectWithin3Sigma(const Estimate& estimate, double expected, double slack = 0.0,
                        std::size_t colour = 0)
{
    const double sigma = estimate.standardError[colour];
    EXPECT_NEAR(estimate.mean[colour], expected, 3.0 * sigma + slack + 1e-12)
        << "sigma " << sigma << ", z " << (estimate.mean[colour] - expected) / sigma;
}

/// z = (mean − truth)/σ follows Student's t with n = batches − 1 degrees of freedom if the standard
/// errors are honest: z² has mean n/(n − 2) and variance 3n²/((n − 2)(n − 4)) − (n/(n − 2))². The
/// mean of many z² is within 4 of its own deviations.
void expectHonest(const std::vector<double>& z, int batches)
{
    const double n = batches - 1;
    const double expected = n / (n - 2.0);
    const double variance = 3.0 * n * n / ((n - 2.0) * (n - 4.0)) - expected * expected;
    double mean = 0.0;
    double squares = 0.0;
    for (double x : z)
    {
        mean += x;
        squares += x * x;
    }
    const double count = static_cast<double>(z.size());
    EXPECT_NEAR(squares / count, expected, 4.0 * std::sqrt(variance / count)) << count;
    EXPECT_NEAR(mean / count, 0.0, 4.0 * std::sqrt(expected / count));
}

Vector3 directionAt(const MapDirection& map, double slope)
{
    const double length = std::sqrt(1.0 + slope * slope);
    return {map.east / length, map.north / length, slope / length};
}

/// Just above the exhaustive horizon a ray is free, just below it is stopped.
void expectHorizons(const DemTile& tile, int posts, std::uint32_t seed)
{
    const PathTracer tracer = tracerOf(tile);
    std::mt19937 random(seed);
    int seen = 0;
    while (seen < posts)
    {
        const int column = static_cast<int>(random() % static_cast<unsigned>(tile.width()));
        const int row = static_cast<int>(random() % static_cast<unsigned>(tile.height()));
        if (!tile.isValid(column, row))
            continue;
        ++seen;
        const SurfacePoint start = tracer.scene().post(column, row);
        for (int k = 0; k < 100; ++k)
        {
            // Axes, diagonals, and azimuths without a meaning.
            const double degrees =
                k < 8 ? 45.0 * k : static_cast<double>(random()) * (360.0 / 0x1p32);
            const MapDirection map = directionOfCompass(degrees);
            const double slope = exhaustiveHorizon(tile, column, row, map).slope;
            if (slope == -infinity)
            {
                EXPECT_FALSE(tracer.scene().isOccluded(start, directionAt(map, -1.0)));
                continue;
            }
            // Heights of up to 1e3 m round by 1e-13 m, seen from a cell's 10 m: 1e-14.
            const double step = 1e-11 * (1.0 + std::abs(slope));
            EXPECT_FALSE(tracer.scene().isOccluded(start, directionAt(map, slope + step)))
                << column << ", " << row << " towards " << degrees;
            EXPECT_TRUE(tracer.scene().isOccluded(start, directionAt(map, slope - step)))
                << column << ", " << row << " towards " << degrees;
            EXPECT_TRUE(tracer.scene().firstHit(start, directionAt(map, slope - step)));
        }
    }
}
} // namespace

TEST(RayScene, RaysEndAtTheExhaustiveHorizon)
{
    expectHorizons(*generateTerrain(TerrainKind::Fractal, 70, 53, 30.0, 5), 300, 1);
    expectHorizons(*generateTerrain(TerrainKind::Cliffs, 53, 70, 10.0, 5), 300, 2);
    expectHorizons(*generateTerrain(TerrainKind::Spikes, 40, 41, 30.0, 5), 100, 3);
    DemTile oblong = *generateTerrain(TerrainKind::Fractal, 33, 47, 30.0, 6);
    oblong.northSpacing = 17.0;
    expectHorizons(oblong, 100, 4);
}

TEST(RayScene, VoidsHideNothing)
{
    // Holes of 3 × 2 posts: every edge between valid posts still borders a complete cell.
    DemTile tile = *generateTerrain(TerrainKind::Fractal, 60, 50, 30.0, 7);
    for (int row = 4; row + 2 < 50; row += 9)
        for (int column = 5; column + 3 < 60; column += 11)
            for (int k = 0; k < 6; ++k)
                tile.setVoid(column + k % 3, row + k / 3);
    expectHorizons(tile, 300, 5);
}

TEST(RayScene, WhatIsSeenThroughAVoidFromBelowIsDark)
{
    // A hill of 45° with a hole in its flank: level rays enter by the hole, below the crest.
    DemTile tile = analytic::ramp(9, 9, 1.0, 1.0, 0.0);
    tile.setVoid(3, 4);
    const PathTracer tracer = tracerOf(tile, 1.0f);
    const SurfacePoint outside = tracer.scene().post(1, 4);
    EXPECT_TRUE(tracer.scene().isOccluded(outside, {1.0, 0.0, 0.0}));
    SurfacePoint inHole;
    inHole.grid = {2.5, 4.0, 1.0};
    const auto below = tracer.scene().firstHit(inHole, {1.0, 0.0, 0.0});
    ASSERT_TRUE(below);
    EXPECT_FALSE(below->above);
    EXPECT_NEAR(below->grid[0], 4.0, 1e-12);
    const auto front = tracer.scene().firstHit(inHole, {0.0, 0.0, -1.0});
    EXPECT_FALSE(front);
    inHole.grid = {1.5, 4.0, 3.0};
    const auto flank = tracer.scene().firstHit(inHole, {0.0, 0.0, -1.0});
    ASSERT_TRUE(flank);
    EXPECT_TRUE(flank->above);
    EXPECT_NEAR(flank->grid[2], 1.5, 1e-15);
    EXPECT_NEAR(flank->normal[2], std::sqrt(0.5), 1e-15);
}

TEST(RayScene, FirstHitOnASaddleSolvesItsQuadratic)
{
    // z = 8·u·v on one cell of 2 m × 4 m: from (0, 0, 2) along the diagonal 8 s² = 2, s = 1/2.
    DemTile tile = analytic::plane(2, 2, 2.0, 0.0);
    tile.northSpacing = 4.0;
    tile.setHeight(1, 1, 8.0f);
    const PathTracer tracer = tracerOf(tile);
    SurfacePoint start;
    start.grid = {0.0, 0.0, 2.0};
    const double length = std::sqrt(20.0);
    const auto hit = tracer.scene().firstHit(start, {2.0 / length, 4.0 / length, 0.0});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->grid[0], 0.5, 1e-15);
    EXPECT_NEAR(hit->grid[1], 0.5, 1e-15);
    // Its gradient there: 8·½/2 m east, 8·½/4 m north.
    EXPECT_NEAR(hit->normal[0] / hit->normal[2], -2.0, 1e-14);
    EXPECT_NEAR(hit->normal[1] / hit->normal[2], -1.0, 1e-14);
    // From the hit, a ray between the surface and its tangent plane: the surface rises above the
    // tangent along this diagonal, and the ray meets it again where 8 s² grows as the ray does.
    const double rise = 2.0 * 8.0 * 0.5 + 2.0; // per s: the tangent's 8, and 2 more
    const double steep = std::sqrt(20.0 + rise * rise);
    const auto again = tracer.scene().firstHit(*hit, {2.0 / steep, 4.0 / steep, rise / steep});
    // 2 + (8 + 2) s' = 8 (½ + s')²: s' = ¼.
    ASSERT_TRUE(again);
    EXPECT_NEAR(again->grid[0], 0.75, 1e-14);
    EXPECT_NEAR(again->grid[2], 4.5, 1e-13);
}

TEST(RayScene, ARayThatPassesARidgeTwiceStopsAtItsFirstFlank)
{
    // z = 2u + 2v − 4uv: along the diagonal u = v = s a ridge of 4s − 4s², which is ¾ at ¼ and ¾.
    DemTile tile = analytic::plane(2, 2, 1.0, 0.0);
    tile.setHeight(1, 0, 2.0f);
    tile.setHeight(0, 1, 2.0f);
    const PathTracer tracer = tracerOf(tile);
    SurfacePoint start;
    start.grid = {0.0, 0.0, 0.75};
    const double diagonal = std::sqrt(0.5);
    const auto hit = tracer.scene().firstHit(start, {diagonal, diagonal, 0.0});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->grid[0], 0.25, 1e-15);
    start.grid[2] = 1.0 + 1e-12;
    EXPECT_FALSE(tracer.scene().firstHit(start, {diagonal, diagonal, 0.0}));
    start.grid[2] = 1.0 - 1e-12;
    EXPECT_TRUE(tracer.scene().firstHit(start, {diagonal, diagonal, 0.0}));
}

TEST(LatinSupercube, PairsAreStratifiedUnbiasedAndIndependent)
{
    constexpr int count = 256;
    LatinSupercube random(count);
    random.start(17);
    for (int pair : {0, 1, 5})
    {
        // A (0, 8, 2)-net: one point in each of 256 boxes, for each of their 9 shapes.
        for (int columns = 1; columns <= count; columns *= 2)
        {
            std::set<std::pair<int, int>> boxes;
            for (int i = 0; i < count; ++i)
            {
                const auto [x, y] = random.point(pair, i);
                EXPECT_TRUE(x >= 0.0 && x < 1.0 && y >= 0.0 && y < 1.0);
                boxes.insert(
                    {static_cast<int>(x * columns), static_cast<int>(y * (count / columns))});
            }
            EXPECT_EQ(boxes.size(), std::size_t(count)) << pair << ", " << columns;
        }
    }
    // In one order two pairs would differ by their shifts alone: one value, not some 160 of 256.
    std::set<int> differences;
    for (int i = 0; i < count; ++i)
        differences.insert(static_cast<int>(random.point(0, i)[0] * count) ^
                           static_cast<int>(random.point(1, i)[0] * count));
    EXPECT_GT(differences.size(), 120u);
    // Over streams, point 3 of two pairs: means ½, variances 1/12, no correlation, each within 4 of
    // its deviation: √(1/12/n), √(1/180/n), 1/12/√n.
    constexpr int streams = 20000;
    double sum = 0.0, squares = 0.0, products = 0.0;
    for (std::uint64_t stream = 0; stream < streams; ++stream)
    {
        LatinSupercube few(4);
        few.start(stream);
        const double a = few.point(0, 3)[0] - 0.5;
        const double b = few.point(1, 3)[1] - 0.5;
        sum += a;
        squares += a * a;
        products += a * b;
    }
    EXPECT_NEAR(sum / streams, 0.0, 4.0 * std::sqrt(1.0 / 12.0 / streams));
    EXPECT_NEAR(squares / streams, 1.0 / 12.0, 4.0 * std::sqrt(1.0 / 180.0 / streams));
    EXPECT_NEAR(products / streams, 0.0, 4.0 / 12.0 / std::sqrt(streams));
}

TEST(PathTracerSky, PlaneAndRamp)
{
    // Under a sky that ends at the horizontal, a ramp of angle S gets (1 + cos S)/2.
    const PathTracer plane = tracerOf(analytic::plane(9, 8, 10.0, 100.0), 0.5f);
    const ReceivedLight level = traceOne(plane, uniformSky(0.25f), post(4, 3), options(4096, 2));
    expectWithin3Sigma(level.sky, 0.25);
    EXPECT_EQ(level.bounces.at(0).mean, LinearRgb{});
    EXPECT_EQ(level.samples, 4096u);
    for (double slope : {0.5, 1.0, 5.0})
    {
        const PathTracer ramp = tracerOf(analytic::ramp(9, 8, 1.0, 0.6 * slope, 0.8 * slope));
        expectWithin3Sigma(traceOne(ramp, uniformSky(), post(4, 3), options(4096)).sky,
                           analytic::rampSkyView(slope).surface);
        Illumination around = uniformSky();
        around.extent = SkyExtent::DownToHorizon;
        expectWithin3Sigma(traceOne(ramp, around, post(4, 3), options(4096)).sky, 1.0);
    }
}

namespace
{
Receiver at(const Vector3& place, const Vector3& normal)
{
    Receiver receiver;
    receiver.place = FreePlace{place, normal};
    return receiver;
}

/// A wall of two triangles along x through (0, y, 0), from 5 km west to 5 km east.
void addWall(std::vector<Triangle>& triangles, double y, double top)
{
    const Vector3 a = {-5000.0, y, 0.0}, b = {5000.0, y, 0.0}, c = {5000.0, y, top},
                  d = {-5000.0, y, top};
    triangles.push_back({{a, b, c}, {}, {}});
    triangles.push_back({{a, c, d}, {}, {}});
}
} // namespace

// Places that are no posts. Every normal of open level ground gets (1 + cos)/2; before an endless
// wall of height h a distance d away level ground gets (1 + cos(atan(h/d)))/2, half at its foot;
// the wall's own face gets half. What lies beyond the wall's ends, 5 km away, is an angle of less
// than 1e-3 of the half space.
TEST(PathTracerSky, PlacesOfTheirOwn)
{
    SceneDescription scene;
    scene.tile = analytic::plane(9, 8, 10.0, 100.0);
    const PathTracer open = std::move(PathTracer::build(scene).value());
    for (const double tilt : {0.0, 0.7, pi / 2.0, 2.0})
    {
        const Receiver receiver =
            at({33.0, 41.0, 103.0}, {0.6 * std::sin(tilt), 0.8 * std::sin(tilt), std::cos(tilt)});
        expectWithin3Sigma(traceOne(open, uniformSky(), receiver, options(4096)).sky,
                           0.5 * (1.0 + std::cos(tilt)));
    }
    scene.tile = analytic::plane(9, 8, 10.0, 0.0);
    addWall(scene.triangles, 35.0, 3.0);
    const PathTracer walled = std::move(PathTracer::build(std::move(scene)).value());
    for (const double distance : {1e-4, 0.5, 1.5, 3.0, 10.0})
    {
        const Receiver ground = at({40.0, 35.0 - distance, 1e-6}, {0.0, 0.0, 1.0});
        const Estimate sky = traceOne(walled, uniformSky(), ground, options(16384)).sky;
        EXPECT_NEAR(sky.mean[0], 0.5 * (1.0 + std::cos(std::atan(3.0 / distance))),
                    3.0 * sky.standardError[0] + 1e-3)
            << distance;
    }
    const Receiver face = at({40.0, 35.0 - 1e-6, 1.5}, {0.0, -1.0, 0.0});
    expectWithin3Sigma(traceOne(walled, uniformSky(), face, options(4096)).sky, 0.5);
    // Below the ground everything is hidden.
    const Receiver buried = at({40.0, 20.0, -0.01}, {0.0, 0.0, 1.0});
    EXPECT_EQ(traceOne(walled, uniformSky(), buried, options(64)).sky.mean[0], 0.0);
}

namespace
{
/// Every eleventh post (of a whole run) of a terrain, direct sky against 2880 exhaustive horizons:
/// the mean within 0.1 %, and single posts by their own errors.
void expectSkyOf(TerrainKind kind)
{
    const DemTile tile = *generateTerrain(kind, 64, 64, 30.0, 1);
    std::vector<Receiver> receivers;
    std::vector<double> expected;
    for (int i = 0; i < 64 * 64; i += 11 * thinning)
    {
        receivers.push_back(post(i % 64, i / 64));
        expected.push_back(skyViewFactor(horizonRing(tile, i % 64, i / 64, 2880),
                                         SkyViewDefinition::Surface,
                                         surfaceNormal(tile, i % 64, i / 64)));
    }
    const auto light = traceAll(tracerOf(tile), uniformSky(), receivers, options(8192));
    std::vector<double> z;
    double sum = 0.0;
    double expectedSum = 0.0;
    double worst = 0.0;
    for (std::size_t i = 0; i < light.size(); ++i)
    {
        const double difference = light[i].sky.mean[0] - expected[i];
        z.push_back(difference / light[i].sky.standardError[0]);
        sum += light[i].sky.mean[0];
        expectedSum += expected[i];
        worst = std::max(worst, std::abs(difference) / expected[i]);
    }
    EXPECT_NEAR(sum, expectedSum, 1e-3 * expectedSum);
    expectHonest(z, 32);
    testing::Test::RecordProperty("relativeErrorOfMean", std::to_string(sum / expectedSum - 1.0));
    testing::Test::RecordProperty("relativeErrorOfWorst", std::to_string(worst));
}
} // namespace

TEST(PathTracerSky, AgreesWithExhaustiveHorizonsOnFractal)
{
    expectSkyOf(TerrainKind::Fractal);
}

TEST(PathTracerSky, AgreesWithExhaustiveHorizonsOnCliffs)
{
    expectSkyOf(TerrainKind::Cliffs);
}

TEST(PathTracerSun, FacingDiscGivesItsIrradiance)
{
    // The whole disc above the surface: E = irradiance · cos θ, exactly, whatever its size.
    const PathTracer plane = tracerOf(analytic::plane(9, 8, 10.0, 100.0));
    const PathTracer ramp = tracerOf(analytic::ramp(9, 8, 1.0, -0.5, 0.25));
    for (double radius : {0.2666, 8.0})
    {
        Illumination illumination = sunAt(123.0, 35.0, radius);
        illumination.light.sunIrradiance = {3.0f, 2.0f, 1.0f};
        const ReceivedLight level = traceOne(plane, illumination, post(4, 3), options(4096));
        for (std::size_t k = 0; k < 3; ++k)
            expectWithin3Sigma(level.sun, (3.0 - double(k)) * std::sin(35.0 * pi / 180.0) / pi, 0.0,
                               k);
        EXPECT_EQ(level.sunVisible.mean[0], 1.0);
        EXPECT_EQ(level.sky.mean, LinearRgb{});
        const MapDirection map = directionOfCompass(123.0);
        const double cosine = (0.5 * map.east - 0.25 * map.north + std::tan(35.0 * pi / 180.0)) *
                              std::cos(35.0 * pi / 180.0) / std::sqrt(1.3125);
        expectWithin3Sigma(traceOne(ramp, illumination, post(4, 3), options(4096)).sun,
                           3.0 * cosine / pi);
    }
    // Half of a disc on the horizon, and none of one that the sky's end hides.
    expectWithin3Sigma(traceOne(plane, sunAt(90.0, 0.0), post(4, 3), options(4096)).sunVisible, 0.5,
                       1e-6);
    EXPECT_EQ(traceOne(plane, sunAt(90.0, -5.0), post(8, 3), options(64)).sunVisible.mean[0], 0.0);
    Illumination around = sunAt(90.0, -5.0);
    around.extent = SkyExtent::DownToHorizon;
    EXPECT_EQ(traceOne(plane, around, post(8, 3), options(64)).sunVisible.mean[0], 1.0);
    EXPECT_EQ(traceOne(plane, around, post(7, 3), options(64)).sunVisible.mean[0], 0.0);
}

TEST(PathTracerSun, BehindAWallTheDiscIsTheSegment)
{
    // As in ReferenceSun: the crest is straight to r²/2 across the disc, 1e-5 rad of 4.7e-3.
    const DemTile tile = analytic::wall(40, 41, 1.0, 30, 8.0);
    const PathTracer tracer = tracerOf(tile);
    const double crest = std::atan(0.8) * 180.0 / pi;
    for (double above : {-0.5, -0.2, -0.1, 0.0, 0.1, 0.2, 0.5})
    {
        const Sun sun = {90.0, crest + above, 0.2666};
        const ReceivedLight light =
            traceOne(tracer, sunAt(sun.azimuth, sun.elevation), post(20, 20), options(16384));
        expectWithin3Sigma(light.sunVisible,
                           segmentFraction(sun.elevation, crest, sun.angularRadius), 2e-3);
        expectWithin3Sigma(light.sunVisible, sunFraction(tile, 20, 20, sun, 2001), 1e-6);
    }
}

TEST(PathTracerSun, AgreesWithExhaustiveHorizonsOnCliffs)
{
    const DemTile tile = *generateTerrain(TerrainKind::Cliffs, 64, 64, 30.0, 2);
    const Sun sun = {217.0, 30.0, 6.0};
    std::vector<Receiver> receivers;
    std::vector<double> expected;
    for (int i = 0; i < 64 * 64; i += 7 * thinning)
    {
        const double fraction = sunFraction(tile, i % 64, i / 64, sun, 2000);
        if (fraction < 0.02 || fraction > 0.98)
            continue;
        receivers.push_back(post(i % 64, i / 64));
        expected.push_back(fraction);
    }
    ASSERT_GT(receivers.size(), 20u);
    const auto light =
        traceAll(tracerOf(tile), sunAt(sun.azimuth, sun.elevation, sun.angularRadius), receivers,
                 options(4096));
    std::vector<double> z;
    for (std::size_t i = 0; i < light.size(); ++i)
        z.push_back((light[i].sunVisible.mean[0] - expected[i]) /
                    light[i].sunVisible.standardError[0]);
    expectHonest(z, 32);
}

namespace
{
/// Two triangles; seen counter-clockwise from the front.
void addQuad(std::vector<Triangle>& triangles, const Vector3& a, const Vector3& b, const Vector3& c,
             const Vector3& d, const LinearRgb& albedo, const LinearRgb& emission = {})
{
    triangles.push_back({{a, b, c}, albedo, emission});
    triangles.push_back({{a, c, d}, albedo, emission});
}

/// A level square seen from below at height `z`, over 0 … size.
void addCeiling(std::vector<Triangle>& triangles, double size, double z, const LinearRgb& albedo,
                const LinearRgb& emission)
{
    addQuad(triangles, {0.0, 0.0, z}, {0.0, size, z}, {size, size, z}, {size, 0.0, z}, albedo,
            emission);
}

/// The part z ≤ ½ of a unit sphere, ¾ of its area, seen from inside: `rings` × 2 `rings` quads with
/// corners on the sphere.
std::vector<Triangle> cavity(int rings, double albedo)
{
    std::vector<Triangle> triangles;
    const LinearRgb rgb = {albedo, albedo, albedo};
    const auto corner = [&](int ring, int place) -> Vector3
    {
        if (ring == rings)
            return {0.0, 0.0, -1.0};
        const double polar = pi / 3.0 + 2.0 * pi / 3.0 * ring / rings;
        const double azimuth = pi * (place % (2 * rings)) / rings;
        return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                std::cos(polar)};
    };
    for (int ring = 0; ring < rings; ++ring)
        for (int k = 0; k < 2 * rings; ++k)
        {
            const Vector3 a = corner(ring, k);
            const Vector3 b = corner(ring, k + 1);
            const Vector3 c = corner(ring + 1, k + 1);
            triangles.push_back({{a, b, c}, rgb, {}});
            if (ring + 1 < rings)
                triangles.push_back({{a, c, corner(ring + 1, k)}, rgb, {}});
        }
    return triangles;
}

constexpr int cavityRings = 160;
/// Of the meshed cavity against the sphere, relative, direct and per bounce. An edge spans at most
/// e = π/160: facets lie up to e²/4 = 1.0e-4 inside the sphere, the opening is smaller by e²/6 =
/// 0.6e-4, and a receiver in the middle of a quad is tilted by up to e²/3 = 1.3e-4.
constexpr double cavitySlack = 3e-4;

/// All void, and triangles alone.
PathTracer tracerOf(std::vector<Triangle> triangles)
{
    SceneDescription scene;
    scene.tile = DemTile(2, 2, 1.0);
    scene.triangles = std::move(triangles);
    return std::move(PathTracer::build(std::move(scene)).value());
}

std::vector<Receiver> onTriangles(std::initializer_list<int> triangles, double s = 1.0 / 3.0,
                                  double t = 1.0 / 3.0)
{
    std::vector<Receiver> receivers;
    for (int index : triangles)
    {
        receivers.emplace_back();
        receivers.back().triangle = index;
        receivers.back().s = s;
        receivers.back().t = t;
    }
    return receivers;
}

/// In the middle of two quads: a third of the way down, and near the bottom.
std::vector<Receiver> inCavity()
{
    const int perRing = 4 * cavityRings;
    return onTriangles({perRing * (cavityRings / 3) + 10, perRing * (cavityRings - 9) + 210}, 0.0,
                       0.5);
}
} // namespace

TEST(PathTracerBounces, ClosedFurnaceIsAGeometricSeries)
{
    // Walls that all send L and reflect a: L·aᵏ after k bounces, from every single path.
    std::vector<Triangle> box;
    const LinearRgb a = {0.2, 0.5, 0.9};
    const LinearRgb l = {1.0, 3.0, 0.25};
    const double x = 7.0, y = 5.0, z = 3.0;
    addQuad(box, {0, 0, 0}, {x, 0, 0}, {x, y, 0}, {0, y, 0}, a, l);
    addQuad(box, {0, 0, z}, {0, y, z}, {x, y, z}, {x, 0, z}, a, l);
    addQuad(box, {0, 0, 0}, {0, 0, z}, {x, 0, z}, {x, 0, 0}, a, l);
    addQuad(box, {0, y, 0}, {x, y, 0}, {x, y, z}, {0, y, z}, a, l);
    addQuad(box, {0, 0, 0}, {0, y, 0}, {0, y, z}, {0, 0, z}, a, l);
    addQuad(box, {x, 0, 0}, {x, 0, z}, {x, y, z}, {x, y, 0}, a, l);
    const auto light = traceAll(tracerOf(box), sunAt(90.0, 60.0), onTriangles({0, 3, 5, 7, 9, 11}),
                                options(2048, 12));
    for (const ReceivedLight& received : light)
        for (std::size_t c = 0; c < 3; ++c)
        {
            EXPECT_NEAR(received.emitters.mean[c], l[c], 1e-12);
            for (std::size_t k = 0; k < 12; ++k)
                EXPECT_NEAR(received.bounces[k].mean[c],
                            l[c] * std::pow(a[c], static_cast<double>(k + 1)), 1e-12);
            EXPECT_NEAR(received.total.mean[c], l[c] * (1.0 - std::pow(a[c], 13.0)) / (1.0 - a[c]),
                        1e-11);
            EXPECT_EQ(received.sun.mean[c], 0.0);
        }
}

TEST(PathTracerBounces, WhiteGroundUnderAWhiteSkyIsInvisible)
{
    // Albedo 1 and a sky all around: every path ends in the sky and brings its radiance. Each
    // bounce escapes with a probability near 0.9, so 60 of them cut none short.
    for (TerrainKind kind : {TerrainKind::Fractal, TerrainKind::Cliffs})
    {
        const PathTracer tracer = tracerOf(*generateTerrain(kind, 64, 64, 30.0, 3), 1.0f);
        Illumination illumination = uniformSky(0.75f);
        illumination.extent = SkyExtent::DownToHorizon;
        std::vector<Receiver> receivers;
        for (int i = 0; i < 64 * 64; i += 71)
            receivers.push_back(post(i % 64, i / 64));
        for (const ReceivedLight& light :
             traceAll(tracer, illumination, receivers, options(1024, 60)))
            EXPECT_NEAR(light.total.mean[0], 0.75, 1e-12);
    }
}

TEST(PathTracerBounces, ParallelPlanes)
{
    // A ceiling that sends L, 1 m over ground 10 km wide: L straight, nothing after an odd number
    // of bounces, L·(a·b)^m after 2m. Paths leave by the sides with a probability of 4e-8 per
    // bounce.
    SceneDescription scene;
    scene.tile = analytic::plane(3, 3, 5000.0, 0.0);
    scene.albedo = {0.75f, 0.5f, 1.0f};
    const LinearRgb ceiling = {0.5, 0.25, 0.75};
    const LinearRgb radiance = {1.0, 2.0, 4.0};
    addCeiling(scene.triangles, 10000.0, 1.0, ceiling, radiance);
    const LinearRgb ground = {0.75, 0.5, 1.0};
    const PathTracer tracer = std::move(PathTracer::build(std::move(scene)).value());
    const ReceivedLight light = traceOne(tracer, uniformSky(), post(1, 1), options(4096, 6));
    for (std::size_t c = 0; c < 3; ++c)
    {
        const double product = ground[c] * ceiling[c];
        EXPECT_NEAR(light.emitters.mean[c], radiance[c], 1e-12);
        EXPECT_NEAR(light.sky.mean[c], 0.0, 1e-12);
        for (std::size_t m = 1; m <= 3; ++m)
        {
            EXPECT_NEAR(light.bounces[2 * m - 2].mean[c], 0.0, 1e-12);
            EXPECT_NEAR(light.bounces[2 * m - 1].mean[c],
                        radiance[c] * std::pow(product, static_cast<double>(m)), 1e-12);
        }
    }
}

TEST(PathTracerBounces, ASquareCeilingHasItsFormFactor)
{
    // From below its middle at a distance of its half side, each quarter has
    // 2·(1/√2)·atan(1/√2)/2π (Siegel and Howell, differential element to parallel rectangle).
    SceneDescription scene;
    scene.tile = analytic::plane(5, 5, 1.0, 0.0);
    addCeiling(scene.triangles, 4.0, 2.0, {}, {1.0, 1.0, 1.0});
    const PathTracer tracer = std::move(PathTracer::build(std::move(scene)).value());
    const double factor = 4.0 * std::sqrt(2.0) * std::atan(std::sqrt(0.5)) / (2.0 * pi);
    const ReceivedLight light = traceOne(tracer, uniformSky(), post(2, 2), options(65536));
    expectWithin3Sigma(light.emitters, factor);
    expectWithin3Sigma(light.sky, 1.0 - factor);
    expectWithin3Sigma(light.total, 1.0);
}

namespace
{
/// Two planes of slope ¾ that meet at the bottom, and ground of albedo ¾. From any point of a side
/// the other side fills F = sin²S = 0.36 of the cosine-weighed half space, so a uniform sky gives
/// cos²S·(a·sin²S)ᵏ after k bounces. The sides end at 10 km, the valley at 500 km, and the receiver
/// is 1 m beside the bottom: what is missing is an angle of 1/10 000 of the half space per bounce.
PathTracer valleyOfPlanes()
{
    constexpr int half = 10000;
    DemTile tile = analytic::valley(2 * half + 1, 3, 1.0, half, 0.75);
    tile.northSpacing = 500e3;
    return tracerOf(std::move(tile), 0.75f);
}
const Receiver besideBottom = post(10001, 1);
constexpr double valleySlack = 1e-4; ///< relative, direct and per bounce
double valleyBounce(int order)
{
    return 0.64 * std::pow(0.75 * 0.36, order);
}
} // namespace

TEST(PathTracerBounces, ValleyOfPlanesIsAGeometricSeries)
{
    const ReceivedLight light =
        traceOne(valleyOfPlanes(), uniformSky(), besideBottom, options(1 << 18, 6));
    expectWithin3Sigma(light.sky, valleyBounce(0), valleySlack);
    for (int order = 1; order <= 6; ++order)
        expectWithin3Sigma(light.bounces[static_cast<std::size_t>(order - 1)], valleyBounce(order),
                           (order + 1.0) * valleySlack * valleyBounce(order));
}

TEST(PathTracerBounces, SphericalCavity)
{
    // Between any two elements of a sphere the form factor is dA/(4πR²). With s = ¾ of the sphere
    // left, a uniform sky of radiance 1 gives (1 − s)·(a·s)ᵏ everywhere.
    const PathTracer tracer = tracerOf(cavity(cavityRings, 0.8));
    const auto light = traceAll(tracer, uniformSky(), inCavity(), options(1 << 16, 5));
    for (const ReceivedLight& received : light)
    {
        expectWithin3Sigma(received.sky, 0.25, cavitySlack * 0.25);
        for (std::size_t k = 0; k < 5; ++k)
        {
            const double order = static_cast<double>(k + 1);
            const double expected = 0.25 * std::pow(0.8 * 0.75, order);
            expectWithin3Sigma(received.bounces[k], expected,
                               (order + 1.0) * cavitySlack * expected);
        }
    }
}

TEST(PathTracerBounces, SphericalCavityInSunlight)
{
    // Flux Φ = I·sin e·(¾π) enters by the opening. Where it falls does not matter: the first bounce
    // gives E = a·Φ/4π everywhere, and the next ones a·s of that.
    const PathTracer tracer = tracerOf(cavity(cavityRings, 0.8));
    Illumination illumination = sunAt(200.0, 70.0);
    illumination.light.sunIrradiance = {2.0f, 2.0f, 2.0f};
    const auto light = traceAll(tracer, illumination, inCavity(), options(1 << 16, 4));
    const double flux = 2.0 * std::sin(70.0 * pi / 180.0) * 0.75 * pi;
    for (const ReceivedLight& received : light)
        for (std::size_t k = 0; k < 4; ++k)
        {
            const double order = static_cast<double>(k);
            const double expected = 0.8 * flux / (4.0 * pi * pi) * std::pow(0.8 * 0.75, order);
            expectWithin3Sigma(received.bounces[k], expected,
                               (order + 2.0) * cavitySlack * expected);
        }
}

TEST(PathTracerBounces, BowlOfCells)
{
    // A cap of 60° sunk in level ground: s = ¼ of its sphere. Chords between posts cut the rim's
    // edge: it appears up to a cell further out than it is, half a cell on average. From the bottom
    // it is 30° high and r = 173 cells away, so cos²30° grows by sin²60°/2·(½/r) = 1.1e-3, and as
    // all points of a sphere see its parts alike, s = ¼ is less by about as much everywhere.
    const double slack = 1.1e-3;
    const double radius = 200.0;
    const double rim = radius * std::sin(pi / 3.0);
    const DemTile tile = analytic::makeTile(
        361, 351, 1.0,
        [&](int column, int row)
        {
            const double x = column - 180.0;
            const double y = row - 175.0;
            return std::hypot(x, y) < rim
                       ? radius / 2.0 - std::sqrt(radius * radius - x * x - y * y)
                       : 0.0;
        });
    const PathTracer tracer = tracerOf(tile, 0.5f);
    const std::vector<Receiver> receivers = {post(180, 175), post(240, 95), post(60, 180)};
    for (const ReceivedLight& light :
         traceAll(tracer, uniformSky(), receivers, options(1 << 16, 3)))
    {
        expectWithin3Sigma(light.sky, 0.75, slack);
        for (std::size_t k = 0; k < 3; ++k)
        {
            const double order = static_cast<double>(k + 1);
            const double expected = 0.75 * std::pow(0.5 * 0.25, order);
            expectWithin3Sigma(light.bounces[k], expected,
                               (slack / 0.75 + order * slack / 0.25) * expected);
        }
    }
}

namespace
{
PathTracer glossyTracer(DemTile tile, double exponent, int bands = 0, double gloss = 1.0,
                        float albedo = 0.0f)
{
    SceneDescription scene;
    scene.tile = std::move(tile);
    scene.albedo = {albedo, albedo, albedo};
    scene.gloss = gloss;
    scene.glossExponent = exponent;
    scene.glossBands = bands;
    return std::move(PathTracer::build(std::move(scene)).value());
}

Receiver towards(int column, int row, const Vector3& direction)
{
    Receiver receiver = post(column, row);
    receiver.towards = direction;
    return receiver;
}
} // namespace

TEST(PathTracerGloss, PlaneUnderAUniformSky)
{
    // Towards the zenith all of the lobe is above the plane, and it integrates to 1. With exponent
    // 1 it is the cosine over π, and a plane at an angle sees (1 + cos) / 2 of it.
    const DemTile plane = analytic::plane(3, 3, 10.0, 0.0);
    for (double exponent : {1.0, 8.0, 64.0})
        expectWithin3Sigma(traceOne(glossyTracer(plane, exponent), uniformSky(),
                                    towards(1, 1, {0.0, 0.0, 1.0}), options(1024))
                               .sky,
                           1.0);
    for (double angle : {0.3, 0.8, 1.3})
        expectWithin3Sigma(traceOne(glossyTracer(plane, 1.0), uniformSky(),
                                    towards(1, 1, {0.0, std::sin(angle), std::cos(angle)}),
                                    options(65536))
                               .sky,
                           0.5 + 0.5 * std::cos(angle));
}

TEST(PathTracerGloss, BandsOfTheLobeAreThatManyOfTheHarmonics)
{
    // A hemisphere in Legendre polynomials: 1/2, 3/4 z, 0, -7/16 P3. Eigenvalues of the lobe of
    // exponent 8: 1, 9/10, 8/11, 9/10 · 7/12.
    const PathTracer tracer = glossyTracer(analytic::plane(3, 3, 10.0, 0.0), 8.0, 4);
    for (double angle : {0.0, 0.5, 1.0, 1.4})
    {
        const double z = std::cos(angle);
        const double expected =
            0.5 + 0.75 * 0.9 * z - 7.0 / 16.0 * 0.9 * 7.0 / 12.0 * 0.5 * (5.0 * z * z - 3.0) * z;
        expectWithin3Sigma(
            traceOne(tracer, uniformSky(), towards(1, 1, {std::sin(angle), 0.0, z}), options(65536))
                .sky,
            expected);
    }
}

TEST(PathTracerGloss, PlaneMirrorsTheSun)
{
    // The disc of 0.27° changes the lobe's value by less than (s r)² = 1e-3 of it.
    const DemTile plane = analytic::plane(3, 3, 10.0, 0.0);
    Illumination sun = sunAt(90.0, 40.0);
    sun.light.sunIrradiance = {1.0f, 2.0f, 3.0f};
    for (double elevation : {20.0, 40.0, 70.0})
    {
        const double e = elevation * pi / 180.0;
        const ReceivedLight light =
            traceOne(glossyTracer(plane, 8.0), sun, towards(1, 1, {-std::cos(e), 0.0, std::sin(e)}),
                     options(1024));
        const double lobe =
            9.0 / (2.0 * pi) * std::pow(std::cos((elevation - 40.0) * pi / 180.0), 8.0);
        for (std::size_t c = 0; c < 3; ++c)
            expectWithin3Sigma(light.sun, (1.0 + static_cast<double>(c)) * lobe, 2e-3 * lobe * 3.0,
                               c);
    }
}

TEST(PathTracerGloss, FlankMirrorsTheSunOntoThePlain)
{
    // Level ground, and from column 60 on a flank of 45°, 60 high and 60 wide. Every place of the
    // flank sends the same lobe, so the light of the first bounce is an integral over where the
    // flank is seen: midpoints, good to some 1e-3 at its edges. Diffusely it sends E/π.
    const DemTile tile =
        analytic::makeTile(121, 121, 1.0, [](int x, int) { return std::max(0, x - 60); });
    const Illumination sun = sunAt(270.0, 60.0);
    const Vector3 normal = {-std::sqrt(0.5), 0.0, std::sqrt(0.5)};
    const Vector3 toSun = {-std::cos(pi / 3.0), 0.0, std::sin(pi / 3.0)};
    const double facing = toSun[0] * normal[0] + toSun[2] * normal[2];
    const Vector3 mirror = {2.0 * facing * normal[0] - toSun[0], 0.0,
                            2.0 * facing * normal[2] - toSun[2]};
    const double irradiance = static_cast<double>(sun.light.sunIrradiance[0]);
    constexpr double gloss = 0.4;
    constexpr double exponent = 3.0;
    double expected = 0.0;
    double diffuse = 0.0;
    constexpr int rows = 1000;
    constexpr int columns = 2000;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i)
        {
            const double z = (j + 0.5) / rows;
            const double azimuth = pi * ((i + 0.5) / columns - 0.5);
            const double level = std::sqrt(1.0 - z * z);
            const Vector3 d = {level * std::cos(azimuth), level * std::sin(azimuth), z};
            const double distance = 40.0 / (d[0] - d[2]); // from column 20 to z = x - 60
            if (distance < 0.0 || distance * d[0] > 100.0 || std::abs(distance * d[1]) > 60.0)
                continue;
            const double cosine =
                std::max(0.0, -(mirror[0] * d[0] + mirror[1] * d[1] + mirror[2] * d[2]));
            const double share = z / pi * (1.0 / rows) * (pi / columns);
            expected += share * gloss * irradiance * (exponent + 1.0) / (2.0 * pi) *
                        std::pow(cosine, exponent);
            diffuse += share * 0.5 * irradiance * facing / pi;
        }
    expectWithin3Sigma(
        traceOne(glossyTracer(tile, exponent, 0, gloss), sun, post(20, 60), options(1 << 17, 1))
            .bounces[0],
        expected, 3e-3 * expected);
    expectWithin3Sigma(traceOne(glossyTracer(tile, exponent, 0, gloss, 0.5f), sun, post(20, 60),
                                options(1 << 17, 1))
                           .bounces[0],
                       expected + diffuse, 3e-3 * (expected + diffuse));
}

TEST(PathTracerGloss, ATableChangesNothing)
{
    // Two estimators of the same light share no densities at the receiver: where the one is wrong,
    // they differ. Two bounces on mixed ground.
    const DemTile tile = *generateTerrain(TerrainKind::Fractal, 32, 32, 30.0, 5);
    Illumination illumination = uniformSky();
    const auto radiance = [](const Vector3& d) {
        return LinearRgb{1.0 + d[0], 1.0 - 0.5 * d[1], d[2]};
    };
    illumination.environment = radiance;
    for (int bands : {0, 4})
    {
        const PathTracer tracer = glossyTracer(tile, 8.0, bands, 0.5, 0.4f);
        const Receiver receiver = towards(16, 16, {0.6, 0.0, 0.8});
        const ReceivedLight plain = traceOne(tracer, illumination, receiver, options(1 << 17, 2));
        Illumination tabled = illumination;
        tabled.importance = importanceOf(radiance, 16, 8);
        const ReceivedLight other = traceOne(tracer, tabled, receiver, options(1 << 17, 2));
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t k = 0; k < 2; ++k)
                EXPECT_NEAR(plain.bounces[k].mean[c], other.bounces[k].mean[c],
                            3.5 * std::hypot(plain.bounces[k].standardError[c],
                                             other.bounces[k].standardError[c]));
    }
}

TEST(PathTracerBounces, AlbedosAreBilinear)
{
    // A small plate 1 m over ground of 10 km, in its shadowless sun from the zenith, receives from
    // the ground below it: what is mirrored about the plate has the plate's own albedo on average,
    // where the albedo is linear in column and row.
    SceneDescription scene;
    scene.tile = analytic::plane(3, 4, 5000.0, 0.0);
    scene.albedos = Raster<Rgb>(3, 4);
    const auto albedo = [](double column, double row) { return 0.1 + 0.3 * column + 0.05 * row; };
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 3; ++column)
            scene.albedos.at(column, row) = {static_cast<float>(albedo(column, row)), 1.0f, 0.0f};
    const double x = 6500.0, y = 4000.0, size = 1e-4;
    scene.triangles.push_back({{{{x, y, 1.0}, {x, y + size, 1.0}, {x + size, y, 1.0}}}, {}, {}});
    const PathTracer tracer = std::move(PathTracer::build(std::move(scene)).value());
    Illumination illumination = sunAt(0.0, 90.0);
    illumination.light.sunIrradiance = {2.0f, 2.0f, 2.0f};
    const ReceivedLight light =
        traceAll(tracer, illumination, onTriangles({0}), options(16384, 1)).at(0);
    EXPECT_EQ(light.sun.mean[0], 0.0);
    // float albedos round by 3e-8; 1e-8 of the ground lies in shadow.
    expectWithin3Sigma(light.bounces[0], albedo(1.3, 0.8) * 2.0 / pi, 1e-7);
    expectWithin3Sigma(light.bounces[0], 2.0 / pi, 1e-7, 1);
    EXPECT_EQ(light.bounces[0].mean[2], 0.0);
}

namespace
{
/// Radiance 1, and `brightness` in a texel of 32 × 16: elevations 45 … 56.25°, azimuths 0 … 11.25°
/// north of east. Green twice that, blue 1 everywhere.
Illumination brightTexelSky(double brightness)
{
    Illumination illumination = uniformSky();
    illumination.environment = [brightness](const Vector3& direction) -> LinearRgb
    {
        const double elevation = std::asin(direction[2]) * 180.0 / pi;
        const double azimuth = std::atan2(direction[1], direction[0]) * 180.0 / pi;
        const bool inside =
            elevation >= 45.0 && elevation < 56.25 && azimuth >= 0.0 && azimuth < 11.25;
        const double radiance = inside ? brightness : 1.0;
        return {radiance, 2.0 * radiance, 1.0};
    };
    illumination.importance = importanceOf(illumination.environment, 32, 16);
    return illumination;
}

/// ∫ (N·ω) dω over that texel, in closed form: N·(cos φ cos² e, sin φ cos² e, sin e cos e).
double throughBrightTexel(const Vector3& normal)
{
    const double low = 0.25 * pi, high = 0.3125 * pi, wide = pi / 16.0;
    const double cos2 = 0.5 * (high - low) + 0.25 * (std::sin(2.0 * high) - std::sin(2.0 * low));
    const double sine = 0.5 * (std::pow(std::sin(high), 2.0) - std::pow(std::sin(low), 2.0));
    return normal[0] * std::sin(wide) * cos2 + normal[1] * (1.0 - std::cos(wide)) * cos2 +
           normal[2] * wide * sine;
}
} // namespace

TEST(PathTracerEnvironment, ATexelAMillionTimesBrighterConverges)
{
    const DemTile tile = analytic::ramp(9, 8, 1.0, 0.5, -0.25);
    const double open = analytic::rampSkyView(std::sqrt(0.3125)).surface;
    const double texel = throughBrightTexel(surfaceNormal(tile, 4, 3)) / pi;
    const ReceivedLight light =
        traceOne(tracerOf(tile), brightTexelSky(1e6), post(4, 3), options(4096));
    expectWithin3Sigma(light.sky, open + (1e6 - 1.0) * texel);
    expectWithin3Sigma(light.sky, 2.0 * (open + (1e6 - 1.0) * texel), 0.0, 1);
    expectWithin3Sigma(light.sky, open, 0.0, 2);
    // One draw of the table in 3900 goes elsewhere: √(1/3900/4096) = 0.025 %. By the cosine alone,
    // which hits the texel once in 140 times, it would be √(140/4096) = 18 %.
    EXPECT_LT(light.sky.standardError[0], 1e-3 * light.sky.mean[0]);
}

TEST(PathTracerEnvironment, ItsLightInACavityIsItsFluxThroughTheOpening)
{
    const double flux = 0.75 * pi * (pi + (1e6 - 1.0) * throughBrightTexel({0.0, 0.0, 1.0}));
    const PathTracer tracer = tracerOf(cavity(cavityRings, 0.8));
    for (const ReceivedLight& light :
         traceAll(tracer, brightTexelSky(1e6), inCavity(), options(1 << 15, 3)))
        for (std::size_t k = 0; k < 3; ++k)
        {
            const double order = static_cast<double>(k);
            const double expected = 0.8 * flux / (4.0 * pi * pi) * std::pow(0.8 * 0.75, order);
            expectWithin3Sigma(light.bounces[k], expected, (order + 2.0) * cavitySlack * expected);
        }
}

TEST(PathTracerEnvironment, AnyTableIsRight)
{
    // A sky of radiance 1 + sin e + ½ cos φ cos e gives a level post 1 + ⅔. Any table leaves that
    // as it is, one with zeros too, and one that favours what a slope does not see.
    Illumination illumination = uniformSky();
    illumination.environment = [](const Vector3& d) -> LinearRgb {
        return {1.0 + d[2] + 0.5 * d[0], 1.0, 0.0};
    };
    Illumination around = illumination;
    around.extent = SkyExtent::DownToHorizon;
    const PathTracer plane = tracerOf(analytic::plane(9, 8, 1.0, 0.0));
    const PathTracer ramp = tracerOf(analytic::ramp(9, 8, 1.0, 2.0, 0.0));
    const std::vector<Receiver> receivers(100 / thinning, post(4, 3));
    std::mt19937 random(5);
    std::vector<double> level, slope, all;
    for (int trial = 0; trial < 4; ++trial)
    {
        Raster<double> table(5 + trial, 4 + trial);
        for (double& value : table.values())
            value = random() % 3 == 0 ? 0.0 : static_cast<double>(random() % 1000u);
        illumination.importance = around.importance = table;
        PathTracerOptions paths = options(2048);
        paths.seed = static_cast<std::uint64_t>(trial);
        const auto append = [](std::vector<double>& z, const std::vector<ReceivedLight>& light,
                               double expected, std::size_t colour)
        {
            for (const ReceivedLight& l : light)
                z.push_back((l.sky.mean[colour] - expected) / l.sky.standardError[colour]);
        };
        append(level, traceAll(plane, illumination, receivers, paths), 1.0 + 2.0 / 3.0, 0);
        append(slope, traceAll(ramp, illumination, receivers, paths),
               analytic::rampSkyView(2.0).surface, 1);
        append(all, traceAll(ramp, around, receivers, paths), 1.0, 1);
    }
    expectHonest(level, 32);
    expectHonest(slope, 32);
    expectHonest(all, 32);
}

TEST(PathTracerErrors, StandardErrorsAreHonest)
{
    // 400 independent estimates each of light with a closed form: a valley's sky and first bounce,
    // and a bright texel over a ramp. What the closed forms leave out is 1/30 of their errors. The
    // table misses this texel one time in five; at 1e6 only one estimate in four would see a miss.
    std::vector<double> sky, bounce, texel;
    const std::vector<Receiver> sides(400 / thinning, besideBottom);
    for (const ReceivedLight& light :
         traceAll(valleyOfPlanes(), uniformSky(), sides, options(2048, 1)))
    {
        sky.push_back((light.sky.mean[0] - valleyBounce(0)) / light.sky.standardError[0]);
        bounce.push_back((light.bounces[0].mean[0] - valleyBounce(1)) /
                         light.bounces[0].standardError[0]);
    }
    expectHonest(sky, 32);
    expectHonest(bounce, 32);

    const DemTile rampTile = analytic::ramp(9, 8, 1.0, 0.5, -0.25);
    const double expected = analytic::rampSkyView(std::sqrt(0.3125)).surface +
                            (1e3 - 1.0) * throughBrightTexel(surfaceNormal(rampTile, 4, 3)) / pi;
    const std::vector<Receiver> slopes(400 / thinning, post(4, 3));
    for (const ReceivedLight& light :
         traceAll(tracerOf(rampTile), brightTexelSky(1e3), slopes, options(1024, 0, 16)))
        texel.push_back((light.sky.mean[0] - expected) / light.sky.standardError[0]);
    expectHonest(texel, 16);
}

namespace
{
/// Root mean square errors of 64 estimates by 32 batches of 1, 2, 4 … `last` paths each: [0] of
/// direct light on a ramp, [1] of the first bounce in the valley of planes.
std::array<std::vector<double>, 2> errorsBySamples(int last)
{
    const PathTracer ramp = tracerOf(analytic::ramp(9, 8, 1.0, 0.6, 0.8));
    const double sky = analytic::rampSkyView(1.0).surface;
    const PathTracer valley = valleyOfPlanes();
    std::array<std::vector<double>, 2> errors;
    for (int paths = 1; paths <= last; paths *= 2)
    {
        std::array<double, 2> squares = {};
        for (const ReceivedLight& light : traceAll(
                 ramp, uniformSky(), std::vector<Receiver>(64, post(4, 3)), options(32 * paths)))
            squares[0] += std::pow(light.sky.mean[0] - sky, 2.0);
        for (const ReceivedLight& light :
             traceAll(valley, uniformSky(), std::vector<Receiver>(64, besideBottom),
                      options(32 * paths, 1)))
            squares[1] += std::pow(light.bounces[0].mean[0] - valleyBounce(1), 2.0);
        for (std::size_t k = 0; k < 2; ++k)
            errors[k].push_back(std::sqrt(squares[k] / 64.0));
    }
    return errors;
}

/// r of the least-squares line errors ~ paths^−r, paths being 1, 2, 4 …
double rateOf(const std::vector<double>& errors)
{
    const double middle = 0.5 * (static_cast<double>(errors.size()) - 1.0);
    double products = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < errors.size(); ++i)
    {
        const double x = static_cast<double>(i) - middle;
        products += x * std::log2(errors[i]);
        squares += x * x;
    }
    return -products / squares;
}
} // namespace

TEST(PathTracerErrors, FallWithTheSamples)
{
    // In a stratified plane only the boxes that an edge passes err: the ¾th power of the paths for
    // direct light. It is told from the ½ of independent paths, and from the 1 of smooth light,
    // half-way between them. A bounce depends on two pairs, which are not stratified together, so ½
    // is all that it is sure of. 64 estimates know a root mean square to 1/√128, so nine of them,
    // in octaves, know the power to 1/(√128·ln 2·√60) = 0.016.
    const char* path = std::getenv("OTL_CONVERGENCE_CSV"); // set by plot_convergence.sh
    const auto errors = errorsBySamples(path ? 2048 : 256);
    EXPECT_GT(rateOf(errors[0]), 0.625);
    EXPECT_LT(rateOf(errors[0]), 0.875);
    EXPECT_GT(rateOf(errors[1]), 0.5 - 3.0 * 0.016);
    if (!path)
        return;
    std::ofstream file(path);
    for (std::size_t i = 0; i < errors[0].size(); ++i)
        file << (32 << i) << ',' << errors[0][i] / analytic::rampSkyView(1.0).surface << ','
             << errors[1][i] / valleyBounce(1) << '\n';
    EXPECT_TRUE(file.good());
}

TEST(PathTracerErrors, SameSeedSameBitsWhateverTheThreads)
{
    const PathTracer tracer =
        tracerOf(*generateTerrain(TerrainKind::Cliffs, 64, 64, 30.0, 3), 0.8f);
    Illumination illumination = brightTexelSky(1e6);
    illumination.light.sunEnabled = true;
    std::vector<Receiver> receivers;
    for (int i = 0; i < 64 * 64; i += 97)
        receivers.push_back(post(i % 64, i / 64));
    PathTracerOptions one = options(256, 4, 8);
    one.threads = 1;
    PathTracerOptions five = one;
    five.threads = 5;
    std::size_t last = 0;
    five.progress = [&](std::size_t done, std::size_t all)
    {
        EXPECT_EQ(done, last + 1);
        EXPECT_EQ(all, receivers.size());
        last = done;
    };
    PathTracerOptions other = one;
    other.seed = 2;
    const auto a = traceAll(tracer, illumination, receivers, one);
    const auto b = traceAll(tracer, illumination, receivers, five);
    const auto c = traceAll(tracer, illumination, receivers, other);
    EXPECT_EQ(last, receivers.size());
    for (std::size_t i = 0; i < receivers.size(); ++i)
    {
        EXPECT_EQ(a[i].total.mean, b[i].total.mean);
        EXPECT_EQ(a[i].total.standardError, b[i].total.standardError);
        EXPECT_EQ(a[i].sunVisible.mean, b[i].sunVisible.mean);
        EXPECT_EQ(a[i].rays, b[i].rays);
        EXPECT_EQ(a[i].samples, 256u);
        EXPECT_NE(a[i].total.mean, c[i].total.mean);
    }
}

TEST(PathTracerInput, TheTotalIsTheSumOfItsParts)
{
    const PathTracer tracer =
        tracerOf(*generateTerrain(TerrainKind::Fractal, 32, 32, 30.0, 3), 0.8f);
    Illumination illumination = uniformSky();
    illumination.light.sunEnabled = true;
    const ReceivedLight light = traceOne(tracer, illumination, post(16, 16), options(1024, 3));
    double sum = light.sky.mean[1] + light.sun.mean[1] + light.emitters.mean[1];
    for (const Estimate& bounce : light.bounces)
        sum += bounce.mean[1];
    EXPECT_EQ(light.bounces.size(), 3u);
    EXPECT_NEAR(light.total.mean[1], sum, 1e-13);
    EXPECT_GT(light.rays, 2048u);
    EXPECT_TRUE(traceAll(tracer, illumination, {}, options(64)).empty());
}

TEST(PathTracerInput, BadScenesAreRefused)
{
    const auto codeOf = [](const SceneDescription& scene) -> int
    {
        const auto tracer = PathTracer::build(scene);
        return tracer ? -1 : static_cast<int>(tracer.error().code);
    };
    const int invalid = static_cast<int>(ErrorCode::Invalid);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    SceneDescription good;
    good.tile = analytic::plane(4, 3, 10.0, 0.0);
    good.triangles.push_back({{{{0, 0, 1}, {0, 1, 1}, {1, 0, 1}}}, {}, {}});
    EXPECT_EQ(codeOf(good), -1);
    EXPECT_EQ(codeOf({}), invalid);
    for (double albedo : {nan, -0.01, 1.01})
    {
        SceneDescription scene = good;
        scene.albedo[1] = static_cast<float>(albedo);
        EXPECT_EQ(codeOf(scene), invalid);
        scene = good;
        scene.triangles[0].albedo[2] = albedo;
        EXPECT_EQ(codeOf(scene), invalid);
        scene = good;
        scene.albedos = Raster<Rgb>(4, 3, {0.5f, 0.5f, 0.5f});
        EXPECT_EQ(codeOf(scene), -1);
        scene.albedos.at(2, 1)[0] = static_cast<float>(albedo);
        EXPECT_EQ(codeOf(scene), invalid);
        scene.tile.setVoid(2, 1);
        EXPECT_EQ(codeOf(scene), -1);
    }
    SceneDescription scene = good;
    scene.albedos = Raster<Rgb>(3, 4);
    EXPECT_EQ(codeOf(scene), invalid);
    for (double emission : {nan, -1.0, infinity})
    {
        scene = good;
        scene.triangles[0].emission[0] = emission;
        EXPECT_EQ(codeOf(scene), invalid);
    }
    scene = good;
    scene.triangles[0].corners[1] = {0.5, 0.0, 1.0}; // on a line with the others
    EXPECT_EQ(codeOf(scene), invalid);
    scene.triangles[0].corners[1] = {0.0, nan, 1.0};
    EXPECT_EQ(codeOf(scene), invalid);
    scene = good;
    scene.tile.northSpacing = 0.0;
    EXPECT_EQ(codeOf(scene), invalid);
    scene = good;
    scene.tile.eastSpacings = {10.0, 10.0, 10.0};
    EXPECT_EQ(codeOf(scene), -1);
    scene.tile.eastSpacings = {10.0, 9.0, 8.0};
    EXPECT_EQ(codeOf(scene), static_cast<int>(ErrorCode::NotSupported));
}

TEST(PathTracerInput, BadReceiversLightsAndOptionsAreRefused)
{
    SceneDescription scene;
    scene.tile = analytic::plane(4, 3, 10.0, 0.0);
    scene.tile.setVoid(1, 1);
    scene.triangles.push_back({{{{0, 0, 1}, {0, 1, 1}, {1, 0, 1}}}, {}, {}});
    const PathTracer tracer = std::move(PathTracer::build(std::move(scene)).value());
    const auto refuses = [&](const Illumination& illumination, const Receiver& receiver,
                             const PathTracerOptions& options)
    {
        const auto result = tracer.trace(illumination, {receiver}, options);
        return !result && result.error().code == ErrorCode::Invalid;
    };
    const Illumination light;
    EXPECT_FALSE(refuses(light, post(3, 2), options(64)));
    for (const Receiver& receiver : {post(1, 1), post(4, 0), post(0, 3), post(-1, 0), post(0, -1)})
        EXPECT_TRUE(refuses(light, receiver, options(64)));
    Receiver onTriangle;
    onTriangle.triangle = 0;
    EXPECT_FALSE(refuses(light, onTriangle, options(64)));
    onTriangle.s = 0.7;
    EXPECT_TRUE(refuses(light, onTriangle, options(64)));
    onTriangle.triangle = 1;
    EXPECT_TRUE(refuses(light, onTriangle, options(64)));
    Receiver free;
    free.place = FreePlace{{1.0, 1.0, 1.0}, {0.0, 0.0, 1.0}};
    EXPECT_FALSE(refuses(light, free, options(64)));
    free.place->normal[2] = 0.9;
    EXPECT_TRUE(refuses(light, free, options(64)));
    free.place = FreePlace{{1.0, infinity, 1.0}, {0.0, 0.0, 1.0}};
    EXPECT_TRUE(refuses(light, free, options(64)));

    const Receiver receiver = post(3, 2);
    EXPECT_TRUE(refuses(light, receiver, options(0)));
    EXPECT_TRUE(refuses(light, receiver, options(64, -1)));
    EXPECT_TRUE(refuses(light, receiver, options(64, 0, 1)));
    PathTracerOptions threads = options(64);
    threads.threads = -1;
    EXPECT_TRUE(refuses(light, receiver, threads));

    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto refusesLight = [&](void (*change)(Illumination&, float), float value)
    {
        Illumination changed;
        change(changed, value);
        return refuses(changed, receiver, options(64));
    };
    for (float value : {nan, -1.0f, std::numeric_limits<float>::infinity()})
    {
        EXPECT_TRUE(
            refusesLight([](Illumination& i, float v) { i.light.skyRadiance[2] = v; }, value));
        EXPECT_TRUE(
            refusesLight([](Illumination& i, float v) { i.light.sunIrradiance[0] = v; }, value));
        EXPECT_TRUE(refusesLight(
            [](Illumination& i, float v) { i.light.sunAngularRadius = double(v); }, value));
        EXPECT_TRUE(refusesLight([](Illumination& i, float v)
                                 { i.importance = Raster<double>(2, 2, double(v)); },
                                 value));
        EXPECT_TRUE(refusesLight(
            [](Illumination& i, float v)
            {
                i.environment = [v](const Vector3&) -> LinearRgb {
                    return {0.0, std::sqrt(double(v)) + double(v) * 1e300 * 1e300, 0.0};
                };
            },
            value));
    }
    EXPECT_TRUE(
        refusesLight([](Illumination& i, float v) { i.light.sunElevation = double(v); }, 91.f));
    // Black where the sky is: the lower half alone.
    Illumination black;
    black.importance = Raster<double>(1, 2, 1.0);
    EXPECT_FALSE(refuses(black, receiver, options(64)));
    black.importance.at(0, 1) = 0.0;
    EXPECT_TRUE(refuses(black, receiver, options(64)));
}
