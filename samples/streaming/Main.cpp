// A flight over terrain of any size that is paged in and lit on the way, with what it costs on the
// screen: streaming FILE [--headless] [--frames N] [--report FILE] [--budget MILLISECONDS]. FILE:
// what the plugin lights, for instance country.vrt.terrainlight or map.earth.terrainlight. Budget:
// of light per frame; 0: all tiles that are there are lit in each frame.
#include <osgTerrainLight/HeadlessContext.h>
#include <osgTerrainLight/TerrainLighting.h>

#include <osg/Depth>
#include <osg/NodeVisitor>
#include <osgDB/DatabasePager>
#include <osgDB/ReadFile>
#include <osgText/Text>
#include <osgViewer/Viewer>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>

using osgTerrainLight::HeadlessContext;
using osgTerrainLight::LightingStatistics;
using osgTerrainLight::TerrainLighting;

namespace
{
constexpr double framesPerSecond = 60.0;
using Clock = std::chrono::steady_clock;

struct Options
{
    std::string file, report;
    bool headless = false;
    int frames = 600;
    double budget = -1.0; ///< < 0: the default one
};

bool parse(osg::ArgumentParser& arguments, Options& options)
{
    arguments.getApplicationUsage()->setDescription(
        "Flies over terrain that is paged in and lit on the way.");
    while (arguments.read("--headless"))
        options.headless = true;
    while (arguments.read("--frames", options.frames) ||
           arguments.read("--report", options.report) || arguments.read("--budget", options.budget))
    {
    }
    for (int i = 1; i < arguments.argc(); ++i)
        if (!arguments.isOption(i))
            options.file = arguments[i];
    arguments.reportRemainingOptionsAsUnrecognized();
    arguments.writeErrorMessages(std::cerr);
    if (arguments.errors() || options.file.empty() || options.frames < 1)
    {
        std::cerr
            << "streaming FILE [--headless] [--frames N] [--report FILE] [--budget MILLISECONDS]: "
               "needs one FILE that the plugin lights, and 1 frame or more\n";
        return false;
    }
    return true;
}

/// The first lighting in a scene.
class LightingFinder : public osg::NodeVisitor
{
public:
    LightingFinder() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
    void apply(osg::Group& group) override
    {
        if (auto* found = dynamic_cast<TerrainLighting*>(&group))
            lighting = found;
        if (!lighting)
            traverse(group);
    }
    osg::ref_ptr<TerrainLighting> lighting;
};

constexpr double secondsPerLap = 120.0;

/// Along a figure of eight over the terrain, looking ahead and a little down. part: of a lap.
osg::Matrixd viewAt(const osg::BoundingSphere& terrain, double part)
{
    const double height = 0.03 * static_cast<double>(terrain.radius());
    const auto place = [&](double at)
    {
        const double angle = 2.0 * osg::PI * at;
        return osg::Vec3d(10.0 * height * std::sin(angle), 5.0 * height * std::sin(2.0 * angle),
                          height * (1.5 + 0.5 * std::cos(angle))) +
               osg::Vec3d(terrain.center());
    };
    const osg::Vec3d eye = place(part);
    osg::Vec3d ahead = place(part + 0.01) - eye;
    ahead.normalize();
    ahead.z() -= 0.25;
    return osg::Matrixd::lookAt(eye, eye + ahead, osg::Vec3d(0.0, 0.0, 1.0));
}

std::string textOf(const LightingStatistics& now, unsigned loading, double frameTime)
{
    char line[200];
    std::snprintf(line, sizeof line,
                  "tiles %zu, lit %zu, waiting %zu, loading %u\nlight %.1f ms, frame %.1f ms\n"
                  "memory for light %.0f MiB",
                  now.tiles, now.lit, now.waiting, loading, now.milliseconds, frameTime,
                  static_cast<double>(now.bytes) / 1048576.0);
    return line;
}

/// Text in the upper left corner.
class Panel
{
public:
    explicit Panel(osg::Group& scene) : _text(new osgText::Text)
    {
        const osg::ref_ptr<osg::Camera> camera = new osg::Camera;
        camera->setReferenceFrame(osg::Transform::ABSOLUTE_RF);
        camera->setProjectionMatrixAsOrtho2D(0.0, 1280.0, 0.0, 720.0);
        camera->setViewMatrix(osg::Matrixd::identity());
        camera->setClearMask(GL_DEPTH_BUFFER_BIT);
        camera->setRenderOrder(osg::Camera::POST_RENDER);
        camera->setAllowEventFocus(false);
        camera->getOrCreateStateSet()->setMode(GL_LIGHTING, osg::StateAttribute::OFF);
        _text->setDataVariance(osg::Object::DYNAMIC);
        _text->setCharacterSize(18.0f);
        _text->setPosition(osg::Vec3(16.0f, 690.0f, 0.0f));
        _text->setBackdropType(osgText::Text::OUTLINE);
        const osg::ref_ptr<osg::Geode> geode = new osg::Geode;
        geode->addDrawable(_text);
        camera->addChild(geode);
        scene.addChild(camera);
    }
    void show(const std::string& text) { _text->setText(text); }

private:
    osg::ref_ptr<osgText::Text> _text;
};

/// False where the report cannot be written.
bool fly(osgViewer::Viewer& viewer, TerrainLighting& lighting, Panel& panel, const Options& options,
         Clock::time_point begin)
{
    std::ofstream report;
    if (!options.report.empty())
        report.open(options.report);
    if (!options.report.empty() && !report)
    {
        std::cerr << options.report << ": cannot be written\n";
        return false;
    }
    report << "frame,milliseconds,light_milliseconds,tiles,lit,waiting,loading,light_bytes\n";
    const osg::BoundingSphere terrain = lighting.getBound();
    viewer.getCamera()->setComputeNearFarMode(
        osg::CullSettings::COMPUTE_NEAR_FAR_USING_BOUNDING_VOLUMES);
    double longest = 0.0, sum = 0.0, mostLight = 0.0, firstLit = 0.0;
    int frames = 0;
    for (; frames < options.frames && !viewer.done(); ++frames)
    {
        const Clock::time_point start = Clock::now();
        viewer.getCamera()->setViewMatrix(
            viewAt(terrain, frames / (framesPerSecond * secondsPerLap)));
        viewer.frame(frames / framesPerSecond);
        const double spent =
            std::chrono::duration<double, std::milli>(Clock::now() - start).count();
        const LightingStatistics now = lighting.getStatistics();
        const unsigned loading =
            static_cast<unsigned>(viewer.getDatabasePager()->getFileRequestListSize());
        panel.show(textOf(now, loading, spent));
        report << frames << ',' << spent << ',' << now.milliseconds << ',' << now.tiles << ','
               << now.lit << ',' << now.waiting << ',' << loading << ',' << now.bytes << '\n';
        longest = std::max(longest, spent);
        mostLight = std::max(mostLight, now.milliseconds);
        sum += spent;
        if (firstLit == 0.0 && now.lit > 0)
            firstLit = std::chrono::duration<double>(Clock::now() - begin).count();
    }
    std::printf(
        "%d frames: mean %.1f ms, longest %.1f ms; light at most %.1f ms of a budget of %.0f "
        "ms; %zu tiles at the end\n",
        frames, sum / std::max(1, frames), longest, mostLight, lighting.getTimeBudget(),
        lighting.getStatistics().tiles);
    report.flush();
    return options.report.empty() || report.good();
}
} // namespace

