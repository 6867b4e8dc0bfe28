// Opens windows on a display, draws lit terrain in them while tiles and light change, and checks
// each window's picture. Arguments: threading model, count of windows. Exit code 0, or 77 where
// there is no display.
#include <osgTerrainLight/DynamicTerrain.h>
#include <osgTerrainLight/LightingHandler.h>
#include <osgTerrainLight/TerrainLighting.h>

#include "scene/TerrainModel.h"
#include "support/AnalyticTerrain.h"

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
} // namespace

int main(int argc, char** argv)
{
    const std::string model = argc > 1 ? argv[1] : "SingleThreaded";
    const int windows = argc > 2 ? std::atoi(argv[2]) : 1;

    const DemTile cone = analytic::cone(65, 65, 10.0, 32, 32, 250.0, 250.0);
    osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    lighting->setTimeBudget(0.0);
    lighting->addChild(createTerrain(cone));

    osgViewer::CompositeViewer viewer;
    std::vector<osg::ref_ptr<Flanks>> flanks;
    for (int i = 0; i < windows; ++i)
    {
        osg::ref_ptr<osg::GraphicsContext::Traits> traits = new osg::GraphicsContext::Traits;
        traits->readDISPLAY();
        traits->x = 20 + i * (side + 40);
        traits->y = 20;
        traits->width = traits->height = side;
        traits->doubleBuffer = true;
        osg::ref_ptr<osg::GraphicsContext> context =
            osg::GraphicsContext::createGraphicsContext(traits);
        if (!context)
            return 77;
        osg::ref_ptr<osgViewer::View> view = new osgViewer::View;
        osg::Camera& camera = *view->getCamera();
        camera.setGraphicsContext(context);
        camera.setViewport(0, 0, side, side);
        camera.setProjectionMatrixAsOrtho(-320, 320, -320, 320, 1.0, 1.0e6);
        camera.setViewMatrixAsLookAt(osg::Vec3d(0, 0, 5.0e5), osg::Vec3d(), osg::Vec3d(0, 1, 0));
        camera.setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
        flanks.push_back(new Flanks);
        camera.setFinalDrawCallback(flanks.back());
        view->setSceneData(lighting);
        viewer.addView(view);
    }
    viewer.setThreadingModel(model == "DrawThreadPerContext"
                                 ? osgViewer::ViewerBase::DrawThreadPerContext
                             : model == "CullThreadPerCameraDrawThreadPerContext"
                                 ? osgViewer::ViewerBase::CullThreadPerCameraDrawThreadPerContext
                                 : osgViewer::ViewerBase::SingleThreaded);
    viewer.realize();

    const unsigned contexts = static_cast<unsigned>(windows);
    const auto settle = [&]
    {
        for (int i = 0; i < 5; ++i)
            viewer.frame();
    };
    const auto check = [&](bool fromNorthWest, const std::string& when)
    {
        settle();
        for (const auto& flank : flanks)
        {
            const double difference = flank->northWest - flank->southEast;
            expect(fromNorthWest ? difference > 40.0 : difference < -40.0,
                   when + ": north-west less south-east is " + std::to_string(difference));
        }
    };
    check(true, "sun in the north-west");
    expect(lighting->getDispatchCount() == 4 * contexts, "each stage once per context");
    for (int i = 0; i < 20; ++i)
        viewer.frame();
    expect(lighting->getDispatchCount() == 4 * contexts, "a still scene dispatches nothing");

    SkyLight sky;
    for (int i = 0; i < 40; ++i) // every frame another light
    {
        sky.sunAzimuth = 135.0 + 9.0 * (i + 1);
        lighting->setSkyLight(sky);
        LightingSettings settings;
        settings.exposure = 0.01 * (i % 7);
        settings.azimuths = i % 10 == 5 ? 16 : 32;
        lighting->setSettings(settings);
        lighting->setLightEnabled(i % 5 != 3);
        viewer.frame();
    }
    sky.sunAzimuth = 135.0;
    lighting->setSkyLight(sky);
    lighting->setLightEnabled(true);
    check(false, "sun in the south-east");
    for (int i = 0; i < 20; ++i) // tiles come and go
    {
        osg::ref_ptr<osg::Node> terrain = createTerrain(cone);
        lighting->addChild(terrain);
        viewer.frame();
        if (i % 3)
            viewer.frame();
        lighting->removeChild(terrain);
        viewer.frame();
    }
    check(false, "after tiles came and went");
    {
        // What is being drawn is bound, changed and left again: a host's own, and a tile's heights.
        osg::ref_ptr<osg::Geometry> quad = osg::createTexturedQuadGeometry(
            osg::Vec3(-320, -320, -500), osg::Vec3(640, 0, 0), osg::Vec3(0, 640, 0));
        osg::StateSet* stateSet = quad->getOrCreateStateSet();
        stateSet->setDataVariance(osg::Object::DYNAMIC);
        osg::ref_ptr<osg::Node> dressed = createTerrain(cone);
        auto* tile = dynamic_cast<osgTerrain::TerrainTile*>(dressed->asGroup()->getChild(0));
        tile->getOrCreateStateSet()->setMode(GL_CULL_FACE, osg::StateAttribute::OFF);
        lighting->addChild(quad);
        lighting->addChild(dressed);
        TileHandle added;
        for (int i = 0; i < 40; ++i)
        {
            if (i % 2)
                expect(lighting->removeTile(added), "tile removed");
            else
                added = lighting->addTile(cone, stateSet, {}, true);
            expect(added.valid(), "tile added");
            tile->getElevationLayer()->dirty();
            tile->setDirty(i % 3 == 0);
            viewer.frame();
            expect(tile->getStateSet()->getDataVariance() == osg::Object::DYNAMIC,
                   "a bound StateSet is dynamic");
        }
        // Lighting that comes above what is already drawn.
        lighting->removeChild(dressed);
        lighting->removeChild(quad);
        for (int i = 0; i < 8; ++i)
            viewer.frame();
        expect(tile->getStateSet()->getDataVariance() == osg::Object::UNSPECIFIED &&
                   !tile->getStateSet()->getUniform(ShadingTexture::sampler),
               "a StateSet is left as it was");
        for (unsigned i = 0; i < contexts; ++i)
            viewer.getView(i)->setSceneData(dressed);
        for (int i = 0; i < 3; ++i)
            viewer.frame();
        osg::ref_ptr<TerrainLighting> late = new TerrainLighting;
        late->addChild(dressed);
        for (unsigned i = 0; i < contexts; ++i)
            viewer.getView(i)->setSceneData(late);
        viewer.frame();
        expect(!tile->getStateSet()->getUniform(ShadingTexture::sampler), "not bound while drawn");
        settle();
        expect(tile->getStateSet()->getUniform(ShadingTexture::sampler), "bound after a frame");
        for (unsigned i = 0; i < contexts; ++i)
            viewer.getView(i)->setSceneData(lighting);
    }
    check(false, "after edits of what is drawn");
    {
        // Heights that change in every frame, and at last are the cone's.
        osg::ref_ptr<DynamicTerrain> dynamic =
            new DynamicTerrain(analytic::plane(65, 65, 10.0, 0.0));
        int frame = 0;
        dynamic->setHeightCallback(
            [&](double, int, int, float* heights)
            {
                const bool last = ++frame > 60;
                for (std::size_t i = 0; i < cone.postCount(); ++i)
                    heights[i] = cone.heights()[i] * (last ? 1.0f : 0.02f * float(frame % 50));
                return frame <= 61;
            });
        osg::ref_ptr<osg::Node> still = lighting->getChild(0);
        lighting->setChild(0, dynamic);
        TileHandle added = lighting->addTile(dynamic);
        expect(added.valid(), "dynamic terrain added");
        for (int i = 0; i < 60; ++i)
        {
            lighting->setLightEnabled(i % 7 != 3);
            if (i % 10 == 5)
            {
                lighting->removeTile(added);
                viewer.frame();
                added = lighting->addTile(dynamic);
                expect(added.valid(), "dynamic terrain added again");
            }
            viewer.frame();
        }
        lighting->setLightEnabled(true);
        check(false, "after heights changed");
        const unsigned spent = lighting->getDispatchCount();
        settle();
        expect(lighting->getDispatchCount() == spent, "heights that stay dispatch nothing");
        lighting->removeTile(added);
        lighting->setChild(0, still);
    }
    check(false, "after dynamic terrain went");
    {
        // A clock that runs, in all windows.
        lighting->setPlace({11.5, 48.1, 0.0});
        lighting->addEventCallback(new LightingHandler);
        UtcTime time{};
        for (int i = 0; i < 40; ++i)
        {
            lighting->setTime(time + std::chrono::minutes(30 * i));
            viewer.frame();
        }
        lighting->removeEventCallback(lighting->getEventCallback());
        lighting->setSkyLight(sky);
    }
    check(false, "after a day");
    expect(lighting->getTileCount() == 1, "one tile is left");
    viewer.stopThreading();
    return failures ? 1 : 0;
}
