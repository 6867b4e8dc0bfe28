#include "fields/TriangleMesh.h"

#include <cmath>

namespace osgTerrainLight
{

std::string TriangleMesh::complaint() const
{
    if (triangles.empty())
        return "the mesh has no triangles";
    for (std::size_t i = 0; i < vertices.size(); ++i)
        for (int k = 0; k < 3; ++k)
            if (!std::isfinite(vertices[i][k]))
                return "vertex " + std::to_string(i) + " of the mesh is not finite";
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (const std::uint32_t index : triangles[i])
            if (index >= vertices.size())
                return "triangle " + std::to_string(i) + " of the mesh has vertex " +
                       std::to_string(index) + ", the mesh has " + std::to_string(vertices.size());
    return {};
}

std::array<glm::dvec3, 2> TriangleMesh::box() const
{
    glm::dvec3 low(vertices.front()), high = low;
    for (const glm::vec3& vertex : vertices)
    {
        low = glm::min(low, glm::dvec3(vertex));
        high = glm::max(high, glm::dvec3(vertex));
    }
    return {low, high};
}

} // namespace osgTerrainLight
