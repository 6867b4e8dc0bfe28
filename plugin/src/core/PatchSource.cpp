#include "core/PatchSource.h"

#include "core/Crests.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace osgTerrainLight
{

namespace
{
constexpr float missing = std::numeric_limits<float>::quiet_NaN();
/// Of a step, within which a place is a post.
constexpr double onPost = 1.0e-3;

/// The posts of a patch on both sides of a place, along one axis.
struct Between
{
    int place = 0; ///< in what is read
    int first = 0, second = 0;
    float part = 0.0f; ///< of the second
};

/// For places first + i · step that lie on the patch.
std::vector<Between> between(int count, double first, double step, double start, double patchStep,
                             int patchPosts)
{
    std::vector<Between> found;
    const auto from = static_cast<int>(std::max(0.0, std::floor((start - first) / step) - 1.0));
    for (int i = from; i < count; ++i)
    {
        const double at = (first + i * step - start) / patchStep;
        if (at > patchPosts - 1 + onPost)
            break;
        if (at < -onPost)
            continue;
        const double nearest = std::round(at);
        Between post;
        post.place = i;
        if (std::abs(at - nearest) <= onPost)
            post.first = post.second = static_cast<int>(nearest);
        else
        {
            post.first = static_cast<int>(std::floor(at));
            post.second = post.first + 1;
            post.part = static_cast<float>(at - post.first);
        }
        found.push_back(post);
    }
    return found;
}

/// NaN where one of the posts that count is void.
float heightAt(const DemTile& dem, const Between& east, const Between& north)
{
    const auto at = [&dem](int column, int row)
    { return dem.isValid(column, row) ? dem.heightAt(column, row) : missing; };
    const auto along = [&](int row)
    {
        const float west = at(east.first, row);
        return east.part > 0.0f ? west + (at(east.second, row) - west) * east.part : west;
    };
    const float south = along(north.first);
    return north.part > 0.0f ? south + (along(north.second) - south) * north.part : south;
}
} // namespace

PatchSource::PatchSource(const TerrainPatch& tile, std::vector<TerrainPatch> patches,
                         std::function<double(double)> eastMetres, std::optional<BaseGround> base)
    : _tile(tile), _patches(std::move(patches)), _eastMetres(std::move(eastMetres)),
      _base(std::move(base))
{
    // Coarser than the tile, or like it: the finer the better; after these the coarsest.
    const auto rank = [this](const TerrainPatch& patch)
    {
        const bool finer = patch.isFinerThan(_tile);
        return std::tuple(finer ? 0 : 1, finer ? patch.eastStep : -patch.eastStep, patch.south,
                          patch.west);
    };
    std::sort(_patches.begin(), _patches.end(),
              [&](const TerrainPatch& a, const TerrainPatch& b) { return rank(a) < rank(b); });
    _patches.push_back(_tile);

    static constexpr double most = whole;
    const auto placed = [](double from, double step)
    {
        const double post = std::fmod(std::round(from / step), half);
        return half + static_cast<int>(post);
    };
    _place = {placed(_tile.west, _tile.eastStep), placed(_tile.south, _tile.northStep),
              _tile.dem->width(), _tile.dem->height()};
    const auto add = [this](double west, double south, double east, double north)
    {
        // What lies beyond all of the terrain is clipped below.
        const auto post = [](double at) { return static_cast<int>(std::clamp(at, -most, most)); };
        const auto first = [&](double from, double step)
        { return post(std::ceil(from / step - onPost)); };
        const auto end = [&](double to, double step)
        { return post(std::floor(to / step + onPost)) + 1; };
        PostRect posts;
        posts.column = _place.column + first(west - _tile.west, _tile.eastStep);
        posts.row = _place.row + first(south - _tile.south, _tile.northStep);
        posts.width = _place.column + end(east - _tile.west, _tile.eastStep) - posts.column;
        posts.height = _place.row + end(north - _tile.south, _tile.northStep) - posts.row;
        if (!posts.empty())
            _extent = _extent.joinedWith(posts);
    };
    for (const TerrainPatch& patch : _patches)
        add(patch.west, patch.south, patch.east(), patch.north());
    if (_base)
        add(_base->west, _base->south, _base->east, _base->north);
    _extent = _extent.clippedTo({0, 0, whole, whole});
}

PostRect PatchSource::extent(int level) const
{
    return _extent.coarser(level);
}

double PatchSource::eastSpacing(int row) const
{
    return _eastMetres ? _eastMetres(northOf(row)) * _tile.eastStep
                       : _tile.dem->nominalEastSpacing();
}

/// heights: of the posts, void so far [m above the tile's heightOrigin].
void PatchSource::readBase(int step, const PostRect& posts, Raster<float>& heights) const
{
    // Those posts that lie in the rectangle of the base.
    const auto within = [](double first, double apart, int count, double from, double to)
    {
        const auto post = [count](double at)
        { return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(count))); };
        const int begin = post(std::ceil((from - first) / apart - onPost));
        const int end = post(std::floor((to - first) / apart + onPost) + 1.0);
        return std::pair(begin, std::max(0, end - begin));
    };
    const double eastStep = step * _tile.eastStep, northStep = step * _tile.northStep;
    const double west = eastOf(posts.column * step), south = northOf(posts.row * step);
    const auto [column, columns] =
        within(west, eastStep, heights.width(), _base->west, _base->east);
    const auto [row, rows] = within(south, northStep, heights.height(), _base->south, _base->north);
    if (columns == 0 || rows == 0)
        return;
    const std::vector<float> read = _base->heights(
        west + column * eastStep, south + row * northStep, eastStep, northStep, columns, rows);
    if (read.empty())
        return;
    assert(read.size() == static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    const double zero = _tile.dem->heightOrigin + _tile.lift;
    auto next = read.begin();
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x, ++next)
            heights.at(column + x, row + y) = static_cast<float>(static_cast<double>(*next) - zero);
}

