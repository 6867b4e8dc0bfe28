// Direct light by the scheme of Nowrouzezahrai and Snyder 2009, on the GPU: against closed forms,
// against the same scheme in double (support/LegendreReference.h), and against exhaustive horizons
// projected onto spherical harmonics of order 4. Subsampling against none, and the memory of it
// all.
#include "core/SyntheticTerrain.h"
#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "lighting/TileLight.h"
#include "lighting/nodes/LegendreDirectNode.h"
#include "reference/ExhaustiveHorizon.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/LegendreReference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <vector>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing::legendre;

namespace
{
using Shading = Raster<osg::Vec4f>;

Shading lit(osg::State& state, const DemTile& tile, const SkyLight& sky,
            const LegendreScheme& scheme)
{
    const osg::ref_ptr<TileInputs> inputs = new TileInputs;
    inputs->sky = sky;
    const osg::ref_ptr<TileSurface> surface = new TileSurface(tile, 1);
    const osg::ref_ptr<PyramidNode> pyramid = new PyramidNode(*surface);
    const osg::ref_ptr<Resource> shading =
        new Resource("shading", surface->perPost(GL_RGBA16F_ARB));
    WorkGraph graph;
    Status done =
        graph.declare({pyramid, new LegendreDirectNode(*inputs, *pyramid, scheme, shading)});
    if (done)
        done = graph.run(state);
    EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
    EXPECT_EQ(takeGlErrors(), "");
    const std::vector<float> values = readFloats(state, *shading->texture(), 4);
    Shading colours(tile.width(), tile.height());
    for (std::size_t i = 0; i < colours.size(); ++i)
        colours.values()[i] =
            osg::Vec4f(values[4 * i], values[4 * i + 1], values[4 * i + 2], values[4 * i + 3]);
    return colours;
}

SkyLight noLight()
{
    SkyLight sky;
    sky.skyEnabled = sky.sunEnabled = false;
    return sky;
}

SkyLight whiteSky()
{
    SkyLight sky = noLight();
    sky.skyEnabled = true;
    sky.skyRadiance = {1.0f, 0.5f, 0.25f};
    return sky;
}

SkyLight keyLight(double azimuth, double width, double lowest, double highest)
{
    SkyLight sky = noLight();
    KeyLight light;
    light.azimuth = azimuth;
    light.width = width;
    light.lowest = lowest;
    light.highest = highest;
    light.radiance = {4.0f, 2.0f, 1.0f};
    sky.keyLights = {light};
    return sky;
}

/// Order 4 of the clamped cosine at z = cos of the angle from the normal: bands 0, 1 and 2.
double cosineOfOrder4(double z)
{
    return 0.25 + 0.5 * z + 5.0 / 32.0 * (3.0 * z * z - 1.0);
}

/// Its integral from 0.
double cosineIntegral(double z)
{
    return 0.25 * z + 0.25 * z * z + 5.0 / 32.0 * (z * z * z - z);
}

double luminance(const osg::Vec4f& c)
{
    return static_cast<double>(c.x());
}

/// Half floats: 2^-11 of the value.
constexpr double halfRounding = 1.0 / 2048.0;

using Harmonics = std::array<double, 16>;

std::size_t place(int l, int m)
{
    return static_cast<std::size_t>(l * (l + 1) + m);
}

double harmonic(int l, int m, double z, double azimuth)
{
    const int order = std::abs(m);
    return elevationPart(l, order, z) *
           (m < 0 ? std::sin(order * azimuth) : std::cos(order * azimuth));
}

/// ∫ over the sphere of sky times visible times the cosine of order 4 about the normal, over π.
double irradianceOf(const Harmonics& sky, const Harmonics& visible, const Vec3& normal)
{
    constexpr int rings = 200; // h²/24 times the change of the derivative, below 10: 4e-5
    constexpr int turns = 16;  // exact: at most 8 turns of azimuth
    double sum = 0.0;
    for (int ring = 0; ring < rings; ++ring)
        for (int turn = 0; turn < turns; ++turn)
        {
            const double z = 2.0 * (ring + 0.5) / rings - 1.0;
            const double azimuth = 2.0 * pi * turn / turns;
            double radiance = 0.0;
            double seen = 0.0;
            for (int l = 0; l < 4; ++l)
                for (int m = -l; m <= l; ++m)
                {
                    const double basis = harmonic(l, m, z, azimuth);
                    radiance += sky[place(l, m)] * basis;
                    seen += visible[place(l, m)] * basis;
                }
            const double side = std::sqrt(1.0 - z * z);
            sum += radiance * seen *
                   cosineOfOrder4(normal[0] * side * std::cos(azimuth) +
                                  normal[1] * side * std::sin(azimuth) + normal[2] * z);
        }
    return sum * 4.0 * pi / (rings * turns) / pi;
}

Harmonics constantSky()
{
    Harmonics sky = {};
    sky[0] = std::sqrt(4.0 * pi);
    return sky;
}

/// The scheme's visibility at a post, in double.
class Visibility
{
public:
    Visibility(const DemTile& tile, const LegendreScheme& scheme)
        : _scheme(scheme), _scene(tile, Colours(tile.width(), tile.height(), {1.0f, 1.0f, 1.0f}))
    {
        const int reach = std::max(tile.width(), tile.height()) - 1;
        for (int i = 0; std::exp2(i / scheme.rays.samplesPerOctave) <= reach; ++i)
            _distances.push_back(std::exp2(i / scheme.rays.samplesPerOctave));
        for (int l = 0; l < 4; ++l)
            for (int m = 0; m <= l; ++m)
                for (unsigned c = 0; c < 4; ++c)
                    _overlaps[static_cast<std::size_t>(l)][static_cast<std::size_t>(m)][c] =
                        overlap(l, m, c);
    }

