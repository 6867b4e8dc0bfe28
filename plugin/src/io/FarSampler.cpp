#include "io/FarSampler.h"

#include "io/Bilinear.h"
#include "io/GdalErrors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace osgTerrainLight
{
namespace
{
/// Parts of a strip, so that the pixels below one are few where the two rasters' rows do not run
/// alike.
constexpr int partSide = 256;
/// Read at once for a part; one with more is halved: it lies across the seam of a map.
constexpr std::size_t mostPixels = 1u << 21;
} // namespace

PixelWindow pixelsAround(const std::vector<PostsToPixels::Places>& places,
                         const PixelWindow& window)
{
    double west = std::numeric_limits<double>::infinity();
    double east = -west;
    double top = west;
    double bottom = -west;
    for (const PostsToPixels::Places& row : places)
        for (std::size_t i = 0; i < row.x.size(); ++i)
            if (!std::isnan(row.x[i]))
            {
                west = std::min(west, row.x[i]);
                east = std::max(east, row.x[i]);
                top = std::min(top, row.y[i]);
                bottom = std::max(bottom, row.y[i]);
            }
    const auto clamped = [](double value, int first, int count)
    {
        return static_cast<int>(std::clamp(value, static_cast<double>(first) - 1.0,
                                           static_cast<double>(first) + count));
    };
    PostRect pixels; // both ends, then their common part with the window
    pixels.column = clamped(std::floor(west), window.column, window.width);
    pixels.row = clamped(std::floor(top), window.row, window.height);
    pixels.width = clamped(std::floor(east) + 2.0, window.column, window.width) - pixels.column;
    pixels.height = clamped(std::floor(bottom) + 2.0, window.row, window.height) - pixels.row;
    pixels = pixels.clippedTo({window.column, window.row, window.width, window.height});
    return {pixels.column, pixels.row, pixels.width, pixels.height};
}

std::optional<Error> FarSampler::sample(int level, const PostRect& posts, float* heights)
{
    for (int row = 0; row < posts.height; row += partSide)
        for (int column = 0; column < posts.width; column += partSide)
        {
            const PostRect part{posts.column + column, posts.row + row,
                                std::min(partSide, posts.width - column),
                                std::min(partSide, posts.height - row)};
            float* first = heights +
                           static_cast<std::size_t>(row) * static_cast<std::size_t>(posts.width) +
                           static_cast<std::size_t>(column);
            if (auto error = samplePart(level, part, first, posts.width))
                return error;
        }
    return std::nullopt;
}

std::optional<Error> FarSampler::samplePart(int level, const PostRect& posts, float* first,
                                            int stride)
{
    const double step = std::ldexp(1.0, level);
    std::vector<PostsToPixels::Places> places;
    for (int row = 0; row < posts.height; ++row)
        places.push_back(
            _toPixels.row(step * posts.column, step, posts.width, step * (posts.row + row)));
    const PixelWindow pixels = pixelsAround(places, _window);
    const std::size_t count = static_cast<std::size_t>(std::max(0, pixels.width)) *
                              static_cast<std::size_t>(std::max(0, pixels.height));
    if (count > mostPixels && posts.width * posts.height > 1)
    {
        PostRect one = posts;
        PostRect other = posts;
        const bool across = posts.width >= posts.height;
        int& length = across ? one.width : one.height;
        length /= 2;
        (across ? other.column : other.row) += length;
        (across ? other.width : other.height) -= length;
        float* firstOfOther =
            first + (across ? length : static_cast<std::ptrdiff_t>(length) * stride);
        if (auto error = samplePart(level, one, first, stride))
            return error;
        return samplePart(level, other, firstOfOther, stride);
    }
    _values.resize(count);
    GdalErrors errors;
    if (count > 0 && !_reader.read(pixels, _values.data(), false))
        return _reader.unreadable(_path, pixels, errors);
    for (double& value : _values)
        if (const double metres = _rules.metresOf(value, _facts); std::isnan(metres))
            value = metres;
        else
            value = _rules.heightOf(metres);
    take(level, posts, places, pixels, first, stride);
    return std::nullopt;
}

void FarSampler::take(int level, const PostRect& posts,
                      const std::vector<PostsToPixels::Places>& places, const PixelWindow& pixels,
                      float* first, int stride) const
{
    const int step = 1 << level;
    const auto at = [&](int column, int row)
    {
        return _values[static_cast<std::size_t>(row) * static_cast<std::size_t>(pixels.width) +
                       static_cast<std::size_t>(column)];
    };
    for (int row = 0; row < posts.height; ++row)
    {
        const PostsToPixels::Places& line = places[static_cast<std::size_t>(row)];
        const int rowOfPosts = (posts.row + row) * step;
        const bool isVoid = _near.isBeyondPole(rowOfPosts);
        for (int i = 0; i < posts.width; ++i)
        {
            const auto place = static_cast<std::size_t>(i);
            const double height =
                isVoid ? std::numeric_limits<double>::quiet_NaN()
                       : bilinear(line.x[place] - pixels.column, line.y[place] - pixels.row,
                                  pixels.width, pixels.height, at);
            first[static_cast<std::ptrdiff_t>(row) * stride + i] =
                _near.placed(height, (posts.column + i) * step, rowOfPosts);
        }
    }
}

} // namespace osgTerrainLight
