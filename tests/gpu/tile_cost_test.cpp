// What a tile costs, in bytes and runs of stages.
#include "core/SettingsTable.h"
#include "core/SyntheticTerrain.h"
#include "lighting/TileLight.h"
#include "support/GlContext.h"
#include <osgTerrainLight/HeadlessContext.h>

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

using namespace osgTerrainLight;

namespace
{
constexpr int width = 64, height = 48;
constexpr std::size_t posts = width * height;
constexpr int azimuths = 16;

/// Of `bench --generate fractal --size 64,48 --posts 0 --azimuths 16` with the program of before
/// tiles declared their work (commit b5d67e3), column memory_bytes of each sweep.
constexpr std::size_t bytesWithoutBounces = 1758728;

osg::ref_ptr<TileLight> lit(osg::State& state, int bounces)
{
    LightingSettings settings;
    settings.azimuths = azimuths;
    settings.bounces = bounces;
    const osg::ref_ptr<TileLight> lighting =
        new TileLight(generateTerrain(TerrainKind::Fractal, width, height, 30.0, 1).value(),
                      settings, SkyLight());
    const Status done = lighting->update(state);
    EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
    return lighting;
}

/// Runs by stage, of those that ran.
std::map<std::string, unsigned> runsOf(const TileLight& lighting)
{
    std::map<std::string, unsigned> runs;
    for (const StageCost& cost : lighting.costs())
        if (cost.dispatches > 0)
            runs[cost.name] = cost.dispatches;
    return runs;
}
} // namespace

TEST(TileCost, WithoutBouncesIsWhatItWasBeforeWorkWasDeclared)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<TileLight> lighting = lit(context->state(), 0);
    EXPECT_EQ(lighting->bytes(), bytesWithoutBounces);
    const std::map<std::string, unsigned> expected = {
        {"horizon", 1}, {"sky", 1}, {"sun", 1}, {"shade", 1}};
    EXPECT_EQ(runsOf(*lighting), expected);
    lighting->releaseGLObjects(&context->state());
}

// Half floats of four channels: direct light, and of each bounce its light and what the four faces
// at a post send. What all bounces compute with: sums of four floats and gradients of two, a length
// of a step per azimuth and row, and a texel of albedo. Of the sun's shadow two half floats, and
// two floats along lines, of which there is one more than posts.
TEST(TileCost, OfBouncesIsOneTextureOfLightAndOneOfWhatIsSentForEach)
{
    OTL_NEED_GL(context);
    const std::size_t once = (8 + 16 + 8) * posts + 4u * azimuths * std::size_t(height) + 8;
    const std::size_t shadow = 4 * posts + 8u * std::size_t((width + 1) * (height + 1));
    const std::size_t each = 8 * posts + 4u * 8u * posts;
    for (const unsigned bounces : {1u, 3u})
    {
        const osg::ref_ptr<TileLight> lighting = lit(context->state(), int(bounces));
        EXPECT_EQ(lighting->bytes(), bytesWithoutBounces + once + shadow + bounces * each)
            << bounces;
        const std::map<std::string, unsigned> expected = {
            {"horizon", 1}, {"sky", 1},        {"sun", 1},          {"shadow", 1},
            {"shade", 1},   {"sent", bounces}, {"bounce", bounces}, {"compose", 1}};
        EXPECT_EQ(runsOf(*lighting), expected) << bounces;
        lighting->releaseGLObjects(&context->state());
    }
}