    Vec3 normal(int x, int y) const { return _scene.normal(x, y); }

    /// Sine of the horizon's elevation, at least 0. Of light 1 all over, what lies between two
    /// elevations is the difference of their sines.
    double horizon(int x, int y, double azimuth) const
    {
        const Vec3 n = normal(x, y);
        const double own =
            std::sin(std::atan(-(n[0] * std::cos(azimuth) + n[1] * std::sin(azimuth)) / n[2]));
        return std::max(own + _scene.received(x, y, azimuth, n, _distances, _scheme.rays.offset,
                                              [](double sine) { return sine; }),
                        0.0);
    }

    /// Of slices between two sines, at azimuths, each with its share of the circle.
    Harmonics visible(int x, int y, const std::vector<double>& azimuths, double lowest,
                      double highest,
                      const std::function<std::array<double, 2>(std::size_t, int)>& share) const
    {
        Harmonics sum = {};
        for (std::size_t k = 0; k < azimuths.size(); ++k)
        {
            const double from = std::max(horizon(x, y, azimuths[k]), lowest);
            if (from >= highest)
                continue;
            for (int l = 0; l < 4; ++l)
                for (int m = 0; m <= l; ++m)
                {
                    double part = 0.0;
                    for (unsigned c = 0; c < 4; ++c)
                        part +=
                            _overlaps[static_cast<std::size_t>(l)][static_cast<std::size_t>(m)][c] *
                            (polynomialIntegral(c, highest) - polynomialIntegral(c, from));
                    const auto [cosine, sine] = share(k, m);
                    sum[place(l, m)] += part * cosine;
                    if (m > 0)
                        sum[place(l, -m)] += part * sine;
                }
        }
        return sum;
    }

    /// All around.
    Harmonics visible(int x, int y) const
    {
        const double spacing = 2.0 * pi / _scheme.azimuths;
        std::vector<double> azimuths;
        for (int k = 0; k < _scheme.azimuths; ++k)
            azimuths.push_back(spacing * k);
        return visible(
            x, y, azimuths, 0.0, 1.0,
            [&](std::size_t k, int m) -> std::array<double, 2>
            {
                const double half = 0.5 * m * spacing;
                const double left =
                    spacing * std::pow(m == 0 ? 1.0 : std::sin(half) / half,
                                       _scheme.blend == AzimuthBlend::Linear ? 2 : 4);
                return {left * std::cos(m * azimuths[k]), left * std::sin(m * azimuths[k])};
            });
    }

