#include "io/HeightSurvey.h"

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{
namespace
{
/// As DemTile::setHeight: no terrain of any body is higher [m].
constexpr double greatest = 1.0e6;
} // namespace

void HeightRange::add(double value)
{
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
    ++count;
}

bool HeightSurvey::areKilometres() const
{
    constexpr double earthRadius = 6378137.0;
    const double kilometres = 1.0e-3 * _bodyRadius;
    return !_knownUnit && _heights.count > 0 && std::abs(_bodyRadius / earthRadius - 1.0) > 0.01 &&
           _heights.lowest >= 0.99 * kilometres && _heights.highest <= 1.01 * kilometres;
}

void HeightSurvey::add(double metres)
{
    ++_count;
    if (std::abs(metres) <= greatest)
        _heights.add(metres);
    // Half and one and a half radii hold the hills of the smallest bodies.
    if (_bodyRadius > 0.0 && metres >= 0.5 * _bodyRadius && metres <= 1.5 * _bodyRadius)
        _radii.add(metres);
}

} // namespace osgTerrainLight
