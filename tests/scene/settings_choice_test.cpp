// The choice by budget: what it promises, held against the exhaustive reference in double on
// terrain and posts that the choice never saw.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"

#include "core/SyntheticTerrain.h"
#include "io/DemReader.h"
#include "lighting/SettingsTrial.h"
#include "reference/ReferenceLight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <random>

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;

double luminance(const Rgb& c)
{
    return 0.2126 * static_cast<double>(c[0]) + 0.7152 * static_cast<double>(c[1]) +
           0.0722 * static_cast<double>(c[2]);
}

/// An estimate and its standard error.
struct Estimate
{
    double value = 0.0;
    double standardError = 0.0;
};

/// Mean of squares, and its standard error.
Estimate meanSquare(const std::vector<double>& errors)
{
    const double count = static_cast<double>(errors.size());
    double mean = 0.0, squares = 0.0;
    for (double e : errors)
    {
        mean += e * e / count;
        squares += e * e * e * e / count;
    }
    return {mean, std::sqrt(std::max(squares - mean * mean, 0.0) / count)};
}

/// Relative root mean square error of the shading under `sky`, as SettingsChoice defines it, with
/// the reference's light at random posts.
Estimate trueError(osg::State& state, const DemTile& tile, const SkyLight& sky,
                   const LightingSettings& settings)
{
    const osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
    const Status done = lighting->update(state);
    EXPECT_TRUE(done) << (done ? "" : done.error().message);
    const Raster<osg::Vec4f> shading = lighting->readShading(state);
    const std::array<double, 3> towards = sky.sunDirection();
    reference::HorizonOptions options;
    options.highest = reference::highestPost(tile);
    std::mt19937 random(977);
    std::vector<double> skyErrors, sunErrors, lights;
    // Wrong shadows are rare: the sun gets more posts than the sky.
    const std::size_t skyPosts = 300, sunPosts = 3000;
    while (lights.size() < sunPosts)
    {
        const int column = static_cast<int>(random() % static_cast<unsigned>(tile.width()));
        const int row = static_cast<int>(random() % static_cast<unsigned>(tile.height()));
        if (!tile.isValid(column, row))
            continue;
        const osg::Vec4f& found = shading.at(column, row);
        const reference::Vector3 normal = reference::surfaceNormal(tile, column, row);
        const double facing =
            std::max(0.0, normal[0] * towards[0] + normal[1] * towards[1] + normal[2] * towards[2]);
        const double sunlit = sky.sunEnabled ? luminance(sky.sunIrradiance) * facing / pi : 0.0;
        const double light = luminance({found.r(), found.g(), found.b()});
        double fraction = 0.0;
        if (sunlit > 0.0)
            fraction = reference::sunFraction(
                tile, column, row, {sky.sunAzimuth, sky.sunElevation, sky.sunAngularRadius}, 9,
                reference::SkyExtent::AboveHorizontal, options);
        sunErrors.push_back(sunlit * (static_cast<double>(found.a()) - fraction));
        if (skyErrors.size() < skyPosts)
        {
            const double view = reference::skyViewFactor(
                reference::horizonRing(tile, column, row, 180, 0.5, options),
                reference::SkyViewDefinition::Surface, normal);
            skyErrors.push_back(light - sunlit * static_cast<double>(found.a()) -
                                luminance(sky.skyRadiance) * view);
        }
        lights.push_back(light);
    }
    const Estimate ofSky = meanSquare(skyErrors), ofSun = meanSquare(sunErrors);
    const double all = meanSquare(lights).value;
    Estimate error;
    error.value = std::sqrt((ofSky.value + ofSun.value) / all);
    error.standardError = std::hypot(ofSky.standardError, ofSun.standardError) /
                          (2.0 * std::max(error.value, 1e-9) * all);
    return error;
}

struct Unseen
{
    std::string name;
    DemTile tile;
    SkyLight sky;
};