    /// Of a light between two elevations and azimuths [rad, counter-clockwise from east], by slices
    /// that are joined linearly: the integral of each one's hat, by the midpoint rule.
    Harmonics visibleOf(int x, int y, double first, double last, int slices, double lowest,
                        double highest) const
    {
        const double spacing = (last - first) / (slices - 1);
        std::vector<double> azimuths;
        for (int k = 0; k < slices; ++k)
            azimuths.push_back(first + spacing * k);
        return visible(x, y, azimuths, std::sin(lowest), std::sin(highest),
                       [&](std::size_t k, int m) -> std::array<double, 2>
                       {
                           constexpr int steps = 2000;
                           std::array<double, 2> sum = {};
                           for (int i = 0; i < steps; ++i)
                           {
                               const double azimuth = first + (last - first) * (i + 0.5) / steps;
                               const double hat =
                                   std::max(0.0, 1.0 - std::abs(azimuth - azimuths[k]) / spacing);
                               sum[0] += hat * std::cos(m * azimuth) * (last - first) / steps;
                               sum[1] += hat * std::sin(m * azimuth) * (last - first) / steps;
                           }
                           return sum;
                       });
    }

private:
    LegendreScheme _scheme;
    Scene _scene;
    std::vector<double> _distances;
    std::array<std::array<Slice, 4>, 4> _overlaps = {};
};

/// Irradiance / π, in harmonics of order 4 and without a detour, of a light of radiance 1 between
/// two elevations and azimuths that exhaustive horizons leave visible. The horizon of each slice is
/// constant across it.
double truth(const DemTile& tile, const Vec3& normal, int x, int y, double first, double last,
             int slices, double lowest, double highest)
{
    double sum = 0.0;
    for (int k = 0; k < slices; ++k)
    {
        const double azimuth = first + (last - first) * (k + 0.5) / slices;
        const reference::Horizon horizon =
            reference::exhaustiveHorizon(tile, x, y, {std::cos(azimuth), std::sin(azimuth)});
        const double from =
            std::max({std::sin(horizon.elevationDegrees() * pi / 180.0), std::sin(lowest), 0.0});
        const double to = std::sin(highest);
        if (from >= to)
            continue;
        constexpr int steps = 128;
        for (int i = 0; i < steps; ++i)
        {
            const double z = from + (to - from) * (i + 0.5) / steps;
            const double side = std::sqrt(1.0 - z * z);
            sum += cosineOfOrder4(normal[0] * side * std::cos(azimuth) +
                                  normal[1] * side * std::sin(azimuth) + normal[2] * z) *
                   (to - from) / steps;
        }
    }
    return sum * (last - first) / slices / pi;
}

DemTile fractal(int width, int height, std::uint32_t seed = 3)
{
    return generateTerrain(TerrainKind::Fractal, width, height, 30.0, seed).value();
}

constexpr double degree = pi / 180.0;
} // namespace

TEST(LegendreDirect, PlainHasClosedForms)
{
    OTL_NEED_GL(context);
    const DemTile tile = analytic::plane(20, 13, 10.0, 1234.5);
    for (const AzimuthBlend blend : {AzimuthBlend::Linear, AzimuthBlend::BSpline})
        for (const int stride : {1, 2, 4})
        {
            LegendreScheme scheme;
            scheme.azimuths = 16;
            scheme.blend = blend;
            scheme.stride = stride;
            // Half a sphere of light: bands 0 and 1 of it and of the cosine are 1/2 and 1/2, and it
            // has no band 2. So order 4 is exact.
            const Shading sky = lit(context->state(), tile, whiteSky(), scheme);
            // A key light: radiance · width · ∫ of the cosine of order 4, over π. At 20° … 50° that
            // is 1.5 % more than all light has.
            const Shading key =
                lit(context->state(), tile, keyLight(200.0, 60.0, 20.0, 50.0), scheme);
            const double expected = 4.0 * 60.0 * degree *
                                    (cosineIntegral(std::sin(50.0 * degree)) -
                                     cosineIntegral(std::sin(20.0 * degree))) /
                                    pi;
            // What is below the horizontal gives nothing.
            const Shading low =
                lit(context->state(), tile, keyLight(200.0, 360.0, -30.0, 50.0), scheme);
            const double half = 8.0 * cosineIntegral(std::sin(50.0 * degree));
            for (std::size_t i = 0; i < sky.size(); ++i)
            {
                const osg::Vec4f& s = sky.values()[i];
                EXPECT_NEAR(luminance(s), 1.0, halfRounding);
                EXPECT_NEAR(s.y(), 0.5f, 0.5f / 2048.0f);
                EXPECT_NEAR(s.z(), 0.25f, 0.25f / 2048.0f);
                EXPECT_EQ(s.w(), 1.0f); // the sun is off
                const osg::Vec4f& k = key.values()[i];
                EXPECT_NEAR(static_cast<double>(k.x()), expected, expected * halfRounding);
                EXPECT_NEAR(static_cast<double>(k.y()), 0.5 * expected, expected * halfRounding);
                EXPECT_NEAR(luminance(low.values()[i]), half, half * halfRounding);
            }
        }
}

