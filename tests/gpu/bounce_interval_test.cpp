#include "core/SyntheticTerrain.h"
#include "lighting/TileLight.h"
#include "support/GlContext.h"
#include <osgTerrainLight/HeadlessContext.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>

using namespace osgTerrainLight;

namespace
{
constexpr int width = 37, height = 29;

DemTile terrain()
{
    return generateTerrain(TerrainKind::Fractal, width, height, 30.0, 3).value();
}

LightingSettings settingsOf(int bounces, int interval, BounceMethod method = BounceMethod::Slices)
{
    LightingSettings settings;
    settings.azimuths = 16;
    settings.bounces = bounces;
    settings.bounceInterval = interval;
    settings.bounceMethod = method;
    return settings;
}

SkyLight sunAt(double azimuth)
{
    SkyLight sky;
    sky.sunAzimuth = azimuth;
    return sky;
}

std::map<std::string, unsigned> countsOf(const TileLight& lighting)
{
    std::map<std::string, unsigned> counts;
    for (const StageCost& cost : lighting.costs())
        counts[cost.name] = cost.dispatches;
    return counts;
}

void update(TileLight& lighting, osg::State& state)
{
    const Status done = lighting.update(state);
    ASSERT_TRUE(done.ok()) << done.error().message;
}

/// The shading of a new tile that computes its bounces in every update.
Raster<osg::Vec4f> freshShading(osg::State& state, LightingSettings settings, const SkyLight& sky)
{
    settings.bounceInterval = 1;
    const osg::ref_ptr<TileLight> lighting = new TileLight(terrain(), settings, sky);
    update(*lighting, state);
    Raster<osg::Vec4f> shading = lighting->readShading(state);
    lighting->releaseGLObjects(&state);
    return shading;
}

/// The sum of the bounces of a new tile, without the rounding of the shading.
Raster<osg::Vec4f> freshBounces(osg::State& state, LightingSettings settings, const SkyLight& sky)
{
    settings.bounceInterval = 1;
    Raster<osg::Vec4f> sum(width, height);
    const osg::ref_ptr<TileLight> lighting = new TileLight(terrain(), settings, sky);
    update(*lighting, state);
    for (int bounce = 1; bounce <= settings.bounces; ++bounce)
    {
        const Raster<osg::Vec4f> light = lighting->readBounce(state, bounce);
        for (std::size_t i = 0; i < sum.size(); ++i)
            sum.values()[i] += light.values()[i];
    }
    lighting->releaseGLObjects(&state);
    return sum;
}
} // namespace

