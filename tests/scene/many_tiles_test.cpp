// Handles, states and many tiles: what is computed first, what a still scene
// costs, and that nothing waits for a dispatch.
#include <osgTerrainLight/TerrainLighting.h>

#include "gpu/Textures.h"
#include "scene/Scheduler.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/ScenePicture.h"
#include "terrain/TerrainModel.h"

#include <osg/MatrixTransform>
#include <osgTerrain/TerrainTile>
#include <osgUtil/UpdateVisitor>

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <future>

using namespace osgTerrainLight;

namespace
{
constexpr double reach = 320.0;

/// A cone of 640 m across, moved east; its tile has an ID where level >= 0.
osg::ref_ptr<osg::MatrixTransform> coneAt(double east, int level = -1, int x = 0)
{
    osg::ref_ptr<osg::Node> terrain =
        createTerrain(analytic::cone(33, 33, 20.0, 16, 16, 200.0, 200.0));
    auto* tile = dynamic_cast<osgTerrain::TerrainTile*>(terrain->asGroup()->getChild(0));
    if (level >= 0)
        tile->setTileID(osgTerrain::TileID(level, x, 0));
    osg::ref_ptr<osg::MatrixTransform> place =
        new osg::MatrixTransform(osg::Matrix::translate(east, 0.0, 0.0));
    place->addChild(terrain);
    return place;
}

osgTerrain::TerrainTile* tileOf(osg::MatrixTransform& place)
{
    return dynamic_cast<osgTerrain::TerrainTile*>(place.getChild(0)->asGroup()->getChild(0));
}

osg::ref_ptr<osg::Geometry> quad()
{
    osg::ref_ptr<osg::Geometry> geometry = osg::createTexturedQuadGeometry(
        osg::Vec3(-320, -320, 0), osg::Vec3(640, 0, 0), osg::Vec3(0, 640, 0));
    geometry->setTexCoordArray(ShadingTexture::coordinateSet, geometry->getTexCoordArray(0));
    return geometry;
}
} // namespace

TEST(Tiles, HaveHandlesByLevelAndPlaceOrByNumber)
{
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 8);
    const auto named = coneAt(0.0, 3, 7);
    const auto twin = coneAt(640.0, 3, 7); // has the same ID, in another database
    const auto nameless = coneAt(1280.0);
    const TileHandle name = lighting->getTileHandle(tileOf(*named));
    EXPECT_EQ(name, TileHandle::at(3, 7, 0));
    const TileHandle other = lighting->getTileHandle(tileOf(*twin));
    const TileHandle number = lighting->getTileHandle(tileOf(*nameless));
    EXPECT_TRUE(other && number);
    EXPECT_EQ(other.level, -1);
    EXPECT_NE(other, number);
    EXPECT_EQ(number, lighting->getTileHandle(tileOf(*nameless))) << "it stays";
    EXPECT_FALSE(lighting->getTileHandle(nullptr));
    EXPECT_EQ(lighting->getTileState(name).stage, TileState::Stage::Unknown) << "not found yet";

    const osg::ref_ptr<osg::StateSet> first = new osg::StateSet, second = new osg::StateSet;
    const DemTile dem = analytic::plane(5, 5, 10.0, 0.0);
    EXPECT_EQ(lighting->addTile(dem, first, {}, false, TileHandle::at(1, 2, 3)),
              TileHandle::at(1, 2, 3));
    Said said;
    EXPECT_FALSE(lighting->addTile(dem, second, {}, false, TileHandle::at(1, 2, 3)));
    EXPECT_EQ(said.count("tile not added"), 1);
    EXPECT_EQ(lighting->getTileState(TileHandle::at(1, 2, 3)).stage, TileState::Stage::Waiting);
    EXPECT_FALSE(lighting->setTileHeights(TileHandle::at(9, 9, 9), {}));
    EXPECT_FALSE(lighting->setTileAlbedo(TileHandle::at(1, 2, 3), {{0.5f, 0.5f, 0.5f}}));
    EXPECT_EQ(said.count("of tile not set"), 2);
    EXPECT_TRUE(lighting->removeTile(TileHandle::at(1, 2, 3)));
    EXPECT_FALSE(lighting->removeTile(TileHandle::at(1, 2, 3)));
    EXPECT_EQ(lighting->getTileState(TileHandle::at(1, 2, 3)).stage, TileState::Stage::Unknown);
}