TEST(LegendreDirect, SunIsAKeyLightOfItsDisc)
{
    OTL_NEED_GL(context);
    const DemTile tile = analytic::plane(9, 7, 10.0, 0.0);
    SkyLight sky = noLight();
    sky.sunEnabled = true;
    for (const double elevation : {5.0, 35.0, 60.0, 89.9, 90.0})
    {
        sky.sunElevation = elevation;
        const Shading sun = lit(context->state(), tile, sky, {});
        // As if all of it came from the middle: the disc's extent changes 3e-5 of that, a cap of 1°
        // about the zenith 1.5e-4.
        const double z = std::sin(elevation * degree);
        const double expected = 3.0 * cosineOfOrder4(z) / pi;
        EXPECT_NEAR(luminance(sun.at(4, 3)), expected, expected * (halfRounding + 3e-3))
            << elevation;
        EXPECT_NEAR(static_cast<double>(sun.at(4, 3).w()), 1.0, 2.0 * halfRounding) << elevation;
    }
    // Half of it above the horizontal; all of it below.
    sky.sunElevation = 0.0;
    EXPECT_NEAR(lit(context->state(), tile, sky, {}).at(4, 3).w(), 0.5f, 1.0f / 2048.0f);
    sky.sunElevation = -1.0;
    EXPECT_EQ(lit(context->state(), tile, sky, {}).at(4, 3), osg::Vec4f(0.0f, 0.0f, 0.0f, 0.0f));
    // A slope that faces away sees none of it, though order 4 of the cosine is not 0 there.
    sky.sunElevation = 20.0;
    sky.sunAzimuth = 90.0;
    const Shading away =
        lit(context->state(), analytic::ramp(20, 20, 10.0, 1.0, 0.0), sky, LegendreScheme());
    EXPECT_EQ(
        lit(context->state(), analytic::ramp(20, 20, 10.0, -1.0, 0.0), sky, {}).at(10, 10).w(),
        1.0f);
    EXPECT_EQ(away.at(10, 10), osg::Vec4f(0.0f, 0.0f, 0.0f, 0.0f));
}

