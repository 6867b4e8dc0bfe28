// Light probes: against closed forms on a plain, and in a deep valley against the path tracer,
// which receives on a small triangle at the probe's place.
#include "lighting/TileLight.h"
#include "lighting/nodes/ProbeNode.h"
#include "reference/PathTracer.h"
#include "support/AnalyticTerrain.h"
#include "support/CubeMap.h"
#include "support/GlContext.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

using namespace osgTerrainLight;
using reference::Vector3;

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr int side = ProbeNode::mapSize;

ProbePlace probeAt(double column, double row, double height)
{
    ProbePlace place;
    place.column = column;
    place.row = row;
    place.height = height;
    place.exponent = 8.0;
    place.diffuse = IrradianceMapPass::createMap(side);
    place.glossy = IrradianceMapPass::createMap(side);
    return place;
}

/// Calls f(direction, rgba) for every texel.
void forEachTexel(osg::State& state, osg::TextureCubeMap& map,
                  const std::function<void(const std::array<double, 3>&, const float*)>& f)
{
    const std::vector<float> values = readCube(state, map);
    for (int i = 0; i < 6 * side * side; ++i)
        f(directionOnCube(i / side / side, 2.0 * (i % side + 0.5) / side - 1.0,
                          2.0 * (i / side % side + 0.5) / side - 1.0),
          &values[4 * static_cast<std::size_t>(i)]);
}

SkyLight uniformSky()
{
    SkyLight sky;
    sky.skyRadiance = {1.0f, 0.8f, 0.5f};
    sky.sunEnabled = false;
    return sky;
}

unsigned probeRuns(const TileLight& lighting)
{
    for (const StageCost& cost : lighting.costs())
        if (cost.name == "probe")
            return cost.dispatches;
    return 0;
}

/// A valley of 45 degrees that runs north, its eastern side red.
Raster<Rgb> redInTheEast(int width, int height)
{
    Raster<Rgb> albedo(width, height);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
            albedo.at(column, row) =
                column > width / 2 ? Rgb{0.8f, 0.1f, 0.1f} : Rgb{0.5f, 0.5f, 0.5f};
    return albedo;
}

/// A triangle that faces `normal`, small beside everything else, about a place [m].
reference::Triangle facing(const Vector3& place, const Vector3& normal)
{
    const bool steep = std::abs(normal[2]) > 0.9;
    Vector3 a = steep ? Vector3{1.0, 0.0, 0.0} : Vector3{-normal[1], normal[0], 0.0};
    const double across = a[0] * normal[0] + a[1] * normal[1] + a[2] * normal[2];
    double length = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
    {
        a[i] -= across * normal[i];
        length += a[i] * a[i];
    }
    for (double& x : a)
        x /= std::sqrt(length);
    const Vector3 b = {normal[1] * a[2] - normal[2] * a[1], normal[2] * a[0] - normal[0] * a[2],
                       normal[0] * a[1] - normal[1] * a[0]};
    constexpr double size = 0.01;
    reference::Triangle triangle;
    for (std::size_t k = 0; k < 3; ++k)
    {
        const double angle = 2.0 * pi * static_cast<double>(k) / 3.0;
        for (std::size_t i = 0; i < 3; ++i)
            triangle.corners[k][i] =
                place[i] + size * (std::cos(angle) * a[i] + std::sin(angle) * b[i]);
    }
    return triangle;
}

/// With one key light, in the north.
SkyLight skyWithAKeyLight()
{
    SkyLight sky;
    sky.skyRadiance = {0.4f, 0.5f, 0.7f};
    sky.sunAzimuth = 270.0;
    sky.sunElevation = 60.0;
    sky.sunIrradiance = {3.0f, 3.0f, 3.0f};
    KeyLight key;
    key.azimuth = 0.0;
    key.radiance = {0.5f, 1.0f, 0.5f};
    sky.keyLights = {key};
    return sky;
}

