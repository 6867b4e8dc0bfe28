#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

/// Means over the cells of a coarser raster of the same extent. A post that an edge between cells
/// crosses counts in both, by its shares of area.
class CellAverages
{
public:
    /// width × height cells from postsX × postsY posts: 1 ≤ width ≤ postsX, 1 ≤ height ≤ postsY.
    CellAverages(int postsX, int postsY, int width, int height);

    void add(int column, int row, double value);

    /// Of the posts that were added; NaN where none was.
    double at(int column, int row) const;

private:
    struct Part
    {
        std::size_t cell = 0;
        double share = 0.0; ///< of the post
    };
    using Parts = std::array<Part, 2>;
    struct Cell
    {
        double sum = 0.0, weight = 0.0;
    };
    static std::vector<Parts> partsOf(int posts, int cells);

    std::size_t _width;
    std::vector<Parts> _columns, _rows;
    std::vector<Cell> _cells;
};

} // namespace osgTerrainLight
