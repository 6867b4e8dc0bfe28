#include "io/RasterHeights.h"

#include "io/GdalErrors.h"
#include "io/HeightShift.h"

#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace osgTerrainLight
{
namespace
{
constexpr float missing = std::numeric_limits<float>::quiet_NaN();

/// So many posts that rectangles of them cannot overflow.
int postsFor(double metres, double spacing)
{
    return static_cast<int>(std::min(std::ceil(metres / spacing), 2.0e8));
}
} // namespace

Result<std::unique_ptr<RasterHeights>> RasterHeights::open(const std::string& path,
                                                           const DemReadOptions& options,
                                                           bool beyondWindow, double reach,
                                                           GDALDatasetUniquePtr dataset)
{
    GdalErrors errors;
    Result<OpenDem> opened = openDem(path, options, false, errors, std::move(dataset));
    if (!opened)
        return opened.error();
    std::unique_ptr<RasterHeights> made(new RasterHeights);
    made->_path = path;
    made->_heightFactor = options.heightFactor;
    made->_shift = options.shift;
    made->_dem = std::move(*opened);
    if (!options.byMapScale)
        made->_dem.ground.factors = HeightFactors();
    const DemInfo& info = made->_dem.info;
    const OGRSpatialReference* crs = made->_dem.dataset->GetSpatialRef();
    if (crs && info.geographic)
        made->_degrees.emplace(*crs, info.frame);
    PostRect& extent = made->_extent;
    extent = {0, 0, info.window.width, info.window.height};
    if (beyondWindow)
        extent = made->postsOf({0, 0, info.rasterWidth, info.rasterHeight})
                     .clippedTo(made->within(reach));
    while (!extent.empty() && made->isBeyondPole(extent.row))
        ++extent.row, --extent.height;
    while (!extent.empty() && made->isBeyondPole(extent.endRow() - 1))
        --extent.height;
    made->_reader = std::make_unique<HeightReader<double>>(made->_dem);
    made->_surveyed = made->_reader.get();
    made->openOverviews();
    return made;
}

double RasterHeights::eastSpacing(int row) const
{
    const std::vector<double>& east = ground().east;
    const auto rows = static_cast<int>(east.size());
    if (_degrees && (row < 0 || row >= rows))
        return _degrees->east(row);
    return east[static_cast<std::size_t>(std::clamp(row, 0, rows - 1))];
}

PostRect RasterHeights::within(double reach) const
{
    const std::vector<double>& east = ground().east;
    const int columns = postsFor(reach, *std::min_element(east.begin(), east.end()));
    const int rows = postsFor(reach, ground().north);
    return {-columns, -rows, info().window.width + 2 * columns, info().window.height + 2 * rows};
}

PixelWindow RasterHeights::pixelsOf(const PostRect& posts) const
{
    const RasterFrame& frame = info().frame;
    const PixelWindow& lit = info().window;
    return {lit.column + frame.fileColumn(frame.westFirst ? posts.column : posts.endColumn() - 1),
            lit.row + frame.fileRow(frame.northUp ? posts.endRow() - 1 : posts.row), posts.width,
            posts.height};
}

PostRect RasterHeights::postsOf(const PixelWindow& pixels) const
{
    const RasterFrame& frame = info().frame;
    const int column = pixels.column - info().window.column;
    const int row = pixels.row - info().window.row;
    // Order is the same or the opposite, so either way is the way back.
    return {frame.fileColumn(frame.westFirst ? column : column + pixels.width - 1),
            frame.fileRow(frame.northUp ? row + pixels.height - 1 : row), pixels.width,
            pixels.height};
}

Result<HeightRules> RasterHeights::survey(const std::function<bool(double)>& progress)
{
    if (_extent.empty())
        return Error{ErrorCode::Invalid, _path + ": holds no valid height between the poles"};
    GdalErrors errors;
    const PixelWindow window = pixelsOf(_extent);
    std::vector<double> strip(static_cast<std::size_t>(_reader->stripRows(window)) *
                              static_cast<std::size_t>(window.width));
    const auto see = [&](const PixelWindow& rows)
    { return _reader->read(rows, strip.data(), true); };
    if (auto error = _reader->eachStrip(window, false, _path, errors, progress, see))
        return *error;
    return _reader->rules(_path, window);
}

std::pair<double, double> RasterHeights::rangeOf(const HeightRules& rules) const
{
    return std::minmax({rules.heightOf(rules.lowest) * _heightFactor,
                        rules.heightOf(rules.highest) * _heightFactor});
}

void RasterHeights::use(HeightRules rules, double origin)
{
    _rules = std::move(rules);
    _origin = origin;
}

double RasterHeights::heightOf(double metres, int column, int row) const
{
    const double height = _rules.heightOf(metres) * _heightFactor;
    const RasterFrame& frame = info().frame;
    return _shift ? height + _shift->at(frame.mapX(column), frame.mapY(row)) : height;
}

float RasterHeights::placed(double height, int column, int row) const
{
    const HeightFactors& factors = ground().factors;
    const double factor = factors.areOne()
                              ? 1.0
                              : factors.at(std::clamp(column, 0, info().window.width - 1),
                                           std::clamp(row, 0, info().window.height - 1));
    const auto result = static_cast<float>((height - _origin) * factor);
    return std::abs(result) <= greatestHeight ? result : missing;
}

void RasterHeights::convert(const double* stored, const PostRect& posts, int row, float* heights,
                            std::size_t& beyond, std::size_t& all) const
{
    const RasterFrame& frame = info().frame;
    const int rowInFile = frame.northUp ? posts.endRow() - 1 - row : row - posts.row;
    const double* values =
        stored + static_cast<std::size_t>(rowInFile) * static_cast<std::size_t>(posts.width);
    for (int i = 0; i < posts.width; ++i)
    {
        const double metres =
            _rules.metresOf(values[frame.westFirst ? i : posts.width - 1 - i], info());
        float& height = heights[i] = missing;
        if (std::isnan(metres))
            continue;
        height = placed(heightOf(metres, posts.column + i, row), posts.column + i, row);
        ++all;
        beyond += std::isnan(height) ? 1u : 0u;
    }
}

Result<Raster<float>> RasterHeights::read(const PostRect& posts)
{
    Raster<float> result(std::max(0, posts.width), std::max(0, posts.height), missing);
    const PostRect inside = posts.clippedTo(_extent);
    if (inside.empty())
        return result;
    GdalErrors errors;
    const PixelWindow window = pixelsOf(inside);
    std::vector<double> stored(static_cast<std::size_t>(inside.width) *
                               static_cast<std::size_t>(inside.height));
    if (!_reader->read(window, stored.data(), false))
        return _reader->unreadable(_path, window, errors);
    std::size_t beyond = 0;
    std::size_t all = 0;
    for (int row = inside.row; row < inside.endRow(); ++row)
        convert(stored.data(), inside, row,
                &result.at(inside.column - posts.column, row - posts.row), beyond, all);
    return result;
}

/// Those of powers of 2.
void RasterHeights::openOverviews()
{
    const int width = _reader->width();
    const int height = _reader->height();
    const int longest = std::max(width, height);
    for (int level = 1; (longest >> level) > 1; ++level)
    {
        auto reader = std::make_unique<HeightReader<double>>(_dem);
        const auto isLevelOf = [level](int coarse, int fine)
        { return coarse == fine >> level || coarse == ((fine - 1) >> level) + 1; };
        if (reader->useOverview(longest >> level) && isLevelOf(reader->width(), width) &&
            isLevelOf(reader->height(), height))
            _overviews.push_back({level, std::move(reader)});
    }
}

int RasterHeights::overviewLevels() const
{
    return _overviews.empty() ? 0 : _overviews.back().level;
}

std::pair<int, HeightReader<double>*> RasterHeights::overviewFor(int level)
{
    std::pair<int, HeightReader<double>*> best = {0, _reader.get()};
    for (const Overview& overview : _overviews)
        if (overview.level <= level)
            best = {overview.level, overview.reader.get()};
    return best;
}

Result<HeightRules> RasterHeights::surveyEvery(int level)
{
    GdalErrors errors;
    const auto [at, reader] = overviewFor(level);
    _surveyed = reader;
    const int step = 1 << (level - at);
    PixelWindow strip{0, 0, reader->width(), 1};
    if (step == 1)
        strip.height = reader->stripRows(strip);
    std::vector<double> values(static_cast<std::size_t>(strip.width) *
                               static_cast<std::size_t>(strip.height));
    for (; strip.row<reader->height(); strip.row += step> 1 ? step : strip.height)
    {
        strip.height = std::min(strip.height, reader->height() - strip.row);
        if (!reader->read(strip, values.data(), true))
            return reader->unreadable(_path, strip, errors);
    }
    Result<HeightRules> rules =
        reader->rules(_path, {0, 0, info().window.width, info().window.height});
    if (!rules)
        return rules;
    _seen = rangeOf(*rules);
    // Heights that were not seen may be any that readDem() takes.
    const double unit = rules->kilometres ? 1.0e-3 : 1.0;
    rules->lowest = rules->radius > 0.0 ? 0.5 * rules->radius * unit : -double(greatestHeight);
    rules->highest = rules->radius > 0.0 ? 1.5 * rules->radius * unit : double(greatestHeight);
    return rules;
}

Result<Raster<float>> RasterHeights::readEvery(int level, int column, int row, int width,
                                               int height)
{
    Raster<float> result(width, height, missing);
    const RasterFrame& frame = info().frame;
    HeightReader<double>* const reader = overviewFor(level).second;
    const int step = 1 << level;
    // Posts of the result that the raster has.
    const auto firstInside = [step](int from, int begin)
    { return from >= begin ? 0 : (begin - from + step - 1) / step; };
    const auto endInside = [step](int from, int count, int end)
    { return from >= end ? 0 : std::min(count, (end - 1 - from) / step + 1); };
    const int beginX = firstInside(column, _extent.column);
    const int endX = endInside(column, width, _extent.endColumn());
    const int beginY = firstInside(row, _extent.row);
    const int endY = endInside(row, height, _extent.endRow());
    if (beginX >= endX || beginY >= endY)
        return result;
    GdalErrors errors;
    // GDAL stretches overviews whose size is not whole: pixel i is near i times this many.
    const auto nearest = [](int pixel, int of, int all) {
        return std::min(static_cast<int>(std::lround(static_cast<double>(pixel) * of / all)),
                        of - 1);
    };
    const auto pixelOf = [&](int post)
    { return nearest(frame.fileColumn(column + post * step), reader->width(), frame.width); };
    const int left = std::min(pixelOf(beginX), pixelOf(endX - 1));
    const int right = std::max(pixelOf(beginX), pixelOf(endX - 1));
    const auto lineOf = [&](int post)
    { return nearest(frame.fileRow(row + post * step), reader->height(), frame.height); };
    // Rows that are close are read together: a call for each costs a VRT of many files dear.
    PixelWindow window{left, std::min(lineOf(beginY), lineOf(endY - 1)), right - left + 1, 1};
    const int lines = std::abs(lineOf(beginY) - lineOf(endY - 1)) + 1;
    const bool isAtOnce = lines <= 2 * (endY - beginY);
    window.height = isAtOnce ? lines : 1;
    std::vector<double> stored(static_cast<std::size_t>(window.width) *
                               static_cast<std::size_t>(window.height));
    if (isAtOnce && !reader->read(window, stored.data(), false))
        return reader->unreadable(_path, window, errors);
    for (int y = beginY; y < endY; ++y)
    {
        if (!isAtOnce)
        {
            window.row = lineOf(y);
            if (!reader->read(window, stored.data(), false))
                return reader->unreadable(_path, window, errors);
        }
        const double* line =
            stored.data() + static_cast<std::ptrdiff_t>(lineOf(y) - window.row) * window.width;
        for (int x = beginX; x < endX; ++x)
        {
            const double metres = _rules.metresOf(line[pixelOf(x) - left], info());
            if (!std::isnan(metres))
                result.at(x, y) = placed(heightOf(metres, column + x * step, row + y * step),
                                         column + x * step, row + y * step);
        }
    }
    return result;
}

std::optional<Error> RasterHeights::eachRow(const std::function<bool(double)>& progress,
                                            const std::function<bool(const float* heights)>& take,
                                            std::size_t& beyond, std::size_t& all)
{
    GdalErrors errors;
    const PixelWindow window = pixelsOf(_extent);
    std::vector<double> stored(static_cast<std::size_t>(_reader->stripRows(window)) *
                               static_cast<std::size_t>(window.width));
    std::vector<float> heights(static_cast<std::size_t>(window.width));
    const auto convertStrip = [&](const PixelWindow& strip)
    {
        if (!_reader->read(strip, stored.data(), false))
            return false;
        const PostRect posts = postsOf(strip);
        for (int row = posts.row; row < posts.endRow(); ++row)
        {
            convert(stored.data(), posts, row, heights.data(), beyond, all);
            if (!take(heights.data()))
                return false;
        }
        return true;
    };
    return _reader->eachStrip(window, info().frame.northUp, _path, errors, progress, convertStrip);
}

} // namespace osgTerrainLight
