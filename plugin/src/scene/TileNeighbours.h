#pragma once

#include "core/PatchSource.h"
#include "core/Result.h"
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/TileHandle.h>

#include <osg/Matrixd>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

namespace osgTerrainLight
{

struct TileWindows;

/// Where a tile's heights lie on a map.
struct PlacedGround
{
    TerrainPatch patch;
    /// Map units are radians on an ellipsoid with these axes [m]; 0: they are metres.
    double semiMajor = 0.0, semiMinor = 0.0;
    /// Of the tile's frame where map units are radians: tiles of two places are of two maps.
    osg::Matrixd toScene;
    std::string crs; ///< of tiles that a host has placed; those of two are of two maps

    bool isOnMapOf(const PlacedGround& other) const
    {
        return semiMajor == other.semiMajor && semiMinor == other.semiMinor &&
               toScene == other.toScene && crs == other.crs;
    }
};

/// Tiles that light one another, as far as they are loaded. A tile whose rectangle touches that of
/// another one on the map is surrounded by all of that map; one that touches none is lit alone,
/// unless its map has a base.
///
/// What comes, goes or changes makes those tiles stale that it may change: those that it is nearer
/// to than 128 posts (a bounce sees ground there that no horizon tells of), and those above whose
/// lowest post it rises by more than Reach::tolerance. That is the bound of Reach with all horizons
/// at the horizontal, since those that are computed stay on the graphics card. Finer ground over
/// ground that a tile sees at its own spacing, or coarser, changes nothing for it. In update
/// traversal.
class TileNeighbours
{
public:
    /// A tile came, or has other ground now.
    void set(const TileHandle& handle, const PlacedGround& ground);
    void remove(const TileHandle& handle);

    /// Ground of the map with this CRS that counts where no tile is; none: there is none any more.
    /// All tiles of the map are stale then.
    void setBase(std::optional<BaseGround> base, const std::string& crs);
    /// Heights of the base are others now in a rectangle of its map, none of them, before or after,
    /// above `top` [m above the map's 0].
    void changeBase(double west, double south, double east, double north, double top);

    /// The tile and what surrounds it, as it is now; null where nothing does. It is not stale then.
    std::shared_ptr<const TileWindows> around(const TileHandle& handle, HorizonQuality quality);

    /// A tile that must be lit again, which it is not any more then; none where all see what is
    /// there.
    std::optional<TileHandle> takeStale();

private:
    struct Tile
    {
        PlacedGround ground;
        double lowest, highest;  ///< valid post [m above the map's 0]
        bool surrounded = false; ///< when it was lit
    };
    /// Ground that is another one now.
    struct Change
    {
        PlacedGround ground;
        double west, south, east, north; ///< on the map
        double top;                      ///< before and after [m above the map's 0]
    };
    static Tile measured(const PlacedGround& ground);
    static Change whole(const Tile& tile);
    static std::optional<Change> between(const Tile& before, const Tile& after);
    void mark(const TileHandle& changed, const Change& change);
    bool hasBase(const Tile& tile) const { return _base && tile.ground.crs == _baseCrs; }
    static bool isReached(const Tile& tile, const Change& change);
    bool isHidden(const Tile& tile, const TileHandle& changed, const Change& change) const;
    bool touchesAny(const TileHandle& handle, const Tile& tile) const;

    std::map<TileHandle, Tile> _tiles;
    std::set<TileHandle> _stale;
    std::optional<BaseGround> _base;
    std::string _baseCrs;
};

} // namespace osgTerrainLight
