#include "core/Reach.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace osgTerrainLight
{
namespace
{
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double pi = 3.14159265358979323846;
constexpr double radians = pi / 180.0;

/// How far beside a receiver its line of the sweep may lie, where far hulls are shared [posts].
constexpr double besideRay = 2.0;

bool meet(const PostRect& a, const PostRect& b)
{
    return !a.clippedTo(b).empty();
}

/// Of every code ≥ levelCode: the slope from which on terrain counts. It is what the lowest
/// elevation of the code allows for, less the tolerance; but what stands no higher than the
/// tolerance above the horizontal changes nothing by more than it.
std::vector<double> slopesOfCodes()
{
    const double least = std::tan(Reach::tolerance * radians);
    std::vector<double> slopes(65536 - HorizonMap::levelCode);
    for (std::size_t i = 0; i < slopes.size(); ++i)
    {
        const double elevation = (static_cast<double>(i) - 0.5) * (90.0 / 32767.0);
        slopes[i] = std::max(std::tan(elevation * radians) - least, least);
    }
    return slopes;
}

struct Point
{
    double x, y;
};

double cross(const Point& a, const Point& b)
{
    return a.x * b.y - a.y * b.x;
}

/// A convex polygon; a rectangle cut by the two sides of a sector has at most 6 corners.
struct Polygon
{
    std::array<Point, 8> corners;
    int count = 0;

    void add(const Point& corner) { corners[static_cast<std::size_t>(count++)] = corner; }
    const Point& at(int i) const { return corners[static_cast<std::size_t>(i % count)]; }

    /// What is to the left of a line through the origin.
    Polygon leftOf(const Point& line) const
    {
        Polygon kept;
        for (int i = 0; i < count; ++i)
        {
            const Point& a = at(i);
            const Point& b = at(i + 1);
            const double sideA = cross(line, a);
            const double sideB = cross(line, b);
            if (sideA >= 0.0)
                kept.add(a);
            if ((sideA < 0.0) != (sideB < 0.0))
            {
                const double part = sideA / (sideA - sideB);
                kept.add({a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)});
            }
        }
        return kept;
    }

    /// Whether the origin is inside or on the edge.
    bool hasOrigin() const
    {
        for (int i = 0; i < count; ++i)
            if (cross(at(i), at(i + 1)) < 0.0)
                return false;
        return true;
    }

    /// The least part along a direction of any point.
    double least(const MapDirection& direction) const
    {
        double least = infinity;
        for (int i = 0; i < count; ++i)
            least = std::min(least, at(i).x * direction.east + at(i).y * direction.north);
        return least;
    }

    /// The least distance from the origin to any point.
    double nearest() const
    {
        if (hasOrigin())
            return 0.0;
        double least = infinity;
        for (int i = 0; i < count; ++i)
        {
            const Point& a = at(i);
            const Point edge{at(i + 1).x - a.x, at(i + 1).y - a.y};
            const double length = edge.x * edge.x + edge.y * edge.y;
            const double part =
                length > 0.0 ? std::clamp(-(a.x * edge.x + a.y * edge.y) / length, 0.0, 1.0) : 0.0;
            least = std::min(least, std::hypot(a.x + part * edge.x, a.y + part * edge.y));
        }
        return least;
    }
};

int floorShifted(int value, int levels)
{
    return static_cast<int>(std::floor(std::ldexp(value, -levels)));
}
} // namespace

double TerrainEdit::top(int level) const
{
    assert(!tops.empty() && level >= 0);
    return tops[std::min(static_cast<std::size_t>(level), tops.size() - 1)];
}

TerrainEdit TerrainEdit::coarsened(int levels) const
{
    assert(levels >= 0);
    if (levels == 0 || posts.empty())
        return *this;
    // A coarse post stands for what is at most half a step around it, that included.
    const int half = 1 << (levels - 1);
    TerrainEdit coarse;
    coarse.posts.column = -floorShifted(-(posts.column - half), levels);
    coarse.posts.row = -floorShifted(-(posts.row - half), levels);
    coarse.posts.width =
        floorShifted(posts.endColumn() - 1 + half, levels) + 1 - coarse.posts.column;
    coarse.posts.height = floorShifted(posts.endRow() - 1 + half, levels) + 1 - coarse.posts.row;
    // 2^(k+1) coarse posts and what both ends stand for: less than twice as far.
    coarse.tops.clear();
    const int last = static_cast<int>(tops.size()) - 1;
    for (int level = levels + 1; level <= std::max(last, levels + 1); ++level)
        coarse.tops.push_back(top(level));
    return coarse;
}

