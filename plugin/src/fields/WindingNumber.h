#pragma once

#include "fields/SolidTriangles.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace osgTerrainLight
{

/// The generalised winding number of a set of triangles (Jacobson, Kavan and Sorkine-Hornung 2013):
/// the solid angle that they are seen under, over that of a sphere. Of closed parts that face
/// outwards it is the number of parts that a point is in, and where triangles are missing or
/// flipped it is near that. Distant groups of triangles are taken as a dipole with its first-order
/// term (Barill et al. 2018), near ones triangle by triangle.
class WindingNumber
{
public:
    /// triangles: at least one, each with an area.
    explicit WindingNumber(const std::vector<TriangleCorners>& triangles);

    /// The winding number at a point [m]. A triangle that contains the point counts 0. May be
    /// called by several threads at once.
    double at(const glm::dvec3& point) const;

    /// The same without groups: one triangle after another. Tests hold at() against it.
    double exactlyAt(const glm::dvec3& point) const;

private:
    struct Node
    {
        glm::dvec3 centre{0.0};     ///< of area [m]
        double radius = 0.0;        ///< about the centre, over all corners [m]
        glm::dvec3 area{0.0};       ///< sum of normals, as long as areas [m²]
        glm::dmat3 moment{0.0};     ///< sum of (centre of triangle − centre) ⊗ area [m³]
        std::uint32_t first = 0;    ///< triangle
        std::uint32_t count = 0;    ///< of triangles; 0: the node has children
        std::uint32_t children = 0; ///< the first of two
    };

    void build(std::uint32_t node, std::uint32_t first, std::uint32_t count);

    std::vector<TriangleCorners> _triangles;
    std::vector<Node> _nodes;
};

} // namespace osgTerrainLight
