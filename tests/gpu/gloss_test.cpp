// Glossy ground: what posts send towards viewers, and through bounces, against closed forms and
// against the path tracer, with the lobe as it is and with the four bands of it that order 4 has.
#include "core/SyntheticTerrain.h"
#include "lighting/TileLight.h"
#include "lighting/nodes/GlossNode.h"
#include "reference/PathTracer.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

using namespace osgTerrainLight;
using reference::Vector3;

namespace
{
constexpr double pi = 3.14159265358979323846;

SkyLight whiteSky()
{
    SkyLight sky;
    sky.sunEnabled = false;
    sky.skyRadiance = {1.0f, 1.0f, 1.0f};
    return sky;
}

LightingSettings glossySettings(double gloss, double exponent, int bounces = 0)
{
    LightingSettings settings;
    settings.azimuths = 16;
    settings.quality = HorizonQuality::Draft;
    settings.gloss = gloss;
    settings.glossExponent = exponent;
    settings.bounces = bounces;
    return settings;
}

/// The library's functions of harmonics, tested by tests/glsl, written again.
std::array<double, 16> basisAt(const Vector3& d)
{
    std::array<double, 16> basis = {};
    const double azimuth = std::atan2(d[1], d[0]);
    for (int l = 0; l < 4; ++l)
        for (int m = -l; m <= l; ++m)
        {
            const int order = std::abs(m);
            const double norm = std::sqrt((m == 0 ? 1.0 : 2.0) * (2 * l + 1) / (4.0 * pi) *
                                          std::tgamma(l - order + 1) / std::tgamma(l + order + 1));
            basis[static_cast<std::size_t>(l * (l + 1) + m)] =
                norm *
                std::assoc_legendre(static_cast<unsigned>(l), static_cast<unsigned>(order), d[2]) *
                (m < 0 ? std::sin(order * azimuth) : std::cos(order * azimuth));
        }
    return basis;
}

struct Glossy
{
    int width = 0, height = 0;
    std::vector<float> light; ///< GlossWork::layers
    Raster<osg::Vec4f> shading;

    double at(int layer, int x, int y, int part) const
    {
        const auto texel = static_cast<std::size_t>((layer * height + y) * width + x);
        return static_cast<double>(light[texel * 4 + static_cast<std::size_t>(part)]);
    }
    /// Sent by gloss towards a direction, of one colour.
    double sent(int x, int y, const Vector3& towards, int colour = 0) const
    {
        const std::array<double, 16> basis = basisAt(towards);
        double sum = 0.0;
        for (int i = 0; i < 16; ++i)
            sum += basis[static_cast<std::size_t>(i)] * at(4 * colour + i / 4, x, y, i % 4);
        return sum;
    }
};

Glossy glossOf(osg::State& state, const DemTile& tile, const LightingSettings& settings,
               const SkyLight& sky)
{
    const osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
    const Status done = lighting->update(state);
    EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
    EXPECT_EQ(takeGlErrors(), "");
    Glossy glossy = {tile.width(), tile.height(), lighting->readGlossLight(state),
                     lighting->readShading(state)};
    lighting->releaseGLObjects(&state);
    return glossy;
}

const std::vector<Vector3>& viewers()
{
    static const std::vector<Vector3> directions = {
        {0.0, 0.0, 1.0}, {0.6, 0.0, 0.8}, {-0.48, 0.64, 0.6}, {0.0, -0.8, 0.6}};
    return directions;
}

struct Errors
{
    double truth = 0.0, limited = 0.0; ///< relative root mean square, noise subtracted
};

/// Light of bounces 1 … n, or straight from the sky where n is 0, sent by gloss towards all viewers
/// from every fourth post.
Errors errorsOf(osg::State& state, const DemTile& tile, LightingSettings settings, double albedo,
                const SkyLight& sky)
{
    const auto a = static_cast<float>(albedo);
    settings.albedo = {a, a, a};
    const Glossy all = glossOf(state, tile, settings, sky);
    const int bounces = settings.bounces;
    settings.bounces = 0;
    const Glossy direct = glossOf(state, tile, settings, sky);

    reference::SceneDescription scene;
    scene.tile = tile;
    scene.albedo = settings.albedo;
    scene.gloss = settings.gloss;
    scene.glossExponent = settings.glossExponent;
    reference::Illumination illumination;
    illumination.light = sky;
    std::vector<reference::Receiver> receivers;
    for (int y = 2; y < tile.height(); y += 6)
        for (int x = 2; x < tile.width(); x += 6)
            for (const Vector3& viewer : viewers())
            {
                receivers.emplace_back();
                receivers.back().column = x;
                receivers.back().row = y;
                receivers.back().towards = viewer;
            }
    reference::PathTracerOptions options;
    options.samples = 4096;
    options.bounces = bounces;
    Errors errors;
    for (double* error : {&errors.truth, &errors.limited})
    {
        scene.glossBands = error == &errors.truth ? 0 : 4;
        const auto tracer = reference::PathTracer::build(scene);
        const auto light = tracer->trace(illumination, receivers, options);
        EXPECT_TRUE(light.ok());
        double squares = 0.0;
        double sum = 0.0;
        for (std::size_t i = 0; i < receivers.size(); ++i)
        {
            const reference::Receiver& r = receivers[i];
            double found = all.sent(r.column, r.row, *r.towards);
            double expected = (*light)[i].sky.mean[0];
            double variance = std::pow((*light)[i].sky.standardError[0], 2);
            if (bounces > 0)
            {
                found -= direct.sent(r.column, r.row, *r.towards);
                expected = variance = 0.0;
                for (const reference::Estimate& bounce : (*light)[i].bounces)
                {
                    expected += bounce.mean[0];
                    variance += std::pow(bounce.standardError[0], 2);
                }
            }
            expected *= settings.gloss;
            variance *= settings.gloss * settings.gloss;
            squares += std::pow(found - expected, 2) - variance;
            sum += expected * expected - variance;
        }
        *error = std::sqrt(std::max(0.0, squares) / sum);
    }
    return errors;
}
} // namespace

