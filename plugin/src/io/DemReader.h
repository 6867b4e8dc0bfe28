#pragma once

#include "core/Result.h"
#include "io/RasterBand.h"
#include "io/RasterFrame.h"
#include <osgTerrainLight/DemTile.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace osgTerrainLight
{

class HeightShift;

/// A rectangle of pixels in the raster's own order: row 0 is the file's first row.
struct PixelWindow
{
    int column = 0;
    int row = 0;
    int width = 0;
    int height = 0;
};

struct DemReadOptions
{
    /// The part to read, as GDAL's -srcwin; the whole raster where not given.
    std::optional<PixelWindow> window;
    /// Distance between posts [m], > 0, of a raster that has no geotransform; others keep theirs.
    std::optional<double> cellSize;
    /// 1 … band count.
    int band = 1;
    /// Unit of the band's values, a name that metresPerHeightUnit() knows, instead of what band and
    /// CRS say; empty where not given.
    std::string heightUnit;
    /// What heights are multiplied by, as gdaldem's -z: not 0; below 0 turns depths into heights.
    double heightFactor = 1.0;
    /// What is added to heights, to bring them to another vertical datum; may be null.
    std::shared_ptr<const HeightShift> shift;
    /// Whether heights of the tile are multiplied by the HeightFactors of measureGround(), which
    /// make slopes right; else they are what the raster says.
    bool byMapScale = true;
    /// Called with 0 … 1 while reading; false cancels.
    std::function<bool(double)> progress;
    /// A larger raster or window is refused before anything is allocated.
    std::size_t maxPosts = std::size_t(8192) * 8192;
};

/// What a DEM says about itself, and what readDem() makes of it.
struct DemInfo : BandFacts
{
    int rasterWidth = 0;
    int rasterHeight = 0;
    int bandCount = 0;
    std::string driver;
    PixelWindow window; ///< what would be read
    RasterFrame frame;  ///< of the window
    std::string crsName;
    bool geographic = false;
    double bodyRadius = 0.0;        ///< the CRS's semi-major axis [m]; 0 where it has none
    double eastSpacing = 0.0;       ///< between posts in the middle of the window [m]
    double northSpacing = 0.0;      ///< [m]
    std::vector<std::string> notes; ///< assumptions made, one sentence each
};

struct DemFile
{
    DemTile tile;
    RasterFrame frame;
    double lowest = 0.0, highest = 0.0; ///< of the valid heights [m]
    std::vector<std::string> notes;     ///< assumptions made, one sentence each, to be said once
};

/// Opens any raster that GDAL reads and says what readDem() would read; heights are not read, and
/// the size is not limited. Thread-safe, as readDem() is.
Result<DemInfo> describeDem(const std::string& path, const DemReadOptions& options = {});

/// Reads heights in metres. Posts are pixel centres. Void are: the nodata value, what a mask or
/// alpha band has 0 for, NaN, infinities, heights beyond ±1e6 m, rows of a geographic raster beyond
/// a pole, and CustomaryVoids. Radii of the CRS's body become heights above its semi-major axis.
/// Where the map's scale differs within the raster, heights of the tile are multiplied by factors
/// (DemReadOptions::byMapScale), which are 1 in the middle.
Result<DemFile> readDem(const std::string& path, const DemReadOptions& options = {});

/// As readDem() without a window, but a raster with more than maxSide posts a side is averaged down
/// to it while reading, with a note that says so: each post is read as by readDem(), and a mean is
/// that of the valid ones. Of more posts than options.maxPosts an overview is read where there is
/// one, as gdaladdo made it. maxSide ≥ 2.
Result<DemFile> readDemReduced(const std::string& path, const DemReadOptions& options, int maxSide);

} // namespace osgTerrainLight
