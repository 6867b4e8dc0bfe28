#include <osgTerrainLight/SkyLight.h>

#include "core/AzimuthSet.h"

#include <cmath>

namespace osgTerrainLight
{

std::array<double, 3> SkyLight::sunDirection() const
{
    const MapDirection d = directionOfCompass(sunAzimuth);
    const MapDirection e = directionOfCompass(90.0 - sunElevation); // east = cos, north = sin
    return {d.east * e.east, d.north * e.east, e.north};
}

} // namespace osgTerrainLight
