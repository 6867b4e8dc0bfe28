#include "io/DemReader.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
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

void CPL_STDCALL keepError(CPLErr level, CPLErrorNum, const char* message)
{
    if (auto* errors = static_cast<GdalErrors*>(CPLGetErrorHandlerUserData()))
        errors->add(level >= CE_Failure, message);
}

/// A unit's length in metres; nothing where the name is not known.
std::optional<double> metresPerUnit(const std::string& name)
{
    std::string key;
    for (const char c : name)
        if (std::isalnum(static_cast<unsigned char>(c)))
            key += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    struct Unit
    {
        const char* name;
        double metres;
    };
    constexpr double foot = 0.3048;
    constexpr double surveyFoot = 1200.0 / 3937.0;
    static const Unit units[] = {{"m", 1.0},
                                 {"metre", 1.0},
                                 {"metres", 1.0},
                                 {"meter", 1.0},
                                 {"meters", 1.0},
                                 {"ft", foot},
                                 {"foot", foot},
                                 {"feet", foot},
                                 {"internationalfoot", foot},
                                 {"internationalfeet", foot},
                                 {"footinternational", foot},
                                 {"ftus", surveyFoot},
                                 {"usft", surveyFoot},
                                 {"footus", surveyFoot},
                                 {"usfoot", surveyFoot},
                                 {"usfeet", surveyFoot},
                                 {"surveyfoot", surveyFoot},
                                 {"surveyfeet", surveyFoot},
                                 {"ussurveyft", surveyFoot},
                                 {"ussurveyfoot", surveyFoot},
                                 {"ussurveyfeet", surveyFoot},
                                 {"footussurvey", surveyFoot},
                                 {"km", 1000.0},
                                 {"kilometre", 1000.0},
                                 {"kilometer", 1000.0},
                                 {"dm", 0.1},
                                 {"decimetre", 0.1},
                                 {"decimeter", 0.1},
                                 {"cm", 0.01},
                                 {"centimetre", 0.01},
                                 {"centimeter", 0.01},
                                 {"mm", 0.001},
                                 {"millimetre", 0.001},
                                 {"millimeter", 0.001}};
    for (const Unit& unit : units)
        if (key == unit.name)
            return unit.metres;
    return std::nullopt;
}

/// Metres per unit of map x and y, as a function of latitude where the CRS is geographic.
struct MapMetric
{
    double metresPerUnit = 1.0;
    bool geographic = false;
    double radiansPerUnit = pi / 180.0;
    double semiMajor = 6378137.0, semiMinor = 6356752.314245179;
};

/// An open raster whose metadata passed every check.
struct OpenDem
{
    GDALDatasetUniquePtr dataset;
    GDALRasterBand* band = nullptr;
    DemInfo info;
    std::vector<double> eastSpacings; // tile order
    std::vector<bool> beyondPole;     // by tile row; empty where none is
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

