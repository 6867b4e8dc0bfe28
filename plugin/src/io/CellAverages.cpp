#include "io/CellAverages.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <limits>

namespace osgTerrainLight
{

CellAverages::CellAverages(int postsX, int postsY, int width, int height)
    : _width(static_cast<std::size_t>(width)), _columns(partsOf(postsX, width)),
      _rows(partsOf(postsY, height)), _cells(_width * static_cast<std::size_t>(height))
{
}

std::vector<CellAverages::Parts> CellAverages::partsOf(int posts, int cells)
{
    assert(cells >= 1 && cells <= posts);
    std::vector<Parts> result;
    for (std::int64_t post = 0; post < posts; ++post)
    {
        // In units of 1/posts of a cell a post is `cells` wide, and never in more than two cells.
        const std::int64_t start = post * cells;
        const std::int64_t cell = start / posts;
        const std::int64_t inFirst = std::min((cell + 1) * posts - start, std::int64_t(cells));
        const double share = static_cast<double>(inFirst) / cells;
        const std::int64_t next = std::min(cell + 1, std::int64_t(cells) - 1);
        result.push_back({Part{static_cast<std::size_t>(cell), share},
                          Part{static_cast<std::size_t>(next), 1.0 - share}});
    }
    return result;
}

void CellAverages::add(int column, int row, double value)
{
    for (const Part& y : _rows[static_cast<std::size_t>(row)])
        for (const Part& x : _columns[static_cast<std::size_t>(column)])
        {
            Cell& cell = _cells[y.cell * _width + x.cell];
            cell.sum += x.share * y.share * value;
            cell.weight += x.share * y.share;
        }
}

double CellAverages::at(int column, int row) const
{
    const Cell& cell =
        _cells[static_cast<std::size_t>(row) * _width + static_cast<std::size_t>(column)];
    return cell.weight > 0.0 ? cell.sum / cell.weight : std::numeric_limits<double>::quiet_NaN();
}

} // namespace osgTerrainLight
