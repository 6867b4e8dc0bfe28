#include <osgTerrainLight/Surroundings.h>

#include <cmath>

namespace osgTerrainLight
{

std::string Surroundings::complaint() const
{
    for (const double side : {west, south, east, north})
        if (!std::isfinite(side))
            return "west, south, east and north: need finite coordinates";
    if (!(west < east && south < north))
        return "west, south, east and north: need west < east and south < north";
    if (!heights)
        return "needs a function that returns heights";
    return {};
}

} // namespace osgTerrainLight
