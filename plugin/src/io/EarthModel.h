#pragma once

#include "core/Result.h"
#include "io/EarthKeys.h"

#include <array>
#include <limits>
#include <string>

namespace osgTerrainLight
{

/// A model that a map places: a <model> of its own, or one in <annotations>. Its axes are x east,
/// y north and z up, where nothing turns it.
struct EarthModel
{
    std::string name = {};
    std::string what = {}; ///< its element, as messages call it: <model name="church">
    int line = 0;
    std::string url = {}; ///< as written, with / for \; relative to the file's folder
    EarthPoint place = {};
    double height = 0.0;     ///< above the ground, or above the terrain's vertical datum [m]
    bool isAbsolute = false; ///< the latter
    double heading = 0.0;    ///< that its y axis points to, degrees clockwise from north
    double pitch = 0.0;      ///< degrees that its y axis rises
    double roll = 0.0;       ///< degrees that its x axis sinks
    std::array<double, 3> scales = {1.0, 1.0, 1.0}; ///< along its x, y and z, > 0
    double minRange = 0.0; ///< from the camera that it is drawn at, and at most [m]
    double maxRange = std::numeric_limits<double>::infinity();
    std::string unread = {}; ///< keys that are not read here, as a list
};

/// As osgEarth 2 and 3 write it, with keys of <style>, too. A height counts from the ground where
/// mode is relative, and where it is hat or 0; else, as in osgEarth, it is absolute. The url may be
/// empty. The error names key, value and what is needed.
Result<EarthModel> readModel(const pugi::xml_node& element);

} // namespace osgTerrainLight
