// Opens windows on a display, draws lit terrain in them while tiles and light change, and checks
// each window's picture. Arguments: threading model, count of windows. Exit code 0, or 77 where
// there is no display.
#include <osgTerrainLight/DynamicTerrain.h>
#include <osgTerrainLight/LightingHandler.h>
#include <osgTerrainLight/PlacedObject.h>
#include <osgTerrainLight/TerrainLighting.h>

#include "support/AnalyticTerrain.h"
#include "terrain/TerrainModel.h"

#include <osg/Geode>
#include <osg/MatrixTransform>
#include <osg/ShapeDrawable>
#include <osgTerrain/TerrainTile>
#include <osgViewer/CompositeViewer>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
constexpr int side = 200;

/// Mean red of the north-western and south-eastern flank of the cone in the middle.
class Flanks : public osg::Camera::DrawCallback
{
public:
    void operator()(osg::RenderInfo&) const override
    {
        northWest = meanAt(side / 2 - 25, side / 2 + 25);
        southEast = meanAt(side / 2 + 25, side / 2 - 25);
        if (const GLenum error = glGetError())
            std::cerr << "OpenGL error " << error << std::endl;
    }
    mutable std::atomic<double> northWest{0.0}, southEast{0.0};

private:
    static double meanAt(int x, int y)
    {
        std::vector<unsigned char> pixels(4 * 16 * 16);
        glReadPixels(x - 8, y - 8, 16, 16, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
        double sum = 0.0;
        for (std::size_t i = 0; i < pixels.size(); i += 4)
            sum += pixels[i];
        return sum / 256.0;
    }
};

int failures = 0;
void expect(bool condition, const std::string& what)
{
    if (!condition)
        std::cerr << "failed: " << what << std::endl;
    failures += condition ? 0 : 1;
}

osgViewer::ViewerBase::ThreadingModel threadingModel(const std::string& name)
{
    return name == "DrawThreadPerContext"       ? osgViewer::ViewerBase::DrawThreadPerContext
           : name == "CullDrawThreadPerContext" ? osgViewer::ViewerBase::CullDrawThreadPerContext
           : name == "CullThreadPerCameraDrawThreadPerContext"
               ? osgViewer::ViewerBase::CullThreadPerCameraDrawThreadPerContext
               : osgViewer::ViewerBase::SingleThreaded;
}

/// A lit cone in windows that look straight down on it. Every function that changes what is drawn
/// leaves the light in the south-east and the one tile.
class Windows
{
public:
    Windows() : _cone(analytic::cone(65, 65, 10.0, 32, 32, 250.0, 250.0))
    {
        _lighting->setTimeBudget(0.0);
        _lighting->addChild(createTerrain(_cone));
        _southEast.sunAzimuth = 135.0;
    }

    bool open(int count, osgViewer::ViewerBase::ThreadingModel model);
    void stillScene();
    void anotherLightInEveryFrame();
    void tilesComeAndGo();
    void levelsComeAndGo();
    void editsOfWhatIsDrawn();
    void heightsThatChange();
    void objectsThatMove();
    void aRunningClock();
    void close();

private:
    bool openOne(int place);
    void frames(int count)
    {
        for (int i = 0; i < count; ++i)
            _viewer.frame();
    }
    void settle() { frames(5); }
    void check(bool fromNorthWest, const std::string& when);
    void bindAndRelease(osg::Geometry& host, osgTerrain::TerrainTile& tile);
    void lightingComesAbove(osg::Node* terrain, osgTerrain::TerrainTile& tile);
    void show(osg::Node* scene)
    {
        for (unsigned i = 0; i < _viewer.getNumViews(); ++i)
            _viewer.getView(i)->setSceneData(scene);
    }

