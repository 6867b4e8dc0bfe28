#pragma once

#include "scene/TileBinder.h"
#include "scene/TileFades.h"
#include "scene/TileNeighbours.h"
#include "scene/TileRegistry.h"
#include <osgTerrainLight/Surroundings.h>

#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Tiles that a host has added and whose place on the map is known: they light one another, and are
/// lit by the surroundings that the host has set. In update traversal, or where the scene may be
/// changed.
///
/// What surrounds a tile is read at its turn, within the budget of a frame but for one tile. Until
/// then a new tile waits, and an edited one keeps the light that it has.
class HostTiles
{
public:
    HostTiles(TileRegistry& registry, TileBinder& binder, TileFades& fades, Scheduler* scheduler)
        : _registry(registry), _binder(binder), _fades(fades), _scheduler(scheduler)
    {
    }

    /// Where the DEM says that a tile with this name lies; none where it does not
    /// (TerrainLighting::addTile()).
    static std::optional<PlacedGround> placeOf(const DemTile& dem, const TileHandle& name);

    void add(SceneTile& tile, const PlacedGround& ground, osg::StateSet* stateSet,
             const ShadingCoordinates& coordinates, bool program);
    void remove(const SceneTile& tile);
    /// heights: one per post.
    void setHeights(SceneTile& tile, const std::vector<float>& heights);

    /// Null function: there are none any more.
    void setSurroundings(const Surroundings& surroundings);
    /// As TerrainLighting::surroundingsChanged().
    void changeSurroundings(double west, double south, double east, double north, double highest);

    /// Once per update.
    void update();

private:
    bool hasTime() const;
    void followSettings();
    void surround(SceneTile& tile);

    TileRegistry& _registry;
    TileBinder& _binder;
    TileFades& _fades;
    osg::ref_ptr<Scheduler> _scheduler;
    TileNeighbours _neighbours;
    std::deque<TileHandle> _due;  ///< new or edited, in the order in which they became it
    double _reading = 0.0;        ///< what surrounds tiles, in this update [ms]
    double _radiansPerUnit = 1.0; ///< of the map of the surroundings; 1 where its units are lengths
    bool _bounces = false;        ///< that tiles were lit with
    HorizonQuality _quality = HorizonQuality::Normal;
};

} // namespace osgTerrainLight