TEST(LegendreDirect, IsTheSchemeInDouble)
{
    OTL_NEED_GL(context);
    DemTile oblong = fractal(47, 30);
    oblong.eastSpacings = {22.0};
    DemTile holed = fractal(33, 40);
    for (int y = 10; y < 20; ++y)
        for (int x = 0; x < y; ++x)
            holed.setVoid(x, y);
    holed.setVoid(0, 0);
    DemTile geographic = fractal(20, 21);
    geographic.eastSpacings.clear();
    for (int y = 0; y < 21; ++y)
        geographic.eastSpacings.push_back(30.0 - 0.3 * y);
    struct Case
    {
        const char* name;
        DemTile tile;
        LegendreScheme scheme;
    };
    const std::vector<Case> cases = {
        {"oblong", oblong, {{4.0, 2.0}, 32, AzimuthBlend::Linear, 1}},
        {"holed", holed, {{4.0, 1.0}, 16, AzimuthBlend::BSpline, 1}},
        {"geographic", geographic, {{8.0, 3.0}, 16, AzimuthBlend::Linear, 1}},
        {"one row", fractal(30, 1), {{4.0, 2.0}, 8, AzimuthBlend::Linear, 1}},
        {"one column", fractal(1, 17), {{1.0, 0.0}, 8, AzimuthBlend::Linear, 1}},
        {"one post", fractal(1, 1), {{4.0, 2.0}, 8, AzimuthBlend::Linear, 1}},
    };
    SkyLight harmonics = noLight();
    harmonics.skyEnabled = true;
    Harmonics red = {};
    for (std::size_t i = 0; i < 16; ++i)
    {
        const float c = i == 0 ? 3.5f : 0.4f * std::cos(3.0f * static_cast<float>(i));
        red[i] = static_cast<double>(c);
        harmonics.skyHarmonics.push_back({c, 0.5f * c, 0.25f * c});
    }
    for (const Case& c : cases)
    {
        SCOPED_TRACE(c.name);
        const Shading uniform = lit(context->state(), c.tile, whiteSky(), c.scheme);
        const Shading sky = lit(context->state(), c.tile, harmonics, c.scheme);
        // From 50° to 110° clockwise from north: −20° to 40° from east. Three slices.
        const Shading key =
            lit(context->state(), c.tile, keyLight(80.0, 60.0, 5.0, 40.0), c.scheme);
        const Visibility visibility(c.tile, c.scheme);
        double worst[3] = {};
        for (int y = 0; y < c.tile.height(); ++y)
            for (int x = 0; x < c.tile.width(); ++x)
            {
                if (!c.tile.isValid(x, y))
                {
                    EXPECT_EQ(uniform.at(x, y), osg::Vec4f()) << x << ", " << y;
                    EXPECT_EQ(key.at(x, y), osg::Vec4f()) << x << ", " << y;
                    continue;
                }
                if ((x + 3 * y) % 29 != 0)
                    continue;
                const Vec3 normal = visibility.normal(x, y);
                const Harmonics visible = visibility.visible(x, y);
                const auto differ = [&](int i, const Shading& found, double expected) {
                    worst[i] = std::max(
                        worst[i], std::abs(luminance(found.at(x, y)) - std::max(expected, 0.0)));
                };
                differ(0, uniform, irradianceOf(constantSky(), visible, normal));
                differ(1, sky, irradianceOf(red, visible, normal));
                differ(2, key,
                       4.0 * irradianceOf(constantSky(),
                                          visibility.visibleOf(x, y, -20.0 * degree, 40.0 * degree,
                                                               3, 5.0 * degree, 40.0 * degree),
                                          normal));
                EXPECT_NEAR(sky.at(x, y).y(), 0.5f * sky.at(x, y).x(), 1e-3f);
            }
        std::printf("%-18s worst difference: uniform sky %.1e, in harmonics %.1e, key light %.1e\n",
                    c.name, worst[0], worst[1], worst[2]);
        // Light up to 1, 2 and 1: half floats, 2^-12 of that, and as much for the rest.
        EXPECT_LT(worst[0], 5e-4);
        EXPECT_LT(worst[1], 1e-3);
        EXPECT_LT(worst[2], 5e-4);
    }
}

