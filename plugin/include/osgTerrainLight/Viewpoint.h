#pragma once

#include <string>

namespace osgTerrainLight
{

/// A camera that looks at a place of a scene. The place is in metres in the local frame of the
/// terrain: x east, y north (the map's y axis), z up.
struct Viewpoint
{
    std::string name = {};
    double x = 0.0, y = 0.0, z = 0.0; ///< of the place [m]
    double heading = 0.0; ///< that the camera looks to, degrees clockwise from the y axis
    double pitch = -90.0; ///< of the view above the horizontal, −90 … 90 degrees; −90 looks down
    double range = 1.0; ///< from the camera to the place [m], > 0
};

} // namespace osgTerrainLight
