#include "lighting/TileWindows.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace osgTerrainLight
{
namespace
{

/// East spacings of a level's rows, of posts of level `unit` apart.
std::vector<double> spacingsOf(const TileSource& source, int level, int unit, const PostRect& posts)
{
    std::vector<double> spacings;
    for (int row = posts.row; row < posts.endRow(); ++row)
        spacings.push_back(source.eastSpacing(row * (1 << level)) * (1 << unit));
    return spacings;
}

/// Of heights of `near`.
DemTile tileOf(const TileWindows& windows, double northSpacing, double heightOrigin)
{
    const PostRect& place = windows.place;
    const PostRect& near = windows.near;
    DemTile tile(place.width, place.height, northSpacing);
    tile.heightOrigin = heightOrigin;
    const auto first = windows.eastSpacings.begin() + (place.row - near.row);
    tile.eastSpacings.assign(first, first + place.height);
    if (std::all_of(first, first + place.height,
                    [first](double spacing) { return spacing == *first; }))
        tile.eastSpacings.resize(1);
    for (int row = 0; row < place.height; ++row)
        for (int column = 0; column < place.width; ++column)
            tile.setHeight(column, row,
                           windows.heights.at(place.column - near.column + column,
                                              place.row - near.row + row));
    return tile;
}

} // namespace

WindowScheme WindowScheme::of(HorizonQuality quality)
{
    if (quality == HorizonQuality::Best)
        return {256, 128};
    return {};
}

Result<std::shared_ptr<const TileWindows>> readWindows(TileSource& source, int level,
                                                       const PostRect& tile, HorizonQuality quality)
{
    const WindowScheme scheme = WindowScheme::of(quality);
    assert(!tile.empty() && level >= 0 && level <= source.lastLevel());
    auto windows = std::make_shared<TileWindows>();
    const PostRect extent = source.extent(level);
    windows->place = tile;
    windows->extent = extent;
    windows->lastColumn = std::ldexp(source.width() - 1, -level);
    windows->lastRow = std::ldexp(source.height() - 1, -level);
    const PostRect terrain = source.terrain();
    windows->middleColumn = std::ldexp(terrain.column + 0.5 * (terrain.width - 1), -level);
    windows->middleRow = std::ldexp(terrain.row + 0.5 * (terrain.height - 1), -level);
    // The tile itself, where it reaches beyond what may be valid too.
    PostRect& near = windows->near;
    near = tile.grownBy(scheme.ring).clippedTo(extent).joinedWith(tile);
    Result<Raster<float>> heights = source.readSurface(level, near);
    if (!heights)
        return heights.error();
    windows->heights = std::move(*heights);
    windows->eastSpacings = spacingsOf(source, level, level, near);
    windows->tile = tileOf(*windows, source.northSpacing() * (1 << level), source.heightOrigin());

    if (source.lastLevel() - level > TileWindows::mostLevels)
        return Error{ErrorCode::NotSupported,
                     "the terrain has " + std::to_string(source.lastLevel() - level) +
                         " coarser levels around a tile: needed at most " +
                         std::to_string(TileWindows::mostLevels) +
                         " (coarser posts, or surroundings that reach less far)"};
    PostRect covered = near; // in posts of the tile's level
    for (int far = level + 1; far <= source.lastLevel() && !covered.contains(extent); ++far)
    {
        FarLevel made;
        made.level = far - level;
        made.posts =
            covered.coarser(made.level).grownBy(scheme.farRing).clippedTo(source.extent(far));
        for (const CrestAxis axis : {CrestAxis::East, CrestAxis::North})
        {
            Result<Raster<float>> read = source.readLevel(far, axis, made.posts);
            if (!read)
                return read.error();
            made.heights[axis == CrestAxis::East ? 0 : 1] = std::move(*read);
        }
        made.eastSpacings = spacingsOf(source, far, level, made.posts);
        covered = made.posts.finer(made.level);
        windows->levels.push_back(std::move(made));
    }
    return std::shared_ptr<const TileWindows>(windows);
}

std::shared_ptr<const TileWindows> withLitMargin(const TileWindows& windows, int posts)
{
    auto larger = std::make_shared<TileWindows>(windows);
    larger->place = windows.place.grownBy(posts).clippedTo(windows.near);
    larger->tile = tileOf(*larger, windows.tile.northSpacing, windows.tile.heightOrigin);
    return larger;
}

} // namespace osgTerrainLight