/// Twenty terrains: kinds, sizes, slopes, spacings and suns that chose nothing in the library. Nine
/// are hard: cliffs, walls and spikes of one post, suns at 5° to 12°, a disc of 3°.
std::vector<Unseen> unseenTerrains()
{
    std::vector<Unseen> all;
    const auto add = [&all](const std::string& name, DemTile tile, double azimuth, double elevation,
                            double radius = 0.2666)
    {
        SkyLight sky;
        sky.sunAzimuth = azimuth;
        sky.sunElevation = elevation;
        sky.sunAngularRadius = radius;
        all.push_back({name, std::move(tile), sky});
    };
    for (unsigned seed = 201; seed <= 208; ++seed)
    {
        const int width = 120 + static_cast<int>(seed * 37 % 90);
        const int height = 110 + static_cast<int>(seed * 53 % 100);
        DemTile tile = generateTerrain(TerrainKind::Fractal, width, height, 30.0, seed).value();
        const float stretch = 0.5f + 0.15f * static_cast<float>(seed % 8); // flat to steep
        for (int row = 0; row < height; ++row)
            for (int column = 0; column < width; ++column)
                tile.setHeight(column, row, stretch * tile.heightAt(column, row));
        add("fractal " + std::to_string(seed), std::move(tile), seed * 31.0, 5.0 + seed % 5 * 12.0,
            seed == 203 ? 3.0 : 0.2666);
    }
    for (unsigned seed : {211u, 212u, 213u, 214u})
        add("cliffs " + std::to_string(seed),
            generateTerrain(TerrainKind::Cliffs, 170, 150, 30.0, seed).value(), seed * 77.0,
            12.0 + seed % 4 * 12.0);
    for (unsigned seed : {221u, 222u})
        add("spikes " + std::to_string(seed),
            generateTerrain(TerrainKind::Spikes, 160, 140, 30.0, seed).value(), seed * 7.0,
            seed == 221 ? 10.0 : 40.0);
    for (unsigned seed : {301u, 302u})
        add("crater " + std::to_string(seed),
            generateTerrain(TerrainKind::Crater, 180, 150, 5.0, seed).value(), seed * 1.7, 9.0);
    const Result<DemFile> real = readDem(OTL_SOURCE_DIR "/samples/data/jacksboro_90m.tif");
    EXPECT_TRUE(real) << (real ? "" : real.error().message);
    for (int part = 0; real && part < 4; ++part) // four quarters
    {
        DemTile tile(200, 170, 90.0);
        for (int row = 0; row < 170; ++row)
            for (int column = 0; column < 200; ++column)
                tile.setHeight(
                    column, row,
                    real->tile.heightAt(column + 200 * (part % 2), row + 170 * (part / 2)));
        add("Jacksboro " + std::to_string(part), std::move(tile), 60.0 * part + 10.0,
            6.0 + 8.0 * part);
    }
    return all;
}
} // namespace

TEST(SettingsChoice, KeepsAMaximumErrorOnTerrainItNeverSaw)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const std::vector<Unseen> terrains = unseenTerrains();
    ASSERT_EQ(terrains.size(), 20u);
    std::map<double, int> met, kept;
    int chosen = 0, cheapestMisses = 0;
    for (const Unseen& unseen : terrains)
    {
        Result<SettingsTrial> trial = SettingsTrial::create(unseen.tile, unseen.sky);
        ASSERT_TRUE(trial) << trial.error().message;
        for (const double wanted : {0.01, 0.002})
        {
            const Result<SettingsChoice> choice = trial->forMaxError(state, {}, wanted);
            ASSERT_TRUE(choice) << choice.error().message;
            if (!choice->met)
            {
                EXPECT_GT(choice->error, wanted);
                std::printf("%g %-14s not met: %.5f\n", wanted, unseen.name.c_str(), choice->error);
                continue;
            }
            EXPECT_LE(choice->error, wanted);
            const double error = trueError(state, unseen.tile, unseen.sky, choice->settings).value;
            ++met[wanted];
            kept[wanted] += error <= wanted ? 1 : 0;
            std::printf("%g %-14s %-6s x %-3d bound %.5f true %.5f%s\n", wanted,
                        unseen.name.c_str(), toString(choice->settings.quality),
                        choice->settings.azimuths, choice->error, error,
                        error <= wanted ? "" : " MISSED");
            if (wanted != 0.01)
                continue;
            // Small tiles under a low sun are not chosen for: they get what needs no choosing.
            if (choice->settings.quality != HorizonQuality::Best || choice->settings.azimuths < 128)
            {
                ++chosen;
                LightingSettings exact;
                exact.quality = HorizonQuality::Best;
                exact.azimuths = 192;
                const Result<SettingsChoice> dear = trial->measure(state, exact, 1);
                ASSERT_TRUE(dear) << dear.error().message;
                EXPECT_LE(2.0 * choice->milliseconds, dear->milliseconds) << unseen.name;
            }
            LightingSettings cheapest;
            cheapest.quality = HorizonQuality::Draft;
            cheapest.azimuths = 8;
            if (choice->settings.azimuths > 8 || choice->settings.quality != cheapest.quality)
                cheapestMisses +=
                    trueError(state, unseen.tile, unseen.sky, cheapest).value > wanted ? 1 : 0;
        }
    }
    for (const auto& [wanted, count] : met)
        std::printf("%g: met on %d of %zu, kept on %d\n", wanted, count, terrains.size(),
                    kept[wanted]);
    std::printf("0.01: chosen by trial on %d; the cheapest settings miss on %d\n", chosen,
                cheapestMisses);
    // 1 % is promised to be found, and what is found to hold on 95 % of terrains. That needs a
    // choice: no one setting would do.
    EXPECT_GE(met[0.01], 19);
    EXPECT_GE(kept[0.01], 19);
    EXPECT_GE(kept[0.002], 0.95 * met[0.002]);
    EXPECT_GE(met[0.002], 10);
    EXPECT_GE(cheapestMisses, 4);
    EXPECT_GE(chosen, 10);
}

