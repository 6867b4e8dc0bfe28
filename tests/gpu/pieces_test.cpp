// Light that is computed in pieces. Expected values are those of the same tile in one go, to the
// last bit: the same invocations compute the same numbers, and each post is one invocation's at a
// time.

#include "core/SyntheticTerrain.h"
#include "lighting/TileLight.h"
#include "support/GlContext.h"
#include <osgTerrainLight/HeadlessContext.h>

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
constexpr int width = 37, height = 29;

/// Stops after each piece, which has so many groups at most.
class OnePiece : public WorkPace
{
public:
    explicit OnePiece(unsigned groups) : _groups(groups) {}
    void ran(const std::string& kind, unsigned) override { last = kind; }
    std::string last;

protected:
    bool mayContinue() override { return last.empty(); }
    unsigned choose(const std::string&, unsigned, unsigned least) override
    {
        return last.empty() ? std::max(least, _groups) : 0;
    }

private:
    unsigned _groups;
};

struct Scene
{
    const char* name;
    LightingSettings settings;
    SkyLight sky;
};

std::vector<Scene> scenes()
{
    LightingSettings settings;
    settings.azimuths = 8;
    settings.bounces = 2;
    settings.shadowEdges = true;
    SkyLight sky;
    std::vector<Scene> all = {{"bounces and edges", settings, sky}};
    settings.quality = HorizonQuality::Best;
    settings.bounces = 0;
    sky.skyModel = SkyModel::Overcast;
    sky.keyLights.resize(1);
    sky.keyLights[0].radiance = {4.0f, 2.0f, 1.0f};
    all.push_back({"a table, a key light, best", settings, sky});
    settings = LightingSettings();
    settings.azimuths = 8;
    settings.bounces = 2;
    settings.gloss = 0.5;
    all.push_back({"gloss", settings, SkyLight()});
    settings.gloss = 0.0;
    settings.bounceMethod = BounceMethod::Legendre;
    all.push_back({"by Legendre", settings, SkyLight()});
    return all;
}

osg::ref_ptr<TileLight> tileOf(const Scene& scene, unsigned seed = 3)
{
    return new TileLight(generateTerrain(TerrainKind::Fractal, width, height, 30.0, seed).value(),
                         scene.settings, scene.sky);
}

/// All that can be seen of the light.
std::vector<osg::Vec4f> lightOf(TileLight& tile, osg::State& state)
{
    const Raster<osg::Vec4f> shading = tile.readShading(state);
    std::vector<osg::Vec4f> all = shading.values();
    for (int bounce = 1; bounce <= tile.bounces(); ++bounce)
    {
        const Raster<osg::Vec4f> light = tile.readBounce(state, bounce);
        all.insert(all.end(), light.values().begin(), light.values().end());
    }
    if (tile.glossLight())
        for (const float value : tile.readGlossLight(state))
            all.emplace_back(value, 0.0f, 0.0f, 0.0f);
    return all;
}

/// Runs one piece: false where there was none left.
bool runPiece(TileLight& tile, osg::State& state, unsigned groups)
{
    OnePiece pace(groups);
    const Status done = tile.update(state, &pace);
    EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
    return done && pace.isStopped();
}

unsigned dispatchesOf(const TileLight& tile)
{
    unsigned sum = 0;
    for (const StageCost& cost : tile.costs())
        sum += cost.dispatches;
    return sum;
}
} // namespace

