#pragma once

#include <osgTerrainLight/DemTile.h>

#include "core/AzimuthSet.h"
#include "core/Raster.h"
#include "core/Result.h"

#include <osg/State>

#include <limits>
#include <vector>

namespace osgTerrainLight
{

/// A post by its column and row.
struct TilePost
{
    int column = 0;
    int row = 0;
};

/// Horizons of some valid posts in some directions by exhaustive scan on the GPU, in float: exact
/// for the bilinear surface but for rounding. Returns tangents of the elevation, one row per
/// direction, one column per post, −1e30 or less where nothing lies ahead. Where the tangent is
/// below `lowest`, it may be given lower than it is: the scan ends where no post could rise above
/// `lowest`, if that is above 0. At most 16384 posts. Needs a current context.
Result<Raster<double>> scanHorizons(osg::State& state, const DemTile& tile,
                                    const std::vector<TilePost>& posts,
                                    const std::vector<MapDirection>& directions,
                                    double lowest = -std::numeric_limits<double>::infinity());

} // namespace osgTerrainLight
