#include "fields/SolidTriangles.h"

#include "fields/TriangleMesh.h"

#include <algorithm>
#include <tuple>

namespace osgTerrainLight
{

namespace
{
bool isBefore(const glm::dvec3& a, const glm::dvec3& b)
{
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

bool comesBefore(const TriangleCorners& a, const TriangleCorners& b)
{
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), isBefore);
}
} // namespace

std::vector<TriangleCorners> solidTriangles(const TriangleMesh& mesh)
{
    std::vector<TriangleCorners> result;
    result.reserve(mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles)
    {
        TriangleCorners corners{glm::dvec3(mesh.vertices[a]), glm::dvec3(mesh.vertices[b]),
                                glm::dvec3(mesh.vertices[c])};
        const glm::dvec3 ab = corners[1] - corners[0], ac = corners[2] - corners[0];
        const glm::dvec3 bc = corners[2] - corners[1];
        const double edge = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
        // Below this the area is what rounding leaves: products of double round by 1e-16.
        constexpr double leastArea = 1e-12;
        if (!(glm::length(glm::cross(ab, ac)) > leastArea * edge))
            continue;
        // The same triangle may begin at another corner.
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), isBefore),
                    corners.end());
        result.push_back(corners);
    }
    std::sort(result.begin(), result.end(), comesBefore);
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
}

} // namespace osgTerrainLight
