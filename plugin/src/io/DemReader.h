#pragma once

#include "core/Result.h"
#include <osgTerrainLight/DemTile.h>

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace osgTerrainLight
{

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
    /// Called with 0 … 1 while reading; false cancels.
    std::function<bool(double)> progress;
    /// A larger raster or window is refused before anything is allocated.
    std::size_t maxPosts = std::size_t(8192) * 8192;
};

/// Where a raster lies and how its rows and columns run: what a result needs to be written so that
/// its pixels coincide with the input's.
struct RasterFrame
{
    int width = 0;
    int height = 0;
    /// False where the geotransform below was made up from a cell size; it is then not written.
    bool hasGeoTransform = false;
    /// GDAL's order: pixel corner to map; no rotation.
    std::array<double, 6> geoTransform = {0.0, 1.0, 0.0, 0.0, 0.0, -1.0};
    bool northUp = true;   ///< row 0 of the file is its northernmost
    bool westFirst = true; ///< column 0 of the file is its westernmost
    std::string crs;       ///< WKT 2; empty where unknown

    /// Row and column of the file that hold a tile's row and column (and the other way round).
    int fileRow(int tileRow) const { return northUp ? height - 1 - tileRow : tileRow; }
    int fileColumn(int tileColumn) const { return westFirst ? tileColumn : width - 1 - tileColumn; }
};

/// What a DEM says about itself, and what readDem() makes of it.
struct DemInfo
{
    int rasterWidth = 0;
    int rasterHeight = 0;
    int bandCount = 0;
    std::string driver;
    std::string dataType;
    PixelWindow window; ///< what would be read
    RasterFrame frame;  ///< of the window
    std::string crsName;
    bool geographic = false;
    std::string heightUnit; ///< as the file has it; empty where it has none
    double metresPerHeightUnit = 1.0;
    double scale = 1.0, offset = 0.0; ///< height = (stored · scale + offset) units
    std::optional<double> noData;     ///< of stored values
    bool hasMask = false;             ///< a mask or alpha band says what is void
    double eastSpacing = 0.0;         ///< between posts in the middle of the window [m]
    double northSpacing = 0.0;        ///< [m]
    std::vector<std::string> notes;   ///< assumptions made, one sentence each
};

struct DemFile
{
    DemTile tile;
    RasterFrame frame;
    std::vector<std::string> notes; ///< assumptions made, one sentence each, to be said once
};

/// Opens any raster that GDAL reads and says what readDem() would read; heights are not read, and
/// the size is not limited. Thread-safe, as readDem() is.
OSGTERRAINLIGHT_EXPORT Result<DemInfo> describeDem(const std::string& path,
                                                   const DemReadOptions& options = {});

/// Reads heights in metres. Posts are pixel centres. Void are: the nodata value, what a mask or
/// alpha band has 0 for, NaN, infinities, heights beyond ±1e6 m, rows of a geographic raster beyond
/// a pole, and where neither a nodata value nor a scale is declared -32767, -32768 and -99999.
OSGTERRAINLIGHT_EXPORT Result<DemFile> readDem(const std::string& path,
                                               const DemReadOptions& options = {});

/// Length on the ground of a small step in longitude and latitude.
struct MetresPerRadian
{
    double east = 0.0;
    double north = 0.0;
};

/// On an ellipsoid with semi-axes a ≥ b > 0 [m] at a geodetic latitude [rad], −π/2 … π/2:
/// north is the meridional radius of curvature a²b²/w³, east the prime vertical radius a²/w times
/// cos(latitude), with w² = a²cos² + b²sin² (Snyder, Map Projections, 1987, eqs 4-18 to 4-20). At
/// the poles, where all longitudes meet, cos is kept at 1e-6, so that a spacing is always > 0.
OSGTERRAINLIGHT_EXPORT MetresPerRadian metresPerRadian(double latitude, double semiMajor,
                                                       double semiMinor);

/// While it lives, GDAL's errors and warnings on this thread are kept here and off stderr.
/// Registers GDAL's drivers on first use.
class GdalErrors
{
public:
    GdalErrors();
    ~GdalErrors();
    GdalErrors(const GdalErrors&) = delete;
    GdalErrors& operator=(const GdalErrors&) = delete;

    void add(bool failure, const char* message);
    void clear();

    bool hasFailure() const { return !_firstFailure.empty(); }
    /// The first failure is mostly the cause, the last the one that names the place; a warning
    /// stands in where there was no failure, and a fixed phrase where there was nothing.
    std::string first() const;
    std::string last() const;

private:
    std::string _firstFailure, _lastFailure, _warning;
};

} // namespace osgTerrainLight
