#pragma once

#include "fields/DistanceGrid.h"
#include "fields/WindingNumber.h"

#include <functional>
#include <optional>

namespace osgTerrainLight
{

/// What giving a grid its signs came to.
struct SigningReport
{
    std::size_t nearVoxels = 0;      ///< next to the surface, within the mesh's box
    std::size_t ambiguousVoxels = 0; ///< of those, with a winding number between whole ones
    std::size_t windingNumbers = 0;  ///< computed; what the fill saves
};

/// Makes distances negative inside, where |w| > 1/2. Winding numbers are computed for voxels within
/// one spacing of the surface. Beyond, w is harmonic (Jacobson et al. 2013, section 3), so it takes
/// its extremes on the border: a connected region whose border is plainly inside, or plainly
/// outside, is so as a whole. Any other region is computed voxel by voxel.
/// low, high: the box of the mesh [m]; what is beyond it is outside. Nothing: given up.
std::optional<SigningReport> giveSigns(DistanceGrid& grid, const WindingNumber& winding,
                                       const glm::dvec3& low, const glm::dvec3& high,
                                       const std::function<bool(double)>& progress);

} // namespace osgTerrainLight