// Expected: a hemisphere of 1 in Legendre polynomials is 1/2, 3/4 z, 0, -7/16 P3; the lobe of
// exponent 8 multiplies bands by 1, 9/10, 8/11, 9/10 · 7/12. Bound: 16 halves of up to 1.8.
TEST(Gloss, PlainUnderAUniformSky)
{
    OTL_NEED_GL(context);
    const DemTile tile = analytic::plane(20, 13, 10.0, 100.0);
    const Glossy glossy = glossOf(context->state(), tile, glossySettings(0.5, 8.0), whiteSky());
    for (const Vector3& viewer : viewers())
    {
        const double z = viewer[2];
        const double expected =
            0.5 *
            (0.5 + 0.75 * 0.9 * z - 7.0 / 16.0 * 0.9 * 7.0 / 12.0 * 0.5 * (5.0 * z * z - 3.0) * z);
        for (int y = 0; y < tile.height(); ++y)
            for (int x = 0; x < tile.width(); ++x)
                EXPECT_NEAR(glossy.sent(x, y, viewer), expected, 2e-3) << x << ' ' << y;
    }
    EXPECT_NEAR(glossy.at(12, 5, 5, 2), 0.5, 1e-3);
    EXPECT_EQ(glossy.at(12, 5, 5, 3), 8.0);
}

// Expected: a void post sends nothing, and its neighbours' light has no trace of it.
TEST(Gloss, VoidsSendNothing)
{
    OTL_NEED_GL(context);
    DemTile tile = analytic::plane(17, 17, 10.0, 0.0);
    tile.setVoid(8, 8);
    const Glossy glossy = glossOf(context->state(), tile, glossySettings(1.0, 4.0, 2), whiteSky());
    for (int layer = 0; layer < 12; ++layer)
        for (int part = 0; part < 4; ++part)
        {
            EXPECT_EQ(glossy.at(layer, 8, 8, part), 0.0);
            EXPECT_NEAR(glossy.at(layer, 9, 8, part), glossy.at(layer, 2, 3, part), 2e-3);
        }
}

// Expected: gloss per post is gloss for all where it is the same, and 0 where it is 0.
TEST(Gloss, PerPost)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const DemTile tile = *generateTerrain(TerrainKind::Fractal, 24, 20, 30.0, 3);
    const Glossy whole = glossOf(state, tile, glossySettings(0.5, 8.0), whiteSky());
    Raster<std::array<float, 2>> gloss(24, 20, {0.5f, 8.0f});
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 12; ++x)
            gloss.at(x, y) = {0.0f, 1.0f};
    const osg::ref_ptr<TileLight> lighting =
        new TileLight(tile, glossySettings(0.0, 2.0), whiteSky());
    ASSERT_TRUE(lighting->update(state).ok());
    EXPECT_FALSE(lighting->glossLight());
    lighting->setGloss(gloss);
    ASSERT_TRUE(lighting->update(state).ok());
    const Glossy half = {24, 20, lighting->readGlossLight(state), {}};
    for (int layer = 0; layer < GlossWork::layers; ++layer)
        for (int y = 0; y < 20; ++y)
            for (int x = 0; x < 24; ++x)
                EXPECT_EQ(half.at(layer, x, y, 2), x >= 12 || (layer == 12)
                                                       ? (x >= 12 ? whole.at(layer, x, y, 2) : 0.0)
                                                       : 0.0)
                    << layer << ' ' << x << ' ' << y;
    lighting->releaseGLObjects(&state);
}