// Visibility of the sky, as Figure 10 of the paper has indirect light.
TEST(LegendreDirect, ConvergesToExhaustiveHorizonsInHarmonics)
{
    OTL_NEED_GL(context);
    const DemTile tile = smoothMountains(96, 6);
    const Scene scene(tile, Colours(96, 96, {1.0f, 1.0f, 1.0f}));
    std::vector<double> expected;
    for (int y = 2; y < 96; y += 4)
        for (int x = 2; x < 96; x += 4)
            expected.push_back(
                truth(tile, scene.normal(x, y), x, y, 0.0, 2.0 * pi, 128, 0.0, 0.5 * pi));
    double open = 0.0; // what is hidden at all, as a measure
    for (const double e : expected)
        open += (1.0 - e) * (1.0 - e) / static_cast<double>(expected.size());
    std::printf("Direct light of the sky; root mean square of 1 - light is %.3f.\n"
                "   m   k  o  join       error [%% of the light]\n",
                std::sqrt(open));
    const auto error = [&](int m, double k, double o, AzimuthBlend blend = AzimuthBlend::Linear)
    {
        const Shading found = lit(context->state(), tile, whiteSky(), {{k, o}, m, blend, 1});
        Relative relative;
        std::size_t i = 0;
        for (int y = 2; y < 96; y += 4)
            for (int x = 2; x < 96; x += 4)
                relative.add(luminance(found.at(x, y)), expected[i++]);
        std::printf("%4d %3.0f %2.0f  %-9s %8.3f\n", m, k, o,
                    blend == AzimuthBlend::Linear ? "linear" : "b-spline", 100.0 * relative.rms());
        return relative.rms();
    };
    const auto falls = [](const std::vector<double>& errors)
    { return std::is_sorted(errors.rbegin(), errors.rend()); };
    std::vector<double> errors;
    error(32, 4.0, 2.0);
    error(32, 4.0, 2.0, AzimuthBlend::BSpline);
    error(32, 8.0, 4.0);
    for (const int m : {4, 8, 16, 32, 64})
        errors.push_back(error(m, 16.0, 6.0));
    EXPECT_LT(errors[3], errors[0]) << "m";
    errors.clear();
    for (const double k : {1.0, 2.0, 4.0, 8.0, 16.0})
        errors.push_back(error(32, k, 6.0));
    EXPECT_TRUE(falls(errors)) << "k";
    errors.clear();
    for (const double o : {0.0, 2.0, 4.0, 6.0})
        errors.push_back(error(32, 16.0, o));
    EXPECT_TRUE(falls(errors)) << "o";
}

// The paper's three azimuths per key light against 64 exhaustive ones.
TEST(LegendreDirect, KeyLightOfThreeAzimuths)
{
    OTL_NEED_GL(context);
    const DemTile tile = smoothMountains(96, 6);
    const Scene scene(tile, Colours(96, 96, {1.0f, 1.0f, 1.0f}));
    constexpr double low = 10.0;
    constexpr double high = 40.0;
    std::vector<double> expected;
    for (int y = 2; y < 96; y += 4)
        for (int x = 2; x < 96; x += 4)
            expected.push_back(
                4.0 * std::max(0.0, truth(tile, scene.normal(x, y), x, y, -20.0 * degree,
                                          40.0 * degree, 64, low * degree, high * degree)));
    const auto error = [&](int lights, const BounceScheme& rays)
    {
        SkyLight sky = noLight();
        for (int i = 0; i < lights; ++i)
        {
            const double width = 60.0 / lights;
            sky.keyLights.push_back(
                keyLight(50.0 + (i + 0.5) * width, width, low, high).keyLights[0]);
        }
        const Shading found = lit(context->state(), tile, sky, {rays, 32, AzimuthBlend::Linear, 1});
        Relative relative;
        std::size_t i = 0;
        for (int y = 2; y < 96; y += 4)
            for (int x = 2; x < 96; x += 4)
                relative.add(luminance(found.at(x, y)), expected[i++]);
        std::printf("%d azimuths, k = %2.0f, o = %.0f: %.2f %%\n", 2 * lights + 1,
                    rays.samplesPerOctave, rays.offset, 100.0 * relative.rms());
        return relative.rms();
    };
    error(1, {4.0, 2.0});
    const double three = error(1, {16.0, 6.0});
    const double nine = error(4, {16.0, 6.0});
    EXPECT_LT(nine, three);
}

