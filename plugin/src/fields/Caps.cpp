#include "fields/Caps.h"

#include <cmath>

namespace osgTerrainLight
{

std::vector<TriangleCorners> capsOf(const DistanceGrid& grid)
{
    std::vector<TriangleCorners> caps;
    const double half = 0.5 * double(grid.spacing);
    const double together = double(grid.spacing) * (1.0 + 1e-3); // well above what rounding makes
    const auto close = [&](const glm::dvec3& centre, int axis, double from, double to)
    {
        if ((from < 0.0) == (to < 0.0) || std::abs(from) + std::abs(to) <= together)
            return;
        glm::dvec3 middle = centre, along(0.0), across(0.0);
        middle[axis] += half;
        along[(axis + 1) % 3] = half;
        across[(axis + 2) % 3] = half;
        const glm::dvec3 a = middle - along - across, b = middle + along - across;
        const glm::dvec3 c = middle + along + across, d = middle - along + across;
        caps.push_back({a, b, c});
        caps.push_back({a, c, d});
    };
    for (int z = 0; z < grid.size.z; ++z)
        for (int y = 0; y < grid.size.y; ++y)
            for (int x = 0; x < grid.size.x; ++x)
            {
                const glm::dvec3 centre = grid.centre(x, y, z);
                const double distance = double(grid.at(x, y, z));
                if (x + 1 < grid.size.x)
                    close(centre, 0, distance, double(grid.at(x + 1, y, z)));
                if (y + 1 < grid.size.y)
                    close(centre, 1, distance, double(grid.at(x, y + 1, z)));
                if (z + 1 < grid.size.z)
                    close(centre, 2, distance, double(grid.at(x, y, z + 1)));
            }
    return caps;
}

} // namespace osgTerrainLight
