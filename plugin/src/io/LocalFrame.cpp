#include "io/LocalFrame.h"

#include "io/Bilinear.h"
#include "io/GdalErrors.h"
#include "io/MapGround.h"

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

namespace osgTerrainLight
{
namespace
{
constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;
/// Of WGS 84; all ellipsoids of the Earth lie within 0.1 % of it, other bodies beyond 5 %.
constexpr double earthRadius = 6378137.0;

/// A longitude and latitude on the map of a terrain.
struct OnMap
{
    double x = 0.0, y = 0.0;
    double convergence = 0.0; ///< bearing of the map's y axis there [degrees]
};

/// The longitude that is nearest to the middle of the terrain, on a map of degrees.
double nearestTurn(double x, double middle, const OGRSpatialReference& crs)
{
    if (!crs.IsGeographic())
        return x;
    const double turn = 360.0 * radiansPerDegree / crs.GetAngularUnits();
    return x + turn * std::round((middle - x) / turn);
}

/// The CRS of the terrain and its degrees, and the way between both.
struct MapDegrees
{
    std::string name; ///< of the CRS
    OGRSpatialReference crs;
    std::optional<MapGround> ground; ///< none where the CRS tells no place
};

Result<MapDegrees> degreesOfMap(const std::string& wkt, const EarthPoint& point)
{
    if (wkt.empty())
        return Error{ErrorCode::NotSupported,
                     "the terrain has no CRS that tells where " + toString(point) + " lies"};
    MapDegrees map;
    if (map.crs.importFromWkt(wkt.c_str()) != OGRERR_NONE)
        return Error{ErrorCode::Invalid, "the CRS of the terrain cannot be read"};
    map.name = map.crs.GetName() ? map.crs.GetName() : "";
    OGRSpatialReference degrees;
    if (std::abs(map.crs.GetSemiMajor() / earthRadius - 1.0) < 0.01)
        degrees.SetWellKnownGeogCS("WGS84");
    else // of another body, whose degrees are its own
        degrees.CopyGeogCSFrom(&map.crs);
    if (!map.crs.IsLocal())
        if (std::optional<MapGround> ground = MapGround::between(map.crs, degrees))
            map.ground.emplace(std::move(*ground));
    return map;
}

Result<OnMap> onMapOf(const EarthPoint& point, const LocalFrame& frame)
{
    const GdalErrors errors;
    const Result<MapDegrees> map = degreesOfMap(frame.crs, point);
    if (!map)
        return map.error();
    const double longitude = point.x * radiansPerDegree;
    const double latitude = point.y * radiansPerDegree;
    const std::optional<std::pair<double, double>> place =
        map->ground ? map->ground->toMap(longitude, latitude) : std::nullopt;
    const std::optional<GroundPoint> ground =
        place ? map->ground->at(place->first, place->second, longitude, latitude) : std::nullopt;
    if (!ground || !(ground->metresPerY() > 0.0))
        return Error{ErrorCode::Invalid,
                     toString(point) + " does not lie on the map of CRS \"" + map->name + "\""};
    return OnMap{nearestTurn(place->first, frame.mapX, map->crs), place->second,
                 ground->convergence() / radiansPerDegree};
}

/// Of a plain place, which needs no CRS.
Result<OnMap> onMapOfPlain(const EarthPoint& point, const LocalFrame& frame)
{
    const GdalErrors errors;
    const Result<MapDegrees> map = degreesOfMap(frame.crs, point);
    const bool hasDegrees = map && map->ground;
    if (hasDegrees && std::abs(point.x) <= 360.0 && std::abs(point.y) <= 90.0)
        return onMapOf({point.x, point.y, false}, frame);
    const std::optional<GroundPoint> ground =
        hasDegrees ? map->ground->at({{point.x, point.y}}).front() : std::nullopt;
    return OnMap{point.x, point.y, ground ? ground->convergence() / radiansPerDegree : 0.0};
}

/// Of the terrain, where it is known; else the nearest that is known towards its middle, or 0.
double heightNear(const LocalFrame& frame, double x, double y)
{
    x = std::clamp(x, -frame.halfWidth, frame.halfWidth);
    y = std::clamp(y, -frame.halfHeight, frame.halfHeight);
    constexpr int steps = 64;
    for (int i = 0; i <= steps; ++i)
    {
        const double share = 1.0 - double(i) / steps;
        if (const double height = frame.heightAt(share * x, share * y); !std::isnan(height))
            return height;
    }
    return 0.0;
}

/// Raises a camera that stands in the terrain, and looks at the same place from there.
void raise(Viewpoint& view, const LocalFrame& frame, std::vector<std::string>& notes)
{
    const double heading = view.heading * radiansPerDegree;
    const double level = view.range * std::cos(view.pitch * radiansPerDegree);
    const double x = view.x - level * std::sin(heading);
    const double y = view.y - level * std::cos(heading);
    const double ground = frame.heightAt(x, y);
    const double eye = view.z - view.range * std::sin(view.pitch * radiansPerDegree);
    const double lowest = ground + std::max(2.0, 0.01 * view.range); // about a person's height
    if (std::isnan(ground) || eye >= lowest)
        return;
    view.range = std::hypot(level, lowest - view.z);
    view.pitch = std::atan2(view.z - lowest, level) / radiansPerDegree;
    notes.push_back(std::string("its camera is raised by ") + CPLSPrintf("%.4g", lowest - eye) +
                    " m, above the terrain");
}
} // namespace

LocalFrame localFrameOf(const DemTile& tile)
{
    const double east = tile.nominalEastSpacing(), north = tile.northSpacing;
    const double middleX = 0.5 * (tile.width() - 1), middleY = 0.5 * (tile.height() - 1);
    LocalFrame frame;
    frame.crs = tile.crs;
    frame.mapX = tile.mapOriginX + middleX * tile.mapStepX;
    frame.mapY = tile.mapOriginY + middleY * tile.mapStepY;
    frame.metresPerX = east / tile.mapStepX;
    frame.metresPerY = north / tile.mapStepY;
    frame.halfWidth = middleX * east;
    frame.halfHeight = middleY * north;
    frame.heightAt = [&tile, east, north, middleX, middleY](double x, double y)
    {
        return bilinear(x / east + middleX, y / north + middleY, tile.width(), tile.height(),
                        [&](int column, int row)
                        {
                            return tile.isValid(column, row)
                                       ? tile.heightOrigin + double(tile.heightAt(column, row))
                                       : std::numeric_limits<double>::quiet_NaN();
                        });
    };
    return frame;
}

Result<Viewpoint> placeViewpoint(const EarthViewpoint& viewpoint, const LocalFrame& frame,
                                 std::vector<std::string>& notes)
{
    const EarthPoint point{viewpoint.longitude, viewpoint.latitude, false};
    const Result<OnMap> place = onMapOf(point, frame);
    if (!place)
        return place.error();
    Viewpoint view;
    view.name = viewpoint.name;
    view.x = (place->x - frame.mapX) * frame.metresPerX;
    view.y = (place->y - frame.mapY) * frame.metresPerY;
    const double diagonal = 2.0 * std::hypot(frame.halfWidth, frame.halfHeight);
    const double outside = std::hypot(std::max(0.0, std::abs(view.x) - frame.halfWidth),
                                      std::max(0.0, std::abs(view.y) - frame.halfHeight));
    if (!(outside <= diagonal))
        return Error{ErrorCode::Invalid,
                     toString(point) + " lies " + CPLSPrintf("%.4g", 1e-3 * outside) +
                         " km outside the terrain; needs a place on it, or at most " +
                         CPLSPrintf("%.4g", 1e-3 * diagonal) + " km from its edge"};
    view.z = viewpoint.height ? *viewpoint.height : heightNear(frame, view.x, view.y);
    view.heading = viewpoint.heading - place->convergence;
    view.pitch = viewpoint.pitch;
    view.range = viewpoint.range > 0.0 ? viewpoint.range : diagonal;
    raise(view, frame, notes);
    return view;
}

Result<ModelPlace> placeModel(const EarthModel& model, const LocalFrame& frame)
{
    const Result<OnMap> place =
        model.place.isPlain ? onMapOfPlain(model.place, frame) : onMapOf(model.place, frame);
    if (!place)
        return place.error();
    ModelPlace placed;
    placed.x = (place->x - frame.mapX) * frame.metresPerX;
    placed.y = (place->y - frame.mapY) * frame.metresPerY;
    const double rounding = 1.0e-6 * std::hypot(frame.halfWidth, frame.halfHeight);
    const double outside = std::hypot(std::max(0.0, std::abs(placed.x) - frame.halfWidth),
                                      std::max(0.0, std::abs(placed.y) - frame.halfHeight));
    if (!(outside <= rounding))
        return Error{ErrorCode::Elsewhere, toString(model.place) + " lies " +
                                               CPLSPrintf("%.4g", 1e-3 * outside) +
                                               " km outside the terrain; needs a place on it"};
    placed.heading = model.heading - place->convergence;
    if (const double ground = frame.heightAt(placed.x, placed.y); !std::isnan(ground))
        placed.ground = ground;
    if (!placed.ground && !model.isAbsolute)
        return Error{ErrorCode::Elsewhere,
                     "the terrain has no height at " + toString(model.place) +
                         "; needs a place that has one, or a height with mode=\"absolute\""};
    placed.z = model.height + (model.isAbsolute ? 0.0 : *placed.ground);
    return placed;
}

} // namespace osgTerrainLight
