#include "support/HardCase.h"

#include "support/FramedHeights.h"

#include "core/Raster.h"
#include "io/DemReader.h"
#include "lighting/TileLight.h"
#include "lighting/nodes/HorizonNode.h"
#include "support/Precisions.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <sstream>
#include <utility>

namespace osgTerrainLight::hard
{

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double radian = 180.0 / pi; // degrees
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double u = roundoff<float>;

/// Of an elevation on its way through a code [degrees]: half a code, the arc tangent's polynomial
/// (2e-8 rad) and a few roundings of it and of the 32767 steps.
constexpr double codeSlack = 45.0 / 32767.0 + 5e-5;
/// elevationOfCode in float [rad]: code and product are rounded at 65535.
constexpr double decodeError = 2.0 * 65536.0 * u * (0.5 * pi / 32767.0);
/// Absolute error of a GPU's sine and cosine within a turn: special-function units keep 21 bits.
constexpr double trigonometry = 1.0 / (1 << 19);

/// Values that should lie in an interval: counts those that do not, keeps the worst.
class Tally
{
public:
    explicit Tally(std::string what) : _what(std::move(what)) {}

    template <class Where>
    void take(double value, double low, double high, const Where& where)
    {
        if (value >= low && value <= high)
            return;
        const double excess = std::isnan(value) ? infinity : std::max(low - value, value - high);
        if (++_count == 1 || excess > _worst)
        {
            std::ostringstream text;
            text << value << ", allowed " << low << " to " << high << ", " << where();
            _worst = excess;
            _text = text.str();
        }
    }

    void report() const
    {
        if (_count > 0)
            ADD_FAILURE() << _what << ": " << _count << " out of bounds, worst " << _text;
    }

private:
    std::string _what;
    std::size_t _count = 0;
    double _worst = 0.0;
    std::string _text;
};

/// Unit vector at an angle [rad] counter-clockwise from east; 0 where an axis has it. Not the
/// library's own conversion, which is under test.
MapDirection directionAt(double angle)
{
    const auto snapped = [](double v) { return std::abs(v) < 1e-12 ? 0.0 : v; };
    return {snapped(std::cos(angle)), snapped(std::sin(angle))};
}

MapDirection directionOfIndex(int index, int count)
{
    return directionAt(2.0 * pi * index / count);
}

/// H, V and D of a tile (HardCase.h), D per axis.
struct Relief
{
    explicit Relief(const DemTile& tile)
    {
        double lowest = infinity;
        highest = -infinity;
        const auto step = [&](int x, int y, int toX, int toY)
        {
            return toX < tile.width() && toY < tile.height() && tile.isValid(toX, toY)
                       ? std::abs(double(tile.heightAt(toX, toY)) - double(tile.heightAt(x, y)))
                       : 0.0;
        };
        for (int y = 0; y < tile.height(); ++y)
            for (int x = 0; x < tile.width(); ++x)
            {
                if (!tile.isValid(x, y))
                {
                    voids = true;
                    continue;
                }
                const double z = double(tile.heightAt(x, y));
                lowest = std::min(lowest, z);
                highest = std::max(highest, z);
                east = std::max(east, step(x, y, x + 1, y));
                north = std::max(north, step(x, y, x, y + 1));
            }
        size = std::max(std::abs(lowest), std::abs(highest));
        range = highest - lowest;
    }

    double rounding(double slope, int reach) const
    {
        constexpr double underflow = 2.2e-19;
        return underflow +
               u * (3.0 * size + 3.0 * range + (15.0 + 30.0 * reach) * std::max(east, north) +
                    12.0 * std::abs(slope));
    }

    double highest = 0.0, size = 0.0, range = 0.0, east = 0.0, north = 0.0;
    bool voids = false;
};

/// A ray in posts: along its major axis, drifting by `tangent` per step along its minor axis.
struct GridRay
{
    GridRay(const DemTile& tile, int column, int row, const MapDirection& direction)
        : _tile(tile), _column(column), _row(row)
    {
        const double x = direction.east / tile.nominalEastSpacing();
        const double y = direction.north / tile.northSpacing;
        north = std::abs(y) > std::abs(x);
        tangent = north ? std::abs(x / y) : std::abs(y / x);
        step = north ? std::hypot(tangent * tile.eastSpacing(row), tile.northSpacing)
                     : std::hypot(tile.eastSpacing(row), tangent * tile.northSpacing);
        _majorSign = (north ? y : x) < 0.0 ? -1 : 1;
        _minorSign = (north ? x : y) < 0.0 ? -1 : 1;
    }

