#pragma once

#include <osgTerrainLight/DemTile.h>

#include "core/Raster.h"
#include "core/TileSource.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace osgTerrainLight
{

/// Equal, or both void.
inline bool same(float a, float b)
{
    return a == b || (std::isnan(a) && std::isnan(b));
}

/// Of a tile, NaN where void.
inline Raster<float> heightsOf(const DemTile& tile)
{
    Raster<float> heights(tile.width(), tile.height(), std::numeric_limits<float>::quiet_NaN());
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column)
            if (tile.isValid(column, row))
                heights.at(column, row) = tile.heightAt(column, row);
    return heights;
}

/// Heights of coarse posts worked out from their definition, one by one:
/// C_0[cell] = mean across of the maximum along its 4 posts, C_k = the same of 2 x 2 C_(k-1), and
/// post (i, j) of level k = the same of C_(k-1)[2i-1 ... 2i][2j-1 ... 2j]. Voids (NaN) are left
/// out.
class DirectLevels
{
public:
    explicit DirectLevels(const Raster<float>& posts) : _posts(posts) {}

    float post(int level, CrestAxis axis, int i, int j) const
    {
        return of(axis, cell(level - 1, axis, 2 * i - 1, 2 * j - 1),
                  cell(level - 1, axis, 2 * i, 2 * j - 1), cell(level - 1, axis, 2 * i - 1, 2 * j),
                  cell(level - 1, axis, 2 * i, 2 * j));
    }

private:
    float cell(int level, CrestAxis axis, int i, int j) const
    {
        // A single row or column has one cell across.
        const int columns = std::max(1, _posts.width() - 1);
        const int rows = std::max(1, _posts.height() - 1);
        if (i < 0 || j < 0 || i << level >= columns || j << level >= rows)
            return missing;
        if (level == 0)
            return of(axis, height(i, j), height(i + 1, j), height(i, j + 1), height(i + 1, j + 1));
        return of(axis, cell(level - 1, axis, 2 * i, 2 * j),
                  cell(level - 1, axis, 2 * i + 1, 2 * j), cell(level - 1, axis, 2 * i, 2 * j + 1),
                  cell(level - 1, axis, 2 * i + 1, 2 * j + 1));
    }

    float height(int i, int j) const { return _posts.contains(i, j) ? _posts.at(i, j) : missing; }

    static float higher(float a, float b)
    {
        return std::isnan(a) ? b : std::isnan(b) ? a : std::max(a, b);
    }
    static float mean(float a, float b)
    {
        return std::isnan(a) ? b : std::isnan(b) ? a : 0.5f * (a + b);
    }
    static float of(CrestAxis axis, float sw, float se, float nw, float ne)
    {
        return axis == CrestAxis::East ? mean(higher(sw, se), higher(nw, ne))
                                       : mean(higher(sw, nw), higher(se, ne));
    }

    static constexpr float missing = std::numeric_limits<float>::quiet_NaN();
    const Raster<float>& _posts;
};

} // namespace osgTerrainLight
