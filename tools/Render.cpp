#include "Pipeline.h"
#include "RenderCamera.h"
#include "SceneFiles.h"

#include "io/GdalErrors.h"
#include "io/InputFiles.h"
#include "io/LightParameters.h"
#include "osgdb/Register.h"
#include "viewer/FirstView.h"

#include <osgTerrainLight/LightingHandler.h>
#include <osgTerrainLight/PlacedObject.h>
#include <osgTerrainLight/TerrainLighting.h>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <osg/ComputeBoundsVisitor>
#include <osg/NodeVisitor>
#include <osgDB/DatabasePager>
#include <osgDB/FileNameUtils>
#include <osgDB/FileUtils>
#include <osgDB/Registry>
#include <osgViewer/Viewer>

#include <algorithm>

namespace osgTerrainLight::tool
{
namespace
{

struct Options
{
    std::string scene;
    OutputOptions output;
    int width = 1024, height = 768;
    SkyLight sky;
    std::string skyFile;
    SunTime sun;
    LightingSettings settings;
    LightParameters light; ///< of --light
    DemReadOptions read;   ///< cell size, unit and factor
    BodyRadius bodyRadius = BodyRadius::Unsaid;
    CameraPlace camera;
    int frames = 100;
    bool geocentric = false;
};

const std::string suffix = ".terrainlight"; // asks for our reader

bool hasSuffix(const std::string& scene)
{
    return "." + osgDB::getLowerCaseFileExtension(scene) ==
           suffix; // too long for CPLGetExtension()
}

std::string withoutSuffix(const std::string& scene)
{
    return hasSuffix(scene) ? scene.substr(0, scene.size() - suffix.size()) : scene;
}

/// A map or a raster, without the suffix.
bool isMapOrRaster(const std::string& name)
{
    const GdalErrors quiet;
    return EQUAL(CPLGetExtension(name.c_str()), "earth") ||
           GDALIdentifyDriver(name.c_str(), nullptr);
}

/// DEMs and maps go to our reader, anything else to its own.
std::string readableName(const std::string& scene)
{
    return !hasSuffix(scene) && isMapOrRaster(scene) ? scene + suffix : scene;
}

/// checkProj() of a raster and of all that a map is made of.
Status checkProj(const Options& options)
{
    const std::string name = withoutSuffix(options.scene);
    return isMapOrRaster(name) ? tool::checkProj(name, describeDem(name, options.read))
                               : Status(Nothing{});
}

/// What was asked for, since a map has settings of its own.
GivenLight givenLight(const CLI::App& app, const Options& options)
{
    LightParameters asked;
    asked.sky = options.sky;
    asked.settings = options.settings;
    asked.time = options.sun.time;
    asked.place = options.sun.place;
    GivenLight given;
    const auto add = [&](const std::string& option, const std::string& key)
    {
        const CLI::Option* found = app.get_option_no_throw("--" + option);
        if (found && found->count() > 0)
            given.changes.push_back([asked, copy = findLightKey(key)->copy](LightParameters& light)
                                    { copy(light, asked); });
    };
    for (const char* key : {"sun-azimuth", "sun-elevation"})
        add("sun", key);
    for (const char* key : {"sky", "time", "place"})
        add(key, key);
    add("key-light", "key-lights");
    for (const LightKey& key : lightKeys())
    {
        const bool ofFile = key.name == "sky-heading" || key.name == "sky-gain";
        if (key.isOption && !(ofFile && !options.skyFile.empty())) // set with the file's sky
            add(key.name, key.name);
    }
    if (app.count("--light") > 0)
        given.changes.push_back([light = options.light](LightParameters& parameters)
                                { findLightKey("light")->copy(parameters, light); });
    given.read = options.read;
    given.geocentric = options.geocentric;
    return given;
}

/// --body-radius auto, of a raster.
Status takeRadius(Options& options)
{
    if (options.bodyRadius != BodyRadius::OfCrs)
        return Nothing{};
    const Result<DemInfo> info = describeDem(options.scene, options.read);
    if (!info)
        return Error{info.error().code, "--body-radius auto: " + info.error().message};
    const Result<double> radius = radiusOfCrs(*info);
    if (!radius)
        return Error{radius.error().code, options.scene + ": " + radius.error().message};
    options.settings.bodyRadius = *radius;
    return Nothing{};
}

/// A scene on a globe without the transform to geocentric coordinates: cameras are placed in axes
/// of the middle of its terrain.
osg::Node& inOwnFrame(osg::Node& scene)
{
    auto* globe = dynamic_cast<osg::CoordinateSystemNode*>(&scene);
    osg::Transform* toWorld =
        globe && globe->getNumChildren() == 1 ? globe->getChild(0)->asTransform() : nullptr;
    osg::Node* lit = toWorld && toWorld->getNumChildren() == 1 ? toWorld->getChild(0) : nullptr;
    return dynamic_cast<TerrainLighting*>(lit) ? *lit : scene;
}

Result<osg::ref_ptr<osg::Node>> load(const CLI::App& app, const Options& options)
{
    registerReader();
    registerSerializers();
    GivenLight given = givenLight(app, options);
    const osg::ref_ptr<osgDB::Options> reading = new osgDB::Options;
    reading->setPluginData(GivenLight::pluginData, &given);
    osgDB::ReaderWriter::ReadResult result =
        osgDB::Registry::instance()->readNode(readableName(options.scene), reading);
    if (result.validNode())
        return osg::ref_ptr<osg::Node>(&inOwnFrame(*result.getNode()));
    const bool isError = result.status() == osgDB::ReaderWriter::ReadResult::ERROR_IN_READING_FILE;
    VSIStatBufL stat;
    if (!isError && osgDB::findDataFile(options.scene).empty() &&
        VSIStatL(options.scene.c_str(), &stat) != 0)
        return Error{ErrorCode::NotFound, options.scene + ": no such file"};
    const std::string reason =
        isError ? result.message()
                : "no raster that GDAL reads, and no scene that OpenSceneGraph reads";
    // Some readers' sentences name the file, others' do not.
    return Error{ErrorCode::Invalid, reason.rfind(withoutSuffix(options.scene), 0) == 0
                                         ? reason
                                         : options.scene + ": " + reason};
}

std::vector<std::uint8_t> readPixels(int width, int height)
{
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) *
                                     static_cast<std::size_t>(height) * 3);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
    return pixels;
}