    /// Steps to the edge of the data along the major axis.
    int steps() const
    {
        return north ? (_majorSign > 0 ? _tile.height() - 1 - _row : _row)
                     : (_majorSign > 0 ? _tile.width() - 1 - _column : _column);
    }

    bool valid(int along, int across) const
    {
        const int x = _column + (north ? _minorSign * across : _majorSign * along);
        const int y = _row + (north ? _majorSign * along : _minorSign * across);
        return x >= 0 && y >= 0 && x < _tile.width() && y < _tile.height() && _tile.isValid(x, y);
    }

    bool throughPosts() const { return tangent < 1e-9 || std::abs(tangent - 1.0) < 1e-9; }

    /// Whether the surface stands where the ray crosses a column.
    bool crosses(int along) const
    {
        const double offset = tangent * along;
        const int whole = static_cast<int>(std::floor(offset + 1e-9));
        return valid(along, whole) && (offset - whole < 1e-9 || valid(along, whole + 1));
    }

    /// Whether a line up to half a post aside has data from the receiver to the tile's far edge.
    bool clear(bool voids) const
    {
        for (int s = voids ? 0 : steps(); s <= steps(); ++s)
        {
            const int whole = static_cast<int>(std::floor(tangent * s));
            for (int across = whole - 1; across <= whole + 2; ++across)
                if (!valid(s, across))
                    return false;
        }
        return valid(0, -1) && valid(0, 2);
    }

