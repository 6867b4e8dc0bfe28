#pragma once

#include "core/TileSource.h"
#include "io/DemReader.h"

#include <memory>
#include <string>
#include <vector>

namespace osgTerrainLight
{

class FarTerrain;
class LevelFile;
class RasterHeights;

struct RasterSourceOptions
{
    /// As of readDem(). The window is what is lit. Progress counts what is read to make levels, 0 …
    /// 1 over all rasters; it is not called where all of them come from the cache. maxPosts does
    /// not count.
    DemReadOptions read;
    /// Where coarse levels are kept; empty: beside each raster, or in the user's cache folder where
    /// that cannot be written.
    std::string cacheFolder;
    /// Rasters with terrain beyond and in the voids of this one, of any CRS, resolution and unit;
    /// of several the first that has a valid height counts. Their band 1 is read.
    std::vector<std::string> surroundings;
    /// Whether the raster outside read.window is there, though not lit.
    bool beyondWindow = true;
    /// How far from what is lit terrain is looked for [m], > 0.
    double reach = 500.0e3;
};

/// Terrain of a GDAL raster of any size, for tiles and what surrounds them.
///
/// All that readDem() says of heights holds, for the whole raster at once: what is void by custom,
/// whether heights are radii, the origin of heights, the scale of the map. A tile differs from that
/// of readDem() in its origin only. Coarse levels (LevelReducer) are made when the raster is first
/// opened, in two passes over its rows with memory for a few strips, and kept in a file; later they
/// are read from it. GDAL's overviews are not used: averages lower crests, and overviews can be
/// older than the raster. GDAL's block cache (GDAL_CACHEMAX) is the bounded cache of heights.
class RasterSource : public TileSource
{
public:
    static Result<std::unique_ptr<RasterSource>> open(const std::string& path,
                                                      const RasterSourceOptions& options = {});
    ~RasterSource() override;

    int width() const override;
    int height() const override;
    /// So that a level has at most 64 posts a side, and 16 of the raster's own.
    int lastLevel() const override { return _lastLevel; }
    PostRect extent(int level) const override;
    double heightOrigin() const override;
    double northSpacing() const override;
    double eastSpacing(int row) const override;
    Result<Raster<float>> readPosts(const PostRect& posts) override;
    Result<Raster<float>> readLevel(int level, CrestAxis axis, const PostRect& posts) override;

    /// What is lit: of the window.
    const RasterFrame& frame() const;
    const DemInfo& info() const;
    double lowest() const { return _lowest; } ///< of the raster's valid heights [m]
    double highest() const { return _highest; }
    /// Assumptions made, one sentence each, to be said once; those of surroundings name their file.
    const std::vector<std::string>& notes() const { return _notes; }

private:
    RasterSource();
    Status openRaster(const std::string& path, const RasterSourceOptions& options, double share);
    Status openSurroundings(const RasterSourceOptions& options, double share);
    Status compareHeights(FarTerrain& far, const std::string& path);
    /// Where heights are missing, those of the surroundings, along an axis.
    Status fill(int level, CrestAxis axis, const PostRect& posts, Raster<float>& heights);

    std::unique_ptr<RasterHeights> _heights;
    std::unique_ptr<LevelFile> _levels;
    int _ownLastLevel = 1;
    int _lastLevel = 1;
    std::vector<std::unique_ptr<FarTerrain>> _surroundings;
    double _lowest = 0.0, _highest = 0.0;
    std::vector<std::string> _notes;
};

} // namespace osgTerrainLight
