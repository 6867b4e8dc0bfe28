#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/LightingSettings.h>

#include "core/Raster.h"
#include "core/TileSource.h"

#include <array>
#include <memory>
#include <vector>

namespace osgTerrainLight
{

/// How far a tile sees at each level, in posts of that level.
struct WindowScheme
{
    int ring = 128;   ///< around the tile, of its own level, 64 … 1024
    int farRing = 64; ///< that each coarser level adds around the one before, 16 … 1024

    /// What a quality needs so that coarse ground does not spoil it.
    static WindowScheme of(HorizonQuality quality);
};

/// A coarser level around a tile.
struct FarLevel
{
    int level = 1;  ///< its posts are 2^level posts of the tile's level apart
    PostRect posts; ///< of it, in the whole terrain
    std::array<Raster<float>, 2>
        heights;                      ///< by CrestAxis [m above the tile's heightOrigin], NaN void
    std::vector<double> eastSpacings; ///< of its rows [m], of posts of the tile's level
};

/// A tile and the terrain around it: nested windows, near at the tile's own resolution, far at
/// coarser and coarser ones, up to the end of the terrain.
struct TileWindows
{
    static constexpr int mostLevels = 23; ///< posts 2^23 apart are beyond any planet

    DemTile tile;
    PostRect place;             ///< of the tile in the whole terrain, in posts of its level
    double lastColumn, lastRow; ///< of the terrain that is lit as one, from (0, 0), in such posts
    double middleColumn, middleRow;   ///< where a plane touches the planet, in such posts
    PostRect extent;                  ///< all that may be valid, in such posts
    PostRect near;                    ///< the tile and its ring, clipped to what may be valid
    Raster<float> heights;            ///< of `near` [m above the tile's heightOrigin], NaN void
    std::vector<double> eastSpacings; ///< of the rows of `near` [m]
    std::vector<FarLevel> levels;     ///< finest first; each reaches beyond the one before
};

/// Reads a tile of a level's posts: level 0's are the terrain itself. Fails where the source does.
Result<std::shared_ptr<const TileWindows>>
readWindows(TileSource& source, int level, const PostRect& tile, HorizonQuality quality);

/// The same with a larger tile: so many posts more on each side as far as there is terrain.
/// Precondition: not more than the ring.
std::shared_ptr<const TileWindows> withLitMargin(const TileWindows& windows, int posts);

} // namespace osgTerrainLight