    bool north = false;
    double tangent = 0.0;
    double step = 1.0; ///< [m]

private:
    const DemTile& _tile;
    int _column, _row;
    int _majorSign, _minorSign;
};

/// What a horizon may be [degrees].
struct Allowed
{
    double low = -90.0, high = 90.0;
    bool twoSided = false;
};

/// How much eight strips across a disc differ from its segment over a straight horizon, at most.
double stripDefect()
{
    double worst = 0.0;
    for (int k = -1000; k <= 1000; ++k)
    {
        double strips = 0.0;
        for (int i = 0; i < 8; ++i)
        {
            const double half = std::sin(pi * (i + 0.5) / 8.0);
            strips += half * half / 4.0 * std::clamp(0.5 + 0.0005 * k / half, 0.0, 1.0);
        }
        worst = std::max(worst, std::abs(strips - reference::segmentFraction(0.001 * k, 0.0, 1.0)));
    }
    return worst;
}

Allowed allowedHorizon(const HardCase& hardCase, const Relief& relief, int column, int row,
                       const MapDirection& direction, const reference::Horizon& expected,
                       const HorizonScheme& scheme)
{
    const DemTile& tile = hardCase.tile;
    const GridRay ray(tile, column, row, direction);
    const auto elevation = [&](double slope) { return std::atan(slope / ray.step) * radian; };
    const double slope = expected.slope * ray.step;
    const double rounding = std::isfinite(slope) ? relief.rounding(slope, scheme.reach) : 0.0;
    const double place = expected.distance / ray.step;
    const double farthest = scheme.reach + 1.0;

    Allowed allowed;
    const bool clear = ray.clear(relief.voids);
    double above = slope + rounding;
    if (relief.voids && !clear && !ray.throughPosts())
        above = std::max(above, (relief.highest - double(tile.heightAt(column, row))) / farthest +
                                    rounding);
    // Code 1 is -90 degrees exactly.
    allowed.high = std::isfinite(above) ? std::min(90.0, elevation(above) + codeSlack) : -90.0;
    if (!std::isfinite(slope))
        return allowed;

    double loss = 0.0;
    if (place > scheme.reach)
    {
        double sampling = infinity;
        int from = 0;
        for (int c : {static_cast<int>(std::floor(place + 1e-9)),
                      static_cast<int>(std::ceil(place - 1e-9))})
        {
            const double w = std::abs(place - c);
            const bool onto = w < 1e-9;
            if (c < 1 || (relief.voids && !clear && !onto) || !ray.crosses(c))
                continue;
            const double major = ray.north ? relief.north : relief.east;
            const double minor = ray.north ? relief.east : relief.north;
            const double lost =
                onto ? 0.0 : w * (major + ray.tangent * minor + std::abs(slope)) / c;
            if (lost < sampling)
            {
                sampling = lost;
                from = c;
            }
        }
        loss = sampling;
        if (from > scheme.reach || !std::isfinite(sampling))
        {
            if ((!clear && !ray.throughPosts()) || hardCase.hullOverflows)
                return allowed;
            const double beside = ray.throughPosts() ? 0.0 : 0.5 / scheme.linesPerPost;
            const double minor = ray.north ? relief.east : relief.north;
            loss += beside * minor * (1.0 / std::max(from, 1) + 1.0 / farthest);
            loss += 6.0 * std::max(tile.width(), tile.height()) * u * relief.range / farthest;
        }
    }
    if (!std::isfinite(loss))
        return allowed;
    allowed.twoSided = true;
    allowed.low = std::max(-90.0, elevation(slope - loss - rounding) - codeSlack);
    return allowed;
}

/// Sky-view factor to the normal of horizons that are constant over each slice [degrees]: Gauss's
/// three nodes in azimuth, in elevation the integral of (nh cos e + nz sin e) cos e. As the method
/// says, the surface's own plane cuts a slice at its centre.
double skyViewOf(const std::vector<double>& elevations, const reference::Vector3& normal)
{
    const double width = 2.0 * pi / static_cast<double>(elevations.size());
    const double node = 0.5 * width * std::sqrt(0.6);
    double sum = 0.0;
    for (std::size_t k = 0; k < elevations.size(); ++k)
    {
        const double azimuth = width * static_cast<double>(k);
        const auto along = [&](double at)
        { return normal[0] * std::cos(at) + normal[1] * std::sin(at); };
        const double a =
            std::max({elevations[k] / radian, 0.0, -std::atan2(along(azimuth), normal[2])});
        const double horizontal = 0.5 * (pi / 2.0 - a - std::sin(a) * std::cos(a));
        const double vertical = 0.5 * std::cos(a) * std::cos(a);
        const double mean =
            (5.0 * along(azimuth - node) + 8.0 * along(azimuth) + 5.0 * along(azimuth + node)) /
            18.0;
        sum += width * (mean * horizontal + normal[2] * vertical);
    }
    return sum / pi;
}

/// As far as a block of eight rays of eight steps reads beyond the tile.
constexpr int frame = 20;

/// How far rounding may move a normal. Each of up to four differences and their sum take four
/// roundings, products one more, the root and quotient of normalize five: u(6K + 5), where the
/// condition number K is the sum of the terms' sizes over the sum's own length.
double normalRounding(const DemTile& tile, int column, int row)
{
    const auto height = [&](int x, int y, double& z)
    {
        const bool there =
            x >= 0 && y >= 0 && x < tile.width() && y < tile.height() && tile.isValid(x, y);
        z = there ? double(tile.heightAt(x, y)) : 0.0;
        return there;
    };
    const double here = double(tile.heightAt(column, row));
    const double eastStep = tile.eastSpacing(row), northStep = tile.northSpacing;
    double terms = 0.0, east = 0.0, north = 0.0, up = 0.0;
    for (int dy : {-1, 1})
        for (int dx : {-1, 1})
        {
            double besideX = 0.0, besideY = 0.0, across = 0.0;
            if (!height(column + dx, row, besideX) || !height(column, row + dy, besideY) ||
                !height(column + dx, row + dy, across))
                continue;
            east += dx * (besideX - here) * northStep;
            north += dy * (besideY - here) * eastStep;
            up += eastStep * northStep;
            terms += std::abs(besideX - here) * northStep + std::abs(besideY - here) * eastStep +
                     eastStep * northStep;
        }
    const double length = std::sqrt(east * east + north * north + up * up);
    return u * (5.0 + (length > 0.0 ? 6.0 * terms / length : 0.0));
}

/// (c): the shared functions in float against double, on this tile's own heights.
class Conditioning
{
public:
    Conditioning(const HardCase& hardCase, const Relief& relief)
        : _name(hardCase.name), _tile(hardCase.tile), _relief(relief),
          _heights(framedHeights<float>(_tile, frame)), _exact(framedHeights<double>(_tile, frame)),
          _near(_name + ", nearHorizon in float"), _normals(_name + ", postNormal in float"),
          _slices(_name + ", skySlice in float"), _discs(_name + ", visibleDiscFraction in float"),
          _angles(_name + ", elevationOfSlope in float")
    {
    }

    void check()
    {
        nearHorizons();
        for (int y = 0; y < _tile.height(); ++y)
            for (int x = 0; x < _tile.width(); ++x)
                if (_tile.isValid(x, y))
                    lightOfPost(x, y);
        for (const Tally* tally : {&_near, &_normals, &_slices, &_discs, &_angles})
            tally->report();
        std::printf("%-26s float against double, near horizon: %.2f of its bound\n", _name.c_str(),
                    _worstNear);
    }

private:
    static auto at(int x, int y)
    {
        return [x, y] { return "post " + std::to_string(x) + ' ' + std::to_string(y); };
    }

