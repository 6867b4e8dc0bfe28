#pragma once

#include "scene/SceneTile.h"

#include <osg/observer_ptr>

#include <map>
#include <memory>
#include <set>
#include <vector>

namespace osgTerrainLight
{

/// The tiles of a TerrainLighting by their handles, which are keyed by level, x and y where there
/// is a level. In update traversal.
class TileRegistry
{
public:
    /// A handle that names no other tile.
    TileHandle next();
    /// The handle of a terrain tile, found or not: by its TileID, unless another tile has that;
    /// else by a number, the same as long as the terrain tile lives.
    TileHandle handleOf(osgTerrain::TerrainTile& tile);

    /// Whether handleOf() has given the handle to a terrain tile that still lives.
    bool isPromised(const TileHandle& handle) const;

    SceneTile* find(const TileHandle& handle) const;
    /// Precondition: there is none yet.
    SceneTile& add(const TileHandle& handle);
    void remove(const TileHandle& handle);

    /// Whether a tile that a host added is bound to the StateSet.
    bool isTaken(const osg::StateSet* stateSet) const { return _taken.count(stateSet) > 0; }
    void take(const SceneTile& tile) { _taken.insert(tile.binding->stateSet()); }
    void untake(const SceneTile& tile) { _taken.erase(tile.binding->stateSet()); }

    std::vector<TileHandle> handles() const;
    template <class F>
    void forEach(F&& f) const
    {
        for (const auto& [handle, tile] : _tiles)
            f(*tile);
    }
    /// Those of dynamic terrain only.
    const std::vector<SceneTile*>& dynamic() const { return _dynamic; }
    void addDynamic(SceneTile& tile) { _dynamic.push_back(&tile); }

private:
    void forgetGone();

    std::map<TileHandle, std::unique_ptr<SceneTile>> _tiles;
    struct Known
    {
        osg::observer_ptr<osgTerrain::TerrainTile> tile; ///< another one may come to the address
        TileHandle handle;
    };
    std::map<const osgTerrain::TerrainTile*, Known> _known;
    std::map<TileHandle, osg::observer_ptr<osgTerrain::TerrainTile>> _byId; ///< as they are known
    std::size_t _forgetAt = 256; ///< size of _known at which those that are gone are forgotten
    std::set<const osg::StateSet*> _taken;
    std::vector<SceneTile*> _dynamic;
    std::uint64_t _last = 0;
};

} // namespace osgTerrainLight
