#include "io/DemReader.h"

#include "io/CustomaryVoids.h"
#include "io/GdalErrors.h"
#include "io/GroundSpacing.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

namespace osgTerrainLight
{
namespace
{

constexpr double pi = 3.14159265358979323846;
// As DemTile::setHeight: no terrain of any body is higher.
constexpr double highest = 1.0e6;

std::string number(double value)
{
    return CPLSPrintf("%.10g", value);
}

std::string posts(std::size_t count)
{
    return std::to_string(count) + (count == 1 ? " post" : " posts");
}

std::string size(int width, int height)
{
    return std::to_string(width) + " x " + std::to_string(height);
}

/// An open raster whose metadata passed every check.
struct OpenDem
{
    GDALDatasetUniquePtr dataset;
    GDALRasterBand* band = nullptr;
    DemInfo info;
    GroundSpacing ground;
};

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

std::optional<Error> openBand(const std::string& path, const DemReadOptions& options, OpenDem& dem,
                              const GdalErrors& errors)
{
    dem.dataset.reset(
        GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
    if (!dem.dataset)
        return openingError(path, errors);

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
                             " m as given, first row taken as north");
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

/// forReading: false where heights are not asked for, and the size therefore not limited.
Result<OpenDem> openDem(const std::string& path, const DemReadOptions& options, bool forReading,
                        const GdalErrors& errors)
{
    OpenDem dem;
    DemInfo& info = dem.info;
    if (auto error = openBand(path, options, dem, errors))
        return *error;
    std::vector<std::string> bandNotes;
    Result<BandFacts> band =
        readBandFacts(path, *dem.dataset, options.band, options.heightUnit, bandNotes);
    if (!band)
        return band.error();
    static_cast<BandFacts&>(info) = std::move(*band);
    if (auto error = chooseWindow(path, options, forReading, info))
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

struct Range
{
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -std::numeric_limits<double>::infinity();
    std::size_t count = 0;

    void add(double value)
    {
        lowest = std::min(lowest, value);
        highest = std::max(highest, value);
        ++count;
    }
};

/// What all values of a raster say together: whether they are heights, or radii of the CRS's body.
class HeightSurvey
{
public:
    explicit HeightSurvey(double bodyRadius) : _bodyRadius(bodyRadius) {}

    /// A value [m] that is not void by nodata, mask or custom.
    void add(double metres)
    {
        ++_count;
        if (std::abs(metres) <= highest)
            _heights.add(metres);
        // Half and one and a half radii hold the hills of the smallest bodies.
        if (_bodyRadius > 0.0 && metres >= 0.5 * _bodyRadius && metres <= 1.5 * _bodyRadius)
            _radii.add(metres);
    }

    bool areRadii() const { return _radii.count > _count / 2; }
    const Range& values() const { return areRadii() ? _radii : _heights; }
    bool isVoid(double metres) const
    {
        return !(metres >= values().lowest && metres <= values().highest);
    }
    std::size_t voids() const { return _count - values().count; }
    /// What comes off a value [m].
    double radius() const { return areRadii() ? _bodyRadius : 0.0; }

private:
    double _bodyRadius;
    std::size_t _count = 0;
    Range _heights, _radii;
};

/// Real holds stored values exactly: float for up to 24 bits, double for the rest. Heights reach
/// float only after the origin, known when all are read, is taken off in double.
template <class Real>
class HeightReader
{
public:
    HeightReader(const std::string& path, const DemReadOptions& options, OpenDem& dem,
                 const GdalErrors& errors)
        : _path(path), _options(options), _dem(dem), _errors(errors), _info(dem.info),
          _columns(static_cast<std::size_t>(dem.info.frame.width)), _customs(dem.info),
          _survey(dem.info.bodyRadius)
    {
    }

    Result<DemFile> read()
    {
        if (auto error = readStored())
            return *error;
        for (const double value : _customs.heights())
            _survey.add(_info.metresOf(value));
        const int width = _info.frame.width;
        const int height = _info.frame.height;
        if (_survey.values().count == 0)
            return Error{ErrorCode::Invalid, _path + ": holds no valid height: all of " +
                                                 size(width, height) + " posts are void"};
        DemFile file;
        file.frame = _info.frame;
        file.notes = _info.notes;
        const double ends[] = {heightOf(_survey.values().lowest),
                               heightOf(_survey.values().highest)};
        file.lowest = std::min(ends[0], ends[1]);
        file.highest = std::max(ends[0], ends[1]);
        addNotes(file);
        fillTile(file);
        if (!_dem.ground.beyondPole.empty() && file.tile.validCount() == 0)
            return Error{ErrorCode::Invalid, _path + ": holds no valid height between the poles"};
        return file;
    }

private:
    double heightOf(double metres) const
    {
        return (metres - _survey.radius()) * _options.heightFactor;
    }

    bool isNoData(Real stored) const
    {
        if (!_info.noData)
            return false;
        if (std::isnan(*_info.noData))
            return std::isnan(stored);
        // A nodata value that text or a double tag holds exactly may have been rounded to float on
        // its way into the pixels, or the other way round. Large whole numbers must not be rounded.
        return static_cast<double>(stored) == *_info.noData ||
               (!_info.integer && static_cast<float>(stored) == static_cast<float>(*_info.noData));
    }

    std::optional<Error> readStored()
    {
        const int width = _info.frame.width;
        const int height = _info.frame.height;
        int blockWidth = 0;
        int blockHeight = 0;
        _dem.band->GetBlockSize(&blockWidth, &blockHeight);
        // Whole rows of blocks, so that none is decoded twice, in strips of at most about 4 M
        // posts.
        const int stripRows = std::clamp(blockHeight, 1, std::max(1, (1 << 22) / width));
        _stored.resize(_columns * static_cast<std::size_t>(height));
        _mask.resize(_info.hasMask ? _columns * static_cast<std::size_t>(stripRows) : 0);
        for (int row = 0; row < height;)
        {
            // The first strip ends where a block ends.
            const int inBlock = (_info.window.row + row) % stripRows;
            const int rows = std::min(stripRows - inBlock, height - row);
            if (!readStrip(row, rows))
                return Error{ErrorCode::Failed,
                             _path + ": cannot read rows " +
                                 std::to_string(_info.window.row + row) + " to " +
                                 std::to_string(_info.window.row + row + rows - 1) + " of " +
                                 std::to_string(_info.rasterHeight) + ": " + _errors.last()};
            row += rows;
            if (_options.progress && !_options.progress(static_cast<double>(row) / height))
                return Error{ErrorCode::Failed, _path + ": reading was cancelled"};
        }
        return std::nullopt;
    }

    /// Marks as NaN what nodata value or mask say is void; the rest is surveyed.
    bool readStrip(int row, int rows)
    {
        const int width = _info.frame.width;
        const int left = _info.window.column;
        const int top = _info.window.row + row;
        Real* strip = _stored.data() + static_cast<std::size_t>(row) * _columns;
        const GDALDataType type = sizeof(Real) == sizeof(float) ? GDT_Float32 : GDT_Float64;
        if (_dem.band->RasterIO(GF_Read, left, top, width, rows, strip, width, rows, type, 0, 0,
                                nullptr) != CE_None)
            return false;
        if (_info.hasMask &&
            _dem.band->GetMaskBand()->RasterIO(GF_Read, left, top, width, rows, _mask.data(), width,
                                               rows, GDT_Byte, 0, 0, nullptr) != CE_None)
            return false;
        const std::size_t count = _columns * static_cast<std::size_t>(rows);
        for (std::size_t i = 0; i < count; ++i)
        {
            Real& value = strip[i];
            if (_info.signedBytes && value > Real(127))
                value -= Real(256);
            if (isNoData(value) || (_info.hasMask && _mask[i] == 0))
                value = std::numeric_limits<Real>::quiet_NaN();
            else if (!_customs.take(static_cast<double>(value)))
                _survey.add(_info.metresOf(static_cast<double>(value)));
        }
        return true;
    }

    void addNotes(DemFile& file) const
    {
        if (_survey.areRadii())
            file.notes.push_back("heights are radii of the body: its " + number(_survey.radius()) +
                                 " m come off");
        if (_survey.voids() > 0)
            file.notes.push_back(posts(_survey.voids()) +
                                 " without a finite height within ±1e6 m: taken as void");
        const std::vector<std::string> customs = _customs.notes();
        file.notes.insert(file.notes.end(), customs.begin(), customs.end());
        // See HeightFactors.
        const double error = _dem.ground.factors.steepest() / _info.northSpacing * 0.5 *
                             (file.highest - file.lowest);
        if (error > std::tan(0.1 * pi / 180.0))
            file.notes.push_back(
                std::string("the map's scale changes so much over the raster that slopes are wrong "
                            "by up to ") +
                CPLSPrintf("%.1f", std::atan(error) * 180.0 / pi) +
                " degrees; a smaller window or another projection is nearer");
    }

    void fillTile(DemFile& file) const
    {
        const RasterFrame& frame = _info.frame;
        DemTile& tile = file.tile;
        tile = DemTile(frame.width, frame.height, _dem.ground.north);
        tile.eastSpacings = std::move(_dem.ground.east);
        tile.heightOrigin = std::round(0.5 * (file.lowest + file.highest)) + 0.0; // never -0
        tile.crs = frame.crs;
        tile.mapStepX = std::abs(frame.geoTransform[1]);
        tile.mapStepY = std::abs(frame.geoTransform[5]);
        tile.mapOriginX = frame.mapX(0);
        tile.mapOriginY = frame.mapY(0);
        for (int row = 0; row < frame.height; ++row)
        {
            if (!_dem.ground.beyondPole.empty() &&
                _dem.ground.beyondPole[static_cast<std::size_t>(row)])
                continue;
            const Real* source =
                _stored.data() + static_cast<std::size_t>(frame.fileRow(row)) * _columns;
            for (int column = 0; column < frame.width; ++column)
            {
                const auto stored = static_cast<double>(source[frame.fileColumn(column)]);
                const double metres = _info.metresOf(stored);
                // Posts of a new tile are void.
                if (std::isnan(stored) || _survey.isVoid(metres) || _customs.isVoid(stored))
                    continue;
                tile.setHeight(column, row,
                               static_cast<float>((heightOf(metres) - tile.heightOrigin) *
                                                  _dem.ground.factors.at(column, row)));
            }
        }
    }

    const std::string& _path;
    const DemReadOptions& _options;
    OpenDem& _dem;
    const GdalErrors& _errors;
    const DemInfo& _info;
    std::size_t _columns;
    std::vector<Real> _stored; ///< rows of the file
    std::vector<GByte> _mask;  ///< of a strip
    CustomaryVoids _customs;
    HeightSurvey _survey;
};

} // namespace

Result<DemInfo> describeDem(const std::string& path, const DemReadOptions& options)
{
    GdalErrors errors;
    Result<OpenDem> opened = openDem(path, options, false, errors);
    if (!opened)
        return opened.error();
    return std::move(opened->info);
}

Result<DemFile> readDem(const std::string& path, const DemReadOptions& options)
{
    GdalErrors errors;
    try
    {
        Result<OpenDem> opened = openDem(path, options, true, errors);
        if (!opened)
            return opened.error();
        if (opened->info.fitsFloat)
            return HeightReader<float>(path, options, *opened, errors).read();
        return HeightReader<double>(path, options, *opened, errors).read();
    }
    catch (const std::bad_alloc&)
    {
        return Error{ErrorCode::Failed,
                     path + ": not enough memory to read it; needed a smaller window"};
    }
}

} // namespace osgTerrainLight