reference::Illumination illuminationOf(const SkyLight& sky)
{
    reference::Illumination illumination;
    illumination.light = sky;
    illumination.environment = [sky](const Vector3& d) -> reference::LinearRgb
    {
        const KeyLight& key = sky.keyLights.front();
        const double azimuth = std::atan2(d[0], d[1]) * 180.0 / pi;
        const double elevation = std::asin(std::clamp(d[2], -1.0, 1.0)) * 180.0 / pi;
        const bool lit = std::abs(azimuth) < 0.5 * key.width && elevation > key.lowest &&
                         elevation < key.highest;
        reference::LinearRgb radiance;
        for (std::size_t c = 0; c < 3; ++c)
            radiance[c] = double(sky.skyRadiance[c]) + (lit ? double(key.radiance[c]) : 0.0);
        return radiance;
    };
    return illumination;
}

/// Gives what a triangle over the valley receives, but for what comes straight from the sun.
void traceInTheValley(const DemTile& tile, const reference::Triangle& triangle,
                      const reference::Illumination& illumination,
                      const reference::PathTracerOptions& options, reference::LinearRgb& received)
{
    reference::SceneDescription scene;
    scene.tile = tile;
    scene.albedos = redInTheEast(tile.width(), tile.height());
    scene.triangles = {triangle};
    const auto tracer = reference::PathTracer::build(scene);
    ASSERT_TRUE(tracer.ok()) << tracer.error().message;
    reference::Receiver receiver;
    receiver.triangle = 0;
    const auto light = tracer->trace(illumination, {receiver}, options);
    ASSERT_TRUE(light.ok()) << light.error().message;
    received = light->front().sky.mean;
    for (const reference::Estimate& bounce : light->front().bounces)
        for (std::size_t c = 0; c < 3; ++c)
            received[c] += bounce.mean[c];
}
} // namespace

// Expected: closed form of a plain of albedo a under a sky L: L (1 + z) / 2 + a L (1 − z) / 2; of
// the lobe of exponent 8, L and a L straight up and down but for what its tail and order 6 leave.
// Bound: what the tile's end leaves dark, 1 m above it at 320 m.
TEST(LightProbe, OnAPlain)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    LightingSettings settings;
    settings.azimuths = 16;
    settings.albedo = {0.5f, 0.25f, 1.0f};
    const osg::ref_ptr<TileLight> lighting =
        new TileLight(analytic::plane(65, 65, 10.0, 100.0), settings, uniformSky());
    const ProbePlace place = probeAt(31.3, 32.8, 1.0);
    EXPECT_TRUE(lighting->setProbes({place}));
    EXPECT_FALSE(lighting->setProbes({place}));
    ASSERT_TRUE(lighting->update(state).ok());
    EXPECT_EQ(takeGlErrors(), "");
    for (const bool model : {false, true}) // the uniform sky; the same as a picture
    {
        SkyLight sky = uniformSky();
        if (model)
            for (const float c : sky.skyRadiance)
                sky.skyHarmonics = {{c, c, c}};
        if (model)
            for (std::size_t c = 0; c < 3; ++c)
                sky.skyHarmonics[0][c] =
                    sky.skyRadiance[c] * 2.0f * static_cast<float>(std::sqrt(pi));
        lighting->setSky(sky);
        ASSERT_TRUE(lighting->update(state).ok());
        double worst = 0.0;
        forEachTexel(state, *place.diffuse,
                     [&](const std::array<double, 3>& n, const float* rgba)
                     {
                         for (std::size_t c = 0; c < 3; ++c)
                         {
                             const double sent = double(settings.albedo[c]);
                             const double expected =
                                 double(sky.skyRadiance[c]) *
                                 (0.5 * (1.0 + n[2]) + sent * 0.5 * (1.0 - n[2]));
                             worst = std::max(worst, std::abs(double(rgba[c]) - expected));
                         }
                         EXPECT_EQ(rgba[3], 1.0f); // no sun
                     });
        std::printf("plain: greatest error %.2e\n", worst);
        EXPECT_LT(worst, 0.004);
        forEachTexel(state, *place.glossy,
                     [&](const std::array<double, 3>& n, const float* rgba)
                     {
                         if (std::abs(n[2]) > 0.9)
                         {
                             EXPECT_NEAR(rgba[0], n[2] > 0.0 ? 1.0f : 0.5f, 0.02f);
                         }
                     });
    }
    lighting->releaseGLObjects(&state);
}

