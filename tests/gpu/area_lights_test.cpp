// Key lights, skies in spherical harmonics and computed skies.
#include "core/ClearSky.h"
#include "core/KeySlices.h"
#include "core/SkyRadiance.h"
#include "core/SyntheticTerrain.h"
#include "gpu/Textures.h"
#include "io/DemReader.h"
#include "lighting/TileLight.h"
#include "lighting/nodes/SkyTableNode.h"
#include "reference/PathTracer.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/PathErrors.h"
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

/// Real spherical harmonics from their definition (docs/CONVENTIONS.md), z of a unit direction.
double sphericalHarmonic(int l, int m, double z, double azimuth)
{
    const int order = std::abs(m);
    static const auto sizes = []
    {
        std::array<std::array<double, 4>, 4> found = {};
        for (int i = 0; i < 4; ++i)
            for (int k = 0; k <= i; ++k)
                found[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] =
                    std::sqrt((k == 0 ? 1.0 : 2.0) * (2 * i + 1) / (4.0 * pi) * factorial(i - k) /
                              factorial(i + k));
        return found;
    }();
    return sizes[static_cast<std::size_t>(l)][static_cast<std::size_t>(order)] *
           associatedLegendre(l, order, z) *
           (m == 0  ? 1.0
            : m > 0 ? std::cos(order * azimuth)
                    : std::sin(order * azimuth));
}

