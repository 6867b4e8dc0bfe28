#include "io/MapPlace.h"

#include "io/GdalErrors.h"
#include "io/MapGround.h"

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <utility>

namespace osgTerrainLight
{

namespace
{
constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;
/// Of WGS 84. All ellipsoids of the Earth lie within 0.1 % of it, other bodies beyond 5 %.
constexpr double earthRadius = 6378137.0;

/// From a map of the Earth to WGS 84; name: of its CRS.
Result<MapGround> toEarth(const std::string& wkt, std::string& name)
{
    if (wkt.empty())
        return Error{ErrorCode::NotFound, "the raster has no CRS that tells its place"};
    const GdalErrors errors;
    OGRSpatialReference crs;
    if (crs.importFromWkt(wkt.c_str()) != OGRERR_NONE)
        return Error{ErrorCode::Invalid, "its CRS cannot be read (" + errors.first() + ")"};
    name = crs.GetName() ? crs.GetName() : "";
    const double radius = crs.GetSemiMajor();
    if (!crs.IsLocal() && std::abs(radius / earthRadius - 1.0) > 0.01)
        return Error{ErrorCode::NotSupported,
                     "CRS \"" + name + "\" is of a body of " + CPLSPrintf("%.6g", 1e-3 * radius) +
                         " km radius; the sun is known by time for the Earth only"};
    OGRSpatialReference wgs84;
    wgs84.SetWellKnownGeogCS("WGS84");
    std::optional<MapGround> ground = MapGround::between(crs, wgs84);
    if (!ground)
        return Error{ErrorCode::NotSupported,
                     "CRS \"" + name + "\" does not tell where it lies on Earth"};
    return std::move(*ground);
}
} // namespace

Result<EarthPlace> placeOnMap(const std::string& wkt, double x, double y)
{
    std::string name;
    const Result<MapGround> ground = toEarth(wkt, name);
    if (!ground)
        return ground.error();
    const GdalErrors errors;
    const std::optional<GroundPoint> point = ground->at({{x, y}}).front();
    if (!point)
        return Error{ErrorCode::NotSupported, "CRS \"" + name + "\" does not tell where " +
                                                  CPLSPrintf("%.10g, %.10g", x, y) +
                                                  " lies on Earth"};
    return EarthPlace{point->longitude / radiansPerDegree, point->latitude / radiansPerDegree,
                      point->convergence() / radiansPerDegree};
}

Result<EarthPlace> placeOf(const RasterFrame& frame)
{
    const std::array<double, 6>& t = frame.geoTransform;
    return placeOnMap(frame.hasGeoTransform ? frame.crs : "", t[0] + 0.5 * frame.width * t[1],
                      t[3] + 0.5 * frame.height * t[5]);
}

Result<EarthPlace> placeOf(const DemTile& tile)
{
    return placeOnMap(tile.crs, tile.mapOriginX + 0.5 * (tile.width() - 1) * tile.mapStepX,
                      tile.mapOriginY + 0.5 * (tile.height() - 1) * tile.mapStepY);
}

Result<EarthPlace> placeInstead(const std::optional<EarthPlace>& given, const std::string& wkt,
                                const Result<EarthPlace>& own)
{
    if (!given)
        return own;
    EarthPlace place = *given;
    std::string name;
    const Result<MapGround> ground = toEarth(wkt, name);
    if (!ground && ground.error().code != ErrorCode::NotFound)
        return ground.error();
    if (!ground)
        return place;
    const GdalErrors errors;
    const double longitude = place.longitude * radiansPerDegree;
    const double latitude = place.latitude * radiansPerDegree;
    const std::optional<std::pair<double, double>> onMap = ground->toMap(longitude, latitude);
    const std::optional<GroundPoint> point =
        onMap ? ground->at(onMap->first, onMap->second, longitude, latitude)
              : std::optional<GroundPoint>();
    // The far pole of a stereographic map is nowhere, which PROJ gives as numbers that are too
    // large for steps between them.
    if (!point || !(point->metresPerY() > 0.0))
        return Error{ErrorCode::Invalid,
                     std::string("the place ") +
                         CPLSPrintf("%.10g, %.10g", place.longitude, place.latitude) +
                         " does not lie on the map of CRS \"" + name + "\""};
    place.convergence = point->convergence() / radiansPerDegree;
    return place;
}

} // namespace osgTerrainLight
