#include "io/OpenDem.h"

#include "io/GdalErrors.h"
#include "io/InputFiles.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace osgTerrainLight
{
namespace
{

std::string number(double value)
{
    return CPLSPrintf("%.10g", value);
}

std::string size(int width, int height)
{
    return std::to_string(width) + " x " + std::to_string(height);
}

Error openingError(const std::string& path, const GdalErrors& errors)
{
    VSIStatBufL stat;
    if (VSIStatL(path.c_str(), &stat) != 0)
        return {ErrorCode::NotFound, path + ": no such file (" + errors.first() + ")"};
    const CPLStringList names(VSIReadDir(path.c_str()));
    if (names.size() > 0)
    {
        std::string example;
        for (int i = 0; i < names.size() && example.empty(); ++i)
            if (names[i][0] != '.')
                example = std::string(", such as ") + names[i];
        return {ErrorCode::Invalid,
                path + ": is a folder or archive; needed a raster in it" + example};
    }
    if (stat.st_size == 0)
        return {ErrorCode::Invalid, path + ": is empty; needed a raster that GDAL reads"};
    return {ErrorCode::Invalid,
            path + ": is no raster that GDAL reads, or is damaged (" + errors.first() + ")"};
}

std::optional<Error> openFile(const std::string& path, OpenDem& dem, const GdalErrors& errors)
{
    if (const std::string wrong = complaintOfFile(path); !wrong.empty())
        return Error{ErrorCode::Invalid, path + ": " + wrong};
    dem.dataset.reset(
        GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
    if (!dem.dataset)
        return openingError(path, errors);
    return std::nullopt;
}

std::optional<Error> chooseBand(const std::string& path, const DemReadOptions& options,
                                OpenDem& dem)
{
    GDALDataset& dataset = *dem.dataset;
    DemInfo& info = dem.info;
    info.rasterWidth = dataset.GetRasterXSize();
    info.rasterHeight = dataset.GetRasterYSize();
    info.bandCount = dataset.GetRasterCount();
    info.driver = dataset.GetDriver() ? dataset.GetDriver()->GetDescription() : "";
    if (info.bandCount == 0)
    {
        const char* part =
            CSLFetchNameValue(dataset.GetMetadata("SUBDATASETS"), "SUBDATASET_1_NAME");
        return Error{ErrorCode::Invalid,
                     path + ": holds no raster band itself; needed one of its parts" +
                         (part ? std::string(", such as ") + part : "")};
    }
    if (options.band < 1 || options.band > info.bandCount)
        return Error{ErrorCode::Invalid, path + ": has no band " + std::to_string(options.band) +
                                             "; needed 1 to " + std::to_string(info.bandCount)};
    dem.band = dataset.GetRasterBand(options.band);
    if (!std::isfinite(options.heightFactor) || options.heightFactor == 0.0)
        return Error{ErrorCode::Invalid, path + ": height factor " + number(options.heightFactor) +
                                             "; needed one that is not 0"};
    return std::nullopt;
}

std::optional<Error> chooseWindow(const std::string& path, const DemReadOptions& options,
                                  bool limited, DemInfo& info)
{
    info.window = options.window.value_or(PixelWindow{0, 0, info.rasterWidth, info.rasterHeight});
    const PixelWindow& window = info.window;
    // Subtractions, since sums of what a user types can overflow.
    if (window.width < 1 || window.height < 1 || window.column < 0 || window.row < 0 ||
        window.width > info.rasterWidth - window.column ||
        window.height > info.rasterHeight - window.row)
        return Error{ErrorCode::Invalid, path + ": window at " + std::to_string(window.column) +
                                             ", " + std::to_string(window.row) + " of " +
                                             size(window.width, window.height) +
                                             " posts is not inside the raster, which has " +
                                             size(info.rasterWidth, info.rasterHeight)};
    const std::size_t count =
        static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height);
    if (limited && count > options.maxPosts)
        return Error{ErrorCode::Invalid, path + ": " + size(window.width, window.height) +
                                             " posts are more than the limit of " +
                                             std::to_string(options.maxPosts) +
                                             "; needed a smaller window of it"};
    info.frame.width = window.width;
    info.frame.height = window.height;
    return std::nullopt;
}

std::optional<Error> placeFrame(const std::string& path, const DemReadOptions& options,
                                OpenDem& dem)
{
    DemInfo& info = dem.info;
    RasterFrame& frame = info.frame;
    std::array<double, 6>& t = frame.geoTransform;
    const bool hasCrs = dem.dataset->GetSpatialRef() != nullptr;
    frame.hasGeoTransform = dem.dataset->GetGeoTransform(t.data()) == CE_None;
    // GDAL's own default; several drivers return it for a raster that has none.
    if (!hasCrs && t == std::array<double, 6>{0.0, 1.0, 0.0, 0.0, 0.0, 1.0})
        frame.hasGeoTransform = false;
    if (options.cellSize && !(std::isfinite(*options.cellSize) && *options.cellSize > 0.0))
        return Error{ErrorCode::Invalid,
                     path + ": cell size " + number(*options.cellSize) + " m; needed more than 0"};

    if (!frame.hasGeoTransform)
    {
        if (!options.cellSize)
            return Error{ErrorCode::Invalid,
                         path + ": has no geotransform" +
                             (dem.dataset->GetGCPCount() > 0
                                  ? ", only ground control points; gdalwarp makes one of them"
                                  : "; needed one, or the cell size in metres")};
        const double cell = *options.cellSize;
        t = {0.0, cell, 0.0, cell * info.rasterHeight, 0.0, -cell};
        info.notes.push_back("no geotransform: cells of " + number(cell) +
                             " m as given, first row taken as north" +
                             (dem.dataset->GetGCPCount() > 0
                                  ? "; ground control points, and the place that they give, are "
                                    "not used"
                                  : ""));
    }
    else if (options.cellSize)
        info.notes.push_back(
            "the cell size given is not used: the raster has its own geotransform");

    if (!std::all_of(t.begin(), t.end(), [](double v) { return std::isfinite(v); }) ||
        (t[1] == 0.0 && t[2] == 0.0) || (t[5] == 0.0 && t[4] == 0.0))
        return Error{ErrorCode::Invalid, path + ": geotransform has no cell size; needed one"};
    // A hundredth of a cell over the whole raster is rounding in the file, not rotation.
    if (std::abs(t[2]) * info.rasterHeight > 0.01 * std::abs(t[1]) ||
        std::abs(t[4]) * info.rasterWidth > 0.01 * std::abs(t[5]))
        return Error{ErrorCode::NotSupported,
                     path + ": geotransform is rotated (" + number(t[1]) + ", " + number(t[2]) +
                         "; " + number(t[4]) + ", " + number(t[5]) +
                         "); needed rows along a map axis, which gdalwarp makes"};

    t[0] += info.window.column * t[1] + info.window.row * t[2];
    t[3] += info.window.column * t[4] + info.window.row * t[5];
    // Numbers of a damaged file may be finite and their sum not.
    if (!std::isfinite(t[0] + info.window.width * t[1]) ||
        !std::isfinite(t[3] + info.window.height * t[5]))
        return Error{ErrorCode::Invalid, path + ": geotransform leads to no finite place (origin " +
                                             number(t[0]) + ", " + number(t[3]) + ", cells " +
                                             number(t[1]) + ", " + number(t[5]) + ")"};
    frame.northUp = t[5] < 0.0;
    frame.westFirst = t[1] > 0.0;
    return std::nullopt;
}

void readCrs(OpenDem& dem)
{
    DemInfo& info = dem.info;
    const OGRSpatialReference* crs = dem.dataset->GetSpatialRef();
    if (!crs)
        return;
    const char* wkt2[] = {"FORMAT=WKT2_2019", nullptr};
    char* text = nullptr;
    if (crs->exportToWkt(&text, wkt2) == OGRERR_NONE && text)
        info.frame.crs = text;
    CPLFree(text);
    info.frame.coordinateEpoch = crs->GetCoordinateEpoch();
    info.crsName = crs->GetName() ? crs->GetName() : "";
    if (crs->IsGeographic() || crs->IsProjected())
        info.bodyRadius = crs->GetSemiMajor();
}

} // namespace

Result<OpenDem> openDem(const std::string& path, const DemReadOptions& options, bool limited,
                        const GdalErrors& errors, GDALDatasetUniquePtr dataset)
{
    OpenDem dem;
    DemInfo& info = dem.info;
    dem.dataset = std::move(dataset);
    if (!dem.dataset)
        if (auto error = openFile(path, dem, errors))
            return *error;
    if (auto error = chooseBand(path, options, dem))
        return *error;
    std::vector<std::string> bandNotes;
    Result<BandFacts> band =
        readBandFacts(path, *dem.dataset, options.band, options.heightUnit, bandNotes);
    if (!band)
        return band.error();
    static_cast<BandFacts&>(info) = std::move(*band);
    if (auto error = chooseWindow(path, options, limited, info))
        return *error;
    if (auto error = placeFrame(path, options, dem))
        return *error;
    readCrs(dem);
    Result<GroundSpacing> ground = measureGround(path, dem.dataset->GetSpatialRef(), info.frame);
    if (!ground)
        return ground.error();
    dem.ground = std::move(*ground);
    info.geographic = dem.ground.geographic;
    info.northSpacing = dem.ground.north;
    info.eastSpacing =
        dem.ground.east[dem.ground.east.size() == 1 ? 0 : dem.ground.east.size() / 2];
    info.notes.insert(info.notes.end(), dem.ground.notes.begin(), dem.ground.notes.end());
    info.notes.insert(info.notes.end(), bandNotes.begin(), bandNotes.end());
    return dem;
}

} // namespace osgTerrainLight
