#pragma once

#include "core/TileSource.h"

#include <array>
#include <functional>
#include <vector>

namespace osgTerrainLight
{

/// Makes coarser levels of terrain in one pass over its rows, from the south. Needs memory for a
/// few rows only.
///
/// Height of a post of level k: what lies around it, half way to its neighbours, the maximum along
/// an axis and the mean across it, level by level, voids (NaN) left out. A point sample misses
/// crests, a mean lowers them and a maximum widens them; this does none of it to rays along the
/// axis (docs/methods/tiles.md has the measurements).
class LevelReducer
{
public:
    /// A row of a level is done: heights by axis, CrestAxis::East first, `posts(level)` each.
    using Take =
        std::function<void(int level, int row, const std::array<std::vector<float>, 2>& heights)>;

    /// levels ≥ 1: how many coarser ones.
    LevelReducer(int width, int height, int levels, Take take);

    /// Posts of a level along an axis of so many posts of level 0: to its end or just beyond.
    static int posts(int count, int level);

    /// Of a cell, or around a post, from the four finer ones: their maximum along the axis, the
    /// mean of that across it. NaN stands for none.
    static float crestOf(CrestAxis axis, float southWest, float southEast, float northWest,
                         float northEast);

    /// The next row of level 0, `width` heights, NaN where void.
    void addRow(const float* heights);

private:
    /// Cells of a level: (column, row) is the ground between four posts of it.
    struct Level
    {
        std::array<std::vector<float>, 2> last; ///< row of cells before
        int cells = 0;                          ///< rows of them so far
        int rows = 0;                           ///< rows of posts given out
    };

    void addCells(int level, std::array<std::vector<float>, 2> cells);
    void end(int level);

    int _width, _height;
    Take _take;
    std::vector<Level> _levels;
    std::vector<float> _before;
    int _row = 0;
};

} // namespace osgTerrainLight