TEST(LegendreDirect, SubsamplingChangesASmoothBowlLittle)
{
    OTL_NEED_GL(context);
    const DemTile tile = analytic::makeTile(
        65, 61, 10.0,
        [](int x, int y) { return 0.01 * ((x - 32.0) * (x - 32.0) + (y - 30.0) * (y - 30.0)); });
    SkyLight sky = keyLight(80.0, 60.0, 10.0, 40.0);
    sky.skyEnabled = true;
    sky.skyRadiance = {1.0f, 1.0f, 1.0f};
    LightingSettings settings;
    settings.bounceMethod = BounceMethod::Legendre;
    settings.bounces = 2;
    settings.azimuths = 16;
    std::vector<Shading> direct, last, all;
    for (const int stride : {1, 2, 4})
    {
        settings.subsampling = stride;
        const osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
        const Status done = lighting->update(context->state());
        ASSERT_TRUE(done.ok()) << done.error().message;
        all.push_back(lighting->readShading(context->state()));
        last.push_back(lighting->readBounce(context->state(), settings.bounces));
        direct.push_back(lit(context->state(), tile, sky, LegendreScheme::of(settings)));
    }
    const auto difference = [](const std::vector<Shading>& found, std::size_t i)
    {
        Relative relative;
        for (std::size_t p = 0; p < found[0].size(); ++p)
            relative.add(luminance(found[i].values()[p]), luminance(found[0].values()[p]));
        return relative.rms();
    };
    for (const std::size_t i : {1u, 2u})
        std::printf("stride %d: direct %.2f %%, second bounce %.2f %%, all %.2f %%\n", 2 << (i - 1),
                    100.0 * difference(direct, i), 100.0 * difference(last, i),
                    100.0 * difference(all, i));
    EXPECT_LT(difference(direct, 1), 0.01);
    EXPECT_LT(difference(all, 1), 0.01);
    EXPECT_LT(difference(direct, 2), 0.02);
    EXPECT_LT(difference(all, 2), 0.02);
}

TEST(LegendreDirect, SubsamplingKeepsEveryPostOfAnySize)
{
    OTL_NEED_GL(context);
    LightingSettings settings;
    settings.bounceMethod = BounceMethod::Legendre;
    settings.bounces = 2;
    settings.azimuths = 8;
    for (const auto& [width, height] :
         std::vector<std::array<int, 2>>{{1, 1}, {30, 1}, {1, 17}, {13, 29}, {15, 57}})
        for (const int stride : {2, 4})
        {
            SCOPED_TRACE(::testing::Message() << width << " x " << height << ", " << stride);
            DemTile tile = fractal(width, height, 9);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x)
                    if ((x / 3 + y / 5) % 4 == 1)
                        tile.setVoid(x, y);
            settings.subsampling = stride;
            const osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, whiteSky());
            const Status done = lighting->update(context->state());
            ASSERT_TRUE(done.ok()) << done.error().message;
            const Shading shading = lighting->readShading(context->state());
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x)
                    if (!tile.isValid(x, y))
                        EXPECT_EQ(shading.at(x, y), osg::Vec4f()) << x << ", " << y;
                    else
                    {
                        EXPECT_GT(shading.at(x, y).x(), 0.1f) << x << ", " << y;
                        EXPECT_LT(shading.at(x, y).x(), 2.5f) << x << ", " << y;
                        EXPECT_EQ(shading.at(x, y).w(), 1.0f) << x << ", " << y;
                    }
            EXPECT_EQ(takeGlErrors(), "");
        }
}