    void nearHorizons()
    {
        for (const bool north : {false, true})
            // No ray of these passes a post so closely that float and double could disagree on its
            // side.
            for (const float tangent : {0.0f, 1.0f, 0.5f, 0.6180339f})
                for (int block = 0; block < (north ? _tile.width() : _tile.height()); block += 8)
                    for (int i = 0; i < (north ? _tile.height() : _tile.width()); ++i)
                        nearHorizonOfBlock(north ? glm::ivec2(block, i) : glm::ivec2(i, block),
                                           north, tangent);
    }

    void nearHorizonOfBlock(const glm::ivec2& first, bool north, float tangent)
    {
        constexpr double nothing = -1e9; // slopes below: a void, or nothing ahead
        constexpr int reach = 8;
        const glm::ivec2 major = north ? glm::ivec2(0, -1) : glm::ivec2(1, 0);
        const glm::ivec2 minor = north ? glm::ivec2(1, 0) : glm::ivec2(0, 1);
        const auto found =
            _single.nearHorizon(_heights, {first + frame, major, minor, tangent}, reach);
        const auto expected = _twofold.nearHorizon(
            _exact, {first + frame, major, minor, static_cast<double>(tangent)}, reach);
        for (int k = 0; k < 8; ++k)
        {
            const glm::ivec2 post = first + minor * k;
            if (post.x >= _tile.width() || post.y >= _tile.height() ||
                !_tile.isValid(post.x, post.y))
                continue;
            const double a = static_cast<double>(found.slopes[k]);
            const double b = expected.slopes[k];
            if (a < nothing && b < nothing)
                continue;
            const double bound = _relief.rounding(b, reach);
            _near.take(a, b - bound, b + bound, at(post.x, post.y));
            _worstNear = std::max(_worstNear, std::abs(a - b) / bound);
        }
    }

    /// What the light of a post is made of, with the slope of its steepest neighbour for its
    /// horizons.
    void lightOfPost(int x, int y)
    {
        const glm::ivec2 post(x + frame, y + frame);
        const float eastStep = static_cast<float>(_tile.eastSpacing(y));
        const float northStep = static_cast<float>(_tile.northSpacing);
        const glm::vec3 normal = _single.postNormal(_heights, post, eastStep, northStep);
        const glm::dvec3 exactNormal = _twofold.postNormal(
            _exact, post, static_cast<double>(eastStep), static_cast<double>(northStep));
        const double bound = normalRounding(_tile, x, y);
        for (int i = 0; i < 3; ++i)
            _normals.take(static_cast<double>(normal[i]), exactNormal[i] - bound,
                          exactNormal[i] + bound, at(x, y));

        const float slope = steepest(post, eastStep, northStep);
        const float elevation = _single.elevationOfSlope(slope);
        const double steep = std::atan(static_cast<double>(slope));
        // The polynomial, and four roundings of up to 90 degrees.
        const double arc = 2e-8 + 4.0 * u * (pi / 2.0);
        _angles.take(static_cast<double>(elevation), steep - arc, steep + arc, at(x, y));
        skySlices(x, y, normal, elevation);
        sunDiscs(x, y, elevation);
    }

    /// Greatest slope to one of a texel's four neighbours, at least -1.
    float steepest(const glm::ivec2& post, float eastStep, float northStep)
    {
        float slope = -1.0f;
        for (const glm::ivec2 to :
             {glm::ivec2(1, 0), glm::ivec2(-1, 0), glm::ivec2(0, 1), glm::ivec2(0, -1)})
        {
            const float beside = _heights.at(post.x + to.x, post.y + to.y);
            if (!_single.isVoid(beside))
                slope = std::max(slope, (beside - _heights.at(post.x, post.y)) /
                                            (to.x != 0 ? eastStep : northStep));
        }
        return slope;
    }

    void skySlices(int x, int y, const glm::vec3& normal, float elevation)
    {
        // The terms of a slice are at most width/2 and width·pi/2; 16 roundings.
        const float width = static_cast<float>(2.0 * pi / 16.0);
        const double bound = static_cast<double>(width) * 16.0 * u;
        const float cosine = std::cos(1.0f), sine = std::sin(1.0f);
        for (int definition : {0, 1, 2})
        {
            const double expected = _twofold.skySlice(
                static_cast<double>(elevation), glm::dvec3(normal), static_cast<double>(cosine),
                static_cast<double>(sine), static_cast<double>(width), definition);
            _slices.take(static_cast<double>(
                             _single.skySlice(elevation, normal, cosine, sine, width, definition)),
                         expected - bound, expected + bound, at(x, y));
        }
    }

