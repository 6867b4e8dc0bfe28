#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

/// A sampled distance to the nearest surface, positive outside of what is solid and negative
/// inside [m]. Voxels are cubes; a distance is that of its voxel's centre.
struct DistanceGrid
{
    glm::ivec3 size{0, 0, 0};          ///< voxels along x, y, z
    glm::vec3 first{0.0f, 0.0f, 0.0f}; ///< centre of voxel (0, 0, 0) [m], the mesh's own frame
    float spacing = 1.0f;              ///< between centres of neighbours [m], > 0
    std::vector<float> distances;      ///< [m], x fastest, then y, then z

    std::size_t indexOf(int x, int y, int z) const
    {
        return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size.y) +
                static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(size.x) +
               static_cast<std::size_t>(x);
    }

    /// Distance of a voxel. Precondition: 0 <= x < size.x, and so on.
    float at(int x, int y, int z) const { return distances[indexOf(x, y, z)]; }

    /// Centre of a voxel [m].
    glm::dvec3 centre(int x, int y, int z) const
    {
        return glm::dvec3(first) + double(spacing) * glm::dvec3(x, y, z);
    }

    /// Trilinear between centres [m]. A point beyond the outermost centres has the distance of the
    /// nearest place between them. Precondition: size is at least 1 along each axis.
    double distanceAt(const glm::dvec3& point) const;
};

} // namespace osgTerrainLight
