#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Triangles over shared vertices. Corners run counter-clockwise as seen from outside; meshes whose
/// parts overlap, are mirrored, open or partly flipped are allowed.
struct TriangleMesh
{
    std::vector<glm::vec3> vertices;                     ///< [m], the mesh's own frame
    std::vector<std::array<std::uint32_t, 3>> triangles; ///< indices into vertices

    /// Why no field can be made of this mesh: it has no triangle, an index is beyond the vertices,
    /// or a vertex is not finite. Empty where none of that holds.
    std::string complaint() const;

    /// Corners of the box about its vertices. Precondition: there are some.
    std::array<glm::dvec3, 2> box() const;
};

} // namespace osgTerrainLight
