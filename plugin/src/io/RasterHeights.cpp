#include "io/RasterHeights.h"

#include "io/GdalErrors.h"

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
                                                           bool beyondWindow, double reach)
{
    GdalErrors errors;
    Result<OpenDem> opened = openDem(path, options, false, errors);
    if (!opened)
        return opened.error();
    std::unique_ptr<RasterHeights> made(new RasterHeights);
    made->_path = path;
    made->_heightFactor = options.heightFactor;
    made->_dem = std::move(*opened);
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
        height = placed(_rules.heightOf(metres) * _heightFactor, posts.column + i, row);
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
