#include "core/TileMosaic.h"

#include "core/Crests.h"
#include "core/LevelReducer.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace osgTerrainLight
{
namespace
{
constexpr float missing = std::numeric_limits<float>::quiet_NaN();
constexpr std::array<CrestAxis, 2> axes = {CrestAxis::East, CrestAxis::North};

std::size_t indexOf(CrestAxis axis)
{
    return axis == CrestAxis::East ? 0 : 1;
}

float at(const Raster<float>& raster, int column, int row)
{
    return raster.contains(column, row) ? raster.at(column, row) : missing;
}
} // namespace

TileMosaic::TileMosaic(int columns, int rows, int cellsLog2, double eastSpacing,
                       double northSpacing, double heightOrigin)
    : _columns(columns), _rows(rows), _cellsLog2(cellsLog2), _eastSpacing(eastSpacing),
      _northSpacing(northSpacing), _heightOrigin(heightOrigin)
{
    assert(columns >= 1 && rows >= 1 && cellsLog2 >= 1);
}

PostRect TileMosaic::placeOf(int x, int y) const
{
    return {x * side(), y * side(), side() + 1, side() + 1};
}

void TileMosaic::set(int x, int y, const DemTile& tile)
{
    assert(x >= 0 && y >= 0 && x < _columns && y < _rows);
    assert(tile.width() == side() + 1 && tile.height() == side() + 1);
    assert(tile.heightOrigin == _heightOrigin);
    auto made = std::make_shared<Tile>();
    made->posts = Raster<float>(tile.width(), tile.height(), missing);
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column)
            if (tile.isValid(column, row))
                made->posts.at(column, row) = tile.heightAt(column, row);
    made->cells.resize(static_cast<std::size_t>(_cellsLog2) + 1);
    for (const CrestAxis axis : axes)
    {
        made->cells[0][indexOf(axis)] = cellsOf(made->posts, axis);
        for (std::size_t level = 1; level < made->cells.size(); ++level)
            made->cells[level][indexOf(axis)] =
                coarserCells(made->cells[level - 1][indexOf(axis)], axis);
    }
    _tiles[{x, y}] = std::move(made);
    _joined.clear();
}

void TileMosaic::remove(int x, int y)
{
    _tiles.erase({x, y});
    _joined.clear();
}

int TileMosaic::lastLevel() const
{
    int levels = 0;
    while (LevelReducer::posts(std::max(width(), height()), levels) > 2)
        ++levels;
    return levels;
}

PostRect TileMosaic::extent(int level) const
{
    return {0, 0, LevelReducer::posts(width(), level), LevelReducer::posts(height(), level)};
}

/// A post on a common edge is any tile's that is there.
float TileMosaic::postAt(int column, int row) const
{
    for (const int y : {row / side(), (row - 1) / side()})
        for (const int x : {column / side(), (column - 1) / side()})
        {
            const auto found = _tiles.find({x, y});
            if (found != _tiles.end())
                return found->second->posts.at(column - x * side(), row - y * side());
        }
    return missing;
}

float TileMosaic::cellAt(int level, CrestAxis axis, int column, int row)
{
    if (column < 0 || row < 0)
        return missing;
    const int perTile = level < _cellsLog2 ? _cellsLog2 - level : 0;
    if (perTile == 0)
    {
        const std::size_t above = static_cast<std::size_t>(level - _cellsLog2);
        return above < _joined.size() ? at(_joined[above][indexOf(axis)], column, row) : missing;
    }
    const auto found = _tiles.find({column >> perTile, row >> perTile});
    if (found == _tiles.end())
        return missing;
    const int mask = (1 << perTile) - 1;
    return found->second->cells[static_cast<std::size_t>(level)][indexOf(axis)].at(column & mask,
                                                                                   row & mask);
}

/// Levels above those of tiles, where each has one cell.
void TileMosaic::joinTiles()
{
    Cells cells;
    for (const CrestAxis axis : axes)
    {
        Raster<float>& made = cells[indexOf(axis)];
        made = Raster<float>(_columns, _rows, missing);
        for (const auto& [place, tile] : _tiles)
            made.at(place.first, place.second) = tile->cells.back()[indexOf(axis)].at(0, 0);
    }
    _joined.push_back(std::move(cells));
    while (_joined.back()[0].width() > 1 || _joined.back()[0].height() > 1)
    {
        Cells coarser;
        for (const CrestAxis axis : axes)
            coarser[indexOf(axis)] = coarserCells(_joined.back()[indexOf(axis)], axis);
        _joined.push_back(std::move(coarser));
    }
}

Result<Raster<float>> TileMosaic::readPosts(const PostRect& posts)
{
    Raster<float> result(std::max(0, posts.width), std::max(0, posts.height), missing);
    const PostRect inside = posts.clippedTo(extent(0));
    for (int row = inside.row; row < inside.endRow(); ++row)
        for (int column = inside.column; column < inside.endColumn(); ++column)
            result.at(column - posts.column, row - posts.row) = postAt(column, row);
    return result;
}

Result<Raster<float>> TileMosaic::readLevel(int level, CrestAxis axis, const PostRect& posts)
{
    assert(level >= 1 && level <= lastLevel());
    if (_joined.empty())
        joinTiles();
    Raster<float> result(std::max(0, posts.width), std::max(0, posts.height), missing);
    const PostRect inside = posts.clippedTo(extent(level));
    for (int row = inside.row; row < inside.endRow(); ++row)
        for (int column = inside.column; column < inside.endColumn(); ++column)
            result.at(column - posts.column, row - posts.row) =
                LevelReducer::crestOf(axis, cellAt(level - 1, axis, 2 * column - 1, 2 * row - 1),
                                      cellAt(level - 1, axis, 2 * column, 2 * row - 1),
                                      cellAt(level - 1, axis, 2 * column - 1, 2 * row),
                                      cellAt(level - 1, axis, 2 * column, 2 * row));
    return result;
}

} // namespace osgTerrainLight