// A white sky of radiance 1 in three ways: as such, as its one harmonic, 2√π, and as a key light
// all around. The first two have the same horizons, and differ by quadrature and half floats; the
// third has horizons of its own, half a slice aside on rough ground. Voids among them.
TEST(Gloss, OneSkyInThreeWays)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    DemTile tile = *generateTerrain(TerrainKind::Fractal, 24, 20, 30.0, 3);
    tile.setVoid(7, 5);
    SkyLight harmonic = whiteSky();
    harmonic.skyHarmonics = {Rgb{3.5449077f, 3.5449077f, 3.5449077f}};
    SkyLight key = whiteSky();
    key.skyEnabled = false;
    KeyLight all;
    all.width = 360.0;
    all.lowest = -10.0;
    all.highest = 90.0;
    key.keyLights = {all};
    for (const int bounces : {0, 1})
    {
        const LightingSettings settings = glossySettings(0.5, 8.0, bounces);
        const Glossy expected = glossOf(state, tile, settings, whiteSky());
        for (const auto& [sky, bound] : {std::pair{&harmonic, 1e-4}, {&key, 0.02}})
        {
            const Glossy found = glossOf(state, tile, settings, *sky);
            double squares = 0.0, of = 0.0;
            for (int layer = 0; layer < 12; ++layer)
                for (int y = 0; y < 20; ++y)
                    for (int x = 0; x < 24; ++x)
                        for (int part = 0; part < 4; ++part)
                        {
                            const double truth = expected.at(layer, x, y, part);
                            const double difference = found.at(layer, x, y, part) - truth;
                            squares += difference * difference;
                            of += truth * truth;
                        }
            std::cout << (sky == &key ? "key light" : "harmonic") << ", " << bounces
                      << " bounces: " << 100.0 * std::sqrt(squares / of) << " %\n";
            EXPECT_GT(of, 1.0);
            EXPECT_LE(std::sqrt(squares / of), bound);
        }
    }
}

// Expected: nothing of gloss exists where there is none, and settings that come and go leave the
// shading as a tile that never had them.
TEST(Gloss, CostsNothingWhereThereIsNone)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const DemTile tile = *generateTerrain(TerrainKind::Fractal, 33, 25, 30.0, 3);
    LightingSettings settings = glossySettings(0.0, 8.0, 2);
    const osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, SkyLight());
    ASSERT_TRUE(lighting->update(state).ok());
    const auto stage = [&]
    {
        for (const StageCost& cost : lighting->costs())
            if (cost.name == "gloss")
                return cost;
        return StageCost();
    };
    const std::size_t before = lighting->bytes();
    const Raster<osg::Vec4f> shading = lighting->readShading(state);
    EXPECT_EQ(stage().dispatches, 0u);
    EXPECT_EQ(stage().bytes, 0u);
    EXPECT_FALSE(lighting->glossLight());

    settings.gloss = 0.5;
    lighting->setSettings(settings);
    ASSERT_TRUE(lighting->update(state).ok());
    EXPECT_EQ(stage().dispatches, 3u) << "direct light, and two bounces";
    // Half floats: 13 layers for the viewer and 12 for other terrain of direct light and of two
    // bounces, but the last bounce, which no terrain receives, has one texel; one layer of each
    // bounce's light with gloss; 12 layers of a pyramid laid out as that of heights. A texel of
    // material.
    const PyramidLayout layout = PyramidLayout::ofPosts(33, 25);
    const auto texels = [](const PyramidLayout& pyramid)
    { return static_cast<std::size_t>(pyramid.width * pyramid.height); };
    const std::size_t expected =
        33u * 25u * (3u * 13u + 2u * 12u + 2u) * 8u + 12u * 8u + texels(layout) * 12u * 8u + 8u;
    // It also owns the lengths of steps, a float per row and azimuth, which are the bounces', too.
    EXPECT_EQ(stage().bytes, expected + 4u * 25u * static_cast<unsigned>(settings.azimuths));
    // Only gloss reads pyramids: two floats per texel of heights, and for each bounce four half
    // floats per texel of what cells send, and per cell.
    const std::size_t pyramids =
        8u * texels(layout) + 2u * 8u * (texels(PyramidLayout::ofCells(32, 24)) + 32u * 24u);
    EXPECT_EQ(lighting->bytes(), before + expected + pyramids);
    const Raster<osg::Vec4f> mixed = lighting->readShading(state);
    EXPECT_GT(mixed.at(16, 12).x(), shading.at(16, 12).x());

    settings.gloss = 0.0;
    lighting->setSettings(settings);
    ASSERT_TRUE(lighting->update(state).ok());
    EXPECT_EQ(lighting->bytes(), before);
    EXPECT_EQ(lighting->readShading(state).values(), shading.values());
    lighting->releaseGLObjects(&state);
}

