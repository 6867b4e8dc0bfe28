#include "core/Crests.h"

#include "core/LevelReducer.h"

#include <limits>

namespace osgTerrainLight
{
namespace
{
float at(const Raster<float>& raster, int column, int row)
{
    return raster.contains(column, row) ? raster.at(column, row)
                                        : std::numeric_limits<float>::quiet_NaN();
}
} // namespace

Raster<float> cellsOf(const Raster<float>& posts, CrestAxis axis)
{
    Raster<float> cells(posts.width() - 1, posts.height() - 1);
    for (int row = 0; row < cells.height(); ++row)
        for (int column = 0; column < cells.width(); ++column)
            cells.at(column, row) =
                LevelReducer::crestOf(axis, posts.at(column, row), posts.at(column + 1, row),
                                      posts.at(column, row + 1), posts.at(column + 1, row + 1));
    return cells;
}

Raster<float> coarserCells(const Raster<float>& cells, CrestAxis axis)
{
    Raster<float> made((cells.width() + 1) / 2, (cells.height() + 1) / 2);
    for (int row = 0; row < made.height(); ++row)
        for (int column = 0; column < made.width(); ++column)
            made.at(column, row) = LevelReducer::crestOf(
                axis, at(cells, 2 * column, 2 * row), at(cells, 2 * column + 1, 2 * row),
                at(cells, 2 * column, 2 * row + 1), at(cells, 2 * column + 1, 2 * row + 1));
    return made;
}

} // namespace osgTerrainLight
