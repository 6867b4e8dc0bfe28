#include "io/MapGround.h"

#include <ogr_spatialref.h>

#include <array>
#include <cmath>
#include <tuple>

namespace osgTerrainLight
{
namespace
{
constexpr double halfTurn = 3.14159265358979323846;

struct Vector
{
    double x, y, z;
};

Vector geocentric(double longitude, double latitude, double a, double b)
{
    const double sine = std::sin(latitude);
    const double cosine = std::cos(latitude);
    // Prime vertical radius of curvature (Snyder, Map Projections, 1987, eq. 4-20).
    const double n = a * a / std::sqrt(a * a * cosine * cosine + b * b * sine * sine);
    return {n * cosine * std::cos(longitude), n * cosine * std::sin(longitude),
            n * (b * b) / (a * a) * sine};
}

/// East and north parts of a geocentric step.
std::pair<double, double> eastNorth(const Vector& v, double longitude, double latitude)
{
    const double sine = std::sin(longitude);
    const double cosine = std::cos(longitude);
    return {-v.x * sine + v.y * cosine,
            -std::sin(latitude) * (v.x * cosine + v.y * sine) + std::cos(latitude) * v.z};
}

/// The difference quotient; one-sided at the edge of what the CRS can do.
std::optional<Vector> slope(const std::optional<Vector>& before, const Vector& here,
                            const std::optional<Vector>& after, double step)
{
    if (!before && !after)
        return std::nullopt;
    const Vector& from = before ? *before : here;
    const Vector& to = after ? *after : here;
    const double length = before && after ? 2.0 * step : step;
    return Vector{(to.x - from.x) / length, (to.y - from.y) / length, (to.z - from.z) / length};
}
} // namespace

double GroundPoint::metresPerX() const
{
    return std::hypot(eastAlongX, northAlongX);
}

double GroundPoint::metresPerY() const
{
    return std::hypot(eastAlongY, northAlongY);
}

double GroundPoint::convergence() const
{
    // Where columns run north, as in degrees, all that is left is what rounding makes of it.
    return std::abs(eastAlongY) < 1e-9 * northAlongY ? 0.0 : std::atan2(eastAlongY, northAlongY);
}

MapGround::MapGround(MapGround&&) noexcept = default;
MapGround::~MapGround() = default;

std::optional<MapGround> MapGround::between(const OGRSpatialReference& map,
                                            const OGRSpatialReference& geographic)
{
    MapGround ground;
    ground._map = std::make_unique<OGRSpatialReference>(map);
    ground._geographic = std::make_unique<OGRSpatialReference>(geographic);
    OGRSpatialReference& flat = *ground._map;
    OGRSpatialReference& round = *ground._geographic;
    // PROJ takes a transverse Mercator map with UTM's numbers for UTM, which it refuses on a
    // sphere.
    const char* projection = flat.GetAttrValue("PROJECTION");
    if (projection && EQUAL(projection, SRS_PT_TRANSVERSE_MERCATOR) &&
        flat.GetSemiMajor() == flat.GetSemiMinor())
    {
        ground._eastOfMap = flat.GetProjParm(SRS_PP_FALSE_EASTING);
        flat.SetProjParm(SRS_PP_FALSE_EASTING, 0.0);
    }
    flat.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    round.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    ground._toGround.reset(OGRCreateCoordinateTransformation(&flat, &round));
    ground._semiMajor = round.GetSemiMajor();
    ground._semiMinor = round.GetSemiMinor();
    ground._radiansPerUnit = round.GetAngularUnits();
    const double radians = 1.0e-4;
    ground._step = flat.IsGeographic()
                       ? radians / flat.GetAngularUnits()
                       : radians * ground._semiMajor / flat.GetTargetLinearUnits(nullptr);
    if (!ground._toGround || !(ground._step > 0.0))
        return std::nullopt;
    return ground;
}

std::vector<std::optional<GroundPoint>>
MapGround::at(const std::vector<std::pair<double, double>>& points) const
{
    constexpr std::size_t around = 5; // here, west, east, south, north
    std::vector<double> xs, ys;
    for (const auto& [mapX, y] : points)
    {
        const double x = mapX - _eastOfMap;
        xs.insert(xs.end(), {x, x - _step, x + _step, x, x});
        ys.insert(ys.end(), {y, y, y, y - _step, y + _step});
    }
    std::vector<int> good(xs.size(), 0);
    _toGround->Transform(static_cast<int>(xs.size()), xs.data(), ys.data(), nullptr, good.data());
    std::vector<std::optional<GroundPoint>> result(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
    {
        std::array<std::optional<Vector>, around> places;
        for (std::size_t k = 0; k < around; ++k)
        {
            const double longitude = xs[around * i + k] * _radiansPerUnit;
            const double latitude = ys[around * i + k] * _radiansPerUnit;
            // A point on the pole itself may lie beyond it by rounding.
            if (good[around * i + k] && std::isfinite(longitude) &&
                std::abs(latitude) <= 0.5 * halfTurn + 1.0e-9)
                places[k] = geocentric(longitude, latitude, _semiMajor, _semiMinor);
        }
        if (!places[0])
            continue;
        const std::optional<Vector> alongX = slope(places[1], *places[0], places[2], _step);
        const std::optional<Vector> alongY = slope(places[3], *places[0], places[4], _step);
        if (!alongX || !alongY)
            continue;
        GroundPoint point;
        point.longitude = xs[around * i] * _radiansPerUnit;
        point.latitude = ys[around * i] * _radiansPerUnit;
        std::tie(point.eastAlongX, point.northAlongX) =
            eastNorth(*alongX, point.longitude, point.latitude);
        std::tie(point.eastAlongY, point.northAlongY) =
            eastNorth(*alongY, point.longitude, point.latitude);
        result[i] = point;
    }
    return result;
}

std::optional<GroundPoint> MapGround::at(double x, double y, double longitude,
                                         double latitude) const
{
    std::optional<GroundPoint> point = at({{x, y}}).front();
    if (!point)
        return std::nullopt;
    // Away from a pole longitudes differ by rounding only.
    const double turn =
        std::remainder(longitude - point->longitude, 2.0 * halfTurn) * std::sin(latitude);
    const auto turned = [turn](double& east, double& north)
    {
        const double before = east;
        east = east * std::cos(turn) + north * std::sin(turn);
        north = north * std::cos(turn) - before * std::sin(turn);
    };
    turned(point->eastAlongX, point->northAlongX);
    turned(point->eastAlongY, point->northAlongY);
    point->longitude = longitude;
    point->latitude = latitude;
    return point;
}

std::optional<std::pair<double, double>> MapGround::toMap(double longitude, double latitude) const
{
    double x = longitude / _radiansPerUnit;
    double y = latitude / _radiansPerUnit;
    int good = 0;
    // Seldom asked for, and PROJ takes milliseconds to find it.
    const std::unique_ptr<OGRCoordinateTransformation> transform(
        OGRCreateCoordinateTransformation(_geographic.get(), _map.get()));
    if (!transform || !transform->Transform(1, &x, &y, nullptr, &good) || !good ||
        !std::isfinite(x) || !std::isfinite(y))
        return std::nullopt;
    return std::pair(x + _eastOfMap, y);
}

} // namespace osgTerrainLight