// Expected: the bits of bounces in every update, whatever the interval: gloss is computed with
// them.
TEST(Gloss, BringsBouncesInEveryUpdate)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const DemTile tile = *generateTerrain(TerrainKind::Fractal, 24, 20, 30.0, 3);
    LightingSettings settings = glossySettings(0.5, 8.0, 1);
    const osg::ref_ptr<TileLight> always = new TileLight(tile, settings, SkyLight());
    settings.bounceInterval = 4;
    const osg::ref_ptr<TileLight> paced = new TileLight(tile, settings, SkyLight());
    for (int step = 0; step < 6; ++step)
    {
        SkyLight sky;
        sky.sunAzimuth = 30.0 * step;
        for (const auto& lighting : {always, paced})
        {
            lighting->setSky(sky);
            ASSERT_TRUE(lighting->update(state).ok());
            EXPECT_FALSE(lighting->isDirty(state.getContextID())) << step;
        }
        EXPECT_EQ(paced->readShading(state).values(), always->readShading(state).values()) << step;
        EXPECT_EQ(paced->readGlossLight(state), always->readGlossLight(state)) << step;
    }
    always->releaseGLObjects(&state);
    paced->releaseGLObjects(&state);
}

// Expected: a second update after touch() gives the same bits, so nothing is added twice.
TEST(Gloss, TwiceIsTheSame)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const DemTile tile = *generateTerrain(TerrainKind::Fractal, 24, 24, 30.0, 3);
    const osg::ref_ptr<TileLight> lighting =
        new TileLight(tile, glossySettings(0.5, 8.0, 1), SkyLight());
    ASSERT_TRUE(lighting->update(state).ok());
    const auto first = lighting->readGlossLight(state);
    const auto shading = lighting->readShading(state).values();
    lighting->touch();
    ASSERT_TRUE(lighting->update(state).ok());
    EXPECT_EQ(lighting->readGlossLight(state), first);
    EXPECT_EQ(lighting->readShading(state).values(), shading);
    lighting->releaseGLObjects(&state);
}

// Expected: the path tracer; the figures that docs/measurements/ACCURACY.md quotes. Bounds: the
// greater of what is measured on the two terrains, and a quarter more.
TEST(GlossAccuracy, AgainstThePathTracer)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    struct Case
    {
        const char* name;
        double albedo, gloss, exponent;
        int bounces;
        GlossTransfer transfer;
        double truth, limited;
    };
    const std::vector<Case> cases = {
        {"sky, exponent 4", 0.0, 1.0, 4.0, 0, GlossTransfer::Vector, 0.025, 0.01},
        {"sky, exponent 16", 0.0, 1.0, 16.0, 0, GlossTransfer::Vector, 0.13, 0.02},
        {"diffuse to glossy", 0.6, 0.02, 8.0, 1, GlossTransfer::Vector, 0.3, 0.075},
        {"mixed, one bounce", 0.4, 0.4, 8.0, 1, GlossTransfer::Vector, 0.31, 0.115},
        {"mixed, one bounce, scalar", 0.4, 0.4, 8.0, 1, GlossTransfer::Scalar, 0.4, 0.32},
        {"glossy, one bounce", 0.0, 0.8, 8.0, 1, GlossTransfer::Vector, 0.36, 0.21},
        {"glossy, one bounce, scalar", 0.0, 0.8, 8.0, 1, GlossTransfer::Scalar, 0.72, 0.7},
        {"mixed, two bounces", 0.4, 0.4, 8.0, 2, GlossTransfer::Vector, 0.3, 0.11},
    };
    const std::vector<std::pair<const char*, DemTile>> tiles = {
        {"fractal", *generateTerrain(TerrainKind::Fractal, 48, 48, 30.0, 2)},
        {"valley", analytic::valley(48, 48, 10.0, 24, 0.7)}};
    for (const auto& [name, tile] : tiles)
        for (const Case& c : cases)
        {
            LightingSettings settings = glossySettings(c.gloss, c.exponent, c.bounces);
            settings.azimuths = 32;
            settings.quality = HorizonQuality::Normal;
            settings.glossTransfer = c.transfer;
            const Errors errors = errorsOf(state, tile, settings, c.albedo, whiteSky());
            std::printf("%s, %s: %.1f %% of the truth, %.1f %% of it in order 4\n", name, c.name,
                        100.0 * errors.truth, 100.0 * errors.limited);
            EXPECT_LT(errors.truth, c.truth) << name << ", " << c.name;
            EXPECT_LT(errors.limited, c.limited) << name << ", " << c.name;
        }
}
