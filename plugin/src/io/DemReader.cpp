#include "io/DemReader.h"

#include "io/CellAverages.h"
#include "io/CustomaryVoids.h"
#include "io/GdalErrors.h"
#include "io/HeightSurvey.h"
#include "io/OpenDem.h"

#include <cpl_conv.h>
#include <gdal_priv.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <new>

namespace osgTerrainLight
{
namespace
{

constexpr double pi = 3.14159265358979323846;
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

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

/// Real holds stored values exactly: float for up to 24 bits, double for the rest. Heights reach
/// float only after the origin, known when all are read, is taken off in double.
template <class Real>
class HeightReader
{
public:
    HeightReader(const std::string& path, const DemReadOptions& options, OpenDem& dem,
                 const GdalErrors& errors)
        : _path(path), _options(options), _dem(dem), _errors(errors), _info(dem.info),
          _band(dem.band), _maskBand(dem.band->GetMaskBand()), _window(dem.info.window),
          _customs(dem.info), _survey(dem.info.bodyRadius, !dem.info.heightUnit.empty())
    {
        if (_info.alphaBand != 0)
            _maskBand = dem.dataset->GetRasterBand(_info.alphaBand);
    }

    Result<DemFile> read()
    {
        std::vector<Real> stored(place(_window.height, 0));
        const auto take = [&](int row, int rows)
        { return readRows(row, rows, stored.data() + place(row, 0), true); };
        if (auto error = eachStrip(0.0, 1.0, take))
            return *error;
        if (auto error = endSurvey())
            return *error;
        return fileOf(_info.frame, _dem.ground,
                      [&](int column, int row) { return metresOf(stored[place(row, column)]); });
    }

    /// Every post is judged as by read() before it enters an average, so the raster is read twice:
    /// what is void by custom, and whether heights are radii, is known when all were seen.
    Result<DemFile> readReduced(int width, int height)
    {
        useOverview(std::max(width, height));
        std::vector<Real> strip(place(stripRows(), 0));
        const auto see = [&](int row, int rows) { return readRows(row, rows, strip.data(), true); };
        if (auto error = eachStrip(0.0, 0.5, see))
            return *error;
        if (auto error = endSurvey())
            return *error;

        const OGRSpatialReference* crs = _dem.dataset->GetSpatialRef();
        const RasterFrame source = _info.frame.scaledTo(_window.width, _window.height);
        const Result<GroundSpacing> ground = measureGround(_path, crs, source);
        if (!ground)
            return ground.error();
        CellAverages averages(_window.width, _window.height, width, height);
        const auto average = [&](int row, int rows)
        {
            if (!readRows(row, rows, strip.data(), false))
                return false;
            for (int y = 0; y < rows; ++y)
                for (int x = 0; x < _window.width && !isBeyondPole(*ground, source, row + y); ++x)
                    if (const double metres = metresOf(strip[place(y, x)]); !std::isnan(metres))
                        averages.add(x, row + y, metres);
            return true;
        };
        if (auto error = eachStrip(0.5, 1.0, average))
            return *error;

        const RasterFrame frame = _info.frame.scaledTo(width, height);
        const Result<GroundSpacing> coarse = measureGround(_path, crs, frame);
        if (!coarse)
            return coarse.error();
        Result<DemFile> file =
            fileOf(frame, *coarse, [&](int column, int row) { return averages.at(column, row); });
        if (file)
            file->notes.push_back(size(_info.rasterWidth, _info.rasterHeight) +
                                  " posts are averaged to " + size(width, height) +
                                  (_band == _dem.band ? ""
                                                      : ", from the overview of " +
                                                            size(_window.width, _window.height)));
        return file;
    }

private:
    /// Of a post in rows of the window.
    std::size_t place(int row, int column) const
    {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(_window.width) +
               static_cast<std::size_t>(column);
    }

    /// Of a stored value; NaN where it is void.
    double metresOf(Real stored) const
    {
        const auto value = static_cast<double>(stored);
        const double metres = _info.metresOf(value);
        // Comparisons with NaN are false.
        return _survey.isVoid(metres) || _customs.isVoid(value) ? missing : metres;
    }

    double heightOf(double metres) const
    {
        return _survey.heightOf(metres) * _options.heightFactor;
    }