Result<Raster<float>> PatchSource::readSurface(int level, const PostRect& posts)
{
    const int step = 1 << level;
    Raster<float> result(std::max(0, posts.width), std::max(0, posts.height), missing);
    Raster<float> finest(result.width(), result.height(), 0.0f); // spacing of what is there
    if (_base)
        readBase(step, posts, result);
    const double zero = _tile.dem->heightOrigin + _tile.lift;
    for (const TerrainPatch& patch : _patches)
    {
        const DemTile& dem = *patch.dem;
        const std::vector<Between> columns =
            between(posts.width, eastOf(posts.column * step), step * _tile.eastStep, patch.west,
                    patch.eastStep, dem.width());
        if (columns.empty())
            continue;
        const auto spacing = static_cast<float>(patch.eastStep);
        const auto lift = static_cast<float>(dem.heightOrigin + patch.lift - zero);
        for (const Between& row :
             between(posts.height, northOf(posts.row * step), step * _tile.northStep, patch.south,
                     patch.northStep, dem.height()))
            for (const Between& column : columns)
            {
                const float height = heightAt(dem, column, row) + lift;
                // Beside a patch of the same spacing an edge that is void here may be valid there.
                float& there = finest.at(column.place, row.place);
                if (std::isnan(height) && there == spacing)
                    continue;
                result.at(column.place, row.place) = height;
                there = spacing;
            }
    }
    return result;
}

Result<Raster<float>> PatchSource::readLevel(int level, CrestAxis axis, const PostRect& posts)
{
    assert(level >= 1 && level <= last);
    if (posts.empty())
        return Raster<float>(std::max(0, posts.width), std::max(0, posts.height), missing);
    const int finer = level > 1 ? 2 : 1;
    const int scale = 1 << finer;
    if (level != _readLevel || !posts.contains(_readPosts) || !_readPosts.contains(posts))
    {
        // Half a post to all sides.
        Result<Raster<float>> read = readSurface(
            level - finer, {scale * posts.column - scale / 2, scale * posts.row - scale / 2,
                            scale * posts.width + 1, scale * posts.height + 1});
        if (!read)
            return read.error();
        _read = std::move(*read);
        _readLevel = level;
        _readPosts = posts;
    }
    Raster<float> cells = cellsOf(_read, axis);
    for (int k = 0; k < finer; ++k)
        cells = coarserCells(cells, axis);
    return cells;
}

} // namespace osgTerrainLight
