#pragma once

#include <osgTerrainLight/SkyLight.h>
#include <osgTerrainLight/SunPosition.h>

#include <string>
#include <utility>
#include <vector>

/// What a result says of how it was made.
namespace osgTerrainLight::tool
{

using Metadata = std::vector<std::pair<std::string, std::string>>;

void addPlace(Metadata& metadata, const EarthPlace& place);
void add(Metadata& metadata, const std::string& name, const std::string& value);
void addSun(Metadata& metadata, const SkyLight& sky);
void addAreaLights(Metadata& metadata, const SkyLight& sky);

} // namespace osgTerrainLight::tool
