// Ground whose heights change in every frame, with its light. See usage() below.
#include "Heights.h"

#include <osgTerrainLight/DynamicTerrain.h>
#include <osgTerrainLight/HeadlessContext.h>
#include <osgTerrainLight/LightingHandler.h>
#include <osgTerrainLight/TerrainLighting.h>

#include <osgDB/ReadFile>
#include <osgDB/WriteFile>
#include <osgTerrain/Layer>
#include <osgTerrain/TerrainTile>
#include <osgViewer/Viewer>
#include <osgViewer/ViewerEventHandlers>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>

using namespace osgTerrainLight;

namespace
{
int usage()
{
    std::cerr << "dynamic waves|dunes|craters [options] [DEM]\n"
                 "  DEM           any raster that GDAL reads, to dig in; for craters\n"
                 "  --posts N     posts a side of ground that is made up, 16 to 2048; default 256\n"
                 "  --bounces N   of light from ground to ground, 0 to 8; default 1\n"
                 "  --frames N    draw N frames without a window, print times and OpenGL errors\n"
                 "  --picture F   with --frames: write the last frame\n"
                 "Ctrl and left click digs a crater.\n";
    return 2;
}

/// Heights of a DEM through the plugin of this project. Empty where it cannot be read.
DemTile readDem(const std::string& path)
{
    class Finder : public osg::NodeVisitor
    {
    public:
        Finder() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
        osgTerrain::TerrainTile* found = nullptr;
        void apply(osg::Group& group) override
        {
            if (auto* tile = dynamic_cast<osgTerrain::TerrainTile*>(&group))
                found = tile;
            else
                traverse(group);
        }
    } finder;
    const osg::ref_ptr<osg::Node> scene = osgDB::readRefNodeFile(path + ".terrainlight");
    if (!scene)
        return {};
    scene->accept(finder);
    const auto* layer =
        finder.found
            ? dynamic_cast<const osgTerrain::HeightFieldLayer*>(finder.found->getElevationLayer())
            : nullptr;
    if (!layer)
        return {};
    const osg::HeightField& field = *layer->getHeightField();
    const osg::Matrixd& place = layer->getLocator()->getTransform();
    DemTile tile(static_cast<int>(field.getNumColumns()), static_cast<int>(field.getNumRows()),
                 place(1, 1) / (field.getNumRows() - 1));
    tile.eastSpacings = {place(0, 0) / (field.getNumColumns() - 1)};
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column) // its voids are too low to be heights
            tile.setHeight(
                column, row,
                field.getHeight(static_cast<unsigned>(column), static_cast<unsigned>(row)));
    return tile;
}

/// Digs where ctrl and a click meet the ground as it is now.
class Digger : public osgGA::GUIEventHandler
{
public:
    Digger(Heights& ground, const std::vector<float>& heights) : _ground(ground), _heights(heights)
    {
    }

    using osgGA::GUIEventHandler::handle;
    bool handle(const osgGA::GUIEventAdapter& event, osgGA::GUIActionAdapter& action) override
    {
        auto* view = dynamic_cast<osgViewer::View*>(&action);
        if (!view || event.getEventType() != osgGA::GUIEventAdapter::PUSH ||
            event.getButton() != osgGA::GUIEventAdapter::LEFT_MOUSE_BUTTON ||
            !(event.getModKeyMask() & osgGA::GUIEventAdapter::MODKEY_CTRL))
            return false;
        const osg::Camera& camera = *view->getCamera();
        osg::Matrixd toScene;
        toScene.invert(camera.getViewMatrix() * camera.getProjectionMatrix());
        const double x = event.getXnormalized();
        const double y = event.getYnormalized();
        meet(osg::Vec3d(x, y, -1.0) * toScene, osg::Vec3d(x, y, 1.0) * toScene);
        return true;
    }

private:
    void meet(const osg::Vec3d& from, const osg::Vec3d& to)
    {
        const DemTile& tile = _ground.tile;
        // Steps of half a post across, whatever the ray's slope is.
        const double across = std::hypot((to - from).x() / tile.nominalEastSpacing(),
                                         (to - from).y() / tile.northSpacing);
        const double steps = std::min(2.0 * across + 2.0, 1.0e6);
        for (double i = 0.0; i < steps; ++i)
        {
            const osg::Vec3d point = from + (to - from) * (i / steps);
            const double column = point.x() / tile.nominalEastSpacing() + 0.5 * (tile.width() - 1);
            const double row = point.y() / tile.northSpacing + 0.5 * (tile.height() - 1);
            if (column < 0.0 || row < 0.0 || column > tile.width() - 1 || row > tile.height() - 1)
                continue;
            const auto post =
                static_cast<std::size_t>(std::lround(row) * tile.width() + std::lround(column));
            if (point.z() <= static_cast<double>(_heights[post])) // false for a void
            {
                _ground.dig(column, row);
                return;
            }
        }
    }

    Heights& _ground;
    const std::vector<float>& _heights;
};