    void sunDiscs(int x, int y, float elevation)
    {
        // The arc's error over pi, four roundings of at most 1, the root's least value 1e-7.
        const double bound = (2e-8 + 4.0 * u + 1e-7) / pi + 4.0 * u;
        const float radius = static_cast<float>(0.2666 / radian);
        for (const float sun : {0.0f, elevation, elevation + 0.7f * radius})
        {
            const float above = sun - std::max(elevation, 0.0f);
            const double expected = _twofold.visibleDiscFraction(static_cast<double>(above),
                                                                 static_cast<double>(radius));
            _discs.take(static_cast<double>(_single.visibleDiscFraction(above, radius)),
                        expected - bound, expected + bound, at(x, y));
        }
    }

    const std::string& _name;
    const DemTile& _tile;
    const Relief& _relief;
    const Raster<float> _heights;
    const Raster<double> _exact;
    Glsl<float> _single;
    Glsl<double> _twofold;
    Tally _near, _normals, _slices, _discs, _angles;
    double _worstNear = 0.0; ///< error over its bound
};

LightingSettings settingsOf(HorizonQuality quality, int azimuths)
{
    LightingSettings settings;
    settings.quality = quality;
    settings.azimuths = azimuths;
    return settings;
}

SkyLight skyWith(const reference::Sun& sun)
{
    SkyLight sky;
    sky.sunAzimuth = sun.azimuth;
    sky.sunElevation = sun.elevation;
    sky.sunAngularRadius = sun.angularRadius;
    return sky;
}

Bits readBits(osg::State& state, const TileLight& lighting)
{
    Bits bits;
    bits.codes = lighting.readHorizons(state).codes();
    const Raster<float> view = lighting.readSkyView(state);
    const Raster<osg::Vec4f> shading = lighting.readShading(state);
    bits.skyView.resize(view.size());
    bits.shading.resize(4 * shading.size());
    std::memcpy(bits.skyView.data(), view.data(), view.size() * sizeof(float));
    std::memcpy(bits.shading.data(), shading.data(), shading.size() * sizeof(osg::Vec4f));
    return bits;
}

void update(osg::State& state, TileLight& lighting)
{
    const Status done = lighting.update(state);
    ASSERT_TRUE(done) << done.error().message;
}

/// Everything that (a) and (b) say of one quality.
class QualityCheck
{
public:
    QualityCheck(const HardCase& hardCase, const Relief& relief, HorizonQuality quality)
        : _case(hardCase), _tile(hardCase.tile), _relief(relief), _quality(quality),
          _scheme(HorizonScheme::of(quality)), _sunScheme(HorizonScheme::ofSun(quality)),
          _name(hardCase.name + ", " + toString(quality))
    {
    }

    void horizons(const HorizonMap& map, const std::vector<reference::Horizon>& expected)
    {
        Tally bounds(_name + ", horizon [degrees]");
        Tally voids(_name + ", code of a void post");
        std::size_t rays = 0, twoSided = 0, index = 0;
        double worst = 0.0, worstBounded = 0.0, widest = 0.0, mean = 0.0;
        std::string worstPlace = "nowhere";
        const std::size_t count = static_cast<std::size_t>(_case.azimuths) * _tile.postCount();
        _low.assign(count, 0.0);
        _high.assign(count, 0.0);
        for (int y = 0; y < _tile.height(); ++y)
            for (int x = 0; x < _tile.width(); ++x)
                for (int k = 0; k < _case.azimuths; ++k, ++index)
                {
                    const auto where = [&]
                    {
                        return at(x, y) + ", azimuth index " + std::to_string(k) + ", reference " +
                               std::to_string(expected[index].elevationDegrees()) + " from " +
                               std::to_string(expected[index].distance) + " m";
                    };
                    if (!_tile.isValid(x, y))
                    {
                        voids.take(map.codeAt(x, y, k), 0.0, 0.0, where);
                        continue;
                    }
                    const Allowed allowed =
                        allowedHorizon(_case, _relief, x, y, directionOfIndex(k, _case.azimuths),
                                       expected[index], _scheme);
                    _low[index] = allowed.low;
                    _high[index] = allowed.high;
                    const double found = map.elevationAt(x, y, k);
                    bounds.take(found, allowed.low, allowed.high, where);
                    // The sky ends at the horizontal: errors below it do not count.
                    const double reference = std::max(0.0, expected[index].elevationDegrees());
                    const double error = std::abs(std::max(0.0, found) - reference);
                    ++rays;
                    mean += error;
                    if (error > worst)
                    {
                        worst = error;
                        worstPlace = where();
                    }
                    if (allowed.twoSided)
                    {
                        ++twoSided;
                        worstBounded = std::max(worstBounded, error);
                        widest = std::max({widest, std::max(0.0, allowed.high) - reference,
                                           reference - std::max(0.0, allowed.low)});
                    }
                }
        bounds.report();
        voids.report();
        const double all = static_cast<double>(std::max<std::size_t>(rays, 1));
        std::printf("%-26s %-6s mean %.4f worst %.4f degrees (%s); where bounded on both sides "
                    "(%.0f %%) worst %.4f, bound up to %.4f\n",
                    _case.name.c_str(), toString(_quality), mean / all, worst, worstPlace.c_str(),
                    100.0 * static_cast<double>(twoSided) / all, worstBounded, widest);
    }

