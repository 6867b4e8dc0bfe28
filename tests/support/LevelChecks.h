#pragma once

#include "core/Raster.h"
#include "core/TileSource.h"
#include "io/LevelBuilder.h"
#include "support/DirectLevels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace osgTerrainLight
{

inline bool sameHeight(float a, float b)
{
    return a == b || (std::isnan(a) && std::isnan(b));
}

/// The posts of a source, as many as its extent has, against a height worked out for each.
template <class Expected>
void expectPosts(TileSource& source, const PostRect& posts, const Expected& expected)
{
    const Result<Raster<float>> found = source.readPosts(posts);
    ASSERT_TRUE(found) << found.error().message;
    for (int row = 0; row < posts.height; ++row)
        for (int column = 0; column < posts.width; ++column)
            ASSERT_TRUE(sameHeight(found->at(column, row),
                                   expected(posts.column + column, posts.row + row)))
                << "post " << posts.column + column << ", " << posts.row + row << ": "
                << found->at(column, row) << " instead of "
                << expected(posts.column + column, posts.row + row);
}

/// Every level against its definition, evaluated on the source's own posts: those before them, up
/// to the nearest post of the coarsest level, are void.
inline void expectLevelsOfPosts(TileSource& source, int lastLevel)
{
    PostRect grid = source.extent(0);
    const PostRect coarse = grid.coarser(lastLevel);
    grid = {coarse.column * (1 << lastLevel), coarse.row * (1 << lastLevel),
            grid.endColumn() - (coarse.column * (1 << lastLevel)),
            grid.endRow() - (coarse.row * (1 << lastLevel))};
    const Result<Raster<float>> posts = source.readPosts(grid);
    ASSERT_TRUE(posts) << posts.error().message;
    const DirectLevels direct(*posts);
    for (int level = 1; level <= lastLevel; ++level)
        for (const CrestAxis axis : {CrestAxis::East, CrestAxis::North})
        {
            const PostRect extent = source.extent(level);
            const Result<Raster<float>> found = source.readLevel(level, axis, extent);
            ASSERT_TRUE(found) << found.error().message;
            for (int row = 0; row < extent.height; ++row)
                for (int column = 0; column < extent.width; ++column)
                    ASSERT_TRUE(
                        sameHeight(found->at(column, row),
                                   direct.post(level, axis,
                                               extent.column + column - grid.column / (1 << level),
                                               extent.row + row - grid.row / (1 << level))))
                        << "level " << level << ", " << extent.column + column << ", "
                        << extent.row + row;
        }
}

} // namespace osgTerrainLight
