// Key lights and skies in spherical harmonics.
#include "core/KeySlices.h"
#include "core/SyntheticTerrain.h"
#include "gpu/Textures.h"
#include "gpu/passes/SkyTablePass.h"
#include "io/DemReader.h"
#include "reference/PathTracer.h"
#include "scene/TileLighting.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/SharedData.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double radiansPerDegree = pi / 180.0;
/// Of a half float that is rounded to the nearest.
const double halfError = std::exp2(-11.0);

/// P_lm(z) without the sign (-1)^m, by the recurrences (Abramowitz and Stegun, 8.5).
double associatedLegendre(int l, int m, double z)
{
    double diagonal = 1.0;
    for (int i = 1; i <= m; ++i)
        diagonal *= (2 * i - 1) * std::sqrt(1.0 - z * z);
    double last = 0.0, now = diagonal;
    for (int i = m; i < l; ++i)
    {
        const double next = ((2 * i + 1) * z * now - (i + m) * last) / (i - m + 1);
        last = now;
        now = next;
    }
    return now;
}

double factorial(int n)
{
    return n < 2 ? 1.0 : n * factorial(n - 1);
}

/// Real spherical harmonics from their definition (docs/CONVENTIONS.md).
double sphericalHarmonic(int l, int m, const reference::Vector3& d)
{
    const int order = std::abs(m);
    const double size =
        std::sqrt((2 * l + 1) / (4.0 * pi) * factorial(l - order) / factorial(l + order));
    const double azimuth = std::atan2(d[1], d[0]);
    return size * associatedLegendre(l, order, d[2]) *
           (m == 0  ? 1.0
            : m > 0 ? std::sqrt(2.0) * std::cos(order * azimuth)
                    : std::sqrt(2.0) * std::sin(order * azimuth));
}

reference::LinearRgb radianceOf(const std::vector<Rgb>& harmonics, const reference::Vector3& d)
{
    reference::LinearRgb sum = {};
    for (int l = 0, i = 0; i < static_cast<int>(harmonics.size()); ++l)
        for (int m = -l; m <= l; ++m, ++i)
        {
            const double basis = sphericalHarmonic(l, m, d);
            for (std::size_t c = 0; c < 3; ++c)
                sum[c] += static_cast<double>(harmonics[static_cast<std::size_t>(i)][c]) * basis;
        }
    return sum;
}

reference::LinearRgb radianceOf(const std::vector<KeyLight>& keys, const reference::Vector3& d)
{
    reference::LinearRgb sum = {};
    const double elevation = std::asin(std::clamp(d[2], -1.0, 1.0)) / radiansPerDegree;
    const double azimuth = std::atan2(d[0], d[1]) / radiansPerDegree;
    for (const KeyLight& key : keys)
        if (elevation >= key.lowest && elevation <= key.highest &&
            std::abs(std::remainder(azimuth - key.azimuth, 360.0)) <= 0.5 * key.width)
            for (std::size_t c = 0; c < 3; ++c)
                sum[c] += static_cast<double>(key.radiance[c]);
    return sum;
}

/// Irradiance / π of a surface above which nothing stands, from above the horizontal: midpoints of
/// steps of 0.25°.
reference::LinearRgb
openIrradiance(const std::function<reference::LinearRgb(const reference::Vector3&)>& radiance,
               const reference::Vector3& normal)
{
    constexpr int rows = 360;
    constexpr int columns = 1440;
    reference::LinearRgb sum = {};
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
        {
            const double elevation = 0.5 * pi * (row + 0.5) / rows;
            const double azimuth = 2.0 * pi * (column + 0.5) / columns;
            const reference::Vector3 d = {std::cos(elevation) * std::cos(azimuth),
                                          std::cos(elevation) * std::sin(azimuth),
                                          std::sin(elevation)};
            const double cosine = d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2];
            if (cosine <= 0.0)
                continue;
            const double weight =
                cosine * std::cos(elevation) * (0.5 * pi / rows) * (2.0 * pi / columns) / pi;
            const reference::LinearRgb light = radiance(d);
            for (std::size_t c = 0; c < 3; ++c)
                sum[c] += light[c] * weight;
        }
    return sum;
}