    void skyView(const Raster<float>& view)
    {
        Tally bounds(_name + ", sky view");
        const auto azimuths = static_cast<std::size_t>(_case.azimuths);
        std::vector<double> ring(azimuths);
        _viewLow = Raster<double>(_tile.width(), _tile.height());
        _viewHigh = _viewLow;
        for (int y = 0; y < _tile.height(); ++y)
            for (int x = 0; x < _tile.width(); ++x)
            {
                const double found = static_cast<double>(view.at(x, y));
                if (!_tile.isValid(x, y))
                {
                    EXPECT_TRUE(std::isnan(found)) << _name << ' ' << at(x, y);
                    continue;
                }
                const reference::Vector3 normal = reference::surfaceNormal(_tile, x, y);
                // 16 roundings of slices that sum to 2, a sum of m, decoded angles (2 of sky per
                // radian), the normal, and sines and cosines of two angles in two terms.
                const double rounding = u * (32.0 + _case.azimuths) + 2.0 * decodeError +
                                        2.0 * normalRounding(_tile, x, y) + 4.0 * trigonometry;
                const auto begin = static_cast<std::ptrdiff_t>(
                    (static_cast<std::size_t>(y) * static_cast<std::size_t>(_tile.width()) +
                     static_cast<std::size_t>(x)) *
                    azimuths);
                // A higher horizon leaves less sky.
                std::copy_n(_high.begin() + begin, azimuths, ring.begin());
                const double low = std::max(0.0, skyViewOf(ring, normal) - rounding);
                std::copy_n(_low.begin() + begin, azimuths, ring.begin());
                const double high = std::min(1.0, skyViewOf(ring, normal)) + rounding;
                bounds.take(found, low, high, [&] { return at(x, y); });
                _viewLow.at(x, y) = low;
                _viewHigh.at(x, y) = high;
            }
        bounds.report();
    }

    /// The sun's visible fraction and the light of sun and sky.
    void shading(const Raster<osg::Vec4f>& shading, const SkyLight& sky)
    {
        Tally fractions(_name + ", visible fraction of the sun");
        Tally lights(_name + ", light");
        const MapDirection direction = directionAt((90.0 - sky.sunAzimuth) / radian);
        const double level = std::cos(sky.sunElevation / radian);
        const reference::Vector3 sun = {direction.east * level, direction.north * level,
                                        std::sin(sky.sunElevation / radian)};
        // Half a unit of a half float, to which the shader rounds.
        constexpr double half = 1.0 / 2048.0;
        for (int y = 0; y < _tile.height(); ++y)
            for (int x = 0; x < _tile.width(); ++x)
            {
                const osg::Vec4f& found = shading.at(x, y);
                const auto where = [&]
                {
                    return at(x, y) + ", sun at " + std::to_string(sky.sunAzimuth) + ", " +
                           std::to_string(sky.sunElevation);
                };
                if (!_tile.isValid(x, y))
                {
                    for (unsigned i = 0; i < 4; ++i)
                        lights.take(static_cast<double>(found[i]), 0.0, 0.0, where);
                    continue;
                }
                const auto [low, high] = visibleSun(sky, x, y);
                fractions.take(static_cast<double>(found.a()), low * (1.0 - half),
                               high * (1.0 + half), where);
                const reference::Vector3 normal = reference::surfaceNormal(_tile, x, y);
                const double facing = normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2];
                const double turn = normalRounding(_tile, x, y) + 8.0 * u;
                for (unsigned i = 0; i < 3; ++i)
                {
                    const double sunlight = static_cast<double>(sky.sunIrradiance[i]) / pi;
                    const double skylight = static_cast<double>(sky.skyRadiance[i]);
                    lights.take(static_cast<double>(found[i]),
                                (skylight * _viewLow.at(x, y) +
                                 sunlight * low * std::max(0.0, facing - turn)) *
                                    (1.0 - half - 8.0 * u),
                                (skylight * _viewHigh.at(x, y) +
                                 sunlight * high * std::max(0.0, facing + turn)) *
                                        (1.0 + half + 8.0 * u) +
                                    1e-7, // the least half float
                                where);
                }
            }
        fractions.report();
        lights.report();
    }

private:
    /// Between what the visible fraction of the sun's disc may be at a post.
    std::pair<double, double> visibleSun(const SkyLight& sky, int x, int y) const
    {
        if (sky.sunElevation + sky.sunAngularRadius <= 0.0)
            return {0.0, 0.0};
        const double middle = (90.0 - sky.sunAzimuth) / radian;
        const double side = std::atan2(std::sin(0.85 * sky.sunAngularRadius / radian),
                                       std::cos(sky.sunElevation / radian));
        reference::HorizonOptions options;
        options.highest = _relief.highest;
        double lowest[3], highest[3]; // of the disc's centre over the horizons
        for (const int i : {0, 1, 2}) // the disc's left, centre and right
        {
            const MapDirection across = directionAt(middle + (1 - i) * side);
            const reference::Horizon expected =
                reference::exhaustiveHorizon(_tile, x, y, across, options);
            const Allowed allowed =
                allowedHorizon(_case, _relief, x, y, across, expected, _sunScheme);
            const auto above = [&](double horizon)
            { return (sky.sunElevation - std::max(0.0, horizon)) / radian; };
            lowest[i] = above(allowed.high);
            highest[i] = above(allowed.low);
        }
        const double radius = sky.sunAngularRadius / radian;
        const auto visible = [&](const double* above)
        { return Glsl<double>().visibleDiscFractionAcross(above[0], above[1], above[2], radius); };
        // Angles in float, over the disc's radius; its area grows by at most 2/pi per radius.
        const double angle = decodeError + 2.0 * u * std::abs(sky.sunElevation) / radian;
        const double rounding = 2.0 / pi * angle / radius + (2e-8 + 4.0 * u) / pi + 8.0 * u;
        // The strips' sum falls with each horizon. What makes a straight horizon exact need not: it
        // is below `defect`, and changes by at most 1.5 per radius.
        static const double defect = stripDefect();
        const double wrong =
            rounding * 3.0 + std::min(2.0 * defect, 1.5 * (highest[1] - lowest[1]) / radius);
        return {std::max(0.0, visible(lowest) - wrong), std::min(1.0, visible(highest) + wrong)};
    }
    static std::string at(int x, int y)
    {
        return "post " + std::to_string(x) + ' ' + std::to_string(y);
    }

