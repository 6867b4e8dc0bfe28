#include "core/LevelReducer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace osgTerrainLight
{
namespace
{
constexpr float missing = std::numeric_limits<float>::quiet_NaN();

float higher(float a, float b)
{
    return std::fmax(a, b); // the other where one is NaN
}

float mean(float a, float b)
{
    return std::isnan(a) ? b : std::isnan(b) ? a : 0.5f * (a + b);
}

/// NaN beside the row.
float at(const std::vector<float>& row, int column)
{
    return column >= 0 && column < static_cast<int>(row.size())
               ? row[static_cast<std::size_t>(column)]
               : missing;
}
} // namespace

LevelReducer::LevelReducer(int width, int height, int levels, Take take)
    : _width(width), _height(height), _take(std::move(take)),
      _levels(static_cast<std::size_t>(levels))
{
    assert(width >= 1 && height >= 1 && levels >= 1);
}

float LevelReducer::crestOf(CrestAxis axis, float southWest, float southEast, float northWest,
                            float northEast)
{
    return axis == CrestAxis::East
               ? mean(higher(southWest, southEast), higher(northWest, northEast))
               : mean(higher(southWest, northWest), higher(southEast, northEast));
}

int LevelReducer::posts(int count, int level)
{
    const int step = 1 << level;
    return (count - 1 + step - 1) / step + 1;
}

void LevelReducer::addRow(const float* heights)
{
    assert(_row < _height);
    std::vector<float> row(heights, heights + _width);
    if (_row > 0 || _height == 1) // a single row has void ones beside it
    {
        std::array<std::vector<float>, 2> cells;
        for (const CrestAxis axis : {CrestAxis::East, CrestAxis::North})
        {
            std::vector<float>& made = cells[axis == CrestAxis::East ? 0 : 1];
            made.resize(static_cast<std::size_t>(std::max(1, _width - 1)));
            for (int i = 0; i < static_cast<int>(made.size()); ++i)
                made[static_cast<std::size_t>(i)] =
                    crestOf(axis, at(_before, i), at(_before, i + 1), at(row, i), at(row, i + 1));
        }
        addCells(1, std::move(cells));
    }
    _before = std::move(row);
    if (++_row == _height)
        end(1);
}

/// cells: of level - 1, the next row of them.
void LevelReducer::addCells(int level, std::array<std::vector<float>, 2> cells)
{
    Level& now = _levels[static_cast<std::size_t>(level - 1)];
    const bool isFirst = now.cells % 2 == 0; // of the two of a cell of this level
    const int width = posts(_width, level);
    std::array<std::vector<float>, 2> made;
    for (const CrestAxis axis : {CrestAxis::East, CrestAxis::North})
    {
        const std::size_t index = axis == CrestAxis::East ? 0 : 1;
        const std::vector<float>& south = now.last[index];
        const std::vector<float>& north = cells[index];
        std::vector<float>& row = made[index];
        row.resize(static_cast<std::size_t>(isFirst ? width : std::max(1, width - 1)));
        for (int i = 0; i < static_cast<int>(row.size()); ++i)
        {
            const int west = isFirst ? 2 * i - 1 : 2 * i;
            row[static_cast<std::size_t>(i)] = crestOf(axis, at(south, west), at(south, west + 1),
                                                       at(north, west), at(north, west + 1));
        }
    }
    // Around a post lie the second row of a cell and the first of the next.
    if (isFirst)
        _take(level, now.rows++, made);
    now.last = std::move(cells);
    ++now.cells;
    if (!isFirst && level < static_cast<int>(_levels.size()))
        addCells(level + 1, std::move(made));
}

/// All rows were given: what is left of this level and the coarser ones.
void LevelReducer::end(int level)
{
    if (level > static_cast<int>(_levels.size()))
        return;
    Level& now = _levels[static_cast<std::size_t>(level - 1)];
    const std::size_t width = now.last[0].size();
    const std::array<std::vector<float>, 2> none = {std::vector<float>(width, missing),
                                                    std::vector<float>(width, missing)};
    while (now.rows < posts(_height, level) || now.cells % 2 != 0)
        addCells(level, none);
    end(level + 1);
}

} // namespace osgTerrainLight