TEST(SettingsChoice, MeasuredErrorIsTheTrueOnesBound)
{
    // Of any settings, not only of chosen ones.
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const DemTile tile = generateTerrain(TerrainKind::Cliffs, 160, 130, 30.0, 77).value();
    SkyLight sky;
    Result<SettingsTrial> trial = SettingsTrial::create(tile, sky);
    ASSERT_TRUE(trial) << trial.error().message;
    for (const auto& [quality, azimuths] : std::vector<std::pair<HorizonQuality, int>>{
             {HorizonQuality::Draft, 8}, {HorizonQuality::Normal, 16}, {HorizonQuality::Best, 64}})
    {
        LightingSettings settings;
        settings.quality = quality;
        settings.azimuths = azimuths;
        const Result<SettingsChoice> measured = trial->measure(state, settings, 1);
        ASSERT_TRUE(measured) << measured.error().message;
        const Estimate error = trueError(state, tile, sky, settings);
        std::printf("%s x %d: bound %.5f, true %.5f +- %.5f\n", toString(quality), azimuths,
                    measured->error, error.value, error.standardError);
        // 95 %, of an estimate with an error of its own.
        EXPECT_LE(error.value - 1.645 * error.standardError, measured->error);
        // Not so wide that it says nothing: two parts are added, each the end of an interval.
        EXPECT_GE(error.value + 1.645 * error.standardError, 0.5 * measured->error);
    }
}

TEST(SettingsChoice, TightensWithTheErrorAsked)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const DemTile tile = generateTerrain(TerrainKind::Fractal, 128, 128, 30.0, 9).value();
    SkyLight sky;
    sky.sunEnabled = false;
    Result<SettingsTrial> trial = SettingsTrial::create(tile, sky);
    ASSERT_TRUE(trial) << trial.error().message;
    int last = 0;
    for (const double wanted : {0.02, 0.002, 0.0005})
    {
        LightingSettings base;
        base.exposure = 1.5;
        const Result<SettingsChoice> choice = trial->forMaxError(state, base, wanted);
        ASSERT_TRUE(choice) << choice.error().message;
        EXPECT_TRUE(choice->met);
        EXPECT_GT(choice->settings.azimuths, last) << "asked " << wanted;
        EXPECT_EQ(choice->settings.exposure, 1.5);
        last = choice->settings.azimuths;
    }
    const Result<SettingsChoice> choice = trial->forMaxError(state, {}, 1e-5);
    ASSERT_TRUE(choice) << choice.error().message;
    EXPECT_FALSE(choice->met);
    EXPECT_EQ(choice->settings.azimuths, 192);
    EXPECT_EQ(choice->settings.quality, HorizonQuality::Best);
    EXPECT_GT(choice->error, 1e-5);
}

