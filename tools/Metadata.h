#pragma once

#include "core/SettingsTable.h"
#include "io/DemReader.h"

#include <osgTerrainLight/SkyLight.h>
#include <osgTerrainLight/SunPosition.h>

#include <cctype>
#include <string>
#include <utility>
#include <vector>

/// What a result says of how it was made.
namespace osgTerrainLight::tool
{

using Metadata = std::vector<std::pair<std::string, std::string>>;

void addPlace(Metadata& metadata, const EarthPlace& place);
void add(Metadata& metadata, const std::string& name, const std::string& value);
/// The row of a setting by its name: TERRAINLIGHT_NAME, in capitals, and its text.
template <class Owner>
void addSetting(Metadata& metadata, const std::string& name, const Owner& owner)
{
    const Setting<Owner>& setting = *findSetting<Owner>(name);
    std::string key = setting.key();
    for (char& c : key)
        c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    add(metadata, key, setting.textOf(owner));
}
/// What was asked for of the input: its part, cell size, unit and factor.
void addReading(Metadata& metadata, const DemReadOptions& read);
void addSun(Metadata& metadata, const SkyLight& sky);
void addAreaLights(Metadata& metadata, const SkyLight& sky);

} // namespace osgTerrainLight::tool