// Expected: one warning per TerrainLighting, once it has had two tiles that are lit alone in so
// many updates in which no tile came; none where tiles that come meanwhile touch those that are
// there.
TEST(Tiles, BesideOthersAreSaidToBeLitAloneOnce)
{
    const char* warning = "Each of them is lit alone, so its shadows end at its edge";
    const DemTile dem = analytic::plane(5, 5, 10.0, 0.0);
    std::vector<osg::ref_ptr<osg::StateSet>> states;
    const auto add = [&](TerrainLighting& lighting)
    {
        states.emplace_back(new osg::StateSet);
        return lighting.addTile(dem, states.back());
    };
    const auto update = [](TerrainLighting& lighting, int count)
    {
        osgUtil::UpdateVisitor visitor;
        for (int i = 0; i < count; ++i)
            lighting.accept(visitor);
    };
    constexpr int enough = Scheduler::updatesToTellAlone;
    {
        Said said;
        const osg::ref_ptr<TerrainLighting> one = lightingWithBudget(0.0, 8);
        for (int i = 0; i < 3; ++i) // one after the other
            EXPECT_TRUE(one->removeTile(add(*one)));
        add(*one);
        update(*one, 2 * enough);
        EXPECT_EQ(said.text(), "");
        TileHandle second = add(*one);
        update(*one, enough - 1);
        EXPECT_EQ(said.text(), "") << "more may come";
        add(*one);
        update(*one, enough - 1);
        EXPECT_EQ(said.text(), "") << "one has come";
        update(*one, 1);
        EXPECT_EQ(said.count(warning), 1);
        one->removeTile(second);
        add(*one);
        update(*one, 2 * enough);
        EXPECT_EQ(said.count(warning), 1) << said.text();
        const osg::ref_ptr<TerrainLighting> other = lightingWithBudget(0.0, 8);
        add(*other);
        update(*other, 2 * enough);
        EXPECT_EQ(said.count(warning), 1) << "alone in a scene of its own";
        second = add(*other);
        update(*other, enough - 1);
        other->removeTile(second);
        update(*other, enough);
        EXPECT_EQ(said.count(warning), 1) << "one has gone";
        add(*other);
        update(*other, enough);
        EXPECT_EQ(said.count(warning), 2);
    }
    // Found in a scene: two that touch no other one, until one comes between them.
    OTL_NEED_GL(context);
    Said said;
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 8);
    lighting->addChild(coneAt(-640.0));
    lighting->addChild(coneAt(640.0));
    ScenePicture picture(lighting, reach);
    picture.draw(enough - 1);
    lighting->addChild(coneAt(0.0));
    picture.draw(2 * enough);
    EXPECT_EQ(lighting->getTileCount(), 3u);
    EXPECT_EQ(said.text(), "");
    lighting->addChild(coneAt(5000.0));
    lighting->addChild(coneAt(-5000.0));
    picture.draw(2 + enough);
    EXPECT_EQ(said.count(warning), 1) << said.text();
}

// Expected: with time for one piece a frame, the tile in view is lit first, then the nearer of the
// two beside it. They were added in the other order. Each takes more frames than it has stages:
// horizon, sky, sun, shade.
TEST(Tiles, TheOneThatIsSeenBestComesFirst)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(1.0e-6, 8);
    const double places[] = {50000.0, 9000.0, 0.0};
    std::vector<TileHandle> handles;
    for (const double east : places)
    {
        const auto place = coneAt(east);
        lighting->addChild(place);
        handles.push_back(lighting->getTileHandle(tileOf(*place)));
    }
    ScenePicture picture(lighting, reach);
    using Stage = TileState::Stage;
    const auto stages = [&]
    {
        std::vector<Stage> all;
        for (const TileHandle& handle : handles)
            all.push_back(lighting->getTileState(handle).stage);
        return all;
    };
    picture.draw(); // finds them
    for (const std::vector<Stage>& next : {std::vector{Stage::Waiting, Stage::Waiting, Stage::Lit},
                                           std::vector{Stage::Waiting, Stage::Lit, Stage::Lit},
                                           std::vector{Stage::Lit, Stage::Lit, Stage::Lit}})
    {
        const std::vector<Stage> before = stages();
        int frames = 0;
        for (; stages() == before && frames < 1000; ++frames)
            picture.draw();
        EXPECT_EQ(stages(), next);
        EXPECT_GE(frames, 4);
    }
}