    const HardCase& _case;
    const DemTile& _tile;
    const Relief& _relief;
    HorizonQuality _quality;
    HorizonScheme _scheme, _sunScheme;
    std::string _name;
    std::vector<double> _low, _high; ///< allowed horizons, post by post
    Raster<double> _viewLow, _viewHigh;
};
} // namespace

const std::vector<HorizonQuality>& allQualities()
{
    static const std::vector<HorizonQuality> qualities = {
        HorizonQuality::Draft, HorizonQuality::Normal, HorizonQuality::Best};
    return qualities;
}

void checkHardCase(osg::State& state, const HardCase& hardCase)
{
    const DemTile& tile = hardCase.tile;
    ASSERT_GT(tile.validCount(), 0u) << hardCase.name;
    ASSERT_FALSE(hardCase.suns.empty());
    const Relief relief(tile);
    Conditioning(hardCase, relief).check();

    reference::HorizonOptions options;
    options.highest = relief.highest;
    std::vector<reference::Horizon> expected;
    for (int y = 0; y < tile.height(); ++y)
        for (int x = 0; x < tile.width(); ++x)
            for (int k = 0; k < hardCase.azimuths; ++k)
                expected.push_back(reference::exhaustiveHorizon(
                    tile, x, y, directionOfIndex(k, hardCase.azimuths), options));

    for (const HorizonQuality quality : allQualities())
    {
        const LightingSettings settings = settingsOf(quality, hardCase.azimuths);
        const SkyLight first = skyWith(hardCase.suns.front());
        osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, first);
        update(state, *lighting);
        const Bits bits = readBits(state, *lighting);
        EXPECT_EQ(lighting->readDroppedVertices(state) > 0, hardCase.hullOverflows)
            << hardCase.name;

        QualityCheck check(hardCase, relief, quality);
        check.horizons(lighting->readHorizons(state), expected);
        check.skyView(lighting->readSkyView(state));
        for (const reference::Sun& sun : hardCase.suns)
        {
            const SkyLight sky = skyWith(sun);
            lighting->setSky(sky);
            update(state, *lighting);
            check.shading(lighting->readShading(state), sky);
        }

        lighting->setSky(first);
        lighting->touch();
        update(state, *lighting);
        EXPECT_TRUE(readBits(state, *lighting) == bits)
            << hardCase.name << ", " << toString(quality) << ": other bits after touch()";
        EXPECT_TRUE(lightingBits(state, tile, quality, hardCase.azimuths, first) == bits)
            << hardCase.name << ", " << toString(quality) << ": other bits from a second lighting";
    }
}

