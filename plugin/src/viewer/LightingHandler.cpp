#include <osgTerrainLight/LightingHandler.h>

#include "scene/DrawBeside.h"
#include "viewer/ClockDisplay.h"
#include "viewer/FirstView.h"

#include <osgTerrainLight/Environment.h>
#include <osgTerrainLight/TerrainLighting.h>

#include <osg/ApplicationUsage>
#include <osg/DisplaySettings>
#include <osg/Transform>
#include <osg/observer_ptr>
#include <osgGA/GUIActionAdapter>
#include <osgViewer/View>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>

namespace osgTerrainLight
{

namespace
{
struct Key
{
    const char* name;
    const char* meaning;
};
constexpr Key keys[] = {
    {"r", "Terrain light: turn the sun 5 degrees clockwise"},
    {"R", "Terrain light: turn the sun 5 degrees anticlockwise"},
    {"u", "Terrain light: raise the sun 2 degrees"},
    {"U", "Terrain light: lower the sun 2 degrees"},
    {"x", "Terrain light: half a stop brighter"},
    {"X", "Terrain light: half a stop darker"},
    {"i", "Terrain light: toggle on and off"},
    {"k", "Terrain light: sun and sky, sky only, sun only"},
    {"d", "Terrain light: start and stop the day's clock"},
    {"n", "Terrain light: clock twice as fast"},
    {"N", "Terrain light: clock half as fast"},
    {"j", "Terrain light: an hour on"},
    {"J", "Terrain light: an hour back"},
    {"y", "Terrain light: a day on"},
    {"Y", "Terrain light: a day back"},
    {"g", "Terrain light: go to the next viewpoint of the map"},
    {"G", "Terrain light: go to the viewpoint before"},
};

constexpr double fastest = 86400.0; // a day per second

/// What the clock shows. speed: 0 where it stands still.
std::string said(const TerrainLighting& lighting, double speed)
{
    const std::string time = toString(*lighting.getTime());
    const SunPosition sun = sunPosition(*lighting.getTime(), *lighting.getPlace());
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << time.substr(0, 10) << "  " << time.substr(11, 8) << " UTC";
    if (speed > 0.0)
        text << "  x " << speed;
    text << std::fixed << std::setprecision(1) << "\nsun: azimuth " << sun.azimuth << ", elevation "
         << sun.elevation << " degrees";
    return text.str();
}

/// Both, sky only, sun only, and again. An environment without a sun has none to show.
void nextTerm(SkyLight& sky)
{
    if (sky.environment && !sky.environment->hasSun)
    {
        sky.skyEnabled = !sky.skyEnabled;
        return;
    }
    if (sky.skyEnabled && sky.sunEnabled)
        sky.sunEnabled = false;
    else if (sky.skyEnabled)
        std::swap(sky.skyEnabled, sky.sunEnabled);
    else
        sky.skyEnabled = sky.sunEnabled = true;
}

/// An environment turns with its sun.
void turnSun(SkyLight& sky, double degrees)
{
    const bool enabled = sky.sunEnabled;
    if (sky.environment)
        sky.setEnvironment(sky.environment, std::fmod(sky.environmentHeading + degrees, 360.0),
                           sky.environmentGain);
    else
        sky.sunAzimuth = std::fmod(sky.sunAzimuth + 360.0 + degrees, 360.0);
    sky.sunEnabled = enabled;
}

/// The sun of an environment stays where it is in the picture.
void raiseSun(SkyLight& sky, double degrees)
{
    if (!sky.environment)
        sky.sunElevation = std::clamp(sky.sunElevation + degrees, -90.0, 90.0);
}
} // namespace

/// What the keys do to one lighting.
struct LightingHandler::Implementation
{
    explicit Implementation(TerrainLighting* lighting) : given(lighting) {}
    ~Implementation();

    bool handle(const osgGA::GUIEventAdapter& event, TerrainLighting& lighting,
                osgGA::GUIActionAdapter& action, const osg::Matrixd& toWorld);
    bool goOn(int key, osgGA::GUIActionAdapter& action, const osg::Matrixd& toWorld);
    bool handleKey(int key, TerrainLighting& lighting);
    void runClock(double now, TerrainLighting& lighting, osgGA::GUIActionAdapter& action);
    void show(TerrainLighting& lighting, const std::string& text);

