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

std::string placeText(const EarthViewpoint& viewpoint)
{
    return CPLSPrintf("longitude %.8g, latitude %.8g", viewpoint.longitude, viewpoint.latitude);
}

/// The longitude that is nearest to the middle of the terrain, on a map of degrees.
double nearestTurn(double x, double middle, const OGRSpatialReference& crs)
{
    if (!crs.IsGeographic())
        return x;
    const double turn = 360.0 * radiansPerDegree / crs.GetAngularUnits();
    return x + turn * std::round((middle - x) / turn);
}

Result<OnMap> onMapOf(const EarthViewpoint& viewpoint, const LocalFrame& frame)
{
    if (frame.crs.empty())
        return Error{ErrorCode::NotSupported,
                     "the terrain has no CRS that tells where " + placeText(viewpoint) + " lies"};
    const GdalErrors errors;
    OGRSpatialReference crs;
    if (crs.importFromWkt(frame.crs.c_str()) != OGRERR_NONE)
        return Error{ErrorCode::Invalid, "the CRS of the terrain cannot be read"};
    const std::string name = crs.GetName() ? crs.GetName() : "";
    OGRSpatialReference degrees;
    if (std::abs(crs.GetSemiMajor() / earthRadius - 1.0) < 0.01)
        degrees.SetWellKnownGeogCS("WGS84");
    else // of another body, whose degrees are its own
        degrees.CopyGeogCSFrom(&crs);
    const std::optional<MapGround> ground =
        crs.IsLocal() ? std::nullopt : MapGround::between(crs, degrees);
    const double longitude = viewpoint.longitude * radiansPerDegree;
    const double latitude = viewpoint.latitude * radiansPerDegree;
    const std::optional<std::pair<double, double>> place =
        ground ? ground->toMap(longitude, latitude) : std::nullopt;
    const std::optional<GroundPoint> point =
        place ? ground->at(place->first, place->second, longitude, latitude) : std::nullopt;
    if (!point || !(point->metresPerY() > 0.0))
        return Error{ErrorCode::Invalid,
                     placeText(viewpoint) + " does not lie on the map of CRS \"" + name + "\""};
    return OnMap{nearestTurn(place->first, frame.mapX, crs), place->second,
                 point->convergence() / radiansPerDegree};
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
    const Result<OnMap> place = onMapOf(viewpoint, frame);
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
                     placeText(viewpoint) + " lies " + CPLSPrintf("%.4g", 1e-3 * outside) +
                         " km outside the terrain; needs a place on it, or at most " +
                         CPLSPrintf("%.4g", 1e-3 * diagonal) + " km from its edge"};
    view.z = viewpoint.height ? *viewpoint.height : heightNear(frame, view.x, view.y);
    view.heading = viewpoint.heading - place->convergence;
    view.pitch = viewpoint.pitch;
    view.range = viewpoint.range > 0.0 ? viewpoint.range : diagonal;
    raise(view, frame, notes);
    return view;
}

} // namespace osgTerrainLight