/// Draws until a frame looks like the one before it and nothing is being loaded: light arrives
/// some frames after the terrain.
std::vector<std::uint8_t> draw(osgViewer::Viewer& viewer, const Options& options,
                               Progress& progress)
{
    constexpr int fewest = 4;
    std::vector<std::uint8_t> pixels;
    const osgDB::DatabasePager& pager = *viewer.getDatabasePager();
    int frame = 0;
    for (int time = 0; frame < options.frames && time < 100 * options.frames; ++time)
    {
        viewer.frame(time / 60.0);
        glFinish();
        std::vector<std::uint8_t> next = readPixels(options.width, options.height);
        const bool same = next == pixels;
        pixels = std::move(next);
        progress.reach(0.2 + 0.7 * frame / options.frames);
        // Tiles of large terrain come level by level: those frames do not count.
        const bool loading = pager.requiresUpdateSceneGraph() || pager.getRequestsInProgress();
        if (++frame >= fewest && same && !loading)
            break;
        if (loading)
            --frame;
    }
    return pixels;
}

/// Gives all terrain the sky of a file.
class SkySetter : public osg::NodeVisitor
{
public:
    explicit SkySetter(const SkyLight& from) : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN), _from(from)
    {
    }

    void apply(osg::Group& group) override
    {
        if (auto* lighting = dynamic_cast<TerrainLighting*>(&group))
        {
            SkyLight sky = lighting->getSkyLight();
            const bool withSun = sky.sunEnabled;
            sky.setEnvironment(_from.environment, _from.environmentHeading, _from.environmentGain);
            sky.sunEnabled = sky.sunEnabled && withSun;
            lighting->setSkyLight(sky);
        }
        traverse(group);
    }

private:
    const SkyLight& _from;
};

/// Switches the viewer's keys off, and with them the clock in the picture, keeps where they lead
/// to, and has all light computed in one frame: a picture that is drawn while light waits looks
/// like one that is done.
class ForAPicture : public osg::NodeVisitor
{
public:
    ForAPicture() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}

    std::vector<Viewpoint> viewpoints;

    static LightingHandler* handlerOf(TerrainLighting& lighting)
    {
        osg::Callback* each = lighting.getEventCallback();
        while (each && !dynamic_cast<LightingHandler*>(each))
            each = each->getNestedCallback();
        return dynamic_cast<LightingHandler*>(each);
    }

    void apply(osg::Group& group) override
    {
        if (auto* lighting = dynamic_cast<TerrainLighting*>(&group))
        {
            while (auto* keys = handlerOf(*lighting))
            {
                const std::vector<Viewpoint>& more = keys->getViewpoints();
                viewpoints.insert(viewpoints.end(), more.begin(), more.end());
                lighting->removeEventCallback(keys);
            }
            lighting->setTimeBudget(0.0);
            lighting->setFadeSeconds(0.0);
        }
        traverse(group);
    }
};

