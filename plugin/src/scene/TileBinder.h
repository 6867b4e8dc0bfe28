#pragma once

#include "scene/SceneTile.h"
#include "scene/Scheduler.h"
#include "scene/TerrainTileReader.h"
#include "scene/TilePrograms.h"
#include "scene/TileUnits.h"

#include <deque>
#include <map>
#include <string>

namespace osgTerrainLight
{

/// Gives tiles light and binds it to their StateSets, and takes it off again once no frame uses it.
/// In update traversal.
class TileBinder
{
public:
    TileBinder(Scheduler* scheduler, TilePrograms* programs)
        : _scheduler(scheduler), _programs(programs)
    {
    }

    TileUnits units;

    /// A host's terrain. Precondition: its StateSet has no tile.
    void bindHost(SceneTile& tile, const DemTile& dem, osg::StateSet* stateSet,
                  const ShadingCoordinates& coordinates, bool program);
    /// A host's terrain with its place, and with what surrounds it; null: it is lit alone.
    void bindPlaced(SceneTile& tile, const std::shared_ptr<const TileWindows>& windows);
    /// The same before that is known: nothing is computed yet.
    void bindWaiting(SceneTile& tile);
    void bindDynamic(SceneTile& tile, DynamicTerrain& terrain);
    /// A terrain tile that was found.
    void bindTerrain(SceneTile& tile, const TerrainHeights& heights, const std::string& name,
                     const ShadingCoordinates& coordinates, bool program);

    /// Takes the light off the tile, a few updates later from its StateSet: frames that are still
    /// being drawn use it.
    void release(SceneTile& tile);
    /// Once per update.
    void retire();
    /// Removes what is still bound to a StateSet that is about to be bound anew, by a tile that is
    /// gone, of another lighting too.
    void takeFrom(const osg::StateSet* stateSet);

    /// Binds light sent by gloss, edges of shadows, and what objects leave of the light, where
    /// there are some now. Until they are computed the tile waits.
    void followTextures(SceneTile& tile);
    /// Hands on heights of dynamic terrain that have changed.
    void followHeights(SceneTile& tile);

    /// Dispatches of tiles that are gone.
    const std::map<std::string, unsigned>& pastDispatches() const { return _pastDispatches; }

private:
    /// A binding that frames still being drawn may use.
    struct Retired
    {
        std::shared_ptr<ShadingBinding> binding;
        osg::ref_ptr<osgTerrain::TerrainTile> emptied; ///< its StateSet is ours to take off
        int updates = 3;                               ///< frames that a threaded viewer has going
    };
    void light(SceneTile& tile, LitTile* lit);
    void bind(SceneTile& tile, osg::StateSet* stateSet, const ShadingCoordinates& coordinates,
              osg::Program* program);
    osg::ref_ptr<osg::Program> programOf(const SceneTile& tile, bool wanted);
    static void take(Retired& retired);
    void followGloss(SceneTile& tile);
    void followEdges(SceneTile& tile);
    void followObjects(SceneTile& tile);

    osg::ref_ptr<Scheduler> _scheduler;
    osg::ref_ptr<TilePrograms> _programs;
    std::deque<Retired> _retired;
    std::map<std::string, unsigned> _pastDispatches;
};

} // namespace osgTerrainLight