/// Draws without a window; 0 where all went well.
int drawFrames(osgViewer::Viewer& viewer, const TerrainLighting& lighting, const DemTile& tile,
               int frames, const std::string& picture)
{
    constexpr int width = 640;
    constexpr int height = 480;
    std::string problem;
    const std::unique_ptr<HeadlessContext> context =
        HeadlessContext::create(width, height, problem);
    if (!context)
    {
        std::cerr << problem << '\n';
        return 1;
    }
    osgViewer::GraphicsWindowEmbedded* window = context->window();
    viewer.setThreadingModel(osgViewer::ViewerBase::SingleThreaded);
    viewer.setReleaseContextAtEndOfFrameHint(false);
    osg::Camera& camera = *viewer.getCamera();
    camera.setGraphicsContext(window);
    camera.setViewport(0, 0, width, height);
    camera.setProjectionMatrixAsPerspective(30.0, double(width) / height, 1.0, 1.0e5);
    const osg::BoundingSphere bound = viewer.getSceneData()->getBound();
    camera.setViewMatrixAsLookAt(bound.center() + osg::Vec3d(0.0, -2.2, 1.3) * bound.radius(),
                                 bound.center(), osg::Vec3d(0.0, 0.0, 1.0));
    viewer.realize();

    std::vector<double> milliseconds;
    int errors = 0;
    for (int frame = 0; frame < frames; ++frame)
    {
        if (frame % 10 == 5) // as if someone clicked, in a spiral
        {
            const double away = 0.004 * std::min(frame, 60);
            osgGA::EventQueue& events = *window->getEventQueue();
            events.getCurrentEventState()->setModKeyMask(osgGA::GUIEventAdapter::MODKEY_CTRL);
            const float x = static_cast<float>(width * (0.5 + away * std::cos(0.9 * frame)));
            const float y = static_cast<float>(height * (0.5 + away * std::sin(0.9 * frame)));
            events.mouseButtonPress(x, y, 1);
            events.mouseButtonRelease(x, y, 1);
        }
        const auto start = std::chrono::steady_clock::now();
        viewer.frame(frame / 60.0);
        glFinish();
        const std::chrono::duration<double, std::milli> took =
            std::chrono::steady_clock::now() - start;
        milliseconds.push_back(took.count());
        for (GLenum error = glGetError(); error != GL_NO_ERROR; error = glGetError())
        {
            std::cerr << "frame " << frame << ": OpenGL error 0x" << std::hex << error << std::dec
                      << '\n';
            ++errors;
        }
    }
    if (!picture.empty())
    {
        osg::ref_ptr<osg::Image> image = new osg::Image;
        image->readPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE);
        if (!osgDB::writeImageFile(*image, picture))
            return 1;
    }
    std::sort(milliseconds.begin(), milliseconds.end());
    std::cout << tile.width() << " x " << tile.height() << " posts, " << frames
              << " frames: median " << milliseconds[milliseconds.size() / 2] << " ms, slowest "
              << milliseconds.back() << " ms (the first compiles); " << errors
              << " OpenGL errors; lit " << lighting.getDispatchCounts()["shade"] << " times\n";
    if (!lighting.getFailure().empty())
        std::cerr << "not lit: " << lighting.getFailure() << '\n';
    viewer.setSceneData(nullptr);
    return errors == 0 && lighting.getFailure().empty() ? 0 : 1;
}
} // namespace

int main(int argc, char** argv)
{
    osg::ArgumentParser arguments(&argc, argv);
    int posts = 256;
    int frames = 0;
    int bounces = 1;
    std::string picture;
    arguments.read("--posts", posts);
    arguments.read("--frames", frames);
    arguments.read("--bounces", bounces);
    arguments.read("--picture", picture);
    if (arguments.argc() < 2 || arguments.argc() > 3 || posts < 16 || posts > 2048 || frames < 0 ||
        bounces < 0 || bounces > 8)
        return usage();
    DemTile dem;
    if (arguments.argc() == 3)
    {
        dem = readDem(arguments[2]);
        if (dem.postCount() == 0)
        {
            std::cerr << arguments[2] << ": not a DEM that can be read\n";
            return 1;
        }
    }
    const std::unique_ptr<Heights> ground = createHeights(arguments[1], posts, dem);
    if (!ground)
        return usage();

    osg::ref_ptr<DynamicTerrain> terrain = new DynamicTerrain(ground->tile);
    std::vector<float> shown = ground->tile.heights(); // where a click meets it
    for (std::size_t i = 0; i < shown.size(); ++i)
        if (!ground->tile.validity()[i])
            shown[i] = std::numeric_limits<float>::quiet_NaN();
    terrain->setHeightCallback(
        [&](double time, int width, int height, float* heights)
        {
            const bool changed = ground->update(time, width, height, heights);
            if (changed)
                shown.assign(heights, heights + shown.size());
            return changed;
        });

    osg::ref_ptr<TerrainLighting> lit = new TerrainLighting;
    lit->addChild(terrain);
    lit->addTile(terrain);
    SkyLight sky;
    sky.sunAzimuth = 285.0; // degrees clockwise from north
    sky.sunElevation = 22.0;
    lit->setSkyLight(sky);
    LightingSettings settings; // for many frames rather than the last bit
    settings.azimuths = 16;
    settings.quality = HorizonQuality::Draft;
    settings.bounces = bounces;
    lit->setSettings(settings);

    osgViewer::Viewer viewer;
    viewer.setSceneData(lit);
    viewer.addEventHandler(new LightingHandler(lit));
    viewer.addEventHandler(new Digger(*ground, shown));
    if (frames > 0)
        lit->setTimeBudget(0.0); // all light in the frame that it is for: frames are timed
    if (frames > 0)
        return drawFrames(viewer, *lit, ground->tile, frames, picture);
    viewer.addEventHandler(new osgViewer::StatsHandler);
    return viewer.run();
}
