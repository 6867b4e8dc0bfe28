#include "core/MemorySource.h"

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

int levelsOf(int width, int height)
{
    int levels = 0;
    while (LevelReducer::posts(std::max(width, height), levels) > 2)
        ++levels;
    return levels;
}

/// heightAt(column, row): of posts of `extent`; those beyond it are NaN.
template <class HeightAt>
Raster<float> cut(const PostRect& posts, const PostRect& extent, const HeightAt& heightAt)
{
    Raster<float> result(std::max(0, posts.width), std::max(0, posts.height), missing);
    const PostRect inside = posts.clippedTo(extent);
    for (int row = inside.row; row < inside.endRow(); ++row)
        for (int column = inside.column; column < inside.endColumn(); ++column)
            result.at(column - posts.column, row - posts.row) = heightAt(column, row);
    return result;
}
} // namespace

MemorySource::MemorySource(DemTile whole) : _whole(std::move(whole))
{
    const int levels = levelsOf(width(), height());
    if (levels == 0)
        return;
    for (int level = 1; level <= levels; ++level)
        _levels.emplace_back().fill(Raster<float>(LevelReducer::posts(width(), level),
                                                  LevelReducer::posts(height(), level), missing));
    LevelReducer reducer(width(), height(), levels,
                         [this](int level, int row, const auto& heights)
                         {
                             auto& made = _levels[static_cast<std::size_t>(level - 1)];
                             for (std::size_t axis = 0; axis < 2; ++axis)
                                 std::copy(heights[axis].begin(), heights[axis].end(),
                                           &made[axis].at(0, row));
                         });
    std::vector<float> posts(static_cast<std::size_t>(width()));
    for (int row = 0; row < height(); ++row)
    {
        for (int column = 0; column < width(); ++column)
            posts[static_cast<std::size_t>(column)] =
                _whole.isValid(column, row) ? _whole.heightAt(column, row) : missing;
        reducer.addRow(posts.data());
    }
}

PostRect MemorySource::extent(int level) const
{
    return {0, 0, LevelReducer::posts(width(), level), LevelReducer::posts(height(), level)};
}

double MemorySource::eastSpacing(int row) const
{
    return _whole.eastSpacing(std::clamp(row, 0, height() - 1));
}

Result<Raster<float>> MemorySource::readPosts(const PostRect& posts)
{
    return cut(posts, extent(0),
               [this](int column, int row)
               { return _whole.isValid(column, row) ? _whole.heightAt(column, row) : missing; });
}

Result<Raster<float>> MemorySource::readLevel(int level, CrestAxis axis, const PostRect& posts)
{
    assert(level >= 1 && level <= lastLevel());
    const Raster<float>& heights =
        _levels[static_cast<std::size_t>(level - 1)][static_cast<std::size_t>(axis)];
    return cut(posts, extent(level),
               [&heights](int column, int row) { return heights.at(column, row); });
}

} // namespace osgTerrainLight