    osg::observer_ptr<TerrainLighting> given;
    osg::observer_ptr<TerrainLighting> shown; ///< that draws the clock
    osg::ref_ptr<DrawBeside<ClockDisplay>> callback;
    std::vector<Viewpoint> viewpoints;
    std::size_t viewpoint = 0; ///< the last one that was gone to
    bool running = false;
    double speed = 600.0;   ///< seconds of the day per second
    double lastFrame = 0.0; ///< while it runs [s]
};

LightingHandler::LightingHandler(TerrainLighting* lighting)
    : _implementation(new Implementation(lighting))
{
    // A viewer asks its own handlers for their keys, not those in the scene; but stock viewers'
    // help starts from this list.
    getUsage(*osg::ApplicationUsage::instance());
}

LightingHandler::LightingHandler(const LightingHandler& other, const osg::CopyOp& copyop)
    : osg::Object(other, copyop), osg::Callback(other, copyop), osgGA::GUIEventHandler(other,
                                                                                       copyop),
      _implementation(new Implementation(other._implementation->given.get()))
{
    _implementation->viewpoints = other._implementation->viewpoints;
}

LightingHandler::~LightingHandler() = default;

void LightingHandler::setViewpoints(const std::vector<Viewpoint>& viewpoints)
{
    _implementation->viewpoints = viewpoints;
    _implementation->viewpoint = 0;
}

const std::vector<Viewpoint>& LightingHandler::getViewpoints() const
{
    return _implementation->viewpoints;
}

void LightingHandler::getUsage(osg::ApplicationUsage& usage) const
{
    for (const Key& key : keys)
        usage.addKeyboardMouseBinding(key.name, key.meaning);
}

bool LightingHandler::handle(const osgGA::GUIEventAdapter& event, osgGA::GUIActionAdapter& action,
                             osg::Object* object, osg::NodeVisitor* visitor)
{
    osg::ref_ptr<TerrainLighting> lighting = dynamic_cast<TerrainLighting*>(object);
    if (!lighting && !_implementation->given.lock(lighting))
        return false;
    const osg::NodePathList paths = visitor && object == lighting
                                        ? osg::NodePathList{visitor->getNodePath()}
                                        : lighting->getParentalNodePaths();
    return _implementation->handle(event, *lighting, action,
                                   paths.empty() ? osg::Matrixd()
                                                 : osg::computeLocalToWorld(paths.front()));
}

LightingHandler::Implementation::~Implementation()
{
    osg::ref_ptr<TerrainLighting> lighting;
    if (shown.lock(lighting))
        lighting->removeCullCallback(callback);
    if (callback)
        callback->drawn().show(""); // copies of the lighting share the callback
}

bool LightingHandler::Implementation::handle(const osgGA::GUIEventAdapter& event,
                                             TerrainLighting& lighting,
                                             osgGA::GUIActionAdapter& action,
                                             const osg::Matrixd& toWorld)
{
    if (event.getEventType() == osgGA::GUIEventAdapter::FRAME)
        runClock(event.getTime(), lighting, action);
    if (event.getHandled() || event.getEventType() != osgGA::GUIEventAdapter::KEYDOWN ||
        (!goOn(event.getKey(), action, toWorld) && !handleKey(event.getKey(), lighting)))
        return false;
    lastFrame = event.getTime();
    action.requestRedraw();
    return true;
}

/// Around the list. False where the key is another one, or there is nowhere to go.
bool LightingHandler::Implementation::goOn(int key, osgGA::GUIActionAdapter& action,
                                           const osg::Matrixd& toWorld)
{
    auto* view = dynamic_cast<osgViewer::View*>(&action);
    if ((key != 'g' && key != 'G') || viewpoints.empty() || !view)
        return false;
    const std::size_t count = viewpoints.size();
    viewpoint = (viewpoint + (key == 'g' ? 1 : count - 1)) % count;
    lookFrom(*view, viewpoints[viewpoint], toWorld);
    return true;
}

bool LightingHandler::Implementation::handleKey(int key, TerrainLighting& lighting)
{
    SkyLight sky = lighting.getSkyLight();
    LightingSettings settings = lighting.getSettings();
    const auto exposure = *ParameterRange::find("exposure");
    using namespace std::chrono;
    const UtcTime time =
        lighting.getTime().value_or(time_point_cast<milliseconds>(system_clock::now()));
    switch (key)
    {
    case 'd':
        if (!lighting.getTime())
            lighting.setTime(time);
        running = !running && lighting.getTime();
        return true;
    case 'n':
        speed = std::min(2.0 * speed, fastest);
        return true;
    case 'N':
        speed = std::max(0.5 * speed, 1.0);
        return true;
    case 'j':
        lighting.setTime(time + hours(1));
        return true;
    case 'J':
        lighting.setTime(time - hours(1));
        return true;
    case 'y':
        lighting.setTime(time + hours(24));
        return true;
    case 'Y':
        lighting.setTime(time - hours(24));
        return true;
    case 'r':
        turnSun(sky, 5.0);
        break;
    case 'R':
        turnSun(sky, -5.0);
        break;
    case 'u':
        raiseSun(sky, 2.0);
        break;
    case 'U':
        raiseSun(sky, -2.0);
        break;
    case 'x':
        settings.exposure = std::min(settings.exposure + 0.5, exposure.maximum);
        break;
    case 'X':
        settings.exposure = std::max(settings.exposure - 0.5, exposure.minimum);
        break;
    case 'i':
        lighting.setLightEnabled(!lighting.getLightEnabled());
        break;
    case 'k':
        nextTerm(sky);
        break;
    default:
        return false;
    }
    lighting.setSkyLight(sky);
    lighting.setSettings(settings);
    return true;
}

void LightingHandler::Implementation::runClock(double now, TerrainLighting& lighting,
                                               osgGA::GUIActionAdapter& action)
{
    running = running && lighting.getTime(); // keys or the host may have moved the sun
    if (running)
    {
        // A window that hung does not skip half a day.
        const double seconds = speed * std::clamp(now - lastFrame, 0.0, 1.0);
        lastFrame = now;
        lighting.setTime(*lighting.getTime() +
                         std::chrono::milliseconds(std::llround(1000.0 * seconds)));
        action.requestRedraw();
    }
    show(lighting, lighting.getTime() ? said(lighting, running ? speed : 0.0) : "");
}

void LightingHandler::Implementation::show(TerrainLighting& lighting, const std::string& text)
{
    if (!callback && text.empty())
        return;
    if (!callback)
        callback = new DrawBeside(new ClockDisplay);
    if (!shown.valid())
    {
        // Contexts that exist already draw it from threads of their own.
        callback->resizeGLObjectBuffers(
            osg::DisplaySettings::instance()->getMaxNumberOfGraphicsContexts());
        lighting.addCullCallback(callback);
        shown = &lighting;
    }
    callback->drawn().show(text);
}

} // namespace osgTerrainLight