void expectHorizons(osg::State& state, const HardCase& hardCase, const HorizonForm& form,
                    double methodError)
{
    const DemTile& tile = hardCase.tile;
    const Relief relief(tile);
    for (const HorizonQuality quality : allQualities())
    {
        SkyLight sky;
        sky.sunEnabled = false;
        osg::ref_ptr<TileLight> lighting =
            new TileLight(tile, settingsOf(quality, hardCase.azimuths), sky);
        update(state, *lighting);
        const HorizonMap map = lighting->readHorizons(state);
        Tally tally(hardCase.name + ", " + toString(quality) + ", closed form");
        double worst = 0.0, bound = 0.0;
        std::size_t spoken = 0;
        for (int y = 0; y < tile.height(); ++y)
            for (int x = 0; x < tile.width(); ++x)
                for (int k = 0; k < hardCase.azimuths; ++k)
                {
                    const std::optional<double> slope =
                        form(x, y, directionOfIndex(k, hardCase.azimuths));
                    if (!slope)
                        continue;
                    const double step =
                        GridRay(tile, x, y, directionOfIndex(k, hardCase.azimuths)).step;
                    const double rounding =
                        relief.rounding(*slope * step, HorizonScheme::of(quality).reach) / step;
                    const auto elevation = [](double tangent)
                    { return std::max(0.0, std::atan(tangent) * radian); };
                    const double found = std::max(0.0, map.elevationAt(x, y, k));
                    const double expected = elevation(*slope);
                    const double low = elevation(*slope - rounding) - codeSlack - methodError;
                    const double high = elevation(*slope + rounding) + codeSlack + methodError;
                    tally.take(found, low, high,
                               [&]
                               {
                                   return "post " + std::to_string(x) + ' ' + std::to_string(y) +
                                          ", azimuth index " + std::to_string(k);
                               });
                    ++spoken;
                    worst = std::max(worst, std::abs(found - expected));
                    bound = std::max({bound, high - expected, expected - low});
                }
        tally.report();
        EXPECT_GT(spoken, 0u) << hardCase.name << ": the closed form speaks nowhere";
        std::printf("%-26s %-6s closed form, %zu rays: worst %.4f degrees, bound up to %.4f\n",
                    hardCase.name.c_str(), toString(quality), spoken, worst, bound);
    }
}

Bits lightingBits(osg::State& state, const DemTile& tile, HorizonQuality quality, int azimuths,
                  const SkyLight& sky)
{
    osg::ref_ptr<TileLight> lighting = new TileLight(tile, settingsOf(quality, azimuths), sky);
    const Status done = lighting->update(state);
    EXPECT_TRUE(done) << (done ? "" : done.error().message);
    return readBits(state, *lighting);
}

void expectSameLight(osg::State& state, const DemTile& a, const DemTile& b)
{
    for (const HorizonQuality quality : allQualities())
        EXPECT_TRUE(lightingBits(state, a, quality) == lightingBits(state, b, quality))
            << toString(quality);
}

MemoryDem::MemoryDem(int width, int height, const Frame& frame,
                     const std::function<double(int column, int row)>& heightOf)
{
    static int counter = 0;
    _path = "/vsimem/hard_case_" + std::to_string(counter++) + ".tif";
    GDALAllRegister();
    GDALDatasetUniquePtr raster(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        _path.c_str(), width, height, 1, frame.floatValues ? GDT_Float32 : GDT_Float64, nullptr));
    std::array<double, 6> transform = {
        frame.west, frame.stepX, 0.0, frame.south + height * frame.stepY, 0.0, -frame.stepY};
    EXPECT_EQ(raster->SetGeoTransform(transform.data()), CE_None);
    if (!frame.crs.empty())
    {
        OGRSpatialReference crs;
        EXPECT_EQ(crs.SetFromUserInput(frame.crs.c_str()), OGRERR_NONE);
        raster->SetSpatialRef(&crs);
    }
    std::vector<double> heights;
    for (int row = height - 1; row >= 0; --row)
        for (int column = 0; column < width; ++column)
            heights.push_back(heightOf(column, row));
    EXPECT_EQ(raster->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, width, height, heights.data(),
                                                 width, height, GDT_Float64, 0, 0, nullptr),
              CE_None);
}

MemoryDem::~MemoryDem()
{
    VSIUnlink(_path.c_str());
}

DemTile MemoryDem::read() const
{
    const Result<DemFile> file = readDem(_path);
    if (file)
        return file->tile;
    ADD_FAILURE() << file.error().message;
    return DemTile(1, 1, 1.0);
}

} // namespace osgTerrainLight::hard
