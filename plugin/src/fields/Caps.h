#pragma once

#include "fields/DistanceGrid.h"
#include "fields/SolidTriangles.h"

#include <vector>

namespace osgTerrainLight
{

/// What closes the holes of a mesh: the squares between neighbouring voxels, one inside and the
/// other outside, that have no surface between them. That is so where they are more than a spacing
/// away from it together. A closed mesh has none. The squares are up to half a voxel off the place
/// where the winding number is 1/2.
std::vector<TriangleCorners> capsOf(const DistanceGrid& grid);

} // namespace osgTerrainLight