namespace
{
/// A value of each row that is neither the default nor dear.
const std::map<std::string, std::string> otherValues = {
    {"azimuths", "12"},
    {"quality", "draft"},
    {"body-radius", "6371000"},
    {"bounces", "2"},
    {"bounce-method", "legendre"},
    {"subsampling", "2"},
    {"bounce-interval", "3"},
    {"albedo", "0.25"},
    {"gloss", "0.25"},
    {"gloss-exponent", "16"},
    {"gloss-transfer", "scalar"},
    {"gloss-viewer", "1,0,0"},
    {"shadow-edges", "on"},
    {"object-cones", "32"},
    {"exposure", "2"},
    {"sun-azimuth", "100"},
    {"sun-elevation", "10"},
    {"sun-radius", "2"},
    {"sun-irradiance", "1,2,3"},
    {"sun-enabled", "off"},
    {"sky-radiance", "1,2,3"},
    {"turbidity", "5"},
    {"sky-heading", "90"},
    {"sky-gain", "2"},
    {"sky-model", "overcast"},
    {"sky-enabled", "off"},
    {"sky-harmonics", "1,0.5,0.25,0.125"},
    {"key-lights", "100,30,10,40,1,2,3"},
};

/// Stages that a change may run again: those that the table's column stands for, and what follows
/// from them.
std::set<std::string> stagesBehind(Invalidation invalidates)
{
    using I = Invalidation;
    std::set<std::string> stages;
    if (meets(invalidates, I::Heights | I::Horizons | I::Method))
        stages = {"horizon", "sun", "shadow", "key", "sky", "pyramid"};
    if (meets(invalidates, I::SkyShape))
        stages.insert({"sky", "table"});
    if (meets(invalidates, I::SunPlace))
        stages.insert({"sun", "shadow"});
    if (meets(invalidates, I::Keys))
        stages.insert("key");
    if (meets(invalidates, I::Transport | I::Pace | I::Gloss))
        stages.insert({"pyramid", "gloss", "edges"});
    if (!stages.empty() || meets(invalidates, I::Light))
        stages.insert("shade");
    if (!stages.empty() || meets(invalidates, I::Albedo))
        stages.insert({"sent", "bounce", "compose"});
    return stages;
}

/// Changes one row at a time: the light is a new tile's, and no stage runs but those behind it.
template <class Owner, class Change>
void expectRowsRunWhatTheyInvalidate(osg::State& state, Change&& changed)
{
    const DemTile tile = generateTerrain(TerrainKind::Fractal, 24, 20, 30.0, 1).value();
    LightingSettings before;
    before.azimuths = 8;
    before.bounces = 1;
    for (const Setting<Owner>& row : settingsOf<Owner>())
    {
        SCOPED_TRACE(row.name);
        ASSERT_EQ(otherValues.count(row.name), 1u);
        const Result<SettingValue> value = row.read(otherValues.at(row.name), row.name);
        ASSERT_TRUE(value) << value.error().message;
        const osg::ref_ptr<TileLight> lighting = new TileLight(tile, before, SkyLight());
        ASSERT_TRUE(lighting->update(state).ok());
        const std::map<std::string, unsigned> ranBefore = runsOf(*lighting);
        LightingSettings settings = before;
        SkyLight sky;
        changed(settings, sky, row, *value);
        lighting->setSettings(settings);
        lighting->setSky(sky);
        while (lighting->isDirty(state.getContextID())) // bounces may follow in a second update
            ASSERT_TRUE(lighting->update(state).ok());
        const std::set<std::string> behind = stagesBehind(row.invalidates);
        for (const auto& [stage, runs] : runsOf(*lighting))
            if (ranBefore.count(stage) == 0 || runs > ranBefore.at(stage))
            {
                EXPECT_EQ(behind.count(stage), 1u) << stage;
            }
        const osg::ref_ptr<TileLight> fresh = new TileLight(tile, settings, sky);
        ASSERT_TRUE(fresh->update(state).ok());
        EXPECT_EQ(lighting->readShading(state).values(), fresh->readShading(state).values());
        lighting->releaseGLObjects(&state);
        fresh->releaseGLObjects(&state);
    }
}
} // namespace

TEST(TileCost, SettingsRunWhatTheTableSays)
{
    OTL_NEED_GL(context);
    expectRowsRunWhatTheyInvalidate<LightingSettings>(
        context->state(), [](LightingSettings& settings, SkyLight&, const auto& row,
                             const SettingValue& value) { row.set(settings, value); });
}

TEST(TileCost, LightRunsWhatTheTableSays)
{
    OTL_NEED_GL(context);
    expectRowsRunWhatTheyInvalidate<SkyLight>(
        context->state(), [](LightingSettings&, SkyLight& sky, const auto& row,
                             const SettingValue& value) { row.set(sky, value); });
}
