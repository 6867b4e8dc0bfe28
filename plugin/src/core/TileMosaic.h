#pragma once

#include <osgTerrainLight/DemTile.h>

#include "core/TileSource.h"

#include <array>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace osgTerrainLight
{

/// Terrain of a host that holds it as equal tiles side by side, which come and go. Tiles beside
/// each other have the posts of their common edge both. Where no tile is, there is void.
///
/// Coarse heights are those of the whole terrain at once, bit by bit (LevelReducer), whatever the
/// order in which tiles came. A tile that comes costs one pass over its posts.
class TileMosaic : public TileSource
{
public:
    /// A grid of columns × rows tiles, each ≥ 1, of 2^cellsLog2 cells (one more post) a side.
    /// Spacings [m] and heightOrigin [m above the vertical datum] are those of all tiles.
    TileMosaic(int columns, int rows, int cellsLog2, double eastSpacing, double northSpacing,
               double heightOrigin);

    /// A tile at column x from the west and row y from the south, new or instead of the one there.
    /// Its heights are taken as they are; its origin must be the mosaic's, its size the grid's.
    void set(int x, int y, const DemTile& tile);
    /// The tile is no longer there.
    void remove(int x, int y);
    bool has(int x, int y) const { return _tiles.count({x, y}) > 0; }
    /// Its posts in the terrain.
    PostRect placeOf(int x, int y) const;

    int width() const override { return _columns * side() + 1; }
    int height() const override { return _rows * side() + 1; }
    int lastLevel() const override;
    PostRect extent(int level) const override;
    double heightOrigin() const override { return _heightOrigin; }
    double northSpacing() const override { return _northSpacing; }
    double eastSpacing(int) const override { return _eastSpacing; }
    Result<Raster<float>> readPosts(const PostRect& posts) override;
    Result<Raster<float>> readLevel(int level, CrestAxis axis, const PostRect& posts) override;

private:
    /// Cells of a level, by CrestAxis: (column, row) is the ground between four posts of it.
    using Cells = std::array<Raster<float>, 2>;
    struct Tile
    {
        Raster<float> posts;
        std::vector<Cells> cells; ///< of levels 0 … _cellsLog2, the last of one cell
    };

    int side() const { return 1 << _cellsLog2; }
    float postAt(int column, int row) const;
    float cellAt(int level, CrestAxis axis, int column, int row);
    void joinTiles();

    const int _columns, _rows, _cellsLog2;
    const double _eastSpacing, _northSpacing, _heightOrigin;
    std::map<std::pair<int, int>, std::shared_ptr<const Tile>> _tiles;
    std::vector<Cells> _joined; ///< of levels from _cellsLog2 on; none where a tile came or went
};

} // namespace osgTerrainLight