/// Bluer towards the zenith, brightest and reddest in the west; positive above the horizontal.
const std::vector<Rgb> evening = {
    {1.2f, 1.1f, 1.2f},   {0.1f, 0.05f, 0.0f},  {-0.1f, 0.0f, 0.2f},  {-0.45f, -0.3f, -0.1f},
    {0.05f, 0.0f, 0.0f},  {-0.1f, 0.0f, 0.05f}, {0.0f, 0.05f, 0.1f},  {0.1f, 0.1f, 0.05f},
    {0.15f, 0.1f, 0.0f},  {0.02f, 0.0f, 0.01f}, {0.0f, 0.03f, 0.0f},  {-0.05f, 0.0f, 0.02f},
    {0.04f, 0.0f, 0.02f}, {0.05f, 0.02f, 0.0f}, {-0.03f, 0.0f, 0.0f}, {-0.05f, -0.02f, 0.0f}};

SkyLight skyOf(const std::vector<Rgb>& harmonics)
{
    SkyLight sky;
    sky.sunEnabled = false;
    sky.skyHarmonics = harmonics;
    return sky;
}

SkyLight keyOnly(const std::vector<KeyLight>& keys)
{
    SkyLight sky;
    sky.sunEnabled = sky.skyEnabled = false;
    sky.keyLights = keys;
    return sky;
}

KeyLight keyLight(double azimuth, double width, double lowest, double highest, Rgb radiance)
{
    KeyLight key;
    key.azimuth = azimuth;
    key.width = width;
    key.lowest = lowest;
    key.highest = highest;
    key.radiance = radiance;
    return key;
}

/// A low warm one, a high cold one, and one that is partly below the horizontal.
const std::vector<KeyLight> studio = {keyLight(300.0, 30.0, 15.0, 40.0, {6.0f, 4.0f, 2.0f}),
                                      keyLight(80.0, 60.0, 40.0, 80.0, {0.5f, 0.7f, 1.0f}),
                                      keyLight(190.0, 20.0, -10.0, 12.0, {1.0f, 1.0f, 1.0f})};

osg::ref_ptr<TileLighting> lit(osg::State& state, const DemTile& tile,
                               const LightingSettings& settings, const SkyLight& sky)
{
    const osg::ref_ptr<TileLighting> lighting = new TileLighting(tile, settings, sky);
    const Status done = lighting->update(state);
    EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
    return lighting;
}

Raster<osg::Vec4f> shadingOf(osg::State& state, const DemTile& tile, const SkyLight& sky,
                             const LightingSettings& settings = {})
{
    const osg::ref_ptr<TileLighting> lighting = lit(state, tile, settings, sky);
    Raster<osg::Vec4f> shading = lighting->readShading(state);
    lighting->releaseGLObjects(&state);
    return shading;
}

const StageCost& stage(const std::vector<StageCost>& costs, const std::string& name)
{
    const auto found = std::find_if(costs.begin(), costs.end(),
                                    [&](const StageCost& cost) { return cost.name == name; });
    EXPECT_NE(found, costs.end()) << name;
    return *found;
}
} // namespace

