#include "fields/DistanceGrid.h"

#include <algorithm>
#include <cassert>

namespace osgTerrainLight
{

double DistanceGrid::distanceAt(const glm::dvec3& point) const
{
    assert(size.x >= 1 && size.y >= 1 && size.z >= 1);
    int low[3], high[3];
    double weight[3];
    for (int k = 0; k < 3; ++k)
    {
        const double place = (point[k] - double(first[k])) / double(spacing);
        const double inside = std::clamp(place, 0.0, double(size[k] - 1));
        low[k] = std::min(static_cast<int>(inside), std::max(size[k] - 2, 0));
        high[k] = std::min(low[k] + 1, size[k] - 1);
        weight[k] = inside - low[k];
    }
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner)
    {
        const bool x = (corner & 1) != 0, y = (corner & 2) != 0, z = (corner & 4) != 0;
        sum += (x ? weight[0] : 1.0 - weight[0]) * (y ? weight[1] : 1.0 - weight[1]) *
               (z ? weight[2] : 1.0 - weight[2]) *
               double(at(x ? high[0] : low[0], y ? high[1] : low[1], z ? high[2] : low[2]));
    }
    return sum;
}

} // namespace osgTerrainLight
