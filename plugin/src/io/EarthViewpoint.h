#pragma once

#include "core/Result.h"

#include <array>
#include <optional>
#include <string>

namespace pugi
{
class xml_node;
}

namespace osgTerrainLight
{

/// A <viewpoint> of a map: a camera that looks at a place.
struct EarthViewpoint
{
    std::string name;
    double longitude = 0.0, latitude = 0.0; ///< of the place, degrees on WGS 84
    std::optional<double> height;           ///< of the place [m]; none: on the terrain
    double heading = 0.0;  ///< that the camera looks to, degrees clockwise from north
    double pitch = -90.0;  ///< −90 … 90 degrees; −90 looks down
    double range = 0.0;    ///< from the camera to the place [m]; 0 where none is given
    std::string what = {}; ///< its element, as messages call it: <viewpoint name="home">
    int line = 0;
};

/// Its keys, as osgEarth spells them.
constexpr std::array<const char*, 15> viewpointKeys = {
    "name",     "heading", "pitch", "range",  "long", "lon", "longitude", "x",
    "latitude", "lat",     "y",     "height", "alt",  "z",   "srs"};

/// Angles are in degrees, or with a unit; lengths in metres, or with a unit: 5km. x and y are in
/// degrees, or on the map that srs names, any that PROJ knows. The error names key, value and what
/// is needed.
Result<EarthViewpoint> readViewpoint(const pugi::xml_node& element);

} // namespace osgTerrainLight
