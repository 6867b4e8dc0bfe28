#include <osgTerrainLight/HorizonMap.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace osgTerrainLight
{

HorizonMap::HorizonMap(int width, int height, int azimuthCount)
    : _width(width), _height(height), _azimuthCount(azimuthCount),
      _codes(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                 static_cast<std::size_t>(azimuthCount),
             voidCode)
{
    assert(width > 0 && height > 0 && azimuthCount > 0);
}

std::uint16_t HorizonMap::encode(double elevationDegrees)
{
    assert(std::isfinite(elevationDegrees));
    const double code = 32768.0 + std::floor(elevationDegrees * (32767.0 / 90.0) + 0.5);
    return static_cast<std::uint16_t>(std::clamp(code, 1.0, 65535.0));
}

} // namespace osgTerrainLight
