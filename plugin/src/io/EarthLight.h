#pragma once

#include "core/Result.h"
#include "io/LightParameters.h"

namespace pugi
{
class xml_node;
}

namespace osgTerrainLight
{

class EarthXml;

/// Reads <terrain_light> over what the light is so far. Errors name source, line, key, value and
/// what is needed.
Status readTerrainLight(const EarthXml& xml, const pugi::xml_node& element, LightParameters& light);

} // namespace osgTerrainLight