TerrainEdit terrainEdit(const PostRect& changed, const PostRect& area, const Raster<float>& before,
                        const Raster<float>& after)
{
    assert(before.width() == area.width && before.height() == area.height);
    assert(after.width() == area.width && after.height() == area.height);
    TerrainEdit edit;
    edit.posts = changed;
    const auto outside = [](int at, int first, int end) {
        return std::max({first - at, at - (end - 1), 0});
    };
    for (int j = 0; j < area.height; ++j)
        for (int i = 0; i < area.width; ++i)
        {
            const int away = std::max(outside(area.column + i, changed.column, changed.endColumn()),
                                      outside(area.row + j, changed.row, changed.endRow()));
            std::size_t level = 0;
            while ((2 << level) < away)
                ++level;
            if (level >= edit.tops.size())
                edit.tops.resize(level + 1, -infinity);
            // A comparison with NaN is false.
            for (const double height : {double(before.at(i, j)), double(after.at(i, j))})
                if (height > edit.tops[level])
                    edit.tops[level] = height;
        }
    for (std::size_t level = 1; level < edit.tops.size(); ++level)
        edit.tops[level] = std::max(edit.tops[level], edit.tops[level - 1]);
    return edit;
}

Reach::Reach(const DemTile& tile, const PostRect& place, const HorizonMap& horizons,
             const ReachScheme& scheme)
    : _place(place), _scheme(scheme), _eastSpacing(tile.nominalEastSpacing()),
      _northSpacing(tile.northSpacing)
{
    assert(tile.width() == place.width && tile.height() == place.height);
    assert(horizons.width() == place.width && horizons.height() == place.height);
    assert(scheme.ring >= 1 && scheme.farRing >= 4 && scheme.always >= 1);
    for (const double spacing : tile.eastSpacings)
        _leastRatio = std::min(_leastRatio, spacing / _eastSpacing);
    if (tile.validCount() == 0)
        return;

    _azimuthCount = horizons.azimuthCount();
    _lowest = infinity;
    for (std::size_t i = 0; i < tile.postCount(); ++i)
        if (tile.validity()[i])
            _lowest = std::min(_lowest, double(tile.heights()[i]));

    static const std::vector<double> slopes = slopesOfCodes();
    _above.reserve(static_cast<std::size_t>(_azimuthCount) * distanceCount);
    const AzimuthSet azimuths(_azimuthCount);
    for (int azimuth = 0; azimuth < _azimuthCount; ++azimuth)
    {
        const MapDirection ray = azimuths.direction(azimuth);
        const double first = firstDistance(ray);
        std::array<double, distanceCount> least;
        least.fill(infinity);
        for (int row = 0; row < place.height; ++row)
            for (int column = 0; column < place.width; ++column)
            {
                if (!tile.isValid(column, row))
                    continue;
                // Codes below the horizontal count as level, and so does that of a void.
                const int code = horizons.codeAt(column, row, azimuth);
                const double slope =
                    _leastRatio *
                    slopes[static_cast<std::size_t>(std::max(0, code - HorizonMap::levelCode))];
                const double above = double(tile.heightAt(column, row)) - _lowest;
                const double ahead = ray.east * _eastSpacing * (column - 0.5 * (place.width - 1)) +
                                     ray.north * _northSpacing * (row - 0.5 * (place.height - 1));
                double distance = first;
                for (double& bound : least)
                {
                    bound = std::min(bound, above + std::max(0.0, distance - ahead) * slope);
                    distance *= 2.0;
                }
            }
        for (const double bound : least)
            _above.push_back(std::nextafter(static_cast<float>(bound), -1.0f));
    }
}

std::size_t Reach::bytes() const
{
    return sizeof(*this) + _above.capacity() * sizeof(float);
}

