#pragma once

#include "core/Result.h"
#include "io/LightParameters.h"

#include <array>
#include <optional>

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

/// Keys of osgEarth's <sky> that are read.
constexpr std::array<const char*, 2> skyKeys = {"hours", "date_time"};

/// The time that a <sky> gives: date_time, of whose day `hours` replaces the hour (UTC); without
/// date_time that of today, as in osgEarth. Nothing where it gives none. The error names key, value
/// and what is needed.
Result<std::optional<UtcTime>> readSkyTime(const pugi::xml_node& element);

} // namespace osgTerrainLight
