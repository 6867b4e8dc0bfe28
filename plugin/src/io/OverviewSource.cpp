#include "io/OverviewSource.h"

#include "core/Crests.h"
#include "io/Bilinear.h"
#include "io/RasterHeights.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

namespace osgTerrainLight
{
namespace
{
constexpr float missing = std::numeric_limits<float>::quiet_NaN();
constexpr std::array<CrestAxis, 2> axes = {CrestAxis::East, CrestAxis::North};
/// Posts a side of what is looked at of the whole raster before it is drawn.
constexpr int surveyedPosts = 1024;
/// Without overviews a larger raster takes seconds to show.
constexpr int mostWithoutOverviews = 8192;

/// Of a level, those that stand on a post of the rectangle.
PostRect within(const PostRect& posts, int level)
{
    const int step = 1 << level;
    const auto first = [&](int post) { return (post + step - 1) >> level; };
    const auto last = [&](int end) { return (end - 1) >> level; };
    PostRect result{first(posts.column), first(posts.row), 0, 0};
    result.width = std::max(0, last(posts.endColumn()) + 1 - result.column);
    result.height = std::max(0, last(posts.endRow()) + 1 - result.row);
    return result;
}
} // namespace

OverviewSource::OverviewSource() = default;
OverviewSource::~OverviewSource() = default;

Result<std::unique_ptr<OverviewSource>>
OverviewSource::open(const std::string& path, const DemReadOptions& options, int cellsLog2)
{
    assert(!options.window);
    auto heights = RasterHeights::open(path, options, true, std::numeric_limits<double>::max());
    if (!heights)
        return heights.error();
    return open(std::move(*heights), cellsLog2);
}

Result<std::unique_ptr<OverviewSource>> OverviewSource::open(std::unique_ptr<RasterHeights> heights,
                                                             int cellsLog2)
{
    std::unique_ptr<OverviewSource> made(new OverviewSource);
    made->_heights = std::move(heights);
    made->_cellsLog2 = cellsLog2;
    RasterHeights& raster = *made->_heights;
    const RasterFrame& frame = raster.info().frame;
    const int longest = std::max(frame.width, frame.height);
    while ((made->cells() << made->_root) + 1 < longest)
        ++made->_root;
    const int last = made->width() - 1;
    made->_west = frame.westFirst ? 0 : last - (frame.width - 1);
    made->_south = frame.northUp ? last - (frame.height - 1) : 0;
    PostRect extent = raster.extent();
    extent.column += made->_west;
    extent.row += made->_south;
    for (int level = 0; level <= made->lastLevel(); ++level)
        made->_extents.push_back(within(extent, level));

    int level = 0;
    while ((longest >> level) > surveyedPosts)
        ++level;
    Result<HeightRules> rules = raster.surveyEvery(level);
    if (!rules)
        return rules.error();
    std::tie(made->_lowest, made->_highest) = raster.seenRange();
    raster.use(*rules, originOfHeights(made->_lowest, made->_highest));
    made->_notes = raster.info().notes;
    for (const std::string& note : raster.surveyNotes())
        made->_notes.push_back(note);
    if (const std::string note = noteOfSlopes(raster.ground(), made->_lowest, made->_highest);
        !note.empty())
        made->_notes.push_back(note);
    if (longest > mostWithoutOverviews && (longest >> raster.overviewLevels()) > surveyedPosts)
    {
        std::string factors;
        for (int power = raster.overviewLevels() + 1; (longest >> power) >= 256; ++power)
            factors += " " + std::to_string(1 << power);
        made->_notes.push_back("coarse views read all of " + std::to_string(frame.width) + " x " +
                               std::to_string(frame.height) +
                               " posts, since overviews are missing; faster after: gdaladdo -r "
                               "nearest \"" +
                               raster.path() + "\"" + factors);
    }
    return made;
}

PostRect OverviewSource::placeOf(int x, int y) const
{
    return {x * cells(), y * cells(), cells() + 1, cells() + 1};
}

double OverviewSource::heightOrigin() const
{
    return _heights->origin();
}

double OverviewSource::northSpacing() const
{
    return _heights->ground().north;
}

double OverviewSource::eastSpacing(int row) const
{
    return _heights->eastSpacing(row - _south);
}

const RasterFrame& OverviewSource::frame() const
{
    return info().frame;
}

const DemInfo& OverviewSource::info() const
{
    return _heights->info();
}

double OverviewSource::middleEastSpacing() const
{
    return _heights->eastSpacing(info().frame.height / 2);
}

DemTile OverviewSource::cornersOf(int level, const PostRect& posts) const
{
    const RasterFrame& map = frame();
    const int step = 1 << level;
    const double west = double(posts.column) * step - _west;
    const double south = double(posts.row) * step - _south;
    DemTile tile(2, 2, northSpacing() * (posts.height - 1) * step);
    tile.eastSpacings = {middleEastSpacing() * (posts.width - 1) * step};
    tile.crs = map.crs;
    tile.mapOriginX = map.mapX(west);
    tile.mapOriginY = map.mapY(south);
    tile.mapStepX = map.mapX(west + (posts.width - 1) * step) - tile.mapOriginX;
    tile.mapStepY = map.mapY(south + (posts.height - 1) * step) - tile.mapOriginY;
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 2; ++column)
            tile.setHeight(column, row, 0.0f);
    return tile;
}