    const GDALDataType type = dem.band->GetRasterDataType();
    info.dataType = GDALGetDataTypeName(type);
    if (GDALDataTypeIsComplex(type))
        return Error{ErrorCode::NotSupported, path + ": band " + std::to_string(options.band) +
                                                  " holds complex numbers (" + info.dataType +
                                                  "); needed heights"};
    const GDALColorInterp colour = dem.band->GetColorInterpretation();
    if (colour != GCI_Undefined && colour != GCI_GrayIndex)
        return Error{ErrorCode::NotSupported, path + ": band " + std::to_string(options.band) +
                                                  " of " + std::to_string(info.bandCount) +
                                                  " is a picture's (" +
                                                  GDALGetColorInterpretationName(colour) +
                                                  "), not a DEM; needed a band of heights"};
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

/// Says by how much map distances of a projected CRS differ from those on the ground: Web Mercator,
/// for one, stretches them by 1/cos(latitude), and everything seems flatter by as much.
void noteStretch(const OGRSpatialReference& crs, const MapMetric& metric, DemInfo& info)
{
    const std::unique_ptr<OGRSpatialReference> base(crs.CloneGeogCS());
    if (!base)
        return;
    OGRSpatialReference flat(crs);
    flat.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    base->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRCoordinateTransformation> transform(
        OGRCreateCoordinateTransformation(&flat, base.get()));
    if (!transform)
        return;
    const std::array<double, 6>& t = info.frame.geoTransform;
    const double x0 = t[0] + 0.5 * info.frame.width * t[1];
    const double y0 = t[3] + 0.5 * info.frame.height * t[5];
    double x[3] = {x0, x0 + t[1], x0};
    double y[3] = {y0, y0, y0 + t[5]};
    int good[3] = {0, 0, 0};
    if (!transform->Transform(3, x, y, nullptr, good) || !good[0] || !good[1] || !good[2])
        return;
    const double radians = base->GetAngularUnits();
    const MetresPerRadian ground = metresPerRadian(std::clamp(y[0] * radians, -0.5 * pi, 0.5 * pi),
                                                   base->GetSemiMajor(), base->GetSemiMinor());
    const double cells[2] = {std::abs(t[1]) * metric.metresPerUnit,
                             std::abs(t[5]) * metric.metresPerUnit};
    double stretch[2];
    for (int i = 0; i < 2; ++i)
    {
        const double east = std::remainder((x[i + 1] - x[0]) * radians, 2.0 * pi) * ground.east;
        const double north = (y[i + 1] - y[0]) * radians * ground.north;
        stretch[i] = cells[i] / std::hypot(east, north);
    }
    if (std::max(std::abs(stretch[0] - 1.0), std::abs(stretch[1] - 1.0)) > 0.02)
        info.notes.push_back(
            std::string("map distances are ") + CPLSPrintf("%.3g", stretch[0]) + " (east) and " +
            CPLSPrintf("%.3g", stretch[1]) +
            " (north) times those on the ground: slopes come out wrong by as much; "
            "warp to a local projection such as UTM");
}

std::optional<Error> readCrs(const std::string& path, OpenDem& dem, MapMetric& metric)
{
    DemInfo& info = dem.info;
    const OGRSpatialReference* crs = dem.dataset->GetSpatialRef();
    if (!crs)
    {
        if (info.frame.hasGeoTransform)
            info.notes.push_back("no CRS: map coordinates are taken as metres");
        return std::nullopt;
    }
    const char* wkt2[] = {"FORMAT=WKT2_2019", nullptr};
    char* text = nullptr;
    if (crs->exportToWkt(&text, wkt2) == OGRERR_NONE && text)
        info.frame.crs = text;
    CPLFree(text);
    info.crsName = crs->GetName() ? crs->GetName() : "";
    if (!info.frame.hasGeoTransform)
        return std::nullopt; // the cell size came in metres

    if (crs->IsGeocentric())
        return Error{ErrorCode::NotSupported,
                     path + ": CRS \"" + info.crsName +
                         "\" is geocentric; needed a map or geographic one"};
    if (crs->IsGeographic())
    {
        metric.geographic = info.geographic = true;
        metric.radiansPerUnit = crs->GetAngularUnits();
        metric.semiMajor = crs->GetSemiMajor();
        metric.semiMinor = crs->GetSemiMinor();
        if (crs->IsDerivedGeographic())
            info.notes.push_back("the CRS has a pole of its own: azimuths count from its north");
        return std::nullopt;
    }
    if (crs->IsProjected())
    {
        metric.metresPerUnit = crs->GetTargetLinearUnits("PROJCS");
        noteStretch(*crs, metric, info);
    }
    else if (crs->IsLocal())
    {
        metric.metresPerUnit = crs->GetTargetLinearUnits("LOCAL_CS");
        info.notes.push_back("local CRS \"" + info.crsName + "\": one unit is taken as " +
                             number(metric.metresPerUnit) + " m");
    }
    else
        info.notes.push_back("CRS \"" + info.crsName +
                             "\" has no horizontal part: map coordinates are taken as metres");
    if (!(std::isfinite(metric.metresPerUnit) && metric.metresPerUnit > 0.0))
        return Error{ErrorCode::Invalid, path + ": CRS has a unit of " +
                                             number(metric.metresPerUnit) +
                                             " m; needed more than 0"};
    return std::nullopt;
}

/// perRow: false where only the middle is asked for, in a raster of any size.
std::optional<Error> measureSpacing(const std::string& path, const MapMetric& metric, bool perRow,
                                    OpenDem& dem)
{
    DemInfo& info = dem.info;
    const RasterFrame& frame = info.frame;
    const double stepX = std::abs(frame.geoTransform[1]);
    const double stepY = std::abs(frame.geoTransform[5]);
    if (!metric.geographic)
    {
        info.northSpacing = stepY * metric.metresPerUnit;
        dem.eastSpacings = {stepX * metric.metresPerUnit};
        info.eastSpacing = dem.eastSpacings.front();
        return std::nullopt;
    }

    const int height = frame.height;
    const double dx = stepX * metric.radiansPerUnit;
    const double dy = stepY * metric.radiansPerUnit;
    const auto latitude = [&](double fileRow)
    {
        return (frame.geoTransform[3] + (fileRow + 0.5) * frame.geoTransform[5]) *
               metric.radiansPerUnit;
    };
    const auto metres = [&](double at)
    {
        return metresPerRadian(std::clamp(at, -0.5 * pi, 0.5 * pi), metric.semiMajor,
                               metric.semiMinor);
    };
    int beyond = 0;
    if (perRow)
    {
        dem.eastSpacings.resize(static_cast<std::size_t>(height));
        dem.beyondPole.assign(static_cast<std::size_t>(height), false);
    }
    for (int row = 0; row < height; ++row)
    {
        const double at = latitude(frame.fileRow(row));
        // A post on the pole itself may lie beyond it by rounding.
        const bool outside = std::abs(at) > 0.5 * pi + 1.0e-9;
        beyond += outside ? 1 : 0;
        if (perRow)
        {
            dem.eastSpacings[static_cast<std::size_t>(row)] = dx * metres(at).east;
            dem.beyondPole[static_cast<std::size_t>(row)] = outside;
        }
    }
    if (beyond == height)
        return Error{ErrorCode::Invalid, path + ": CRS \"" + info.crsName +
                                             "\" is geographic, but latitudes are about " +
                                             number(latitude(0.5 * (height - 1)) * 180.0 / pi) +
                                             "; needed -90 to 90"};
    if (beyond > 0)
        info.notes.push_back(std::to_string(beyond) + " rows lie beyond a pole and are void");
    if (beyond == 0)
        dem.beyondPole.clear();
    info.northSpacing = dy * metres(latitude(0.5 * (height - 1))).north;
    info.eastSpacing = dx * metres(latitude(frame.fileRow(height / 2))).east;
    return std::nullopt;
}

std::optional<Error> readHeightUnits(const std::string& path, OpenDem& dem)
{
    DemInfo& info = dem.info;
    GDALRasterBand& band = *dem.band;
    int found = FALSE;
    info.scale = band.GetScale(&found);
    if (!found)
        info.scale = 1.0;
    info.offset = band.GetOffset(&found);
    if (!found)
        info.offset = 0.0;
    if (!std::isfinite(info.scale) || info.scale == 0.0 || !std::isfinite(info.offset))
        return Error{ErrorCode::Invalid, path + ": band scale " + number(info.scale) +
                                             " and offset " + number(info.offset) +
                                             "; needed finite ones, scale not 0"};

    info.heightUnit = band.GetUnitType();
    if (info.heightUnit.empty())
    {
        const OGRSpatialReference* crs = dem.dataset->GetSpatialRef();
        if (crs && (crs->IsCompound() || crs->IsVertical()))
        {
            const char* name = nullptr;
            const double metres = crs->GetTargetLinearUnits("VERT_CS", &name);
            if (std::isfinite(metres) && metres > 0.0)
            {
                info.heightUnit = name ? name : "";
                info.metresPerHeightUnit = metres;
            }
        }
    }
    else if (const std::optional<double> metres = metresPerUnit(info.heightUnit))
        info.metresPerHeightUnit = *metres;
    else
        info.notes.push_back("height unit \"" + info.heightUnit +
                             "\" is not known: heights are taken as metres");

    switch (band.GetRasterDataType())
    {
    case GDT_Int64:
    {
        const std::int64_t value = band.GetNoDataValueAsInt64(&found);
        if (found)
            info.noData = static_cast<double>(value);
        break;
    }
    case GDT_UInt64:
    {
        const std::uint64_t value = band.GetNoDataValueAsUInt64(&found);
        if (found)
            info.noData = static_cast<double>(value);
        break;
    }
    default:
    {
        const double value = band.GetNoDataValue(&found);
        if (found)
            info.noData = value;
    }
    }
    const int flags = band.GetMaskFlags();
    info.hasMask = (flags & GMF_ALL_VALID) == 0 && flags != GMF_NODATA;
    return std::nullopt;
}

/// forReading: false where heights are not asked for, and the size therefore not limited.
Result<OpenDem> openDem(const std::string& path, const DemReadOptions& options, bool forReading,
                        const GdalErrors& errors)
{
    OpenDem dem;
    MapMetric metric;
    if (auto error = openBand(path, options, dem, errors))
        return *error;
    if (auto error = chooseWindow(path, options, forReading, dem.info))
        return *error;
    if (auto error = placeFrame(path, options, dem))
        return *error;
    if (auto error = readCrs(path, dem, metric))
        return *error;
    if (auto error = measureSpacing(path, metric, forReading, dem))
        return *error;
    if (auto error = readHeightUnits(path, dem))
        return *error;
    return dem;
}

/// Real holds stored values exactly: float for up to 24 bits, double for the rest. Heights reach
/// float only after the origin, known when all are read, is taken off in double.
template <class Real>
Result<DemFile> readHeights(const std::string& path, const DemReadOptions& options, OpenDem& dem,
                            const GdalErrors& errors)
{
    const DemInfo& info = dem.info;
    const RasterFrame& frame = info.frame;
    const int width = frame.width;
    const int height = frame.height;
    const auto columns = static_cast<std::size_t>(width);
    const GDALDataType type = sizeof(Real) == sizeof(float) ? GDT_Float32 : GDT_Float64;
    // Where no nodata value is declared, these are one: the lowest 16-bit numbers, kept by many a
    // conversion to float, and ESRI's. No terrain of any body lies at them.
    const bool undeclaredNoData = !info.noData && info.scale == 1.0 && info.offset == 0.0;
    const auto isSentinel = [undeclaredNoData](Real stored)
    {
        return undeclaredNoData &&
               (stored == Real(-32768) || stored == Real(-32767) || stored == Real(-99999));
    };
    const auto metresOf = [&info](Real stored)
    { return (static_cast<double>(stored) * info.scale + info.offset) * info.metresPerHeightUnit; };
    // A nodata value that text or a double tag holds exactly may have been rounded to float on its
    // way into the pixels, or the other way round. Large whole numbers must not be rounded.
    const bool rounded = GDALDataTypeIsFloating(dem.band->GetRasterDataType()) != FALSE;
    const auto isNoData = [&info, rounded](Real stored)
    {
        if (!info.noData)
            return false;
        if (std::isnan(*info.noData))
            return std::isnan(stored);
        return static_cast<double>(stored) == *info.noData ||
               (rounded && static_cast<float>(stored) == static_cast<float>(*info.noData));
    };

    int blockWidth = 0;
    int blockHeight = 0;
    dem.band->GetBlockSize(&blockWidth, &blockHeight);
    // Whole rows of blocks, so that none is decoded twice, in strips of at most about 4 M posts.
    const int stripRows = std::clamp(blockHeight, 1, std::max(1, (1 << 22) / width));

    std::vector<Real> stored(columns * static_cast<std::size_t>(height));
    std::vector<GByte> mask(info.hasMask ? columns * static_cast<std::size_t>(stripRows) : 0);
    constexpr Real voidMark = std::numeric_limits<Real>::quiet_NaN();
    double lowest = std::numeric_limits<double>::infinity();
    double peak = -lowest;
    std::size_t undeclared = 0;
    std::size_t sentinels = 0;
    for (int row = 0; row < height;)
    {
        // The first strip ends where a block ends.
        const int inBlock = (info.window.row + row) % stripRows;
        const int rows = std::min(stripRows - inBlock, height - row);
        Real* strip = stored.data() + static_cast<std::size_t>(row) * columns;
        const int top = info.window.row + row;
        bool good = dem.band->RasterIO(GF_Read, info.window.column, top, width, rows, strip, width,
                                       rows, type, 0, 0, nullptr) == CE_None;
        if (good && info.hasMask)
            good = dem.band->GetMaskBand()->RasterIO(GF_Read, info.window.column, top, width, rows,
                                                     mask.data(), width, rows, GDT_Byte, 0, 0,
                                                     nullptr) == CE_None;
        if (!good)
            return Error{ErrorCode::Failed, path + ": cannot read rows " + std::to_string(top) +
                                                " to " + std::to_string(top + rows - 1) + " of " +
                                                std::to_string(info.rasterHeight) + ": " +
                                                errors.last()};
        const std::size_t count = columns * static_cast<std::size_t>(rows);
        for (std::size_t i = 0; i < count; ++i)
        {
            Real& value = strip[i];
            if (isNoData(value) || (info.hasMask && mask[i] == 0))
            {
                value = voidMark;
                continue;
            }
            const double metres = metresOf(value);
            if (isSentinel(value))
                ++sentinels;
            else if (!(std::abs(metres) <= highest))
                ++undeclared;
            else
            {
                lowest = std::min(lowest, metres);
                peak = std::max(peak, metres);
                continue;
            }
            value = voidMark;
        }
        row += rows;
        if (options.progress && !options.progress(static_cast<double>(row) / height))
            return Error{ErrorCode::Failed, path + ": reading was cancelled"};
    }
    if (!(lowest <= peak))
        return Error{ErrorCode::Invalid, path + ": holds no valid height: all of " +
                                             size(width, height) + " posts are void"};

    DemFile file;
    file.frame = frame;
    file.notes = info.notes;
    if (undeclared > 0)
        file.notes.push_back(posts(undeclared) +
                             " without a finite height within ±1e6 m: taken as void");
    if (sentinels > 0)
        file.notes.push_back(posts(sentinels) +
                             " of -32767, -32768 or -99999 in a raster without a " +
                             "nodata value: taken as void");

    DemTile& tile = file.tile;
    tile = DemTile(width, height, info.northSpacing);
    tile.eastSpacings = std::move(dem.eastSpacings);
    tile.heightOrigin = std::round(0.5 * (lowest + peak)) + 0.0; // never -0
    tile.crs = frame.crs;
    tile.mapStepX = std::abs(frame.geoTransform[1]);
    tile.mapStepY = std::abs(frame.geoTransform[5]);
    tile.mapOriginX = frame.geoTransform[0] + (frame.fileColumn(0) + 0.5) * frame.geoTransform[1];
    tile.mapOriginY = frame.geoTransform[3] + (frame.fileRow(0) + 0.5) * frame.geoTransform[5];
    for (int row = 0; row < height; ++row)
    {
        if (!dem.beyondPole.empty() && dem.beyondPole[static_cast<std::size_t>(row)])
            continue;
        const Real* source = stored.data() + static_cast<std::size_t>(frame.fileRow(row)) * columns;
        for (int column = 0; column < width; ++column)
        {
            const Real value = source[frame.fileColumn(column)];
            if (!std::isnan(value)) // posts of a new tile are void
                tile.setHeight(column, row,
                               static_cast<float>(metresOf(value) - tile.heightOrigin));
        }
    }
    if (!dem.beyondPole.empty() && tile.validCount() == 0)
        return Error{ErrorCode::Invalid, path + ": holds no valid height between the poles"};
    return file;
}

} // namespace

