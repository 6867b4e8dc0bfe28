#pragma once

#include <algorithm>

namespace osgTerrainLight
{

/// Posts of one level, row 0 south. Those of level k are 2^k posts of level 0 apart: post (i, j) of
/// it stands on post (i · 2^k, j · 2^k) of the whole terrain. Columns and rows may be negative,
/// where a source has terrain beyond what is lit.
struct PostRect
{
    int column = 0;
    int row = 0;
    int width = 0;
    int height = 0;

    bool empty() const { return width <= 0 || height <= 0; }
    int endColumn() const { return column + width; }
    int endRow() const { return row + height; }
    bool contains(int x, int y) const
    {
        return x >= column && y >= row && x < endColumn() && y < endRow();
    }

    PostRect grownBy(int posts) const
    {
        return {column - posts, row - posts, width + 2 * posts, height + 2 * posts};
    }
    /// What both have; empty where they have nothing in common.
    PostRect clippedTo(const PostRect& other) const
    {
        PostRect both;
        both.column = std::max(column, other.column);
        both.row = std::max(row, other.row);
        both.width = std::max(0, std::min(endColumn(), other.endColumn()) - both.column);
        both.height = std::max(0, std::min(endRow(), other.endRow()) - both.row);
        return both;
    }
};

} // namespace osgTerrainLight
