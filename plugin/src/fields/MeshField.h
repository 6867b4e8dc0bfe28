#pragma once

#include "core/Result.h"
#include "fields/DistanceGrid.h"
#include "fields/TriangleMesh.h"

#include <cstddef>
#include <functional>

namespace osgTerrainLight
{

/// How a mesh is sampled.
struct BakeOptions
{
    int cells = 64; ///< voxels along the longest side of the mesh's box, 4 … 512; 32 for small ones
    int margin = 4; ///< voxels around the box on each side, 1 … 64

    /// Told what share of the work is done, 0 … 1, by the thread that called bakeMesh(). Where it
    /// returns false, the field is given up. May be empty.
    std::function<bool(double)> progress;

    /// Why these options cannot be used, with the range. Empty where they can.
    std::string complaint() const;
};

/// The distance field of a mesh, and how well inside and outside could be told apart.
struct BakedField
{
    DistanceGrid grid;

    /// Share of the voxels next to the surface whose winding number is more than 0.2 away from any
    /// whole number, 0 … 1. It is 0 where all parts are closed.
    double ambiguousShare = 0.0;

    /// Whether that share is at most greatestGoodShare. A field that is not well signed can be
    /// used: its distances are right, but thin or broken parts may be taken as hollow.
    bool isWellSigned() const { return ambiguousShare <= greatestGoodShare; }

    /// A house without a floor has 0.18, and one with a fifth of its triangles flipped 0.49:
    /// docs/methods/object_fields.md has the figures.
    static constexpr double greatestGoodShare = 0.25;
};

/// Samples the distance to a mesh, positive outside and negative inside, in the mesh's own frame
/// and metres. The distance to its triangles is exact. Its sign is that of 1/2 - |w|, where w is
/// the generalised winding number: parts may overlap, and triangles may be missing. The absolute
/// value makes a part solid that is mirrored, as a whole, by its placement. Holes are closed where
/// |w| is 1/2, to half a voxel. What lies outside of the mesh's box is outside. Uses all
/// processors. Errors: Invalid for a mesh or options with a complaint and for a mesh whose
/// triangles have no area or that lies too far from its frame's origin, NotSupported where the
/// library was built without Embree, Failed where the work was given up.
Result<BakedField> bakeMesh(const TriangleMesh& mesh, const BakeOptions& options = {});

} // namespace osgTerrainLight
