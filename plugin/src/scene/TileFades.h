#pragma once

#include "scene/SceneTile.h"
#include "scene/TileRegistry.h"
#include "scene/TileUnits.h"

#include <osg/FrameStamp>
#include <osg/State>

#include <optional>
#include <vector>

namespace osgTerrainLight
{

/// A terrain tile that is lit anew keeps the light that it had until its own is there; a new one
/// begins with the light of the nearest tile above it, by level, x and y. Its own light then fades
/// in. In update traversal.
///
/// Only what becomes lit fades. Light that changes afterwards is computed into the texture that is
/// drawn, the one of a tile above too, so it neither fades nor lags.
class TileFades
{
public:
    TileFades(const TileRegistry& registry, const TileUnits& units)
        : _registry(registry), _units(units)
    {
    }

    double seconds = 0.5; ///< that a fade lasts; 0: own light is drawn as soon as it is there

    /// Before a tile is released that will be bound again: its light is kept.
    void keep(SceneTile& tile) const;
    /// After it has been bound: it is drawn with the light that was kept, or with that of a tile
    /// above it, where there is some.
    void begin(SceneTile& tile);
    /// Once per update, after bindings have followed their textures. Tiles that do not fade cost
    /// nothing.
    void update(const osg::FrameStamp* stamp);

    void releaseGLObjects(osg::State* state) const;

private:
    std::optional<FormerLight> above(const SceneTile& tile) const;
    /// Of its own light, 0 … 1. Precondition: it fades.
    double part(const SceneTile& tile) const;
    /// False where it need not be looked at again.
    bool follow(SceneTile& tile) const;
    void advance(const osg::FrameStamp* stamp);

    const TileRegistry& _registry;
    const TileUnits& _units;
    std::vector<TileHandle> _tiles;             ///< that wait or fade
    double _now = 0.0;                          ///< [s]
    double _simulation = 0.0, _reference = 0.0; ///< of the last update [s]
};

} // namespace osgTerrainLight