/// Of the terrain, where there is some: what stands on it does not move the camera.
osg::BoundingBox boundsOf(osg::Node& scene)
{
    class OfTerrain : public osg::ComputeBoundsVisitor
    {
    public:
        using osg::ComputeBoundsVisitor::apply;
        void apply(osg::Group& group) override
        {
            if (!dynamic_cast<PlacedObject*>(&group))
                traverse(group);
        }
    };
    OfTerrain terrain;
    scene.accept(terrain);
    if (terrain.getBoundingBox().valid())
        return terrain.getBoundingBox();
    osg::ComputeBoundsVisitor all;
    scene.accept(all);
    return all.getBoundingBox();
}

/// --viewpoint, as a place of the camera.
Status takeViewpoint(const std::vector<Viewpoint>& viewpoints, const std::string& scene,
                     CameraPlace& camera)
{
    if (camera.viewpoint.empty())
        return Nothing{};
    std::string names;
    for (const Viewpoint& viewpoint : viewpoints)
    {
        const bool isHome =
            &viewpoint == &viewpoints.front() && EQUAL(camera.viewpoint.c_str(), "home");
        if (isHome || EQUAL(camera.viewpoint.c_str(), viewpoint.name.c_str()))
        {
            const ViewPlace place = viewFrom(viewpoint);
            camera.eye = place.eye;
            camera.center = place.centre;
            camera.up = place.up;
            return Nothing{};
        }
        names += (names.empty() ? "" : ", ") + ("\"" + viewpoint.name + "\"");
    }
    return Error{
        ErrorCode::NotFound,
        "--viewpoint " + camera.viewpoint + ": " + scene +
            (names.empty() ? " has no viewpoint" : " has no such viewpoint; it has " + names)};
}

/// The first reason why something in the scene was drawn unlit.
class FailureFinder : public osg::NodeVisitor
{
public:
    FailureFinder() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
    std::string failure;

    void apply(osg::Group& group) override
    {
        const auto* lighting = dynamic_cast<const TerrainLighting*>(&group);
        if (lighting && failure.empty())
            failure = lighting->getFailure();
        traverse(group);
    }
};

Status run(const CLI::App& app, Options options)
{
    if (Status read = readSky(app, options.sky, options.skyFile, true); !read)
        return read;
    if (app.get_option("--bounce-method")->count() > 0) // else the scene's counts, which warns
        refuseIdle(app, idleSettings(options.settings));
    if (const std::string wrong = complaintOfFile(options.scene); !wrong.empty())
        return Error{ErrorCode::Invalid, options.scene + ": " + wrong};
    refuseInputs({options.scene, options.skyFile}, options.output);
    if (Status known = checkProj(options); !known)
        return known;
    if (Status writable = checkOutput(options.output, 0); !writable)
        return writable;
    const Result<Gpu> gpu = openGpu(options.width, options.height);
    if (!gpu)
        return gpu.error();
    if (options.width > gpu->capabilities.maxTextureSize ||
        options.height > gpu->capabilities.maxTextureSize)
        return Error{ErrorCode::NotSupported, "a picture of " + std::to_string(options.width) +
                                                  " x " + std::to_string(options.height) + "; '" +
                                                  gpu->capabilities.renderer + "' draws " +
                                                  std::to_string(gpu->capabilities.maxTextureSize) +
                                                  " a side at most"};
    if (Status taken = takeRadius(options); !taken)
        return taken;
    Result<osg::ref_ptr<osg::Node>> scene = load(app, options);
    if (!scene)
        return scene.error();
    refuseInputs(filesOfScene(**scene, options.scene), options.output);
    if (options.sky.environment)
    {
        SkySetter setter(options.sky);
        (*scene)->accept(setter);
    }
    const osg::BoundingBox bounds = boundsOf(**scene);
    if (!bounds.valid())
        return Error{ErrorCode::Invalid, options.scene + ": nothing in it has an extent"};
    ForAPicture forAPicture;
    (*scene)->accept(forAPicture);
    if (Status taken = takeViewpoint(forAPicture.viewpoints, options.scene, options.camera); !taken)
        return taken;
    Progress progress(options.output.quiet);
    progress.reach(0.2);

    osgViewer::Viewer viewer;
    viewer.setThreadingModel(osgViewer::ViewerBase::SingleThreaded);
    viewer.setReleaseContextAtEndOfFrameHint(false);
    osg::Camera& camera = *viewer.getCamera();
    camera.setGraphicsContext(gpu->context->window());
    camera.setViewport(0, 0, options.width, options.height);
    camera.setClearColor(
        osg::Vec4(0.62f, 0.70f, 0.80f, 1.0f)); // haze, not sky: nothing is lit by it
    viewer.setSceneData(*scene);
    placeCamera(camera, options.camera, double(options.width) / options.height, bounds);
    viewer.realize();
    const std::vector<std::uint8_t> pixels = draw(viewer, options, progress);
    if (Status done = gpu->finish(); !done)
        return done;
    FailureFinder finder;
    (*scene)->accept(finder);
    viewer.setSceneData(nullptr);
    if (!finder.failure.empty())
        return Error{ErrorCode::Failed, options.scene + ": not lit: " + finder.failure};

    RasterFrame frame;
    frame.width = options.width;
    frame.height = options.height;
    const DeferredSignals deferred;
    if (Status written =
            writeRgb8(options.output.path, frame, pixels, writeOptions(options.output, {}));
        !written)
        return written;
    progress.reach(1.0);
    return Nothing{};
}

} // namespace