TEST(SettingsChoice, KeepsAFrameTime)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const DemTile tile = generateTerrain(TerrainKind::Fractal, 200, 200, 30.0, 10).value();
    SkyLight sky;
    Result<SettingsTrial> trial = SettingsTrial::create(tile, sky);
    ASSERT_TRUE(trial) << trial.error().message;
    LightingSettings cheap;
    cheap.azimuths = 8;
    cheap.quality = HorizonQuality::Draft;
    const Result<SettingsChoice> least = trial->measure(state, cheap, 3);
    ASSERT_TRUE(least) << least.error().message;
    // Budgets as multiples of the cheapest, since machines differ.
    const Result<SettingsChoice> ample = trial->forFrameTime(state, {}, 8.0 * least->milliseconds);
    ASSERT_TRUE(ample) << ample.error().message;
    EXPECT_TRUE(ample->met);
    EXPECT_LE(ample->milliseconds, 8.0 * least->milliseconds);
    EXPECT_LT(ample->error, least->error);
    const Result<SettingsChoice> none = trial->forFrameTime(state, {}, 0.01);
    ASSERT_TRUE(none) << none.error().message;
    EXPECT_FALSE(none->met);
    EXPECT_EQ(none->settings.azimuths, 8);
}

TEST(SettingsChoice, PublicCallsMeasureInAContextOfTheirOwn)
{
    {
        OTL_NEED_GL(context); // one can be had
    }
    const DemTile tile = generateTerrain(TerrainKind::Fractal, 96, 64, 30.0, 11).value();
    const SettingsChoice byError = LightingSettings::forMaxError(0.01, tile, {});
    EXPECT_EQ(byError.failure, "");
    EXPECT_TRUE(byError.met);
    EXPECT_LE(byError.error, 0.01);
    EXPECT_GT(byError.milliseconds, 0.0);
    const SettingsChoice byTime = LightingSettings::forFrameTime(1e6, tile, {});
    EXPECT_EQ(byTime.failure, "");
    EXPECT_TRUE(byTime.met);
    EXPECT_LT(byTime.error, byError.error);
    DemTile without = tile;
    without.northSpacing = 0.0;
    EXPECT_EQ(LightingSettings::forMaxError(0.01, without, {}).failure, without.complaint());
    EXPECT_NE(without.complaint(), "");
}

TEST(SettingsChoice, OnlyASunNeedsNoAzimuths)
{
    OTL_NEED_GL(context);
    const DemTile tile = generateTerrain(TerrainKind::Fractal, 128, 128, 30.0, 12).value();
    SkyLight sky;
    sky.skyEnabled = false;
    Result<SettingsTrial> trial = SettingsTrial::create(tile, sky);
    ASSERT_TRUE(trial) << trial.error().message;
    LightingSettings base;
    base.azimuths = 20;
    const Result<SettingsChoice> choice = trial->forMaxError(context->state(), base, 0.05);
    ASSERT_TRUE(choice) << choice.error().message;
    EXPECT_TRUE(choice->met);
    EXPECT_EQ(choice->settings.azimuths, 20);
}

TEST(SettingsChoice, NoLightAndLevelGroundHaveNoError)
{
    OTL_NEED_GL(context);
    SkyLight dark;
    dark.skyEnabled = dark.sunEnabled = false;
    const DemTile tile = analytic::plane(40, 30, 10.0, 5.0);
    for (const SkyLight& sky : {dark, SkyLight{}})
    {
        Result<SettingsTrial> trial = SettingsTrial::create(tile, sky);
        ASSERT_TRUE(trial) << trial.error().message;
        const Result<SettingsChoice> choice = trial->forMaxError(context->state(), {}, 1e-3);
        ASSERT_TRUE(choice) << choice.error().message;
        EXPECT_TRUE(choice->met);
        EXPECT_LT(choice->error, 5e-4); // of the half floats that the shading is stored in
    }
}

TEST(SettingsChoice, SaysWhatIsWrong)
{
    const DemTile tile = analytic::plane(8, 8, 10.0, 0.0);
    for (const double wrong : {0.0, -1.0, 2.0, std::numeric_limits<double>::quiet_NaN()})
    {
        const SettingsChoice choice = LightingSettings::forMaxError(wrong, tile, {});
        EXPECT_FALSE(choice.met);
        EXPECT_NE(choice.failure.find("max-error = "), std::string::npos) << choice.failure;
        EXPECT_NE(choice.failure.find("needs 1e-05 ... 1"), std::string::npos) << choice.failure;
    }
    EXPECT_NE(LightingSettings::forFrameTime(0.0, tile, {}).failure.find("max-ms = 0 ms: needs"),
              std::string::npos);
    OTL_NEED_GL(context);
    const Result<SettingsTrial> trial = SettingsTrial::create(DemTile(4, 4, 1.0), {});
    ASSERT_FALSE(trial);
    EXPECT_EQ(trial.error().message, "no valid post: needed at least one to measure settings");
}