// Expected: double quadrature of each slice, 64 azimuths × 2,000 zenith angles per slice, normals
// and horizons at random. What is printed chose the number of rows.
TEST(SkyTable, AgreesWithDoubleQuadrature)
{
    OTL_NEED_GL(context);
    constexpr int azimuths = 32;
    constexpr double width = 2.0 * pi / azimuths;
    const reference::LinearRgb whole =
        openIrradiance([](const auto& d) { return radianceOf(evening, d); }, {0.0, 0.0, 1.0});
    for (const int rows : {16, 32, 64, 128, 256})
    {
        const osg::ref_ptr<SkyTablePass> pass = new SkyTablePass(azimuths, rows);
        ASSERT_TRUE(pass->dispatch(context->state(), evening).ok());
        const std::vector<float> texels = readFloats(context->state(), *pass->table(), 4);
        std::mt19937 random(7);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        double worst = 0.0;
        for (int trial = 0; trial < 60; ++trial)
        {
            const int k = static_cast<int>(random() % azimuths);
            const double end = 0.5 * pi * unit(random); // zenith angle
            const double steep = std::acos(1.0 - 0.9 * unit(random));
            const double turn = 2.0 * pi * unit(random);
            const reference::Vector3 normal = {std::sin(steep) * std::cos(turn),
                                               std::sin(steep) * std::sin(turn), std::cos(steep)};
            reference::LinearRgb expected = {};
            constexpr int across = 16;
            constexpr int along = 1000;
            for (int i = 0; i < across; ++i)
                for (int j = 0; j < along; ++j)
                {
                    const double phi = width * (k - 0.5 + (i + 0.5) / across);
                    const double theta = end * (j + 0.5) / along;
                    const reference::Vector3 d = {std::sin(theta) * std::cos(phi),
                                                  std::sin(theta) * std::sin(phi), std::cos(theta)};
                    const double weight = (d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2]) *
                                          std::sin(theta) * (width / across) * (end / along) / pi;
                    const reference::LinearRgb light = radianceOf(evening, d);
                    for (std::size_t c = 0; c < 3; ++c)
                        expected[c] += light[c] * weight;
                }
            const double place = end / (0.5 * pi) * rows;
            const int row = std::min(static_cast<int>(place), rows - 1);
            for (std::size_t c = 0; c < 3; ++c)
            {
                double found = 0.0;
                for (std::size_t axis = 0; axis < 3; ++axis)
                {
                    const auto at = [&](int y)
                    {
                        return static_cast<double>(
                            texels[4 * static_cast<std::size_t>(
                                           (static_cast<int>(c) * (rows + 1) + y) * azimuths + k) +
                                   axis]);
                    };
                    found += normal[axis] * (at(row) + (at(row + 1) - at(row)) * (place - row));
                }
                // A slice's part of what level ground gets.
                worst = std::max(worst, std::abs(found - expected[c]) * azimuths / whole[c]);
            }
        }
        std::cout << rows << " rows: worst error of a slice " << worst << " of its mean light\n";
        // Linear between rows, which errs by step²/8 times the second derivative, at most about 4.
        const double step = 0.5 * pi / rows;
        EXPECT_LT(worst, 0.5 * step * step + 1e-4);
        pass->releaseGLObjects(&context->state());
    }
}

// Level ground: an integral over the hemisphere of radiance times z, (l, 0) alone counts, and is
// π, 2π/3, π/4, 0 times √((2 l + 1)/4π). Ramps: openIrradiance(). With 64 azimuths the slices'
// clamping at their middles costs 0.04 % (MATHS), and what is stored are two roundings to half
// floats.
TEST(SkyHarmonics, LevelGroundAndRamps)
{
    OTL_NEED_GL(context);
    LightingSettings settings;
    settings.azimuths = 64;
    const SkyLight sky = skyOf(evening);
    const auto level = shadingOf(context->state(), analytic::plane(9, 7, 10.0, 5.0), sky, settings);
    for (std::size_t c = 0; c < 3; ++c)
    {
        const double expected =
            static_cast<double>(evening[0][c]) * std::sqrt(1.0 / (4.0 * pi)) +
            static_cast<double>(evening[2][c]) * std::sqrt(3.0 / (4.0 * pi)) * 2.0 / 3.0 +
            static_cast<double>(evening[6][c]) * std::sqrt(5.0 / (4.0 * pi)) / 4.0;
        EXPECT_NEAR(static_cast<double>(level.at(4, 3)[static_cast<unsigned>(c)]), expected,
                    expected * (2.0 * halfError + 1e-4));
    }
    for (const auto& [east, north] : {std::pair{0.5, 0.0}, {-0.6, 0.3}, {0.2, -1.5}})
    {
        const double size = std::sqrt(1.0 + east * east + north * north);
        const reference::LinearRgb expected =
            openIrradiance([](const auto& d) { return radianceOf(evening, d); },
                           {-east / size, -north / size, 1.0 / size});
        const auto found =
            shadingOf(context->state(), analytic::ramp(33, 33, 10.0, east, north), sky, settings);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(static_cast<double>(found.at(16, 16)[static_cast<unsigned>(c)]),
                        expected[c], expected[c] * (2.0 * halfError + 6e-4))
                << east << ' ' << north << ' ' << c;
    }
}

