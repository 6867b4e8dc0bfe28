#pragma once

#include "scene/TileRegistry.h"

#include <osg/Node>

#include <array>

namespace osgTerrainLight
{

/// Which of the tiles of several levels a scene draws, as the frame numbers of the osg::PagedLOD
/// above them tell: one has a tile first, and the finer ones in its place second. All other tiles
/// count as drawn. In update traversal.
class TileLevels
{
public:
    explicit TileLevels(const TileRegistry& registry) : _registry(registry) {}

    /// above: from TerrainLighting to the tile's parent.
    static void place(SceneTile& tile, const osg::NodePath& above);

    /// Finer children are there, and were drawn when the node was seen last.
    static bool isRefined(const osg::PagedLOD& lod);
    /// Whether finer children should be drawn: else they are not, or are about to go.
    static bool wantsFiner(const osg::PagedLOD& lod);

    static bool isRefined(const SceneTile& tile) { return tile.finer && isRefined(*tile.finer); }
    /// The tile above is drawn in its place, or is about to be.
    static bool leaves(const SceneTile& tile)
    {
        return tile.coarser && !(wantsFiner(*tile.coarser) && isRefined(*tile.coarser)) &&
               !isRefined(tile);
    }

    /// It is drawn, or finer ones in its place.
    bool isReached(const SceneTile& tile) const;

    /// How much of the light of a coarser level is drawn at a tile's place, 0 … 1: all of it where
    /// a coarser tile is drawn there. 0 where nothing is.
    float coarserPart(const TileHandle& place) const;

    std::array<SceneTile*, 4> below(const SceneTile& tile) const;
    /// Tiles of its level at its sides and corners, in the order of BorderParts.
    static std::array<TileHandle, 8> around(const TileHandle& handle);

private:
    const TileRegistry& _registry;
};

} // namespace osgTerrainLight