// Every update is held against a model: the direct light of now, and the bounces of the light of
// the last update that computed any. The tolerance is the rounding to half floats, 2^-11 of what is
// stored: once per bounce, as it is added to direct light.
TEST(BounceInterval, DirectLightIsOfNowAndBouncesOfTheirLastUpdate)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const std::array<SkyLight, 2> lights = {sunAt(315.0), sunAt(100.0)};
    for (const BounceMethod method : {BounceMethod::Slices, BounceMethod::Legendre})
        for (const int bounces : {1, 3})
        {
            SCOPED_TRACE(std::string(toString(method)) + ", " + std::to_string(bounces));
            const LightingSettings settings = settingsOf(bounces, 5, method);
            std::array<Raster<osg::Vec4f>, 2> direct, indirect, all;
            for (std::size_t i = 0; i < 2; ++i)
            {
                direct[i] = freshShading(state, settingsOf(0, 1, method), lights[i]);
                indirect[i] = freshBounces(state, settings, lights[i]);
                all[i] = freshShading(state, settings, lights[i]);
            }
            const osg::ref_ptr<TileLight> lighting = new TileLight(terrain(), settings, lights[0]);
            update(*lighting, state);
            EXPECT_EQ(lighting->readShading(state).values(), all[0].values());
            std::size_t computedFor = 0;
            int kept = 0, keptOfAnother = 0;
            for (std::size_t step = 1; step <= 20; ++step)
            {
                const std::size_t now = step % 2;
                lighting->setSky(lights[now]);
                const unsigned before = countsOf(*lighting)["bounce"];
                update(*lighting, state);
                const Raster<osg::Vec4f> found = lighting->readShading(state);
                if (countsOf(*lighting)["bounce"] > before)
                {
                    computedFor = now;
                    EXPECT_EQ(found.values(), all[now].values()) << step;
                    continue;
                }
                ++kept;
                keptOfAnother += computedFor != now;
                for (std::size_t i = 0; i < found.size(); ++i)
                {
                    const osg::Vec4f& d = direct[now].values()[i];
                    const osg::Vec4f& b = indirect[computedFor].values()[i];
                    for (unsigned c = 0; c < 3; ++c)
                    {
                        const float expected = std::max(d[c] + b[c], 0.0f);
                        ASSERT_NEAR(found.values()[i][c], expected,
                                    float(bounces) * expected / 2048.0f + 1e-7f)
                            << step << ", post " << i;
                    }
                    ASSERT_EQ(found.values()[i].a(), d.a()) << step << ", post " << i;
                }
            }
            EXPECT_EQ(kept, 16);
            EXPECT_GT(keptOfAnother, 3);
            lighting->releaseGLObjects(&state);
        }
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(BounceInterval, LightThatMovesBringsBouncesInEveryNthUpdate)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const unsigned id = state.getContextID();
    const osg::ref_ptr<TileLight> lighting = new TileLight(terrain(), settingsOf(2, 4), sunAt(0.0));
    update(*lighting, state);
    EXPECT_FALSE(lighting->isDirty(id));
    std::map<std::string, unsigned> counts = {
        {"horizon", 1}, {"table", 0},  {"sky", 1},  {"sun", 1},    {"key", 0},
        {"shade", 1},   {"shadow", 1}, {"sent", 2}, {"bounce", 2}, {"compose", 1}};
    EXPECT_EQ(countsOf(*lighting), counts);
    unsigned waits = 0;
    for (unsigned step = 1; step <= 12; ++step)
    {
        lighting->setSky(sunAt(7.0 * step));
        EXPECT_TRUE(lighting->isDirty(id));
        update(*lighting, state);
        ++counts["sun"];
        ++counts["shadow"];
        ++counts["shade"];
        ++counts["compose"];
        const std::map<std::string, unsigned> found = countsOf(*lighting);
        const bool computed = found.at("bounce") > counts["bounce"];
        counts["sent"] += computed ? 2 : 0;
        counts["bounce"] += computed ? 2 : 0;
        EXPECT_EQ(found, counts) << step;
        EXPECT_EQ(lighting->isDirty(id), !computed) << "behind: the next update must come";
        waits = computed ? 0 : waits + 1;
        EXPECT_LT(waits, 4u);
    }
    EXPECT_EQ(counts["bounce"], 2 * (1u + 3u));

    // Still, or changed to where it was: the next update is exact, and the last.
    do
    {
        lighting->setSky(sunAt(50.0));
        update(*lighting, state);
    } while (!lighting->isDirty(id));
    counts = countsOf(*lighting);
    update(*lighting, state);
    counts["sent"] += 2;
    counts["bounce"] += 2;
    ++counts["compose"];
    EXPECT_EQ(countsOf(*lighting), counts) << "bounces, and nothing else";
    EXPECT_FALSE(lighting->isDirty(id));
    EXPECT_EQ(lighting->readShading(state).values(),
              freshShading(state, settingsOf(2, 4), sunAt(50.0)).values());
    update(*lighting, state);
    EXPECT_EQ(countsOf(*lighting), counts);
    lighting->releaseGLObjects(&state);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(BounceInterval, WhateverElseChangesBringsBouncesAtOnce)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const unsigned id = state.getContextID();
    LightingSettings settings = settingsOf(1, 16);
    const osg::ref_ptr<TileLight> lighting = new TileLight(terrain(), settings, sunAt(0.0));
    update(*lighting, state);
    double azimuth = 0.0;
    const auto expectAtOnce = [&](const char* what, const auto& change)
    {
        SCOPED_TRACE(what);
        do
        {
            lighting->setSky(sunAt(azimuth += 5.0));
            update(*lighting, state);
        } while (!lighting->isDirty(id));
        lighting->setSky(sunAt(azimuth += 5.0)); // at the same time
        change();
        const unsigned before = countsOf(*lighting)["bounce"];
        update(*lighting, state);
        EXPECT_EQ(countsOf(*lighting)["bounce"], before + unsigned(settings.bounces));
        EXPECT_FALSE(lighting->isDirty(id));
    };
    const auto set = [&] { lighting->setSettings(settings); };
    expectAtOnce("bounces", [&] { settings.bounces = 2, set(); });
    expectAtOnce("albedo", [&] { settings.albedo = {0.3f, 0.4f, 0.5f}, set(); });
    expectAtOnce("albedo per post",
                 [&] {
                     lighting->setAlbedo(Raster<Rgb>(width, height, {0.2f, 0.9f, 0.1f}));
                 });
    expectAtOnce("azimuths", [&] { settings.azimuths = 8, set(); });
    expectAtOnce("quality", [&] { settings.quality = HorizonQuality::Draft, set(); });
    expectAtOnce("subsampling", [&] { settings.subsampling = 2, set(); });
    expectAtOnce("method", [&] { settings.bounceMethod = BounceMethod::Legendre, set(); });
    expectAtOnce("interval", [&] { settings.bounceInterval = 15, set(); });
    expectAtOnce("heights",
                 [&] { lighting->setHeights(std::vector<float>(width * height, 5.0f)); });
    expectAtOnce("shaders", [&] { lighting->recompute(); });
    expectAtOnce("everything", [&] { lighting->touch(); });
    lighting->releaseGLObjects(&state);

    // Light that goes while bounces wait, and comes again.
    settings = settingsOf(1, 16);
    lighting->setAlbedo({});
    set();
    expectAtOnce("light",
                 [&]
                 {
                     SkyLight dark;
                     dark.skyEnabled = dark.sunEnabled = false;
                     lighting->setSky(dark);
                     update(*lighting, state);
                     EXPECT_FALSE(lighting->isDirty(id));
                     const auto counts = countsOf(*lighting);
                     update(*lighting, state);
                     EXPECT_EQ(countsOf(*lighting), counts);
                     lighting->setSky(sunAt(azimuth));
                 });
    lighting->releaseGLObjects(&state);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(BounceInterval, TilesTakeTurns)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    std::vector<osg::ref_ptr<TileLight>> tiles;
    for (int i = 0; i < 4; ++i)
    {
        tiles.push_back(new TileLight(terrain(), settingsOf(1, 4), sunAt(0.0)));
        update(*tiles.back(), state);
    }
    const auto bounces = [&]
    {
        unsigned sum = 0;
        for (const auto& tile : tiles)
            sum += countsOf(*tile)["bounce"];
        return sum;
    };
    for (unsigned step = 1; step <= 9; ++step)
    {
        for (const auto& tile : tiles)
        {
            tile->setSky(sunAt(3.0 * step));
            update(*tile, state);
        }
        EXPECT_EQ(bounces(), 4u + step);
    }
    for (const auto& tile : tiles)
        tile->releaseGLObjects(&state);
}