// Expected: none without a probe; one for each change, and none where nothing changes.
TEST(LightProbe, RunsWhereSomethingHasChanged)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    LightingSettings settings;
    settings.azimuths = 8;
    SkyLight sky = uniformSky();
    const osg::ref_ptr<TileLight> lighting =
        new TileLight(analytic::plane(17, 17, 10.0, 0.0), settings, sky);
    ASSERT_TRUE(lighting->update(state).ok());
    for (const StageCost& cost : lighting->costs())
        EXPECT_NE(cost.name, "probe");
    const std::size_t bytes = lighting->bytes();
    const ProbePlace place = probeAt(8.0, 8.0, 1.0);
    unsigned runs = 0;
    const auto update = [&](unsigned expected)
    {
        ASSERT_TRUE(lighting->update(state).ok());
        EXPECT_FALSE(lighting->isDirty(state.getContextID()));
        runs += expected;
        EXPECT_EQ(probeRuns(*lighting), runs);
    };
    lighting->setProbes({place});
    update(1);
    EXPECT_GT(lighting->bytes(), bytes);
    update(0);
    sky.skyRadiance = {2.0f, 2.0f, 2.0f};
    lighting->setSky(sky);
    update(1);
    lighting->setHeights(std::vector<float>(17 * 17, 5.0f));
    update(1);
    ProbePlace moved = place;
    moved.column = 3.0;
    lighting->setProbes({moved, place});
    update(1);
    lighting->setProbes({});
    update(0);
    EXPECT_EQ(lighting->bytes(), bytes + 17 * 17 * 4); // the heights that were set
    lighting->releaseGLObjects(&state);
}

// Expected: the path tracer, which bounces once more than the ground's shading has. Bound: what is
// measured, in parts of the greatest value, and a quarter more.
TEST(LightProbe, InAValleyAgainstThePathTracer)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    constexpr int posts = 65;
    const DemTile tile = analytic::valley(posts, posts, 10.0, posts / 2, 1.0);
    LightingSettings settings;
    settings.bounces = 2;
    settings.azimuths = 32;
    const SkyLight sky = skyWithAKeyLight();
    const osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
    lighting->setAlbedo(redInTheEast(posts, posts));
    // Over the bottom's crease, where posts have other normals than the faces beside them; and over
    // a side.
    std::vector<ProbePlace> places = {
        probeAt(posts / 2, posts / 2, 30.0), probeAt(posts / 2, posts / 2, 150.0),
        probeAt(posts / 2 - 10, posts / 2, 2.0), probeAt(posts / 2, posts / 2, 2.0)};
    const std::array<double, 4> bounds = {0.045, 0.01, 0.02, 0.33};
    lighting->setProbes(places);
    const Status done = lighting->update(state);
    ASSERT_TRUE(done.ok()) << done.error().message;
    EXPECT_EQ(takeGlErrors(), "");

    const reference::Illumination illumination = illuminationOf(sky);
    reference::PathTracerOptions options;
    options.samples = 8192;
    options.bounces = settings.bounces + 1;
    for (std::size_t k = 0; k < places.size(); ++k)
    {
        const int column = static_cast<int>(places[k].column);
        const Vector3 at = {column * 10.0, posts / 2 * 10.0,
                            double(tile.heightAt(column, posts / 2)) + places[k].height};
        const std::vector<float> found = readCube(state, *places[k].diffuse);
        double greatest = 0.0, worst = 0.0, mean = 0.0;
        int count = 0;
        for (const int texel : {side / 2, side * side / 2 + side / 2 + 3})
            for (int face = 0; face < 6; ++face)
            {
                const auto n = directionOnCube(face, 2.0 * (texel % side + 0.5) / side - 1.0,
                                               2.0 * (texel / side % side + 0.5) / side - 1.0);
                reference::LinearRgb truth = {};
                ASSERT_NO_FATAL_FAILURE(
                    traceInTheValley(tile, facing(at, n), illumination, options, truth));
                const float* rgba =
                    &found[4 * static_cast<std::size_t>(face * side * side + texel)];
                for (std::size_t c = 0; c < 3; ++c)
                {
                    greatest = std::max(greatest, truth[c]);
                    worst = std::max(worst, std::abs(double(rgba[c]) - truth[c]));
                    mean += std::abs(double(rgba[c]) - truth[c]);
                    ++count;
                }
                EXPECT_EQ(rgba[3], 1.0f); // the sun stands over the valley's side
            }
        mean /= count;
        std::printf("valley, column %.0f, %.0f m up: greatest error %.2f %%, mean %.2f %% of the "
                    "greatest value\n",
                    places[k].column, places[k].height, 100.0 * worst / greatest,
                    100.0 * mean / greatest);
        EXPECT_LT(worst / greatest, bounds[k]);
    }
    // Redder towards the red side.
    const std::vector<float> low = readCube(state, *places[0].diffuse);
    const std::size_t middle = 4 * (side * side / 2 + side / 2);
    const float* east = &low[middle];
    const float* west = &low[4 * side * side + middle];
    EXPECT_GT(east[0] / east[1], 1.5f * west[0] / west[1]);
    lighting->releaseGLObjects(&state);
}

