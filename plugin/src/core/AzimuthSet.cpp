#include "core/AzimuthSet.h"

#include <cassert>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr double pi = 3.14159265358979323846;

/// (cos, sin) of an angle in degrees, from the first octant only, so that symmetric angles give
/// symmetric vectors.
MapDirection unitVector(double degrees)
{
    const double turns = degrees / 360.0;
    const double angle = (turns - std::floor(turns)) * 360.0;
    const int quarter = static_cast<int>(angle / 90.0) % 4;
    const double rest = angle - 90.0 * quarter;
    const double c =
        rest <= 45.0 ? std::cos(rest * pi / 180.0) : std::sin((90.0 - rest) * pi / 180.0);
    const double s =
        rest <= 45.0 ? std::sin(rest * pi / 180.0) : std::cos((90.0 - rest) * pi / 180.0);
    switch (quarter)
    {
    case 0:
        return {c, s};
    case 1:
        return {-s, c};
    case 2:
        return {-c, -s};
    default:
        return {s, -c};
    }
}
} // namespace

MapDirection directionOfCompass(double degrees)
{
    return unitVector(90.0 - degrees);
}

AzimuthSet::AzimuthSet(int count) : _count(count)
{
    assert(isValidCount(count));
}

bool AzimuthSet::isValidCount(int count)
{
    return count >= 4 && count <= 256 && count % 4 == 0;
}

MapDirection AzimuthSet::direction(int index) const
{
    assert(index >= 0 && index < _count);
    const int half = _count / 2;
    const MapDirection d = unitVector(360.0 * (index % half) / _count);
    return index < half ? d : MapDirection{-d.east, -d.north};
}

int AzimuthSet::indexOfBand(int band) const
{
    assert(band >= 0 && band < _count);
    return (_count / 4 - band + _count) % _count;
}

double AzimuthSet::compassDegreesOfBand(int band) const
{
    return 360.0 * band / _count;
}

} // namespace osgTerrainLight