Result<std::function<double(double, double)>> OverviewSource::coarseHeights()
{
    Result<Raster<float>> posts = readSurface(_root, placeOf(0, 0));
    if (!posts)
        return posts.error();
    const auto shared = std::make_shared<const Raster<float>>(std::move(*posts));
    const PostRect all = terrain();
    return std::function<double(double, double)>(
        [shared, middleX = all.column + 0.5 * (all.width - 1),
         middleY = all.row + 0.5 * (all.height - 1), east = middleEastSpacing(),
         north = northSpacing(), step = 1 << _root, origin = heightOrigin()](double x, double y)
        {
            const auto column = static_cast<int>(std::lround((middleX + x / east) / step));
            const auto row = static_cast<int>(std::lround((middleY + y / north) / step));
            return shared->contains(column, row)
                       ? origin + static_cast<double>(shared->at(column, row))
                       : std::numeric_limits<double>::quiet_NaN();
        });
}

Result<double> OverviewSource::heightAt(double x, double y)
{
    const PostRect all = terrain();
    std::optional<Error> unread;
    const double above =
        bilinear(x / middleEastSpacing() + 0.5 * (all.width - 1),
                 y / northSpacing() + 0.5 * (all.height - 1), all.width, all.height,
                 [&](int column, int row)
                 {
                     const Result<Raster<float>> post =
                         readPosts({all.column + column, all.row + row, 1, 1});
                     if (!post)
                         unread = post.error();
                     return post ? post->at(0, 0) : missing;
                 });
    if (unread)
        return *unread;
    return heightOrigin() + above;
}

Result<Raster<float>> OverviewSource::readPosts(const PostRect& posts)
{
    PostRect raster = posts;
    raster.column -= _west;
    raster.row -= _south;
    return _heights->read(raster);
}

Result<Raster<float>> OverviewSource::readSurface(int level, const PostRect& posts)
{
    if (level == 0)
        return readPosts(posts);
    const int step = 1 << level;
    return _heights->readEvery(level, posts.column * step - _west, posts.row * step - _south,
                               posts.width, posts.height);
}

Result<std::shared_ptr<const OverviewSource::Block>> OverviewSource::makeBlock(int level, int x,
                                                                               int y)
{
    const int finer = level > 1 ? 2 : 1;
    const int scale = 1 << finer;
    // Half a post of the block to all sides.
    const PostRect from = {scale * x * side - scale / 2, scale * y * side - scale / 2,
                           scale * side + 1, scale * side + 1};
    const Result<Raster<float>> posts = readSurface(level - finer, from);
    if (!posts)
        return posts.error();
    auto made = std::make_shared<Block>();
    for (std::size_t i = 0; i < axes.size(); ++i)
    {
        Raster<float> cells = cellsOf(*posts, axes[i]);
        for (int k = 0; k < finer; ++k)
            cells = coarserCells(cells, axes[i]);
        (*made)[i] = std::move(cells);
    }
    return std::shared_ptr<const Block>(made);
}

Result<std::shared_ptr<const OverviewSource::Block>> OverviewSource::block(int level, int x, int y)
{
    const Key key{level, x, y};
    const auto found = _blocks.find(key);
    if (found != _blocks.end())
    {
        _used.splice(_used.begin(), _used, found->second.second);
        return found->second.first;
    }
    Result<std::shared_ptr<const Block>> made = makeBlock(level, x, y);
    if (!made)
        return made;
    _used.push_front(key);
    _blocks[key] = {*made, _used.begin()};
    if (_blocks.size() > mostBlocks)
    {
        _blocks.erase(_used.back());
        _used.pop_back();
    }
    return made;
}

Result<Raster<float>> OverviewSource::readLevel(int level, CrestAxis axis, const PostRect& posts)
{
    assert(level >= 1 && level <= lastLevel());
    Raster<float> result(std::max(0, posts.width), std::max(0, posts.height), missing);
    const PostRect inside = posts.clippedTo(extent(level));
    if (inside.empty())
        return result;
    const std::size_t plane = axis == CrestAxis::East ? 0 : 1;
    for (int y = inside.row / side; y * side < inside.endRow(); ++y)
        for (int x = inside.column / side; x * side < inside.endColumn(); ++x)
        {
            const Result<std::shared_ptr<const Block>> made = block(level, x, y);
            if (!made)
                return made.error();
            const Raster<float>& heights = (**made)[plane];
            const PostRect part = PostRect{x * side, y * side, side, side}.clippedTo(inside);
            for (int row = part.row; row < part.endRow(); ++row)
                for (int column = part.column; column < part.endColumn(); ++column)
                    result.at(column - posts.column, row - posts.row) =
                        heights.at(column - x * side, row - y * side);
        }
    return result;
}

} // namespace osgTerrainLight