// Expected: half a disc at the horizon of a wall, as the ray's geometry says.
TEST(LightProbe, SunBehindAWall)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    LightingSettings settings;
    settings.azimuths = 8;
    SkyLight sky;
    sky.sunAzimuth = 90.0;
    sky.sunAngularRadius = 2.0;
    // Wall of 50 m, 100 m east of the probe, which is 10 m above the ground: from there 21.8
    // degrees.
    const osg::ref_ptr<TileLight> lighting =
        new TileLight(analytic::wall(33, 33, 10.0, 20, 50.0), settings, sky);
    const ProbePlace place = probeAt(10.0, 16.0, 10.0);
    lighting->setProbes({place});
    const double horizon = std::atan2(40.0, 100.0) * 180.0 / pi;
    for (const auto& [elevation, fraction, bound] : std::vector<std::array<double, 3>>{
             {horizon - 2.5, 0.0, 0.0}, {horizon, 0.5, 0.02}, {horizon + 2.5, 1.0, 0.0}})
    {
        sky.sunElevation = elevation;
        lighting->setSky(sky);
        ASSERT_TRUE(lighting->update(state).ok());
        EXPECT_NEAR(readCube(state, *place.glossy)[3], fraction, bound) << elevation;
    }
    lighting->releaseGLObjects(&state);
}

// Expected: the same light, however the ground's is computed: on a plain a sky in harmonics of band
// 0 is the uniform one. Bound: as OnAPlain.
TEST(LightProbe, WithTheOtherBounceMethods)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    LightingSettings settings;
    settings.azimuths = 16;
    settings.albedo = {0.5f, 0.5f, 0.5f};
    settings.bounceMethod = BounceMethod::Legendre;
    SkyLight sky = uniformSky();
    sky.skyHarmonics = {{3.5449077f, 3.5449077f, 3.5449077f}};
    const osg::ref_ptr<TileLight> lighting =
        new TileLight(analytic::plane(65, 65, 10.0, 0.0), settings, sky);
    const ProbePlace place = probeAt(32.0, 32.0, 1.0);
    lighting->setProbes({place});
    const Status done = lighting->update(state);
    ASSERT_TRUE(done.ok()) << done.error().message;
    EXPECT_EQ(takeGlErrors(), "");
    forEachTexel(state, *place.diffuse,
                 [&](const std::array<double, 3>& n, const float* rgba)
                 {
                     if (n[2] > 0.0) // what the scheme's order leaves of the ground's is its own
                     {
                         EXPECT_NEAR(double(rgba[0]), 0.75 + 0.25 * n[2], 0.02);
                     }
                 });
    lighting->releaseGLObjects(&state);
}
