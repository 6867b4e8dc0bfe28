#pragma once

#include <algorithm>
#include <cmath>

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
    bool contains(const PostRect& other) const
    {
        return other.empty() || (other.column >= column && other.row >= row &&
                                 other.endColumn() <= endColumn() && other.endRow() <= endRow());
    }

    PostRect grownBy(int posts) const
    {
        return {column - posts, row - posts, width + 2 * posts, height + 2 * posts};
    }
    /// The posts of a level so many times coarser that enclose it, south-west of post 0 as well.
    PostRect coarser(int levels) const
    {
        if (empty())
            return {};
        const auto floor = [levels](int post)
        { return static_cast<int>(std::floor(std::ldexp(post, -levels))); };
        PostRect result;
        result.column = floor(column);
        result.row = floor(row);
        result.width = 1 - floor(1 - endColumn()) - result.column;
        result.height = 1 - floor(1 - endRow()) - result.row;
        return result;
    }
    /// From its first to its last post, in posts of a level so many times finer.
    PostRect finer(int levels) const
    {
        const int step = 1 << levels;
        return {column * step, row * step, (width - 1) * step + 1, (height - 1) * step + 1};
    }

    /// The least that holds both; the other where one is empty.
    PostRect joinedWith(const PostRect& other) const
    {
        if (empty() || other.empty())
            return empty() ? other : *this;
        PostRect all;
        all.column = std::min(column, other.column);
        all.row = std::min(row, other.row);
        all.width = std::max(endColumn(), other.endColumn()) - all.column;
        all.height = std::max(endRow(), other.endRow()) - all.row;
        return all;
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