/// How far the tile extends from its middle in a direction [m].
double Reach::extent(const MapDirection& direction) const
{
    return 0.5 * (std::abs(direction.east) * _eastSpacing * (_place.width - 1) +
                  std::abs(direction.north) * _northSpacing * (_place.height - 1));
}

/// The first of the distances that bounds are kept for: beyond all posts [m].
double Reach::firstDistance(const MapDirection& direction) const
{
    return std::max({extent(direction), _eastSpacing, _northSpacing});
}

/// A lower bound of what must be topped [m above the lowest post], so many first distances from
/// the middle.
double Reach::bound(int azimuth, double distances) const
{
    if (distances < 1.0)
        return 0.0;
    const float* above = &_above[static_cast<std::size_t>(azimuth) * distanceCount];
    int i = 0;
    while (i + 1 < distanceCount && distances > std::ldexp(2.0, i))
        ++i;
    const double first = double(above[i]);
    if (i + 1 == distanceCount)
        return first; // it grows with the distance
    return first + (double(above[i + 1]) - first) * (std::ldexp(distances, -i) - 1.0);
}

/// The coarsest level that sees any change of these posts.
int Reach::levelOf(const PostRect& posts) const
{
    const double away =
        std::max({_place.column - posts.column, posts.endColumn() - _place.endColumn(),
                  _place.row - posts.row, posts.endRow() - _place.endRow(), 0});
    // With 3 of its cells to spare, no coarser post that the edit spreads to is beyond the window.
    int level = 0;
    while (level < 30 && away + std::ldexp(3.0, level) >
                             _scheme.ring + _scheme.farRing * (std::ldexp(2.0, level) - 2.0))
        ++level;
    return level;
}

bool Reach::isReached(const TerrainEdit& edit) const
{
    if (edit.posts.empty())
        return false;
    if (meet(_place, edit.posts))
        return true;
    if (_azimuthCount == 0)
        return false;
    if (meet(_place.grownBy(_scheme.always), edit.posts))
        return true;

    const int level = levelOf(edit.posts);
    const double top = edit.top(level) - _lowest;
    if (!(top > 0.0))
        return false;
    // From a tile's post to where the surface changed, any two of them [m].
    const double grown = std::ldexp(1.5, level) + (level > 0 ? besideRay : 0.0);
    const double west = (edit.posts.column - grown - (_place.endColumn() - 1)) * _eastSpacing;
    const double east = (edit.posts.endColumn() - 1 + grown - _place.column) * _eastSpacing;
    const double south = (edit.posts.row - grown - (_place.endRow() - 1)) * _northSpacing;
    const double north = (edit.posts.endRow() - 1 + grown - _place.row) * _northSpacing;
    Polygon box;
    box.add({west, south});
    box.add({east, south});
    box.add({east, north});
    box.add({west, north});

    const AzimuthSet azimuths(_azimuthCount);
    const double half = pi / _azimuthCount * (1.0 + 1e-9);
    const double sine = std::sin(half);
    const double cosine = std::cos(half);
    for (int azimuth = 0; azimuth < _azimuthCount; ++azimuth)
    {
        const MapDirection middle = azimuths.direction(azimuth);
        const Point right{middle.east * cosine + middle.north * sine,
                          middle.north * cosine - middle.east * sine};
        const Point left{middle.east * cosine - middle.north * sine,
                         middle.north * cosine + middle.east * sine};
        const Polygon seen = box.leftOf(right).leftOf({-left.x, -left.y});
        if (seen.count == 0)
            continue;
        // From the tile's middle along the azimuth: to all of the box, and to what is seen of it.
        const double ahead =
            std::max(box.least(middle) + extent(middle), seen.least(middle) - extent(middle));
        const double nearest = seen.nearest() * _leastRatio;
        const double sink =
            _scheme.bodyRadius > 0.0 ? nearest * nearest / (2.0 * _scheme.bodyRadius) : 0.0;
        // Directions beside the azimuth go farther to as much ahead, and the bound grows with it.
        if (top - sink > bound(azimuth, ahead / firstDistance(middle)))
            return true;
    }
    return false;
}

} // namespace osgTerrainLight
