#include "io/DemReader.h"

#include "io/CellAverages.h"
#include "io/GdalErrors.h"
#include "io/HeightReader.h"
#include "io/HeightShift.h"
#include "io/OpenDem.h"
#include "io/PlacedHeights.h"

#include <gdal_priv.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <new>
#include <utility>

namespace osgTerrainLight
{
namespace
{

std::string size(int width, int height)
{
    return std::to_string(width) + " x " + std::to_string(height);
}

/// Heights reach float only after the origin, known when all are read, is taken off in double.
template <class Real>
class TileReader
{
public:
    TileReader(const std::string& path, const DemReadOptions& options, OpenDem& dem,
               const GdalErrors& errors)
        : _path(path), _options(options), _dem(dem), _errors(errors), _info(dem.info),
          _window(dem.info.window), _reader(dem)
    {
    }

    Result<DemFile> read()
    {
        std::vector<Real> stored(place(_window.height, 0));
        const auto take = [&](const PixelWindow& strip)
        { return _reader.read(strip, stored.data() + place(strip.row - _window.row, 0), true); };
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
        const bool fromOverview = place(_window.height, 0) > _options.maxPosts &&
                                  _reader.useOverview(std::max(width, height));
        if (fromOverview)
            _window = {0, 0, _reader.width(), _reader.height()};
        std::vector<Real> strip(place(_reader.stripRows(_window), 0));
        const auto see = [&](const PixelWindow& rows)
        { return _reader.read(rows, strip.data(), true); };
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
        const auto average = [&](const PixelWindow& rows)
        {
            if (!_reader.read(rows, strip.data(), false))
                return false;
            for (int y = 0; y < rows.height; ++y)
                for (int x = 0; x < _window.width && !isBeyondPole(*ground, source, rows.row + y);
                     ++x)
                    if (const double metres = metresOf(strip[place(y, x)]); !std::isnan(metres))
                        averages.add(x, rows.row + y, metres);
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
            file->notes.push_back(
                size(_info.rasterWidth, _info.rasterHeight) + " posts are averaged to " +
                size(width, height) +
                (fromOverview ? ", from the overview of " + size(_window.width, _window.height)
                              : ""));
        return file;
    }

private:
    /// Of a post in rows of the window.
    std::size_t place(int row, int column) const
    {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(_window.width) +
               static_cast<std::size_t>(column);
    }

    double metresOf(Real stored) const
    {
        return _rules.metresOf(static_cast<double>(stored), _info);
    }

    double heightOf(double metres) const { return _rules.heightOf(metres) * _options.heightFactor; }

    /// from, to: of the progress.
    std::optional<Error> eachStrip(double from, double to,
                                   const std::function<bool(const PixelWindow&)>& take)
    {
        const auto progress = [&](double done)
        { return !_options.progress || _options.progress(from + (to - from) * done); };
        return _reader.eachStrip(_window, false, _path, _errors, progress, take);
    }

    /// All values were seen.
    std::optional<Error> endSurvey()
    {
        Result<HeightRules> rules = _reader.rules(_path, _window);
        if (!rules)
            return rules.error();
        _rules = std::move(*rules);
        return std::nullopt;
    }

    /// metresAt(column, row): of the frame in the file's order; NaN where void.
    template <class MetresAt>
    Result<DemFile> fileOf(const RasterFrame& frame, const GroundSpacing& ground,
                           const MetresAt& metresAt) const
    {
        std::vector<std::string> notes = _info.notes;
        const std::vector<std::string> read = _reader.notes();
        notes.insert(notes.end(), read.begin(), read.end());
        GroundSpacing used = ground;
        if (!_options.byMapScale)
            used.factors = HeightFactors();
        return placeHeights(
            _path, frame, used, std::move(notes),
            [&](int column, int row)
            {
                const double metres = metresAt(frame.fileColumn(column), frame.fileRow(row));
                if (std::isnan(metres))
                    return metres;
                const double height = heightOf(metres);
                return _options.shift
                           ? height + _options.shift->at(frame.mapX(column), frame.mapY(row))
                           : height;
            });
    }

    const std::string& _path;
    const DemReadOptions& _options;
    OpenDem& _dem;
    const GdalErrors& _errors;
    const DemInfo& _info;
    PixelWindow _window; ///< of what is read: the raster, or an overview
    HeightReader<Real> _reader;
    HeightRules _rules;
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
            return read(TileReader<float>(path, options, *opened, errors), opened->info);
        return read(TileReader<double>(path, options, *opened, errors), opened->info);
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
