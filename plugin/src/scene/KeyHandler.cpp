#include "scene/KeyHandler.h"

#include <osg/ApplicationUsage>
#include <osgGA/GUIActionAdapter>

#include <algorithm>
#include <cmath>

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
};

/// Both, sky only, sun only, and again.
void nextTerm(SkyLight& sky)
{
    if (sky.skyEnabled && sky.sunEnabled)
        sky.sunEnabled = false;
    else if (sky.skyEnabled)
        std::swap(sky.skyEnabled, sky.sunEnabled);
    else
        sky.skyEnabled = sky.sunEnabled = true;
}
} // namespace

KeyHandler::KeyHandler(TerrainLighting& lighting) : _lighting(&lighting)
{
    // A viewer asks its own handlers for their keys, not those in the scene; but stock viewers'
    // help starts from this list.
    getUsage(*osg::ApplicationUsage::instance());
}

void KeyHandler::getUsage(osg::ApplicationUsage& usage) const
{
    for (const Key& key : keys)
        usage.addKeyboardMouseBinding(key.name, key.meaning);
}

bool KeyHandler::handle(const osgGA::GUIEventAdapter& event, osgGA::GUIActionAdapter& action)
{
    osg::ref_ptr<TerrainLighting> lighting;
    if (event.getHandled() || event.getEventType() != osgGA::GUIEventAdapter::KEYDOWN ||
        !_lighting.lock(lighting))
        return false;
    SkyLight sky = lighting->getSkyLight();
    LightingSettings settings = lighting->getSettings();
    const auto exposure = *ParameterRange::find("exposure");
    switch (event.getKey())
    {
    case 'r':
        sky.sunAzimuth = std::fmod(sky.sunAzimuth + 365.0, 360.0);
        break;
    case 'R':
        sky.sunAzimuth = std::fmod(sky.sunAzimuth + 355.0, 360.0);
        break;
    case 'u':
        sky.sunElevation = std::min(sky.sunElevation + 2.0, 90.0);
        break;
    case 'U':
        sky.sunElevation = std::max(sky.sunElevation - 2.0, -90.0);
        break;
    case 'x':
        settings.exposure = std::min(settings.exposure + 0.5, exposure.maximum);
        break;
    case 'X':
        settings.exposure = std::max(settings.exposure - 0.5, exposure.minimum);
        break;
    case 'i':
        lighting->setLightEnabled(!lighting->getLightEnabled());
        break;
    case 'k':
        nextTerm(sky);
        break;
    default:
        return false;
    }
    lighting->setSkyLight(sky);
    lighting->setSettings(settings);
    action.requestRedraw();
    return true;
}

} // namespace osgTerrainLight
