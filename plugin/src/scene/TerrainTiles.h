#pragma once

#include "scene/TerrainTileReader.h"
#include "scene/TileBinder.h"
#include "scene/TileFades.h"
#include "scene/TileFinder.h"
#include "scene/TileNeighbours.h"
#include "scene/TileRegistry.h"

#include <deque>
#include <vector>

namespace osgTerrainLight
{

/// The osgTerrain tiles that a finder has found: reads them, gives them light, and follows what
/// their layers become. In update traversal.
///
/// osgTerrain tells nobody that a layer or a picture has changed. So a constant number of tiles is
/// looked at in each update, in turn, and all of them in the updates after something has happened
/// in the scene: tiles came, went or moved, or something below asked for an update traversal, as
/// a tile does whose setDirty() was called.
class TerrainTiles final : public TileFinder::Listener
{
public:
    TerrainTiles(TileRegistry& registry, TileBinder& binder, Scheduler* scheduler)
        : fades(registry, binder.units), _registry(registry), _binder(binder), _scheduler(scheduler)
    {
    }

    TileFades fades;

    // What tiles are read and bound with.
    bool defaultProgram = true;
    int glossLayer = -1;
    bool albedoNeeded = false;

    /// All tiles are looked at in the next updates.
    void settle() { _settling = updatesToSettle; }

    /// Once per update, after the finder has followed the scene. updatesBelow: children of the
    /// node that required the update traversal.
    void update(const TileFinder& finder, unsigned updatesBelow);

    void came(const FoundTile& found) override;
    void changed(const FoundTile& found) override;
    void went(osgTerrain::TerrainTile& tile) override;

private:
    static constexpr int updatesToSettle = 4;
    static constexpr std::size_t looksPerUpdate = 32;

    void begin(const TileFinder& finder);
    void use(SceneTile& tile, const FoundTile& found, bool fresh);
    bool hasTime() const;
    void surround(SceneTile& tile, const FoundTile& found, TerrainHeights& heights);
    void relight(const TileFinder& finder);
    void look(SceneTile& tile, const TileFinder& finder);
    bool isFree(SceneTile& tile);
    bool waits(SceneTile& tile, const std::vector<TilePart>& parts, bool fresh);
    static void undoWait(SceneTile& tile);
    void fail(SceneTile& tile, const std::string& problem);

    TileRegistry& _registry;
    TileBinder& _binder;
    osg::ref_ptr<Scheduler> _scheduler;
    std::vector<TileHandle> _tiles; ///< in the order in which they came
    std::deque<TileHandle> _came;   ///< whose ground is known, and that are not lit yet
    std::vector<TileHandle> _new;   ///< since the last update
    double _reading = 0.0;          ///< what surrounds tiles, in this update [ms]
    TileNeighbours _neighbours;
    std::size_t _next = 0; ///< to be looked at
    int _settling = updatesToSettle;
    unsigned _updatesBelow = 0; ///< of the last update
    bool _searched = false;
};

} // namespace osgTerrainLight
