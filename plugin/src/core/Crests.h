#pragma once

#include "core/Raster.h"
#include "core/TileSource.h"

namespace osgTerrainLight
{

// Coarser heights from finer ones, a rectangle at a time (LevelReducer does whole levels, row by
// row). Cells are the ground between four posts. NaN where void.

/// (width − 1) × (height − 1) cells between posts.
Raster<float> cellsOf(const Raster<float>& posts, CrestAxis axis);

/// Cells of the next level: each of 2 × 2, the first at (0, 0); what lies beyond the last is void.
Raster<float> coarserCells(const Raster<float>& cells, CrestAxis axis);

} // namespace osgTerrainLight
