#pragma once

#include <osgTerrainLight/DemTile.h>

#include "core/TileSource.h"

#include <array>
#include <vector>

namespace osgTerrainLight
{

/// Terrain that is in memory as a whole: a DemTile with all its coarser levels, of which the last
/// has 2 posts a side at most. There is nothing beyond it.
class MemorySource : public TileSource
{
public:
    /// whole: with at least one post.
    explicit MemorySource(DemTile whole);

    const DemTile& whole() const { return _whole; }

    int width() const override { return _whole.width(); }
    int height() const override { return _whole.height(); }
    int lastLevel() const override { return static_cast<int>(_levels.size()); }
    PostRect extent(int level) const override;
    double heightOrigin() const override { return _whole.heightOrigin; }
    double northSpacing() const override { return _whole.northSpacing; }
    /// Of rows beyond the terrain: the nearest row's.
    double eastSpacing(int row) const override;
    Result<Raster<float>> readPosts(const PostRect& posts) override;
    Result<Raster<float>> readLevel(int level, CrestAxis axis, const PostRect& posts) override;

private:
    DemTile _whole;
    std::vector<std::array<Raster<float>, 2>> _levels; ///< from level 1 on, by CrestAxis
};

} // namespace osgTerrainLight
