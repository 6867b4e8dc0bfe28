#pragma once

#include "core/PostRect.h"
#include "core/Raster.h"
#include "core/Result.h"

namespace osgTerrainLight
{

/// Along which axis a coarse height is the maximum of those that it stands for; across it is their
/// mean. Rays along that axis keep their crests, and gain none from beside them.
enum class CrestAxis
{
    East,
    North
};

/// Terrain of any extent, from which tiles and what surrounds them are read, level by level.
///
/// Level 0 has the posts themselves; level k has one of every 2^k (PostRect) with heights by
/// LevelReducer. Reads are by one thread at a time.
class TileSource
{
public:
    virtual ~TileSource() = default;

    /// Posts of level 0 that are there to be lit: (0, 0) … (width() − 1, height() − 1).
    virtual int width() const = 0;
    virtual int height() const = 0;

    /// The same posts, or fewer where the source has void ones around them for round sizes: the
    /// middle of these is that of the terrain.
    virtual PostRect terrain() const { return {0, 0, width(), height()}; }

    /// The coarsest level, ≥ 0.
    virtual int lastLevel() const = 0;
    /// All posts of a level that may be valid; those of terrain beyond what is lit too.
    virtual PostRect extent(int level) const = 0;

    /// The height that 0 stands for [m above the vertical datum]: the same for all reads.
    virtual double heightOrigin() const = 0;
    virtual double northSpacing() const = 0;
    /// Between columns of level 0 [m], of any row, those beyond width() × height() too.
    virtual double eastSpacing(int row) const = 0;

    /// Heights [m above heightOrigin()] of posts of level 0, NaN where void or where there is
    /// nothing. The rectangle may reach beyond extent(0).
    virtual Result<Raster<float>> readPosts(const PostRect& posts) = 0;
    /// The same of a level, 1 … lastLevel().
    virtual Result<Raster<float>> readLevel(int level, CrestAxis axis, const PostRect& posts) = 0;
    /// The same of a level as a surface of its own, whose crests are along no axis: by default the
    /// mean of both.
    virtual Result<Raster<float>> readSurface(int level, const PostRect& posts);
};

} // namespace osgTerrainLight
