#pragma once

#include "io/MapReader.h"
#include "scene/TerrainTileReader.h"

#include <osgTerrain/TerrainTile>

#include <vector>

namespace osgTerrainLight
{

/// A tile as an osgTerrain::TerrainTile in metres: x east, y north, from its middle; z above its
/// heightOrigin. eastSpacing: between columns [m] as they are drawn. Voids have no geometry. data:
/// what it is lit by. colours: bottom first, over white. skirt: how far walls hang down from its
/// edges [m], which neither cast nor receive light of their own; 0: none. Precondition: at least 2
/// × 2 posts.
osg::ref_ptr<osgTerrain::TerrainTile> drawnTile(const DemTile& tile, double eastSpacing,
                                                DemData* data,
                                                const std::vector<ColourImage>& colours,
                                                float skirt = 0.0f);

/// How deep skirts must be, so that no gap shows beside a tile of a level one or two coarser or
/// finer: how much heights differ along the edges over four cells [m].
float skirtOf(const DemTile& tile);

} // namespace osgTerrainLight