Mode addRender(CLI::App& tool)
{
    CLI::App* app = tool.add_subcommand(
        "render", "Headless picture of any scene that osgviewer loads. A DEM or .earth map comes "
                  "lit. Without camera options: from the south, 35 degrees down");
    app->footer("Examples:\n"
                "  terrainlight render dem.tif picture.png --sun 300,25\n"
                "  terrainlight render dem.tif dusk.png --time 2024-06-21T19:00+02:00\n"
                "  terrainlight render dem.tif map.png --top --size 800,800\n"
                "  terrainlight render dem.tif wet.png --sun 0,30 --gloss 0.3 --bounces 1\n"
                "  terrainlight render dem.tif evening.png --sun 270,4 --sky clear\n"
                "  terrainlight render map.earth near.png --camera 225,20,0.5 --exposure 0.5\n"
                "  terrainlight render map.earth view.png --viewpoint home\n"
                "  terrainlight render scene.osgt scene.png --size 640,480");
    const auto options = std::make_shared<Options>();
    app->add_option("SCENE", options->scene, "Scene, map or DEM")->required()->type_name("");
    app->add_option("OUTPUT", options->output.path, "Picture to write: PNG, JPEG ...")
        ->required()
        ->type_name("");
    addSize(*app, options->width, options->height,
            "Pixels of the picture; one number: a square; default 1024,768");
    addCamera(*app, options->camera);
    addSun(*app, options->sky);
    addSky(*app, options->sky, options->skyFile);
    addSunTime(*app, options->sun);
    addAreaLights(*app, options->sky);
    const LightKey& light = *findLightKey("light");
    app->add_option_function<std::string>(
           "--light",
           [options, &light](const std::string& what)
           {
               if (const Status set = light.read(options->light, what); !set)
                   throw CLI::ValidationError("--light", set.error().message);
           },
           light.meaning + " One of off, sky, sun and both; default both.")
        ->type_name("off|sky|sun|both");
    addBodyRadius(*app, options->settings, options->bodyRadius);
    for (const Topic topic :
         {Topic::Picture, Topic::Screen, Topic::Horizons, Topic::Bounces, Topic::Gloss})
        addTopic(*app, topic, options->settings);
    for (const char* of : {"--gloss-exponent", "--gloss-transfer"})
        app->get_option(of)->needs("--gloss");
    addCellSize(*app, [options](double size) { options->read.cellSize = size; });
    addHeightOptions(*app, options->read);
    app->add_flag("--geocentric", options->geocentric,
                  "Terrain in longitude and latitude lies on its ellipsoid, as in osgviewer with "
                  "-O geocentric=1; scene coordinates are then metres about its middle");
    addLimitedNumbers(*app, "--frames", "N", {{"frames", 1.0, 100000.0, true}},
                      "Frames drawn at most while the picture still changes; default 100",
                      [options](const auto& v) { options->frames = static_cast<int>(v[0]); });
    addOutputOptions(*app, options->output);
    return {app, [app, options] { return run(*app, *options); }};
}

} // namespace osgTerrainLight::tool