// One coefficient is a uniform sky of 0.2821 times it: the scalar path, which shares no table.
TEST(SkyHarmonics, OneCoefficientIsAUniformSky)
{
    OTL_NEED_GL(context);
    const DemTile tile = *generateTerrain(TerrainKind::Fractal, 61, 64, 30.0, 5);
    LightingSettings settings;
    settings.bounces = 2;
    SkyLight uniform;
    uniform.skyRadiance = {0.5f, 1.0f, 0.25f};
    SkyLight harmonic = uniform;
    const float size = static_cast<float>(std::sqrt(4.0 * pi));
    harmonic.skyHarmonics = {{0.5f * size, size, 0.25f * size}};
    for (const int subsampling : {1, 2})
    {
        settings.subsampling = subsampling;
        const auto expected = shadingOf(context->state(), tile, uniform, settings);
        const auto found = shadingOf(context->state(), tile, harmonic, settings);
        double worst = 0.0;
        for (std::size_t i = 0; i < found.size(); ++i)
            for (unsigned c = 0; c < 4; ++c)
                worst = std::max(worst, std::abs(static_cast<double>(found.values()[i][c] /
                                                                     expected.values()[i][c]) -
                                                 1.0));
        std::cout << "subsampling " << subsampling << ": worst difference " << worst << '\n';
        // Three half floats on either way, each within 2^-11; the table is within 1e-4.
        EXPECT_LT(worst, 6.0 * halfError + 2e-4);
    }
}

// radiance (sin² highest − sin² lowest) / 2 · width, over π.
TEST(KeyLights, LevelGround)
{
    OTL_NEED_GL(context);
    const DemTile tile = analytic::plane(7, 9, 10.0, 100.0);
    for (const KeyLight& key :
         {studio[0], studio[1], studio[2], keyLight(17.0, 360.0, 70.0, 90.0, {1.0f, 2.0f, 3.0f}),
          keyLight(-45.0, 200.0, -90.0, 90.0, {1.0f, 0.5f, 0.0f}),
          keyLight(360.0, 0.1, 30.0, 30.5, {1000.0f, 2000.0f, 500.0f})})
    {
        const auto found = shadingOf(context->state(), tile, keyOnly({key}));
        const double low = std::sin(std::max(key.lowest, 0.0) * radiansPerDegree);
        const double high = std::sin(key.highest * radiansPerDegree);
        const double share = 0.5 * (high * high - low * low) * key.width * radiansPerDegree / pi;
        for (unsigned c = 0; c < 3; ++c)
            EXPECT_NEAR(static_cast<double>(found.at(3, 4)[c]),
                        share * static_cast<double>(key.radiance[c]),
                        share * static_cast<double>(key.radiance[c]) * (halfError + 2e-5))
                << key.azimuth;
        EXPECT_EQ(found.at(3, 4)[3], 1.0f) << "the sun is off";
    }
}

// A plane that faces the light: it sees all of it. Expected: openIrradiance(), whose steps cut a
// light's edges: those of 1° and more by 0.25°/2 on either side at most.
TEST(KeyLights, Ramps)
{
    OTL_NEED_GL(context);
    const KeyLight key = keyLight(90.0, 40.0, 20.0, 50.0, {1.0f, 1.0f, 1.0f});
    for (const auto& [east, north] : {std::pair{-0.5, 0.0}, {0.3, 0.3}, {0.8, 0.0}, {0.3, -0.8}})
    {
        const double size = std::sqrt(1.0 + east * east + north * north);
        const double expected = openIrradiance([&](const auto& d) { return radianceOf({key}, d); },
                                               {-east / size, -north / size, 1.0 / size})[1];
        for (const int azimuths : {32, 128})
        {
            LightingSettings settings;
            settings.azimuths = azimuths;
            const auto found =
                shadingOf(context->state(), analytic::ramp(33, 33, 10.0, east, north),
                          keyOnly({key}), settings);
            std::cout << "ramp " << east << ' ' << north << ", " << azimuths << ": "
                      << static_cast<double>(found.at(16, 16)[1]) / expected - 1.0 << '\n';
        }
    }
}
