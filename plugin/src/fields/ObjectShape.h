#pragma once

#include <glm/glm.hpp>

#include <memory>

namespace osgTerrainLight
{

struct DistanceGrid;
struct SampledForm;

/// A placed object, as distances to it are computed.
struct ObjectShape
{
    enum class Kind
    {
        Box,       ///< size: half sides
        Ellipsoid, ///< size: semi-axes
        Cylinder,  ///< about z; size.x: radius, size.z: half height
        Capsule,   ///< about z; size.x: radius, size.z: half height without the caps
        Mesh,      ///< grid
        Star,      ///< form, of radii
        Heights    ///< form, of heights
    };
    Kind kind = Kind::Box;
    glm::dvec3 size{1.0}; ///< [own units], each > 0
    /// Of a mesh, in own units; never null there.
    std::shared_ptr<const DistanceGrid> grid;
    /// Of a star and of heights, in own units about its centre; never null there.
    std::shared_ptr<const SampledForm> form;
    /// From own axes and units to the scene's: metres, x east, y north, z up. Affine, without
    /// shear; scales may differ, but those of a cylinder's and capsule's x and y by no more than a
    /// mean would forgive.
    glm::dmat4 toScene{1.0};
    /// Of its surface, in the mean: 0 … 1.
    glm::dvec3 albedo{0.5};
    glm::dvec3 emission{0.0}; ///< radiance, >= 0

    bool operator==(const ObjectShape& other) const
    {
        return kind == other.kind && size == other.size && grid == other.grid &&
               form == other.form && toScene == other.toScene && albedo == other.albedo &&
               emission == other.emission;
    }
    bool operator!=(const ObjectShape& other) const { return !(*this == other); }
};

/// An upright box [m].
struct ObjectBounds
{
    glm::dvec3 low{1.0e300}, high{-1.0e300};

    void include(const ObjectBounds& other)
    {
        low = glm::min(low, other.low);
        high = glm::max(high, other.high);
    }
};

/// Of a shape, in the scene.
ObjectBounds boundsOf(const ObjectShape& shape);

/// The shape with its scales in its sizes: a box, ellipsoid, cylinder or capsule of metres, whose
/// toScene turns and moves. What is sampled keeps own units; scale: the least of its scales.
struct RigidShape
{
    glm::dvec3 size;      ///< [m]
    glm::dmat4 fromScene; ///< to metres about the shape; of what is sampled to its own units
    double scale = 1.0;   ///< of what is sampled: metres per own unit, at least
};
RigidShape rigid(const ObjectShape& shape);

} // namespace osgTerrainLight