int main(int argc, char** argv)
{
    const Clock::time_point begin = Clock::now();
    osg::ArgumentParser arguments(&argc, argv);
    Options options;
    if (!parse(arguments, options))
        return 1;
    const osg::ref_ptr<osg::Node> scene = osgDB::readRefNodeFile(options.file);
    LightingFinder finder;
    if (scene)
        scene->accept(finder);
    if (!finder.lighting)
    {
        std::cerr << options.file
                  << ": holds no terrain that the plugin lights; needs a name such as "
                     "country.vrt.terrainlight\n";
        return 1;
    }

    if (options.budget >= 0.0)
        finder.lighting->setTimeBudget(options.budget);
    std::unique_ptr<HeadlessContext> context;
    osgViewer::Viewer viewer;
    const osg::ref_ptr<osg::Group> root = new osg::Group;
    root->addChild(scene);
    Panel panel(*root);
    viewer.setSceneData(root);
    viewer.setThreadingModel(osgViewer::ViewerBase::SingleThreaded);
    if (options.headless)
    {
        std::string problem;
        context = HeadlessContext::create(1280, 720, problem);
        if (!context)
        {
            std::cerr << "no OpenGL without a display: " << problem << '\n';
            return 1;
        }
        viewer.getCamera()->setGraphicsContext(context->window());
        viewer.getCamera()->setViewport(0, 0, 1280, 720);
        viewer.getCamera()->setProjectionMatrixAsPerspective(40.0, 1280.0 / 720.0, 1.0, 1e7);
    }
    else
        viewer.setUpViewInWindow(50, 50, 1280, 720);
    viewer.realize();
    return fly(viewer, *finder.lighting, panel, options, begin) ? 0 : 1;
}
