#pragma once

#include "scene/SceneTile.h"
#include "scene/TileLevels.h"
#include "scene/TileRegistry.h"
#include "scene/TileUnits.h"

#include <osg/FrameStamp>
#include <osg/NodeVisitor>
#include <osg/State>

#include <optional>
#include <set>
#include <vector>

namespace osgTerrainLight
{

/// A terrain tile that is lit anew keeps the light that it had until its own is there; a new one
/// begins with the light of the nearest tile above it, by level, x and y. Its own light then fades
/// in. Before it gives way to the tile above it (FadingLod), that one's light fades in; and while
/// its own does, no finer ones take its place.
///
/// Beside a place where a coarser level is drawn (TileLevels) a tile has the light of the tile
/// above it along the border, as far as that is drawn there: while a neighbour's own light fades
/// in, the tile's does beside it. In update traversal.
///
/// Only what becomes lit fades. Light that changes afterwards is computed into the texture that is
/// drawn, the one of a tile above too, so it neither fades nor lags.
class TileFades
{
public:
    TileFades(const TileRegistry& registry, const TileUnits& units)
        : _registry(registry), _units(units), _levels(registry)
    {
    }

    double seconds = 0.5; ///< that a fade lasts; 0: own light is drawn as soon as it is there

    /// After a tile has been found, or has been found elsewhere. above: to its parent.
    void place(SceneTile& tile, const osg::NodePath& above);
    /// Before a tile is released that will be bound again: its light is kept.
    void keep(SceneTile& tile) const;
    /// After it has been bound: it is drawn with the light that was kept, or with that of a tile
    /// above it, where there is some.
    void begin(SceneTile& tile);
    /// Of tiles around it, by level, x and y: it came or went.
    void follow(const TileHandle& handle);
    /// Once per update, after bindings have followed their textures. Costs nothing for tiles that
    /// neither fade nor have a coarser neighbour, but a look at each osg::PagedLOD.
    /// isOn: the light, for which levels may have to wait.
    void update(const osg::FrameStamp* stamp, bool isOn);

    void releaseGLObjects(osg::State* state) const;

private:
    std::optional<FormerLight> above(const SceneTile& tile) const;
    bool borrow(SceneTile& tile) const;
    bool addAbove(SceneTile& tile) const;
    bool isRenewed(const SceneTile& tile) const;
    void fade(SceneTile& tile);
    double faded(const SceneTile& tile, bool isCurrent) const;
    void blend(SceneTile& tile);
    void followLevels(const osg::FrameStamp* stamp);
    void hold(const osg::FrameStamp* stamp);
    bool mayLeave(const SceneTile& tile) const;
    void advance(const osg::FrameStamp* stamp);

    const TileRegistry& _registry;
    const TileUnits& _units;
    const TileLevels _levels;
    std::set<TileHandle> _tiles; ///< that wait, fade, or have a border with a coarser level
    /// A tile below which there may be finer ones, as it was at the last look.
    struct Family
    {
        TileHandle handle;
        bool isRefined = false, wantsFiner = false;
        unsigned children = 0; ///< of its osg::PagedLOD
    };
    std::vector<Family> _families;
    double _step = 0.0;                         ///< of a fade, in this update
    double _simulation = 0.0, _reference = 0.0; ///< of the last update [s]
};

} // namespace osgTerrainLight