// Expected: counts. One more tile costs a look at the nodes above it and its
// own, twice at most, as its geometry may dirty its bound once more.
TEST(Tiles, AStillSceneOfAThousandIsNotLookedAt)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 8);
    osg::ref_ptr<osg::Group> group;
    for (int i = 0; i < 1000; ++i)
    {
        if (i % 40 == 0)
            lighting->addChild(group = new osg::Group);
        group->addChild(createTerrain(analytic::plane(3, 3, 10.0, 1.0 * i)));
    }
    ScenePicture picture(lighting, reach);
    picture.draw(8);
    EXPECT_EQ(lighting->getTileCount(), 1000u);
    const unsigned dispatches = lighting->getDispatchCount();
    unsigned visits = lighting->getVisitCount();
    picture.draw(10);
    EXPECT_EQ(lighting->getDispatchCount(), dispatches);
    EXPECT_EQ(lighting->getVisitCount(), visits);
    group->addChild(createTerrain(analytic::plane(3, 3, 10.0, 0.0)));
    picture.draw(3);
    EXPECT_EQ(lighting->getTileCount(), 1001u);
    EXPECT_LE(lighting->getVisitCount() - visits,
              2u * 4u); // lighting, group, terrain, tile
}

// Expected: heights and albedo are what was set: a plane shadows nothing, a
// cone its far side; and under a white sky red ground sends red light only.
TEST(Tiles, HeightsAndAlbedoOfAnAddedTileChange)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 8);
    const osg::ref_ptr<osg::Geometry> geometry = quad();
    lighting->addChild(geometry);
    osg::StateSet* stateSet = geometry->getOrCreateStateSet();
    const TileHandle tile =
        lighting->addTile(analytic::plane(33, 33, 20.0, 0.0), stateSet, {}, true);
    ScenePicture picture(lighting, reach);
    picture.draw(2);
    const double level = picture.redAt(0.3, -0.3);
    const DemTile cone = analytic::cone(33, 33, 20.0, 16, 16, 200.0, 200.0);
    EXPECT_TRUE(lighting->setTileHeights(tile, cone.heights()));
    picture.draw(2);
    EXPECT_LT(picture.redAt(0.3, -0.3), level - 40.0);

    const DemTile valley = analytic::makeTile(
        33, 33, 20.0, [](int column, int) { return 15.0 * std::abs(column - 16); });
    EXPECT_TRUE(lighting->setTileHeights(tile, valley.heights()));
    SkyLight sky;
    sky.sunEnabled = false;
    lighting->setSkyLight(sky);
    const auto bottom = [&]
    {
        picture.draw(2);
        auto* shading = dynamic_cast<osg::Texture2D*>(stateSet->getTextureAttribute(
            lighting->getTextureUnit(), osg::StateAttribute::TEXTURE));
        const std::vector<float> values = readFloats(picture.state(), *shading, 4);
        const std::size_t post = 4 * (16 * 33 + 16);
        return osg::Vec2f(values[post], values[post + 1]);
    };
    const osg::Vec2f direct = bottom();
    EXPECT_TRUE(lighting->setTileAlbedo(tile, std::vector<Rgb>(33 * 33, Rgb{1.0f, 0.0f, 0.0f})));
    LightingSettings settings = lighting->getSettings();
    settings.bounces = 1;
    lighting->setSettings(settings);
    const osg::Vec2f red = bottom();
    EXPECT_GT(red.x(), 1.05f * direct.x());
    EXPECT_EQ(red.y(), direct.y());
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: setters come back while a tile is being computed, that is between
// two of its steps, when update() holds whatever it holds during a dispatch.
TEST(Tiles, SettersDoNotWaitForADispatch)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<Scheduler> scheduler = new Scheduler;
    const osg::ref_ptr<LitTile> tile =
        new LitTile("tile", analytic::plane(9, 9, 10.0, 0.0), scheduler->light());
    scheduler->add(tile);
    class Asking : public WorkPace
    {
    public:
        explicit Asking(std::function<void(int)> ask) : _ask(std::move(ask)) {}
        int asked = 0;

    protected:
        bool mayContinue() override
        {
            _ask(++asked);
            return true;
        }

    private:
        std::function<void(int)> _ask;
    } pace(
        [&](int asked)
        {
            auto setters = std::async(std::launch::async,
                                      [&]
                                      {
                                          SkyLight sky;
                                          sky.sunAzimuth = 10.0 * asked;
                                          scheduler->setSky(sky);
                                          scheduler->setSettings(LightingSettings());
                                          tile->lighting().setHeights(std::vector<float>(81, 1.0f));
                                          tile->lighting().setAlbedo({});
                                          tile->lighting().setGloss({});
                                          tile->lighting().setProbes({});
                                          tile->lighting().glossLight();
                                          tile->state();
                                      });
            // Where one waited it would come back only after this.
            EXPECT_EQ(setters.wait_for(std::chrono::seconds(20)), std::future_status::ready);
        });
    EXPECT_TRUE(tile->update(context->state(), scheduler->light(), &pace).ok());
    EXPECT_GT(pace.asked, 0);
    EXPECT_TRUE(tile->isBehind(context->state().getContextID(), scheduler->light()));
}

