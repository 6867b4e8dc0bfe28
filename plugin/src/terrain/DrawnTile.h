#pragma once

#include "io/MapReader.h"
#include "scene/TerrainTileReader.h"

#include <osgTerrain/TerrainTile>

#include <vector>

namespace osgTerrainLight
{

/// A tile as an osgTerrain::TerrainTile in metres: x east, y north, from its middle; z above its
/// heightOrigin. eastSpacing: between columns [m] as they are drawn. Voids have no geometry. data:
/// what it is lit by. colours: bottom first, over white. globe: where it lies on one, in place of
/// that: it is then in its model coordinates. Null: none. Precondition: at least 2 × 2 posts.
osg::ref_ptr<osgTerrain::TerrainTile> drawnTile(const DemTile& tile, double eastSpacing,
                                                DemData* data,
                                                const std::vector<ColourImage>& colours,
                                                osgTerrain::Locator* globe = nullptr);

/// How deep skirts must be, so that no gap shows beside a tile of a level one or two coarser or
/// finer: how much heights differ along the edges over four cells [m].
float skirtOf(const DemTile& tile);

/// Adds walls to a tile that has its geometry, which hang so far down from its edges [m] and
/// neither cast nor receive light of their own. The stock technique's are wrong beside voids: it
/// keeps their indices in 16 bits, and a tile of 257 x 257 posts has more.
void addSkirt(osgTerrain::TerrainTile& tile, const DemTile& dem, float depth);

} // namespace osgTerrainLight
