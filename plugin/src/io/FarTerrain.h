#pragma once

#include "core/PostRect.h"
#include "core/Result.h"
#include "core/TileSource.h"
#include "io/LevelFile.h"
#include "io/PostsToPixels.h"
#include "io/RasterHeights.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Terrain of another raster, of any CRS and resolution, on the posts of the one that is lit and
/// beyond it. It is sampled (bilinear) on the coarsest level whose posts are no further apart than
/// its own. Coarser levels are reduced from there, finer ones interpolated (bilinear).
class FarTerrain
{
public:
    /// near: is used, and outlives it. reach: from what is lit [m]; see extent() for none there.
    static Result<std::unique_ptr<FarTerrain>> open(const std::string& path,
                                                    const RasterHeights& near, double reach);

    /// Posts of a level that may be valid; empty where none lies within reach.
    PostRect extent(int level) const;
    /// The level that it is sampled on.
    int base() const { return _base; }
    const std::vector<std::string>& notes() const { return _notes; }

    /// Makes base() … lastLevel or takes them from the cache. folder: of the cache; empty: beside
    /// the raster. origin: as RasterHeights::use(). progress: 0 … 1; false cancels.
    Status openLevels(int lastLevel, const std::string& folder,
                      const std::function<bool(double)>& progress);

    /// Any level; of a coarser one than base(), along an axis.
    Result<Raster<float>> read(int level, CrestAxis axis, const PostRect& posts);

private:
    FarTerrain() = default;
    double postDistance() const;
    struct Box;
    void findExtent(double reach);
    bool addOutline(Box& box) const;
    void addSeen(Box& box, const PostRect& limits) const;
    PixelWindow surroundedPixels() const;
    Result<LevelFacts> build(LevelFileWriter& writer, int lastLevel,
                             const std::function<bool(double)>& progress);

    std::string _path;
    const RasterHeights* _near = nullptr;
    OpenDem _dem;
    std::unique_ptr<HeightReader<double>> _reader;
    std::optional<PostsToPixels> _toPixels;
    int _base = 0;
    PostRect _extent; ///< of level base()
    std::vector<std::string> _notes;
    std::unique_ptr<LevelFile> _levels;
};

} // namespace osgTerrainLight