TEST(BounceInterval, CostsNoTexture)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const osg::ref_ptr<TileLight> lighting = new TileLight(terrain(), settingsOf(2, 1), sunAt(0.0));
    update(*lighting, state);
    const std::size_t before = lighting->bytes();
    for (const int interval : {2, 1})
    {
        lighting->setSettings(settingsOf(2, interval));
        update(*lighting, state);
        EXPECT_EQ(lighting->bytes(), before);
    }
    for (unsigned step = 1; step <= 3; ++step)
    {
        const auto counts = countsOf(*lighting);
        lighting->setSky(sunAt(step));
        update(*lighting, state);
        EXPECT_EQ(countsOf(*lighting).at("bounce"), counts.at("bounce") + 2);
        EXPECT_FALSE(lighting->isDirty(state.getContextID()));
    }
    lighting->releaseGLObjects(&state);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(BounceInterval, EachContextGoesItsOwnPace)
{
    OTL_NEED_GL(first);
    std::string problem;
    const std::unique_ptr<HeadlessContext> second = HeadlessContext::create(16, 16, problem);
    ASSERT_TRUE(second) << problem;
    const osg::ref_ptr<TileLight> lighting = new TileLight(terrain(), settingsOf(2, 3), sunAt(0.0));
    // The second context sees every second light only.
    for (int step = 0; step <= 8; ++step)
    {
        lighting->setSky(sunAt(11.0 * step));
        for (HeadlessContext* context : {first, second.get()})
            if (context == first || step % 2 == 0)
            {
                context->makeCurrent();
                update(*lighting, context->state());
            }
    }
    for (HeadlessContext* context : {second.get(), first})
    {
        context->makeCurrent();
        osg::State& state = context->state();
        update(*lighting, state);
        EXPECT_FALSE(lighting->isDirty(state.getContextID()));
        EXPECT_EQ(lighting->readShading(state).values(),
                  freshShading(state, settingsOf(2, 3), sunAt(88.0)).values());
        EXPECT_EQ(takeGlErrors(), "");
        lighting->releaseGLObjects(&state);
    }
}