TEST(LegendreDirect, NeedsNoHorizonAndNoSweep)
{
    OTL_NEED_GL(context);
    const DemTile tile = fractal(40, 33);
    osg::State& state = context->state();
    const auto costsOf = [](const TileLight& lighting)
    {
        std::map<std::string, StageCost> costs;
        for (const StageCost& cost : lighting.costs())
            costs[cost.name] = cost;
        return costs;
    };
    LightingSettings settings;
    settings.azimuths = 16;
    const SkyLight sky; // a sky and a sun
    const osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
    ASSERT_TRUE(lighting->update(state).ok());
    const Shading slices = lighting->readShading(state);
    const std::size_t sliceBytes = lighting->bytes();

    settings.bounceMethod = BounceMethod::Legendre;
    for (const int bounces : {0, 1, 3, 1, 0})
    {
        SCOPED_TRACE(bounces);
        settings.bounces = bounces;
        lighting->setSettings(settings);
        ASSERT_TRUE(lighting->update(state).ok());
        EXPECT_FALSE(lighting->isDirty(state.getContextID()));
        const osg::ref_ptr<TileLight> fresh = new TileLight(tile, settings, sky);
        ASSERT_TRUE(fresh->update(state).ok());
        for (const char* stage : {"horizon", "sky", "sun"})
        {
            EXPECT_EQ(costsOf(*lighting)[stage].bytes, 0u);
            EXPECT_EQ(costsOf(*fresh)[stage].dispatches, 0u);
        }
        EXPECT_EQ(costsOf(*fresh)["pyramid"].dispatches, 1u);
        EXPECT_EQ(costsOf(*fresh)["bounce"].dispatches, static_cast<unsigned>(bounces));
        EXPECT_EQ(lighting->bytes(), fresh->bytes());
        EXPECT_EQ(lighting->readShading(state).values(), fresh->readShading(state).values());
    }
    // Light that moves shades anew, and nothing else.
    SkyLight moved = sky;
    moved.sunAzimuth = 100.0;
    const unsigned pyramids = costsOf(*lighting)["pyramid"].dispatches;
    lighting->setSky(moved);
    ASSERT_TRUE(lighting->update(state).ok());
    EXPECT_EQ(costsOf(*lighting)["pyramid"].dispatches, pyramids);
    lighting->setSky(sky);

    // Without light there is no pyramid; a key light alone needs one.
    lighting->setSky(noLight());
    ASSERT_TRUE(lighting->update(state).ok());
    EXPECT_EQ(costsOf(*lighting)["pyramid"].bytes, 0u);
    EXPECT_EQ(lighting->readShading(state).at(20, 20), osg::Vec4f(0.0f, 0.0f, 0.0f, 1.0f));
    lighting->setSky(keyLight(80.0, 60.0, 10.0, 40.0));
    ASSERT_TRUE(lighting->update(state).ok());
    EXPECT_GT(lighting->readShading(state).at(20, 20).x(), 0.0f);

    // Heights that a host sets are lit as those of a tile.
    const osg::ref_ptr<TileLight> dynamic =
        new TileLight(analytic::plane(40, 33, 30.0, 0.0), settings, sky);
    dynamic->setHeights(tile.heights());
    ASSERT_TRUE(dynamic->update(state).ok());
    const osg::ref_ptr<TileLight> fixed = new TileLight(tile, settings, sky);
    ASSERT_TRUE(fixed->update(state).ok());
    EXPECT_EQ(dynamic->readShading(state).values(), fixed->readShading(state).values());

    // And back.
    settings.bounceMethod = BounceMethod::Slices;
    lighting->setSettings(settings);
    lighting->setSky(sky);
    ASSERT_TRUE(lighting->update(state).ok());
    EXPECT_EQ(lighting->readShading(state).values(), slices.values());
    EXPECT_EQ(lighting->bytes(), sliceBytes);
    dynamic->setSettings(settings);
    ASSERT_TRUE(dynamic->update(state).ok());
    EXPECT_EQ(dynamic->readShading(state).values(), slices.values());
    EXPECT_EQ(takeGlErrors(), "");
}

// Table 1 of the paper: 20 MB for "all input and intermediate textures" of 512² posts, subsampled
// 2 × 2, one bounce; a pyramid that is stored, not magnified, was to save a factor of 5.
TEST(LegendreDirect, FitsFourMegabytes)
{
    OTL_NEED_GL(context);
    LightingSettings settings;
    settings.bounceMethod = BounceMethod::Legendre;
    settings.bounces = 1;
    settings.subsampling = 2;
    settings.azimuths = 32;
    // Void posts take as many bytes, and little time.
    const osg::ref_ptr<TileLight> lighting =
        new TileLight(DemTile(512, 512, 30.0), settings, SkyLight());
    ASSERT_TRUE(lighting->update(context->state()).ok());
    // Results: the shading, and direct light and that of the bounce, which are values of their own
    // since nothing is written in place. The paper adds to one texture.
    const std::size_t output = 3 * textureBytes(*lighting->shading());
    const std::size_t others = lighting->bytes() - output;
    std::printf("input and intermediate %.2f MB, results %.2f MB, all %.2f MB\n",
                static_cast<double>(others) * 1e-6, static_cast<double>(output) * 1e-6,
                static_cast<double>(lighting->bytes()) * 1e-6);
    EXPECT_LE(others, 4000000u);
}