    const DemTile _cone;
    const osg::ref_ptr<TerrainLighting> _lighting = new TerrainLighting;
    SkyLight _southEast;
    osgViewer::CompositeViewer _viewer;
    std::vector<osg::ref_ptr<Flanks>> _flanks; ///< per window
};

/// False where there is no display.
bool Windows::open(int count, osgViewer::ViewerBase::ThreadingModel model)
{
    for (int i = 0; i < count; ++i)
        if (!openOne(i))
            return false;
    _viewer.setThreadingModel(model);
    _viewer.realize();
    return true;
}

bool Windows::openOne(int place)
{
    osg::ref_ptr<osg::GraphicsContext::Traits> traits = new osg::GraphicsContext::Traits;
    traits->readDISPLAY();
    traits->x = 20 + place * (side + 40);
    traits->y = 20;
    traits->width = traits->height = side;
    traits->doubleBuffer = true;
    osg::ref_ptr<osg::GraphicsContext> context =
        osg::GraphicsContext::createGraphicsContext(traits);
    if (!context)
        return false;
    osg::ref_ptr<osgViewer::View> view = new osgViewer::View;
    osg::Camera& camera = *view->getCamera();
    camera.setGraphicsContext(context);
    camera.setViewport(0, 0, side, side);
    camera.setProjectionMatrixAsOrtho(-320, 320, -320, 320, 1.0, 1.0e6);
    camera.setViewMatrixAsLookAt(osg::Vec3d(0, 0, 5.0e5), osg::Vec3d(), osg::Vec3d(0, 1, 0));
    camera.setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
    _flanks.push_back(new Flanks);
    camera.setFinalDrawCallback(_flanks.back());
    view->setSceneData(_lighting);
    _viewer.addView(view);
    return true;
}

void Windows::check(bool fromNorthWest, const std::string& when)
{
    settle();
    for (const auto& flank : _flanks)
    {
        const double difference = flank->northWest - flank->southEast;
        expect(fromNorthWest ? difference > 40.0 : difference < -40.0,
               when + ": north-west less south-east is " + std::to_string(difference));
    }
}

void Windows::stillScene()
{
    check(true, "sun in the north-west");
    const unsigned all = 4 * _viewer.getNumViews();
    expect(_lighting->getDispatchCount() == all, "each stage once per context");
    frames(20);
    expect(_lighting->getDispatchCount() == all, "a still scene dispatches nothing");
}

void Windows::anotherLightInEveryFrame()
{
    SkyLight sky;
    for (int i = 0; i < 40; ++i)
    {
        sky.sunAzimuth = 135.0 + 9.0 * (i + 1);
        _lighting->setSkyLight(sky);
        LightingSettings settings;
        settings.exposure = 0.01 * (i % 7);
        settings.azimuths = i % 10 == 5 ? 16 : 32;
        _lighting->setSettings(settings);
        _lighting->setLightEnabled(i % 5 != 3);
        _viewer.frame();
    }
    _lighting->setSkyLight(_southEast);
    _lighting->setLightEnabled(true);
    check(false, "sun in the south-east");
}

void Windows::tilesComeAndGo()
{
    for (int i = 0; i < 20; ++i)
    {
        osg::ref_ptr<osg::Node> terrain = createTerrain(_cone);
        _lighting->addChild(terrain);
        _viewer.frame();
        if (i % 3)
            _viewer.frame();
        _lighting->removeChild(terrain);
        _viewer.frame();
    }
    check(false, "after tiles came and went");
}

/// Tiles below a lit one, which wait with its light, fade, and go before and after they have; the
/// lit one goes and comes meanwhile.
void Windows::levelsComeAndGo()
{
    const auto tile = [this](int level, double down)
    {
        const osg::ref_ptr<osg::Node> terrain = createTerrain(_cone);
        dynamic_cast<osgTerrain::TerrainTile&>(*terrain->asGroup()->getChild(0))
            .setTileID(osgTerrain::TileID(level, 0, 0));
        osg::ref_ptr<osg::MatrixTransform> place =
            new osg::MatrixTransform(osg::Matrix::translate(0.0, 0.0, -down));
        place->addChild(terrain);
        return place;
    };
    _lighting->setFadeSeconds(0.02);
    osg::ref_ptr<osg::MatrixTransform> above = tile(1, 1000.0);
    _lighting->addChild(above);
    settle();
    for (int i = 0; i < 30; ++i)
    {
        const osg::ref_ptr<osg::MatrixTransform> below = tile(2, 500.0);
        _lighting->addChild(below);
        frames(1 + i % 7);
        if (i % 5 == 0)
        {
            _lighting->removeChild(above);
            frames(1 + i % 4);
            _lighting->addChild(above = tile(1, 1000.0));
            frames(2);
        }
        _lighting->removeChild(below);
    }
    _lighting->removeChild(above);
    check(false, "after levels came and went");
}

/// What is being drawn is bound, changed and left again: a host's own, and a tile's heights.
void Windows::editsOfWhatIsDrawn()
{
    {
        osg::ref_ptr<osg::Geometry> quad = osg::createTexturedQuadGeometry(
            osg::Vec3(-320, -320, -500), osg::Vec3(640, 0, 0), osg::Vec3(0, 640, 0));
        osg::ref_ptr<osg::Node> dressed = createTerrain(_cone);
        auto* tile = dynamic_cast<osgTerrain::TerrainTile*>(dressed->asGroup()->getChild(0));
        tile->getOrCreateStateSet()->setMode(GL_CULL_FACE, osg::StateAttribute::OFF);
        _lighting->addChild(quad);
        _lighting->addChild(dressed);
        bindAndRelease(*quad, *tile);
        _lighting->removeChild(dressed);
        _lighting->removeChild(quad);
        frames(8);
        expect(tile->getStateSet()->getDataVariance() == osg::Object::UNSPECIFIED &&
                   !tile->getStateSet()->getUniform(ShadingTexture::sampler),
               "a StateSet is left as it was");
        lightingComesAbove(dressed, *tile);
    }
    check(false, "after edits of what is drawn");
}

void Windows::bindAndRelease(osg::Geometry& host, osgTerrain::TerrainTile& tile)
{
    osg::StateSet* stateSet = host.getOrCreateStateSet();
    stateSet->setDataVariance(osg::Object::DYNAMIC);
    TileHandle added;
    // From the middle on with a place, and a tile beside it that comes and goes and is edited.
    DemTile placed = _cone, next = _cone;
    placed.mapStepX = placed.mapStepY = next.mapStepX = next.mapStepY = _cone.northSpacing;
    next.mapOriginX = _cone.northSpacing * (_cone.width() - 1);
    const osg::ref_ptr<osg::StateSet> beside = new osg::StateSet;
    const TileHandle name = TileHandle::at(9, 0, 0), nextName = TileHandle::at(9, 1, 0);
    for (int i = 0; i < 120; ++i)
    {
        const bool first = i < 40;
        if (first ? i % 2 == 1 : i % 20 == 10)
            expect(_lighting->removeTile(added), "tile removed");
        else if (first || i % 20 == 0)
            added = first ? _lighting->addTile(_cone, stateSet, {}, true)
                          : _lighting->addTile(placed, stateSet, {}, true, name);
        if (!first && i % 6 == 0)
            expect(_lighting->addTile(next, beside, {}, false, nextName).valid(), "tile beside");
        if (!first && i % 6 == 2)
            expect(_lighting->setTileHeights(
                       nextName, std::vector<float>(_cone.postCount(), static_cast<float>(i))),
                   "tile beside edited");
        if (i > 42 && i % 6 == 5)
            expect(_lighting->removeTile(nextName), "tile beside removed");
        expect(added.valid(), "tile added");
        tile.getElevationLayer()->dirty();
        tile.setDirty(i % 3 == 0);
        _viewer.frame();
        expect(tile.getStateSet()->getDataVariance() == osg::Object::DYNAMIC,
               "a bound StateSet is dynamic");
    }
}

/// Lighting that comes above what is already drawn.
void Windows::lightingComesAbove(osg::Node* terrain, osgTerrain::TerrainTile& tile)
{
    show(terrain);
    frames(3);
    osg::ref_ptr<TerrainLighting> late = new TerrainLighting;
    late->addChild(terrain);
    show(late);
    _viewer.frame();
    expect(!tile.getStateSet()->getUniform(ShadingTexture::sampler), "not bound while drawn");
    settle();
    expect(tile.getStateSet()->getUniform(ShadingTexture::sampler), "bound after a frame");
    show(_lighting);
}

/// Objects come, move, turn, are of other fields and go, with and without a budget, so that volumes
/// and what they do to the ground are computed anew while they are drawn.
void Windows::objectsThatMove()
{
    const auto object = [](double size)
    {
        const osg::ref_ptr<osg::Geode> geode = new osg::Geode;
        geode->addDrawable(new osg::ShapeDrawable(new osg::Box(osg::Vec3(), float(size))));
        const osg::ref_ptr<PlacedObject> placed = new PlacedObject;
        placed->addChild(geode);
        return placed;
    };
    const osg::ref_ptr<osg::MatrixTransform> moving = new osg::MatrixTransform;
    const osg::ref_ptr<PlacedObject> first = object(8.0), second = object(12.0);
    moving->addChild(first);
    _lighting->addChild(moving);
    for (int i = 0; i < 80; ++i)
    {
        moving->setMatrix(osg::Matrix::rotate(0.1 * i, osg::Z_AXIS) *
                          osg::Matrix::translate(200.0 - i, 200.0, 10.0));
        _lighting->setTimeBudget(i % 20 < 10 ? 0.0 : 1.0e-3);
        if (i % 10 == 3)
            _lighting->addChild(second);
        if (i % 10 == 8)
            _lighting->removeChild(second);
        first->setField(i % 30 < 15 ? PlacedObject::Field::Automatic : PlacedObject::Field::Mesh);
        _viewer.frame();
    }
    _lighting->removeChild(moving);
    _lighting->setTimeBudget(0.0);
    check(false, "after objects came and went");
}

/// Heights that change in every frame, and at last are the cone's.
void Windows::heightsThatChange()
{
    {
        osg::ref_ptr<DynamicTerrain> dynamic =
            new DynamicTerrain(analytic::plane(65, 65, 10.0, 0.0));
        int frame = 0;
        dynamic->setHeightCallback(
            [&](double, int, int, float* heights)
            {
                const bool last = ++frame > 60;
                for (std::size_t i = 0; i < _cone.postCount(); ++i)
                    heights[i] = _cone.heights()[i] * (last ? 1.0f : 0.02f * float(frame % 50));
                return frame <= 61;
            });
        osg::ref_ptr<osg::Node> still = _lighting->getChild(0);
        _lighting->setChild(0, dynamic);
        TileHandle added = _lighting->addTile(dynamic);
        expect(added.valid(), "dynamic terrain added");
        for (int i = 0; i < 60; ++i)
        {
            _lighting->setLightEnabled(i % 7 != 3);
            if (i % 10 == 5)
            {
                _lighting->removeTile(added);
                _viewer.frame();
                added = _lighting->addTile(dynamic);
                expect(added.valid(), "dynamic terrain added again");
            }
            _viewer.frame();
        }
        _lighting->setLightEnabled(true);
        check(false, "after heights changed");
        const unsigned spent = _lighting->getDispatchCount();
        settle();
        expect(_lighting->getDispatchCount() == spent, "heights that stay dispatch nothing");
        _lighting->removeTile(added);
        _lighting->setChild(0, still);
    }
    check(false, "after dynamic terrain went");
}

void Windows::aRunningClock()
{
    _lighting->setPlace({11.5, 48.1, 0.0});
    _lighting->addEventCallback(new LightingHandler);
    UtcTime time{};
    for (int i = 0; i < 40; ++i)
    {
        _lighting->setTime(time + std::chrono::minutes(30 * i));
        _viewer.frame();
    }
    _lighting->removeEventCallback(_lighting->getEventCallback());
    _lighting->setSkyLight(_southEast);
    check(false, "after a day");
}

void Windows::close()
{
    expect(_lighting->getTileCount() == 1, "one tile is left");
    _viewer.stopThreading();
}
} // namespace

int main(int argc, char** argv)
{
    Windows windows;
    if (!windows.open(argc > 2 ? std::atoi(argv[2]) : 1,
                      threadingModel(argc > 1 ? argv[1] : "SingleThreaded")))
        return 77;
    windows.stillScene();
    windows.anotherLightInEveryFrame();
    windows.tilesComeAndGo();
    windows.levelsComeAndGo();
    windows.editsOfWhatIsDrawn();
    windows.heightsThatChange();
    windows.objectsThatMove();
    windows.aRunningClock();
    windows.close();
    return failures ? 1 : 0;
}
