#pragma once

#include <osgTerrainLight/SkyLight.h>

#include "core/PostRect.h"
#include "core/Raster.h"

namespace osgTerrainLight
{

/// Which of a tile's eight neighbours are shown at a coarser level.
struct CoarserNeighbours
{
    bool west = false, east = false, south = false, north = false;
    bool southWest = false, southEast = false, northWest = false, northEast = false;

    bool any() const
    {
        return west || east || south || north || southWest || southEast || northWest || northEast;
    }
};

/// Per post of a tile, the part of its own light in what it shows, 0 … 1; the rest is its parent's.
/// 0 on edges and corners that are shared with a coarser neighbour, which shows the parent's level
/// there; 1 from `band` posts on; smooth between. The lesser where two edges meet, and round where
/// the neighbour across a corner alone is coarser. Neighbours at the same level have the same
/// weights along their common edge.
///
/// band: ≥ 1 [posts]. Where two edges' bands overlap, weights stay below 1.
Raster<float> edgeBlend(int width, int height, const CoarserNeighbours& coarser, int band = 8);

/// Mixes a tile's light with its parent's, by the weights of edgeBlend. The parent's is bilinear
/// between its posts, as it is shown.
///
/// place: of the light, in posts of the tile's level. parentPlace: of the parent's, in posts
/// 2^levels times as far apart (levels ≥ 1); it covers the tile. A value that is not finite is
/// void: where the parent has one beside it the tile's own light stays, and its own voids stay.
void blendToParent(Raster<float>& light, const PostRect& place, const Raster<float>& parent,
                   const PostRect& parentPlace, int levels, const Raster<float>& weights);
void blendToParent(Raster<Rgb>& light, const PostRect& place, const Raster<Rgb>& parent,
                   const PostRect& parentPlace, int levels, const Raster<float>& weights);

} // namespace osgTerrainLight