reference::LinearRgb radianceOf(const std::vector<Rgb>& harmonics, const reference::Vector3& d)
{
    reference::LinearRgb sum = {};
    const double azimuth = std::atan2(d[1], d[0]);
    const double z = std::clamp(d[2], -1.0, 1.0);
    for (int l = 0, i = 0; i < static_cast<int>(harmonics.size()); ++l)
        for (int m = -l; m <= l; ++m, ++i)
        {
            const double basis = sphericalHarmonic(l, m, z, azimuth);
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

osg::ref_ptr<TileLight> lit(osg::State& state, const DemTile& tile,
                            const LightingSettings& settings, const SkyLight& sky)
{
    const osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
    const Status done = lighting->update(state);
    EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
    return lighting;
}

Raster<osg::Vec4f> shadingOf(osg::State& state, const DemTile& tile, const SkyLight& sky,
                             const LightingSettings& settings = {})
{
    const osg::ref_ptr<TileLight> lighting = lit(state, tile, settings, sky);
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

namespace
{
/// Of a table of 32 slices: error over a slice's mean light, the worst of 60 slices, ends and
/// normals at random, or all of one slice. Expected: double quadrature of the slice, 16 azimuths ×
/// 1,000 zenith angles.
double worstOfTable(osg::State& state, const SkyLight& sky, int rows,
                    const std::function<reference::LinearRgb(const reference::Vector3&)>& radiance,
                    int slice = -1)
{
    constexpr int azimuths = 32;
    constexpr double width = 2.0 * pi / azimuths;
    const reference::LinearRgb whole = openIrradiance(radiance, {0.0, 0.0, 1.0});
    const osg::ref_ptr<TileInputs> inputs = new TileInputs;
    inputs->sky = sky;
    const osg::ref_ptr<SkyTableNode> pass = new SkyTableNode(*inputs, azimuths, rows);
    EXPECT_TRUE(pass->run(state).ok());
    const std::vector<float> texels = readFloats(state, *pass->table()->texture(), 4);
    pass->releaseGLObjects(&state);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    double worst = 0.0;
    for (int trial = 0; trial < 60; ++trial)
    {
        const int drawn = static_cast<int>(random() % azimuths);
        const int k = slice < 0 ? drawn : slice;
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
                const reference::LinearRgb light = radiance(d);
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
    return worst;
}

SkyLight clear(double turbidity, double elevation)
{
    SkyLight sky;
    sky.skyModel = SkyModel::Clear;
    sky.turbidity = turbidity;
    sky.sunAzimuth = 200.0;
    sky.sunElevation = elevation;
    return sky;
}
} // namespace

// What is printed chose the number of rows.
TEST(SkyTable, AgreesWithDoubleQuadrature)
{
    OTL_NEED_GL(context);
    SkyLight sky;
    sky.skyHarmonics = evening;
    for (const int rows : {16, 32, 64, 128, 256})
    {
        const double worst = worstOfTable(context->state(), sky, rows,
                                          [](const auto& d) { return radianceOf(evening, d); });
        std::cout << rows << " rows: worst error of a slice " << worst << " of its mean light\n";
        // Linear between rows, which errs by step²/8 times the second derivative, at most about 4.
        const double step = 0.5 * pi / rows;
        EXPECT_LT(worst, 0.5 * step * step + 1e-4);
    }
}

// The model's own functions in double; core and glsl tests hold those. Low suns are the hard ones:
// the sky is steep at the horizontal and about the sun, whose slice is asked for itself: in clear
// air with a sun at the horizontal it has many times the mean light. Bounds: as measured, and two
// fifths more.
TEST(SkyTable, OfModelsAgreesWithDoubleQuadrature)
{
    OTL_NEED_GL(context);
    SkyLight overcast;
    overcast.skyModel = SkyModel::Overcast;
    for (const int rows : {64, 128, 256})
    {
        const double flat = worstOfTable(context->state(), overcast, rows,
                                         [&](const auto& d) { return modelRadiance(overcast, d); });
        std::cout << rows << " rows, overcast: " << flat << '\n';
        EXPECT_LT(flat, rows == 64 ? 3e-4 : 1e-4);
        for (const double turbidity : {2.0, 10.0})
            for (const double elevation : {60.0, 20.0, 5.0, 0.0})
            {
                const SkyLight sky = clear(turbidity, elevation);
                const auto radiance =
                    [model = clearSky(sky)](const reference::Vector3& d) -> reference::LinearRgb
                {
                    const auto found = Glsl<double>().clearSkyRadiance(model, {d[0], d[1], d[2]});
                    return {found.x, found.y, found.z};
                };
                const int sunny = 22; // of 32, about 247.5° from east; the sun stands at 250°
                const double any = worstOfTable(context->state(), sky, rows, radiance);
                const double at = worstOfTable(context->state(), sky, rows, radiance, sunny);
                std::cout << rows << " rows, turbidity " << turbidity << ", sun at " << elevation
                          << ": worst error of a slice " << any << ", of the sun's " << at
                          << " of the mean light\n";
                EXPECT_LT(any, 1e-3);
                EXPECT_LT(at, rows == 64 ? 1e-2 : 3.1e-3);
            }
    }
}

// Expected: the model in double, at the middles of texels. What float leaves: sine and cosine of
// the texel's angles within 2^-20, and an exponential of up to four times that. Measured 1.9e-6.
TEST(SkyModelPass, IsTheModelInDouble)
{
    OTL_NEED_GL(context);
    std::vector<SkyLight> skies(2);
    skies[1].skyModel = SkyModel::Overcast;
    for (const double turbidity : {2.0, 3.0, 10.0})
        for (const double elevation : {90.0, 60.0, 5.0, 0.0, -4.0, -90.0})
            skies.push_back(clear(turbidity, elevation));
    // One pass for all: what one sky sets is not left over for the next.
    const osg::ref_ptr<TileInputs> inputs = new TileInputs;
    const osg::ref_ptr<SkyTableNode> pass = new SkyTableNode(*inputs, 16, 32);
    double worst = 0.0;
    for (const SkyLight& sky : skies)
    {
        inputs->sky = sky;
        ASSERT_TRUE(pass->run(context->state()).ok());
        const std::vector<float> texels =
            readFloats(context->state(), *pass->picture()->texture(), 4);
        const int columns = pass->picture()->layout().width;
        const auto model = clearSky(sky);
        double brightest = 0.0, difference = 0.0;
        for (int row = 0; row < 32; ++row)
            for (int column = 0; column < columns; ++column)
            {
                const double up = 0.5 * pi * (row + 0.5) / 32;
                const double around = 2.0 * pi * (column + 0.5) / columns;
                const std::array<double, 3> d = {std::cos(up) * std::cos(around),
                                                 std::cos(up) * std::sin(around), std::sin(up)};
                std::array<double, 3> expected = {};
                if (sky.skyModel == SkyModel::Clear)
                {
                    const auto found = Glsl<double>().clearSkyRadiance(model, {d[0], d[1], d[2]});
                    expected = {found.x, found.y, found.z};
                }
                else
                    expected = modelRadiance(sky, d);
                for (std::size_t c = 0; c < 3; ++c)
                {
                    const auto found = static_cast<double>(
                        texels[4 * static_cast<std::size_t>(row * columns + column) + c]);
                    ASSERT_TRUE(std::isfinite(found) && found >= 0.0);
                    brightest = std::max(brightest, expected[1]);
                    difference = std::max(difference, std::abs(found - expected[c]));
                }
            }
        worst = std::max(worst, difference / brightest);
    }
    std::cout << "worst " << worst << " of the brightest\n";
    EXPECT_LT(worst, 4e-6);
    pass->releaseGLObjects(&context->state());
    EXPECT_EQ(takeGlErrors(), "");
}

// 7 π / 9 of the zenith's radiance, over π; through the whole chain. As LevelGroundAndRamps below.
TEST(SkyModelPass, OvercastOnLevelGround)
{
    OTL_NEED_GL(context);
    LightingSettings settings;
    settings.azimuths = 64;
    SkyLight sky;
    sky.sunEnabled = false;
    sky.skyModel = SkyModel::Overcast;
    const auto level = shadingOf(context->state(), analytic::plane(9, 7, 10.0, 5.0), sky, settings);
    for (std::size_t c = 0; c < 3; ++c)
    {
        const double expected = 7.0 / 9.0 * static_cast<double>(sky.skyRadiance[c]);
        EXPECT_NEAR(static_cast<double>(level.at(4, 3)[static_cast<unsigned>(c)]), expected,
                    expected * (2.0 * halfError + 1e-4));
    }
}

// Level ground gets daylightOf(): the sky's, and the sun's times the sine. A low sun is in.
TEST(SkyModelPass, ClearDayOnLevelGround)
{
    OTL_NEED_GL(context);
    LightingSettings settings;
    settings.azimuths = 64;
    for (const double elevation : {60.0, 10.0, -3.0})
    {
        const SkyLight sky = clear(3.0, elevation);
        const auto level =
            shadingOf(context->state(), analytic::plane(9, 7, 10.0, 5.0), sky, settings);
        const Daylight day = daylightOf(3.0, elevation);
        for (std::size_t c = 0; c < 3; ++c)
        {
            const double sine = std::max(std::sin(elevation * radiansPerDegree), 0.0);
            const double expected =
                (day.sky[c] + day.sun[c] * sine) / pi * static_cast<double>(sky.sunIrradiance[c]);
            EXPECT_NEAR(static_cast<double>(level.at(4, 3)[static_cast<unsigned>(c)]), expected,
                        expected * (2.0 * halfError + 5e-4))
                << elevation;
        }
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
    const auto expected = shadingOf(context->state(), tile, uniform, settings);
    const auto found = shadingOf(context->state(), tile, harmonic, settings);
    double worst = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i)
        for (unsigned c = 0; c < 4; ++c)
            worst = std::max(worst, std::abs(static_cast<double>(found.values()[i][c] /
                                                                 expected.values()[i][c]) -
                                             1.0));
    std::cout << "worst difference " << worst << '\n';
    // Three half floats on either way, each within 2^-11; the table is within 1e-4.
    EXPECT_LT(worst, 6.0 * halfError + 2e-4);
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

// A plane, which may cut the light: with 4 slices, and with 15. Expected: openIrradiance(), whose
// steps end where the light does. Bounds: a half float's, and what clamping at the slices' middles
// was measured to cost, and half more.
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
            const double error = static_cast<double>(found.at(16, 16)[1]) / expected - 1.0;
            std::cout << "ramp " << east << ' ' << north << ", " << azimuths << ": " << error
                      << '\n';
            EXPECT_LT(std::abs(error), halfError + (azimuths == 32 ? 1e-3 : 1e-4));
        }
    }
}

namespace
{
struct Scene
{
    std::string name;
    std::function<DemTile()> tile;
    bool shared;
    SkyLight sky;
    /// Allowed relative root mean square of direct light and of the sum of two bounces.
    double direct, bounced;
};

std::ostream& operator<<(std::ostream& out, const Scene& scene)
{
    return out << scene.name;
}

DemTile fractal()
{
    return *generateTerrain(TerrainKind::Fractal, 96, 96, 30.0, 1);
}

/// The steepest there is, in very clear air.
SkyLight clearWithoutSun()
{
    SkyLight sky = clear(2.0, 10.0);
    sky.sunEnabled = false;
    return sky;
}

/// As if on a plane: the path tracer needs rows of one width.
DemTile halfDome()
{
    DemReadOptions options;
    options.window = PixelWindow{100, 100, 96, 96};
    Result<DemFile> dem = readDem(sharedData("dem/halfdome_1s.tif"), options);
    EXPECT_TRUE(dem.ok());
    dem->tile.eastSpacings = {dem->tile.nominalEastSpacing()};
    return dem->tile;
}

/// Where the sky is on, its light, otherwise that of the key lights.
reference::Illumination illuminationOf(const SkyLight& sky)
{
    reference::Illumination illumination;
    illumination.light = sky;
    illumination.light.skyEnabled = true;
    illumination.environment =
        [sky, model = clearSky(sky)](const reference::Vector3& d) -> reference::LinearRgb
    {
        if (sky.skyModel == SkyModel::Clear)
        {
            const auto found = Glsl<double>().clearSkyRadiance(model, {d[0], d[1], d[2]});
            return {found.x, found.y, found.z};
        }
        return sky.skyEnabled ? radianceOf(sky.skyHarmonics, d) : radianceOf(sky.keyLights, d);
    };
    illumination.importance = reference::importanceOf(illumination.environment, 720, 360);
    return illumination;
}
} // namespace

class AreaLightAccuracy : public testing::TestWithParam<Scene>
{
};

// Expected: the path tracer, whose own noise is subtracted in the mean square. Bounds: what is
// measured with the default settings and a fifth more, and no less than the noise.
TEST_P(AreaLightAccuracy, AgainstThePathTracer)
{
    OTL_NEED_GL(context);
    const Scene& scene = GetParam();
    if (scene.shared)
        OTL_SKIP_WITHOUT_SHARED_DATA();
    const DemTile tile = scene.tile();
    reference::SceneDescription description;
    description.tile = tile;
    description.albedo = {0.5f, 0.5f, 0.5f};
    const auto tracer = reference::PathTracer::build(description);
    ASSERT_TRUE(tracer.ok());
    const reference::Illumination illumination = illuminationOf(scene.sky);
    const auto receivers = randomReceivers(tile, 100);
    reference::PathTracerOptions options;
    options.samples = 1 << 16;
    options.bounces = 2;
    const auto truth = tracer->trace(illumination, receivers, options);
    ASSERT_TRUE(truth.ok()) << truth.error().message;

    for (const int azimuths : {16, 32, 64, 128})
    {
        LightingSettings settings;
        settings.azimuths = azimuths;
        std::vector<Raster<osg::Vec4f>> light = {
            shadingOf(context->state(), tile, scene.sky, settings)};
        for (settings.bounces = 1; azimuths == 32 && settings.bounces <= 2; ++settings.bounces)
        {
            const auto lighting = lit(context->state(), tile, settings, scene.sky);
            light.push_back(lighting->readBounce(context->state(), settings.bounces));
            lighting->releaseGLObjects(&context->state());
        }
        std::vector<double> sums(receivers.size()), expected(receivers.size()),
            variances(receivers.size());
        for (std::size_t order = 0; order < light.size(); ++order)
        {
            if (order == 1) // direct light by itself, then the sum of bounces
                sums = expected = variances = std::vector<double>(receivers.size());
            PathErrors errors;
            for (std::size_t i = 0; i < receivers.size(); ++i)
            {
                const reference::Estimate& estimate =
                    order == 0 ? (*truth)[i].sky : (*truth)[i].bounces[order - 1];
                sums[i] +=
                    static_cast<double>(light[order].at(receivers[i].column, receivers[i].row).g());
                expected[i] += estimate.mean[1];
                variances[i] += estimate.standardError[1] * estimate.standardError[1];
                errors.add(sums[i], expected[i], variances[i]);
            }
            std::cout << scene.name << ", " << azimuths << " azimuths, "
                      << TileLight::keyAzimuths(scene.sky, settings) << " of key lights, "
                      << (order == 0   ? "direct"
                          : order == 1 ? "1 bounce"
                                       : "2 bounces")
                      << ": " << errors << '\n';
            if (azimuths > 16) // what is less than the default is printed only
            {
                EXPECT_LE(errors.relativeRms(), order == 0 ? scene.direct : scene.bounced);
            }
            EXPECT_LE(errors.relativeNoise(), order == 0 ? scene.direct : scene.bounced);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, AreaLightAccuracy,
    testing::Values(Scene{"FractalKeyLights", fractal, false, keyOnly(studio), 0.0011, 0.0145},
                    Scene{"FractalOneKeyLight", fractal, false, keyOnly({studio[0]}), 0.0015,
                          0.026},
                    Scene{"FractalHarmonics", fractal, false, skyOf(evening), 0.0007, 0.0095},
                    Scene{"FractalClearSky", fractal, false, clearWithoutSun(), 0.0018, 0.012},
                    Scene{"HalfDomeKeyLights", halfDome, true, keyOnly(studio), 0.0004, 0.018},
                    Scene{"HalfDomeHarmonics", halfDome, true, skyOf(evening), 0.0004, 0.012}),
    [](const auto& each) { return each.param.name; });

// Sky, sun and key lights together are the sum of each alone, alpha is the sun's, and what had
// lights that are gone is what never had them, to the bit.
TEST(AreaLights, AddUpAndLeaveNothingBehind)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    DemTile tile = *generateTerrain(TerrainKind::Fractal, 53, 48, 30.0, 5);
    for (int column = 10; column < 20; ++column)
        tile.setVoid(column, 12);
    SkyLight plain;
    SkyLight all = plain;
    all.skyHarmonics = evening;
    all.keyLights = studio;
    SkyLight sunAlone = plain;
    sunAlone.skyEnabled = false;
    for (const int bounces : {0, 2})
    {
        LightingSettings settings;
        settings.bounces = bounces;
        const auto together = shadingOf(state, tile, all, settings);
        const auto sun = shadingOf(state, tile, sunAlone, settings);
        const auto sky = shadingOf(state, tile, skyOf(evening), settings);
        const auto key = shadingOf(state, tile, keyOnly(studio), settings);
        for (int row = 0; row < tile.height(); ++row)
            for (int column = 0; column < tile.width(); ++column)
            {
                const osg::Vec4f& light = together.at(column, row);
                ASSERT_EQ(light[3], sun.at(column, row)[3]);
                for (unsigned c = 0; c < 3; ++c)
                {
                    const float sum =
                        sun.at(column, row)[c] + sky.at(column, row)[c] + key.at(column, row)[c];
                    ASSERT_TRUE(std::isfinite(light[c]) && light[c] >= 0.0f);
                    // Each is rounded to half floats, and again after each bounce.
                    ASSERT_NEAR(light[c], sum,
                                2.0f * float(1 + 2 * bounces) * float(halfError) * sum + 1e-6f)
                        << bounces << " bounces at " << column << ", " << row;
                }
                if (!tile.isValid(column, row))
                {
                    ASSERT_EQ(light, osg::Vec4f());
                }
            }

        const auto before = shadingOf(state, tile, plain, settings);
        const osg::ref_ptr<TileLight> lighting = lit(state, tile, settings, all);
        EXPECT_EQ(lighting->readShading(state).values(), together.values());
        lighting->setSky(plain);
        ASSERT_TRUE(lighting->update(state).ok());
        EXPECT_EQ(lighting->readShading(state).values(), before.values());
        lighting->setSky(all);
        ASSERT_TRUE(lighting->update(state).ok());
        EXPECT_EQ(lighting->readShading(state).values(), together.values());
        lighting->releaseGLObjects(&state);
    }
}

// Nothing to light: no stage, no texture. A change of colour or elevation needs no horizon.
TEST(AreaLights, CostNothingWhereThereAreNone)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const DemTile tile = *generateTerrain(TerrainKind::Fractal, 33, 33, 30.0, 1);
    SkyLight plain;
    SkyLight nothing = plain; // no key light that lights, and harmonics of a sky that is off
    nothing.skyEnabled = false;
    nothing.skyHarmonics = evening;
    nothing.keyLights = {keyLight(0.0, 30.0, -50.0, 0.0, {1.0f, 1.0f, 1.0f}),
                         keyLight(0.0, 30.0, 10.0, 50.0, {0.0f, 0.0f, 0.0f})};
    for (const SkyLight& sky : {plain, nothing})
    {
        const osg::ref_ptr<TileLight> lighting = lit(state, tile, {}, sky);
        for (const char* name : {"table", "key"})
        {
            EXPECT_EQ(stage(lighting->costs(), name).dispatches, 0u);
            EXPECT_EQ(stage(lighting->costs(), name).bytes, 0u);
        }
        lighting->releaseGLObjects(&state);
    }
    SkyLight keyed = plain;
    keyed.skyHarmonics = evening;
    keyed.keyLights = studio;
    const osg::ref_ptr<TileLight> lighting = lit(state, tile, {}, keyed);
    keyed.keyLights[0].radiance = {1.0f, 2.0f, 3.0f};
    keyed.keyLights[1].highest = 60.0;
    lighting->setSky(keyed);
    ASSERT_TRUE(lighting->update(state).ok());
    EXPECT_EQ(stage(lighting->costs(), "key").dispatches, 1u);
    EXPECT_EQ(stage(lighting->costs(), "table").dispatches, 1u);
    EXPECT_EQ(stage(lighting->costs(), "sky").dispatches, 1u);
    EXPECT_EQ(stage(lighting->costs(), "shade").dispatches, 2u);
    EXPECT_EQ(lighting->readShading(state).values(), shadingOf(state, tile, keyed).values());
    keyed.keyLights[0].azimuth += 1.0;
    keyed.skyHarmonics[3][1] += 0.5f;
    lighting->setSky(keyed);
    ASSERT_TRUE(lighting->update(state).ok());
    EXPECT_EQ(stage(lighting->costs(), "key").dispatches, 2u);
    EXPECT_EQ(stage(lighting->costs(), "table").dispatches, 2u);
    EXPECT_EQ(stage(lighting->costs(), "sky").dispatches, 2u);
    EXPECT_EQ(lighting->readShading(state).values(), shadingOf(state, tile, keyed).values());
    lighting->setSky(plain);
    ASSERT_TRUE(lighting->update(state).ok());
    for (const char* name : {"table", "key"})
        EXPECT_EQ(stage(lighting->costs(), name).bytes, 0u);
    EXPECT_EQ(lighting->readShading(state).values(), shadingOf(state, tile, plain).values());
    lighting->releaseGLObjects(&state);
}

// A full circle of one radiance from the horizontal to the zenith is the uniform sky, by other
// horizons: of midpoints. On the bottom of a pit all of them are 45°. Radiance below 0 counts as it
// is: the negative of a sky is the negative of its light.
TEST(AreaLights, LimitsThatAreKnown)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const DemTile pit = analytic::pit(81, 81, 1.0, 40, 40, 30.0);
    SkyLight uniform = keyOnly({});
    uniform.skyEnabled = true;
    uniform.skyRadiance = {1.0f, 1.0f, 1.0f};
    const SkyLight circle = keyOnly({keyLight(33.0, 360.0, -90.0, 90.0, {1.0f, 1.0f, 1.0f})});
    const float sky = shadingOf(state, pit, uniform).at(40, 40)[0];
    const float key = shadingOf(state, pit, circle).at(40, 40)[0];
    EXPECT_NEAR(key, sky, 0.002f);
    // And only what is above the wall's edge counts.
    const SkyLight low = keyOnly({keyLight(0.0, 360.0, 0.0, 44.0, {1.0f, 1.0f, 1.0f})});
    EXPECT_EQ(shadingOf(state, pit, low).at(40, 40)[0], 0.0f);
    const SkyLight high = keyOnly({keyLight(0.0, 360.0, 46.0, 90.0, {1.0f, 1.0f, 1.0f})});
    const double sine = std::sin(46.0 * radiansPerDegree);
    EXPECT_NEAR(static_cast<double>(shadingOf(state, pit, high).at(40, 40)[0]), 1.0 - sine * sine,
                halfError);

    std::vector<Rgb> negative = evening;
    for (Rgb& coefficient : negative)
        for (float& channel : coefficient)
            channel = -channel;
    const DemTile tile = *generateTerrain(TerrainKind::Cliffs, 40, 41, 30.0, 3);
    LightingSettings settings;
    settings.bounces = 1;
    const auto light = shadingOf(state, tile, skyOf(evening), settings);
    const auto opposite = shadingOf(state, tile, skyOf(negative), settings);
    for (std::size_t i = 0; i < light.size(); ++i)
        for (unsigned c = 0; c < 3; ++c)
            ASSERT_EQ(light.values()[i][c], -opposite.values()[i][c]);
    EXPECT_EQ(takeGlErrors(), "");
}
