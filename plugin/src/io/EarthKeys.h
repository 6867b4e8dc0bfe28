#pragma once

#include "core/Result.h"

#include <initializer_list>
#include <optional>
#include <string>

namespace pugi
{
class xml_node;
}

namespace osgTerrainLight
{

/// A number, an angle in degrees, or a length in metres; the last two with a unit, too: 0.5rad,
/// 5km. Nothing where the text is something else, or not finite.
std::optional<double> numberOf(const std::string& text);
std::optional<double> degreesOf(const std::string& text);
std::optional<double> metresOf(const std::string& text);

/// What a key needs, in words and as numbers.
struct KeyNeed
{
    std::optional<double> (*read)(const std::string&);
    double least, most;
    const char* words;
};

/// The value of a key by its need; the error names key, value and what is needed.
Result<double> valueByNeed(const std::string& key, const std::string& text, const KeyNeed& need);

/// The first key that is there, into `value`; whether one is.
Result<bool> readKey(const pugi::xml_node& element, std::initializer_list<const char*> keys,
                     const KeyNeed& need, double& value);

/// A place on the ground that a map names.
struct EarthPoint
{
    double x = 0.0, y = 0.0; ///< longitude and latitude, degrees on WGS 84, unless isPlain
    /// x and y are as they stand in the map, without a CRS: those of the terrain's map, or degrees.
    bool isPlain = false;
};

/// As messages call it.
std::string toString(const EarthPoint& point);

/// Of long and lat, or x and y. srs names the CRS of x and y, any that PROJ knows, or by the names
/// that osgEarth has for some. plain: without srs they may be more than degrees. Errors where there
/// is no place, too.
Result<EarthPoint> readPoint(const pugi::xml_node& element, bool plain);

} // namespace osgTerrainLight
