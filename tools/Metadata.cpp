#include "Metadata.h"

#include "Console.h"

#include "core/SettingsTable.h"

namespace osgTerrainLight::tool
{
void add(Metadata& metadata, const std::string& name, const std::string& value)
{
    metadata.emplace_back("TERRAINLIGHT_" + name, value);
}

void addSun(Metadata& metadata, const SkyLight& sky)
{
    add(metadata, "SUN_AZIMUTH", text(sky.sunAzimuth));
    add(metadata, "SUN_ELEVATION", text(sky.sunElevation));
    add(metadata, "SUN_RADIUS", text(sky.sunAngularRadius));
}

void addPlace(Metadata& metadata, const EarthPlace& place)
{
    add(metadata, "PLACE", text(place.longitude) + "," + text(place.latitude));
    add(metadata, "CONVERGENCE", text(place.convergence));
}

void addAreaLights(Metadata& metadata, const SkyLight& sky)
{
    if (sky.skyEnabled && sky.environment)
    {
        add(metadata, "SKY_HEADING", text(sky.environmentHeading));
        add(metadata, "SKY_GAIN", text(sky.environmentGain));
    }
    else if (sky.skyEnabled && sky.skyModel == SkyModel::Clear)
        add(metadata, "TURBIDITY", text(sky.turbidity));
    if (sky.skyEnabled && !sky.skyHarmonics.empty())
        add(metadata, "SKY_HARMONICS", findSetting<SkyLight>("sky-harmonics")->textOf(sky));
    if (!sky.keyLights.empty())
        add(metadata, "KEY_LIGHTS", findSetting<SkyLight>("key-lights")->textOf(sky));
}

} // namespace osgTerrainLight::tool
