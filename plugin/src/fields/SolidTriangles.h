#pragma once

#include <glm/glm.hpp>

#include <array>
#include <vector>

namespace osgTerrainLight
{

struct TriangleMesh;

/// Corners of one triangle [m].
using TriangleCorners = std::array<glm::dvec3, 3>;

/// The triangles of a mesh that have an area, each once. A triangle without area bounds nothing,
/// and one that is stored twice would count twice in winding numbers.
std::vector<TriangleCorners> solidTriangles(const TriangleMesh& mesh);

} // namespace osgTerrainLight