// Expected: a tile whose light changes in every frame, with time for one of its pieces in each,
// is lit all the same: a change is taken over once the one before has been computed.
TEST(Tiles, LightThatChangesInEveryFrameIsComputedWithinABudget)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(1.0e-6, 8);
    lighting->addChild(coneAt(0.0));
    ScenePicture picture(lighting, reach);
    const auto shaded = [&] { return lighting->getDispatchCounts()["shade"]; };
    for (int frame = 0; shaded() == 0 && frame < 1000; ++frame)
        picture.draw();
    picture.draw(2);
    ASSERT_EQ(shaded(), 1u);
    SkyLight sky;
    int frames = 0;
    for (; shaded() < 5 && frames < 1000; ++frames)
    {
        sky.sunAzimuth += 0.1;
        lighting->setSkyLight(sky);
        picture.draw();
    }
    EXPECT_EQ(shaded(), 5u);
    EXPECT_GE(frames, 8) << "sun and shade are a piece each, at least";
    picture.draw(frames);
    EXPECT_EQ(shaded(), 6u) << "the last of them";
}

// Expected: gloss is bound to the unit that was set before some of the ground
// was glossy.
TEST(Tiles, GlossHasTheTextureUnitThatWasSet)
{
    OTL_NEED_GL(context);
    Said said;
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 8);
    const osg::ref_ptr<osg::Geometry> geometry = quad();
    lighting->addChild(geometry);
    osg::StateSet* stateSet = geometry->getOrCreateStateSet();
    EXPECT_TRUE(lighting->addTile(analytic::plane(9, 9, 80.0, 0.0), stateSet, {}, true));
    lighting->setGlossUnit(9);
    LightingSettings settings = lighting->getSettings();
    settings.gloss = 0.5;
    lighting->setSettings(settings);
    ScenePicture picture(lighting, reach);
    picture.draw(3);
    EXPECT_TRUE(stateSet->getTextureAttribute(9, osg::StateAttribute::TEXTURE));
    EXPECT_FALSE(
        stateSet->getTextureAttribute(ShadingTexture::glossUnit, osg::StateAttribute::TEXTURE));
    lighting->setGlossUnit(5);
    EXPECT_EQ(lighting->getGlossUnit(), 9u);
    EXPECT_EQ(said.count("gloss unit not set"), 1);
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: on a clock that moves by 1 ms whenever it is read, three times per piece, no frame
// spends more than 1.2 times its budget, and the light is that of one go, to the last bit. Nothing
// runs once it is there.
TEST(Tiles, NoFrameSpendsMuchMoreThanItsBudget)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    double time = 0.0;
    const osg::ref_ptr<Scheduler> scheduler = new Scheduler([&time] { return time += 1.0; });
    scheduler->budget = 40.0;
    LightingSettings settings;
    settings.azimuths = 8;
    settings.bounces = 1;
    scheduler->setSettings(settings);
    const DemTile cone = analytic::cone(65, 65, 20.0, 32, 32, 300.0, 400.0);
    std::vector<osg::ref_ptr<LitTile>> tiles;
    for (int i = 0; i < 2; ++i)
    {
        tiles.push_back(new LitTile("tile", cone, scheduler->light()));
        scheduler->add(tiles.back());
    }
    SkyLight sky;
    for (const double azimuth : {250.0, 100.0})
    {
        sky.sunAzimuth = azimuth;
        scheduler->setSky(sky);
        int frames = 0;
        for (; !scheduler->isDone(state.getContextID()) && frames < 1000; ++frames)
        {
            scheduler->compute(state);
            EXPECT_GT(scheduler->milliseconds(), 0.0);
            EXPECT_LE(scheduler->milliseconds(), 48.0);
        }
        EXPECT_TRUE(scheduler->isDone(state.getContextID()));
        EXPECT_GT(frames, 3);
        const double before = time;
        scheduler->compute(state);
        EXPECT_LE(time, before + 3.0) << "no piece ran";
        const osg::ref_ptr<TileLight> whole = new TileLight(cone, settings, sky);
        ASSERT_TRUE(whole->update(state).ok());
        for (const auto& tile : tiles)
            EXPECT_TRUE(tile->lighting().readShading(state).values() ==
                        whole->readShading(state).values());
    }
    EXPECT_EQ(takeGlErrors(), "");
}