GdalErrors::GdalErrors()
{
    static std::once_flag once;
    std::call_once(once, [] { GDALAllRegister(); });
    CPLPushErrorHandlerEx(keepError, this);
    // CPL_DEBUG stays the user's to switch on.
    CPLSetCurrentErrorHandlerCatchDebug(FALSE);
}

GdalErrors::~GdalErrors()
{
    CPLPopErrorHandler();
}

void GdalErrors::add(bool failure, const char* message)
{
    if (!failure)
        _warning = message;
    else
    {
        if (_firstFailure.empty())
            _firstFailure = message;
        _lastFailure = message;
    }
}

void GdalErrors::clear()
{
    _firstFailure.clear();
    _lastFailure.clear();
    _warning.clear();
}

std::string GdalErrors::first() const
{
    if (!_firstFailure.empty())
        return _firstFailure;
    return _warning.empty() ? "GDAL gives no reason" : _warning;
}

std::string GdalErrors::last() const
{
    return _lastFailure.empty() ? first() : _lastFailure;
}

MetresPerRadian metresPerRadian(double latitude, double semiMajor, double semiMinor)
{
    const double a2 = semiMajor * semiMajor;
    const double b2 = semiMinor * semiMinor;
    const double cosine = std::max(std::cos(latitude), 1.0e-6);
    const double sine = std::sin(latitude);
    const double w2 = a2 * cosine * cosine + b2 * sine * sine;
    const double w = std::sqrt(w2);
    return {a2 / w * cosine, a2 * b2 / (w2 * w)};
}

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
        switch (opened->band->GetRasterDataType())
        {
        case GDT_Byte:
        case GDT_Int16:
        case GDT_UInt16:
        case GDT_Float32:
            return readHeights<float>(path, options, *opened, errors);
        default:
            return readHeights<double>(path, options, *opened, errors);
        }
    }
    catch (const std::bad_alloc&)
    {
        return Error{ErrorCode::Failed,
                     path + ": not enough memory to read it; needed a smaller window"};
    }
}

} // namespace osgTerrainLight