TEST(Pieces, GiveTheLightOfOneGo)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    for (const Scene& scene : scenes())
    {
        SCOPED_TRACE(scene.name);
        const auto whole = tileOf(scene);
        ASSERT_TRUE(whole->update(state).ok());
        const std::vector<osg::Vec4f> expected = lightOf(*whole, state);
        for (const unsigned groups : {1u, 7u})
        {
            const auto tile = tileOf(scene);
            int pieces = 1;
            while (runPiece(*tile, state, groups))
            {
                ++pieces;
                EXPECT_TRUE(tile->isDirty(state.getContextID()));
                ASSERT_LT(pieces, 20000);
            }
            EXPECT_FALSE(tile->isDirty(state.getContextID()));
            EXPECT_GT(pieces, 20);
            EXPECT_TRUE(lightOf(*tile, state) == expected) << groups;
            // A stage counts once, however many pieces it had; and what stands still costs nothing.
            EXPECT_EQ(dispatchesOf(*tile), dispatchesOf(*whole));
            EXPECT_FALSE(runPiece(*tile, state, groups));
            EXPECT_EQ(dispatchesOf(*tile), dispatchesOf(*whole));
        }
    }
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: an update that was stopped ends with the values that it began with; the next one takes
// up those set since. One that is stopped, and then not, goes on from where it stopped.
TEST(Pieces, ChangesInBetweenWaitForTheirTurn)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const Scene scene = scenes().front();
    Scene later = scene;
    later.sky.sunAzimuth = 80.0;
    const auto whole = tileOf(scene);
    ASSERT_TRUE(whole->update(state).ok());
    const std::vector<osg::Vec4f> before = lightOf(*whole, state);
    for (const int stop : {1, 5, 23, 60, 150})
    {
        SCOPED_TRACE(stop);
        const auto tile = tileOf(scene);
        for (int i = 0; i < stop; ++i)
            ASSERT_TRUE(runPiece(*tile, state, 1));
        tile->setSky(later.sky);
        ASSERT_TRUE(tile->update(state).ok());
        EXPECT_TRUE(lightOf(*tile, state) == before);
        EXPECT_TRUE(tile->isDirty(state.getContextID()));
        const std::vector<float> heights =
            generateTerrain(TerrainKind::Cliffs, width, height, 30.0, 8).value().heights();
        tile->setHeights(heights);
        for (int i = 0; i < stop; ++i)
            ASSERT_TRUE(runPiece(*tile, state, 1));
        ASSERT_TRUE(tile->update(state).ok());
        const auto other = tileOf(later);
        other->setHeights(heights);
        ASSERT_TRUE(other->update(state).ok());
        EXPECT_TRUE(lightOf(*tile, state) == lightOf(*other, state));
    }
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: each context comes to the light of the values that the tile has, though the other one
// has taken up new ones when this one was half done.
TEST(Pieces, TwoContextsInTurn)
{
    OTL_NEED_GL(context);
    std::string problem;
    const auto second = HeadlessContext::create(8, 8, problem);
    ASSERT_TRUE(second) << problem;
    HeadlessContext* const contexts[] = {context, second.get()};
    ASSERT_NE(context->state().getContextID(), second->state().getContextID());
    const Scene scene = scenes().front();
    Scene later = scene;
    later.sky.sunAzimuth = 80.0;
    ASSERT_TRUE(context->makeCurrent());
    const auto whole = tileOf(later);
    ASSERT_TRUE(whole->update(context->state()).ok());
    const std::vector<osg::Vec4f> expected = lightOf(*whole, context->state());

    const auto tile = tileOf(scene);
    for (int i = 0; i < 50; ++i)
    {
        ASSERT_TRUE(context->makeCurrent());
        EXPECT_TRUE(runPiece(*tile, context->state(), 1));
    }
    tile->setSky(later.sky); // the second one takes it up
    bool goesOn[] = {true, true};
    for (int i = 0; goesOn[0] || goesOn[1]; ++i)
    {
        ASSERT_LT(i, 20000);
        for (const int which : {0, 1})
            if (goesOn[which])
            {
                ASSERT_TRUE(contexts[which]->makeCurrent());
                goesOn[which] = runPiece(*tile, contexts[which]->state(), 1);
            }
    }
    for (HeadlessContext* each : contexts)
    {
        ASSERT_TRUE(each->makeCurrent());
        EXPECT_FALSE(tile->isDirty(each->state().getContextID()));
        EXPECT_TRUE(lightOf(*tile, each->state()) == expected);
        EXPECT_EQ(takeGlErrors(), "");
    }
    tile->releaseGLObjects(&second->state());
    ASSERT_TRUE(context->makeCurrent());
}