    static bool isBeyondPole(const GroundSpacing& ground, const RasterFrame& frame, int fileRow)
    {
        return !ground.beyondPole.empty() &&
               ground.beyondPole[static_cast<std::size_t>(frame.fileRow(fileRow))];
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

    /// Of a raster with more posts than options.maxPosts, the smallest overview that has no fewer
    /// than maxSide a side, which stands for the raster from then on.
    void useOverview(int maxSide)
    {
        const std::size_t count = place(_window.height, 0);
        GDALRasterBand* const alpha =
            _info.alphaBand != 0 ? _dem.dataset->GetRasterBand(_info.alphaBand) : nullptr;
        for (int i = 0; count > _options.maxPosts && i < _dem.band->GetOverviewCount(); ++i)
        {
            GDALRasterBand* overview = _dem.band->GetOverview(i);
            GDALRasterBand* mask = alpha ? alpha->GetOverview(i) : overview->GetMaskBand();
            const int width = overview->GetXSize();
            const int height = overview->GetYSize();
            const bool masked = mask && mask->GetXSize() == width && mask->GetYSize() == height;
            if (std::max(width, height) >= maxSide && width <= _window.width && masked)
            {
                _band = overview;
                _maskBand = mask;
                _window = {0, 0, width, height};
            }
        }
    }

    /// Whole rows of blocks, so that none is decoded twice, in strips of at most about 4 M posts.
    int stripRows() const
    {
        int blockWidth = 0;
        int blockHeight = 0;
        _band->GetBlockSize(&blockWidth, &blockHeight);
        return std::clamp(blockHeight, 1, std::max(1, (1 << 22) / _window.width));
    }

    /// take(row, rows): false where the rows cannot be read. from, to: of the progress.
    std::optional<Error> eachStrip(double from, double to,
                                   const std::function<bool(int row, int rows)>& take)
    {
        const int most = stripRows();
        for (int row = 0; row < _window.height;)
        {
            // The first strip ends where a block ends.
            const int inBlock = (_window.row + row) % most;
            const int rows = std::min(most - inBlock, _window.height - row);
            if (!take(row, rows))
                return Error{ErrorCode::Failed,
                             _path + ": cannot read rows " + std::to_string(_window.row + row) +
                                 " to " + std::to_string(_window.row + row + rows - 1) + " of " +
                                 std::to_string(_band->GetYSize()) + ": " + _errors.last()};
            row += rows;
            if (_options.progress &&
                !_options.progress(from + (to - from) * static_cast<double>(row) / _window.height))
                return Error{ErrorCode::Failed, _path + ": reading was cancelled"};
        }
        return std::nullopt;
    }

    /// Marks as NaN what nodata value or mask say is void; the rest is surveyed where asked.
    bool readRows(int row, int rows, Real* strip, bool survey)
    {
        const int width = _window.width;
        const int left = _window.column;
        const int top = _window.row + row;
        const std::size_t count = place(rows, 0);
        const GDALDataType type = sizeof(Real) == sizeof(float) ? GDT_Float32 : GDT_Float64;
        if (_band->RasterIO(GF_Read, left, top, width, rows, strip, width, rows, type, 0, 0,
                            nullptr) != CE_None)
            return false;
        _mask.resize(_info.hasMask ? count : 0);
        if (_info.hasMask &&
            _maskBand->RasterIO(GF_Read, left, top, width, rows, _mask.data(), width, rows,
                                GDT_Float32, 0, 0, nullptr) != CE_None)
            return false;
        for (std::size_t i = 0; i < count; ++i)
        {
            Real& value = strip[i];
            if (_info.signedBytes && value > Real(127))
                value -= Real(256);
            if (isNoData(value) || (_info.hasMask && !(_mask[i] > 0.0f)))
                value = std::numeric_limits<Real>::quiet_NaN();
            else if (survey && !_customs.take(static_cast<double>(value)))
                _survey.add(_info.metresOf(static_cast<double>(value)));
        }
        return true;
    }

    /// All values were seen.
    std::optional<Error> endSurvey()
    {
        for (const double value : _customs.heights())
            _survey.add(_info.metresOf(value));
        if (_survey.heights() > 0)
            return std::nullopt;
        std::string why;
        for (const std::string& note : voidNotes())
            why += "; " + note;
        return Error{ErrorCode::Invalid, _path + ": holds no valid height: all of " +
                                             size(_window.width, _window.height) +
                                             " posts are void" + why};
    }

    /// Of posts that are void though neither nodata value nor mask say so.
    std::vector<std::string> voidNotes() const
    {
        std::vector<std::string> notes = _customs.notes();
        if (_survey.voids() > 0)
            notes.insert(
                notes.begin(),
                posts(_survey.voids()) +
                    (_survey.areRadii()
                         ? " that are no radii of the body, half to one and a half of its own"
                         : " without a finite height within ±1e6 m") +
                    ": taken as void");
        return notes;
    }

    void addNotes(const GroundSpacing& ground, DemFile& file) const
    {
        if (_survey.areRadii())
            file.notes.push_back("heights are radii of the body: its " + number(_survey.radius()) +
                                 " m come off");
        if (_survey.areKilometres())
            file.notes.push_back("heights are radii of the body in kilometres: its " +
                                 number(_survey.radius()) +
                                 " m come off; --unit m tells of metres");
        const std::vector<std::string> voids = voidNotes();
        file.notes.insert(file.notes.end(), voids.begin(), voids.end());
        // See HeightFactors.
        const double error =
            ground.factors.steepest(ground.east[ground.east.size() / 2], ground.north) * 0.5 *
            (file.highest - file.lowest);
        if (error > std::tan(0.1 * pi / 180.0))
            file.notes.push_back(
                std::string("the map's scale changes so much over the raster that slopes are wrong "
                            "by up to ") +
                CPLSPrintf("%.1f", std::atan(error) * 180.0 / pi) +
                " degrees; a smaller window or another projection is nearer");
    }

    /// metresAt(column, row): of the frame in the file's order; NaN where void.
    template <class MetresAt>
    Result<DemFile> fileOf(const RasterFrame& frame, const GroundSpacing& ground,
                           const MetresAt& metresAt) const
    {
        HeightRange range;
        const auto eachHeight = [&](const auto& take)
        {
            for (int row = 0; row < frame.height; ++row)
                for (int column = 0;
                     column < frame.width && !isBeyondPole(ground, frame, frame.fileRow(row));
                     ++column)
                    if (const double metres =
                            metresAt(frame.fileColumn(column), frame.fileRow(row));
                        !std::isnan(metres))
                        take(column, row, heightOf(metres));
        };
        eachHeight([&](int, int, double height) { range.add(height); });
        if (range.count == 0)
            return Error{ErrorCode::Invalid, _path + ": holds no valid height between the poles"};

        DemFile file;
        file.frame = frame;
        file.lowest = range.lowest;
        file.highest = range.highest;
        file.notes = _info.notes;
        addNotes(ground, file);
        DemTile& tile = file.tile;
        tile = DemTile(frame.width, frame.height, ground.north);
        tile.eastSpacings = ground.east;
        tile.heightOrigin = std::round(0.5 * (file.lowest + file.highest)) + 0.0; // never -0
        tile.crs = frame.crs;
        tile.mapStepX = std::abs(frame.geoTransform[1]);
        tile.mapStepY = std::abs(frame.geoTransform[5]);
        tile.mapOriginX = frame.mapX(0);
        tile.mapOriginY = frame.mapY(0);
        // Posts of a new tile are void.
        std::size_t beyond = 0;
        eachHeight(
            [&](int column, int row, double height)
            {
                tile.setHeight(column, row,
                               static_cast<float>((height - tile.heightOrigin) *
                                                  ground.factors.at(column, row)));
                beyond += tile.isValid(column, row) ? 0u : 1u;
            });
        const std::string most =
            " more than 1e6 m from the middle height, by the z factor or the map's scale";
        if (beyond == range.count)
            return Error{ErrorCode::Invalid, _path + ": all heights lie" + most};
        if (beyond > 0)
            file.notes.push_back(posts(beyond) + most + ": taken as void");
        return file;
    }

    const std::string& _path;
    const DemReadOptions& _options;
    OpenDem& _dem;
    const GdalErrors& _errors;
    const DemInfo& _info;
    GDALRasterBand* _band;     ///< what is read: the raster's, or an overview
    GDALRasterBand* _maskBand; ///< of _band
    PixelWindow _window;       ///< of it
    std::vector<float> _mask;  ///< of a strip; an alpha band can hold fractions
    CustomaryVoids _customs;
    HeightSurvey _survey;
};

/// read(reader): with a reader of either kind of number.
template <class Read>
Result<DemFile> withReader(const std::string& path, const DemReadOptions& options, bool limited,
                           const Read& read)
{
    GdalErrors errors;
    try
    {
        Result<OpenDem> opened = openDem(path, options, limited, errors);
        if (!opened)
            return opened.error();
        if (opened->info.fitsFloat)
            return read(HeightReader<float>(path, options, *opened, errors), opened->info);
        return read(HeightReader<double>(path, options, *opened, errors), opened->info);
    }
    catch (const std::bad_alloc&)
    {
        return Error{ErrorCode::Failed,
                     path + ": not enough memory to read it; needed a smaller window"};
    }
}

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
    return withReader(path, options, true,
                      [](auto reader, const DemInfo&) { return reader.read(); });
}

Result<DemFile> readDemReduced(const std::string& path, const DemReadOptions& options, int maxSide)
{
    assert(!options.window && maxSide >= 2);
    return withReader(path, options, false,
                      [maxSide](auto reader, const DemInfo& info)
                      {
                          const int longest = std::max(info.rasterWidth, info.rasterHeight);
                          if (longest <= maxSide)
                              return reader.read();
                          const auto reduced = [&](int side)
                          {
                              const double share = static_cast<double>(maxSide) / longest;
                              return std::max(1, static_cast<int>(std::lround(side * share)));
                          };
                          return reader.readReduced(reduced(info.rasterWidth),
                                                    reduced(info.rasterHeight));
                      });
}

} // namespace osgTerrainLight
