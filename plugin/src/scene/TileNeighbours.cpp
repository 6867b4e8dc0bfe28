#include "scene/TileNeighbours.h"

#include "core/Reach.h"
#include "io/GroundSpacing.h"
#include "lighting/TileWindows.h"

#include <osg/Math>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

namespace osgTerrainLight
{

namespace
{
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Of a post, −∞ where it is void [m above the map's 0].
double heightOf(const TerrainPatch& patch, int column, int row)
{
    const DemTile& dem = *patch.dem;
    return dem.isValid(column, row)
               ? static_cast<double>(dem.heightAt(column, row)) + dem.heightOrigin + patch.lift
               : -infinity;
}

/// Between two ranges; 0 where they meet.
double gap(double first, double last, double otherFirst, double otherLast)
{
    return std::max({0.0, otherFirst - last, first - otherLast});
}

bool isLaidOutAs(const PlacedGround& a, const PlacedGround& b)
{
    const TerrainPatch& p = a.patch;
    const TerrainPatch& q = b.patch;
    return a.isOnMapOf(b) && p.west == q.west && p.south == q.south && p.eastStep == q.eastStep &&
           p.northStep == q.northStep && p.dem->width() == q.dem->width() &&
           p.dem->height() == q.dem->height();
}

/// Edges that meet within half a post of the finer one, or rectangles that overlap.
bool doTouch(const TerrainPatch& a, const TerrainPatch& b)
{
    return gap(a.west, a.east(), b.west, b.east()) < 0.5 * std::min(a.eastStep, b.eastStep) &&
           gap(a.south, a.north(), b.south, b.north()) < 0.5 * std::min(a.northStep, b.northStep);
}
} // namespace

TileNeighbours::Tile TileNeighbours::measured(const PlacedGround& ground)
{
    Tile tile{ground, infinity, -infinity};
    const DemTile& dem = *ground.patch.dem;
    for (int row = 0; row < dem.height(); ++row)
        for (int column = 0; column < dem.width(); ++column)
            if (dem.isValid(column, row))
            {
                const double height = heightOf(ground.patch, column, row);
                tile.lowest = std::min(tile.lowest, height);
                tile.highest = std::max(tile.highest, height);
            }
    return tile;
}

TileNeighbours::Change TileNeighbours::whole(const Tile& tile)
{
    const TerrainPatch& patch = tile.ground.patch;
    return {tile.ground, patch.west, patch.south, patch.east(), patch.north(), tile.highest};
}

/// None where all heights are as they were. The top is that of all of the tile: coarse posts mix
/// what has changed with what is beside it.
std::optional<TileNeighbours::Change> TileNeighbours::between(const Tile& before, const Tile& after)
{
    Change change = whole(after);
    change.top = std::max(before.highest, after.highest);
    const TerrainPatch& patch = after.ground.patch;
    if (!isLaidOutAs(before.ground, after.ground))
    {
        const Change gone = whole(before);
        change.west = std::min(change.west, gone.west);
        change.south = std::min(change.south, gone.south);
        change.east = std::max(change.east, gone.east);
        change.north = std::max(change.north, gone.north);
        return change;
    }
    PostRect posts;
    for (int row = 0; row < patch.dem->height(); ++row)
        for (int column = 0; column < patch.dem->width(); ++column)
            if (heightOf(before.ground.patch, column, row) != heightOf(patch, column, row))
                posts = posts.joinedWith({column, row, 1, 1});
    if (posts.empty())
        return std::nullopt;
    change.west = patch.west + posts.column * patch.eastStep;
    change.south = patch.south + posts.row * patch.northStep;
    change.east = change.west + (posts.width - 1) * patch.eastStep;
    change.north = change.south + (posts.height - 1) * patch.northStep;
    return change;
}

void TileNeighbours::set(const TileHandle& handle, const PlacedGround& ground)
{
    Tile now = measured(ground);
    const auto known = _tiles.find(handle);
    const std::optional<Change> change =
        known == _tiles.end() ? whole(now) : between(known->second, now);
    if (!change)
        return;
    if (known != _tiles.end())
    {
        now.surrounded = known->second.surrounded;
        if (!ground.isOnMapOf(known->second.ground))
            mark(handle, whole(known->second)); // it has left another map
    }
    _tiles[handle] = now;
    mark(handle, *change);
}

void TileNeighbours::remove(const TileHandle& handle)
{
    const auto known = _tiles.find(handle);
    _stale.erase(handle);
    if (known == _tiles.end())
        return;
    const Change change = whole(known->second);
    _tiles.erase(known);
    mark(handle, change);
}

void TileNeighbours::mark(const TileHandle& changed, const Change& change)
{
    for (const auto& [handle, tile] : _tiles)
        if (!(handle == changed) && tile.ground.isOnMapOf(change.ground) &&
            isReached(tile, change) && !isHidden(tile, changed, change) &&
            (tile.surrounded || touchesAny(handle, tile)))
            _stale.insert(handle);
}

void TileNeighbours::setBase(std::optional<BaseGround> base, const std::string& crs)
{
    for (const auto& [handle, tile] : _tiles)
        if (hasBase(tile) || (base && tile.ground.crs == crs))
            _stale.insert(handle);
    _base = std::move(base);
    _baseCrs = crs;
}

void TileNeighbours::changeBase(double west, double south, double east, double north, double top)
{
    for (const auto& [handle, tile] : _tiles)
        if (hasBase(tile) && isReached(tile, {tile.ground, west, south, east, north, top}))
            _stale.insert(handle);
}

bool TileNeighbours::isReached(const Tile& tile, const Change& change)
{
    // Coarse posts, one of 64 between a tile and what they show, spread a change over 1.5 of them.
    constexpr double nearer = 1.0 - 1.5 / 64.0;
    const TerrainPatch& patch = tile.ground.patch;
    const double east =
        nearer * gap(patch.west, patch.east(), change.west, change.east) / patch.eastStep;
    const double north =
        nearer * gap(patch.south, patch.north(), change.south, change.north) / patch.northStep;
    if (std::max(east, north) <= ReachScheme().always)
        return true;
    const double distance =
        std::hypot(east * patch.dem->nominalEastSpacing(), north * patch.dem->northSpacing);
    return change.top - tile.lowest > distance * std::tan(osg::DegreesToRadians(Reach::tolerance));
}

/// Whether the tile sees other ground where finer ground has changed.
bool TileNeighbours::isHidden(const Tile& tile, const TileHandle& changed,
                              const Change& change) const
{
    if (!change.ground.patch.isFinerThan(tile.ground.patch))
        return false;
    return std::any_of(
        _tiles.begin(), _tiles.end(),
        [&](const auto& each)
        {
            const TerrainPatch& patch = each.second.ground.patch;
            const double slack = 1.0e-3 * patch.eastStep;
            return !(each.first == changed) && each.second.ground.isOnMapOf(change.ground) &&
                   !patch.isFinerThan(tile.ground.patch) && patch.west <= change.west + slack &&
                   patch.south <= change.south + slack && patch.east() >= change.east - slack &&
                   patch.north() >= change.north - slack;
        });
}

bool TileNeighbours::touchesAny(const TileHandle& handle, const Tile& tile) const
{
    return std::any_of(_tiles.begin(), _tiles.end(),
                       [&](const auto& each)
                       {
                           return !(each.first == handle) &&
                                  each.second.ground.isOnMapOf(tile.ground) &&
                                  doTouch(each.second.ground.patch, tile.ground.patch);
                       });
}

std::optional<TileHandle> TileNeighbours::takeStale()
{
    if (_stale.empty())
        return std::nullopt;
    const TileHandle handle = *_stale.begin();
    _stale.erase(_stale.begin());
    return handle;
}

std::shared_ptr<const TileWindows> TileNeighbours::around(const TileHandle& handle,
                                                          HorizonQuality quality)
{
    _stale.erase(handle);
    const auto known = _tiles.find(handle);
    if (known == _tiles.end())
        return nullptr;
    Tile& tile = known->second;
    tile.surrounded = hasBase(tile) || touchesAny(handle, tile);
    if (!tile.surrounded)
        return nullptr;
    const PlacedGround& ground = tile.ground;
    std::vector<TerrainPatch> patches;
    for (const auto& [other, each] : _tiles)
        if (!(other == handle) && each.ground.isOnMapOf(ground))
            patches.push_back(each.ground.patch);
    std::function<double(double)> eastMetres;
    if (ground.semiMajor > 0.0)
        eastMetres = [a = ground.semiMajor, b = ground.semiMinor](double latitude)
        {
            const double most = 0.5 * osg::PI;
            return metresPerRadian(std::clamp(latitude, -most, most), a, b).east;
        };
    else if (ground.patch.dem->eastSpacings.size() > 1)
        eastMetres = [patch = ground.patch](double northing)
        {
            // Beyond the tile the nearest row's.
            const double row = std::round((northing - patch.south) / patch.northStep);
            const auto last = static_cast<double>(patch.dem->height() - 1);
            return patch.dem->eastSpacing(static_cast<int>(std::clamp(row, 0.0, last))) /
                   patch.eastStep;
        };
    PatchSource source(ground.patch, std::move(patches), std::move(eastMetres),
                       hasBase(tile) ? _base : std::nullopt);
    // Reads of memory do not fail.
    const auto windows = readWindows(source, 0, source.place(), quality);
    return windows ? *windows : nullptr;
}

} // namespace osgTerrainLight
