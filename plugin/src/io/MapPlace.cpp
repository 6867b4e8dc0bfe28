#include "io/MapPlace.h"

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <memory>

namespace osgTerrainLight
{

namespace
{
constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;
/// Of WGS 84. All ellipsoids of the Earth lie within 0.1 % of it, other bodies beyond 5 %.
constexpr double earthRadius = 6378137.0;

/// Of places along the map's y axis; far enough for digits, and near enough for a tangent.
constexpr double stepMetres = 10.0;
} // namespace

Result<EarthPlace> placeOnMap(const std::string& wkt, double x, double y)
{
    if (wkt.empty())
        return Error{ErrorCode::NotFound, "the raster has no CRS that tells its place"};
    GdalErrors errors;
    OGRSpatialReference crs;
    if (crs.importFromWkt(wkt.c_str()) != OGRERR_NONE)
        return Error{ErrorCode::Invalid, "its CRS cannot be read (" + errors.first() + ")"};
    const std::string name = crs.GetName() ? crs.GetName() : "";
    const double radius = crs.GetSemiMajor();
    if (!crs.IsLocal() && std::abs(radius / earthRadius - 1.0) > 0.01)
        return Error{ErrorCode::NotSupported,
                     "CRS \"" + name + "\" is of a body of " + CPLSPrintf("%.6g", 1e-3 * radius) +
                         " km radius; the sun is known by time for the Earth only"};
    OGRSpatialReference wgs84;
    wgs84.SetWellKnownGeogCS("WGS84");
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRCoordinateTransformation> transform(
        OGRCreateCoordinateTransformation(&crs, &wgs84));
    // A degree of latitude is 111 km.
    const double step = crs.IsGeographic() ? stepMetres / earthRadius / crs.GetAngularUnits()
                                           : stepMetres / crs.GetTargetLinearUnits(nullptr);
    double longitudes[3] = {x, x, x};
    double latitudes[3] = {y, y - step, y + step};
    int good[3] = {0, 0, 0};
    if (transform)
        transform->Transform(3, longitudes, latitudes, nullptr, good);
    if (!good[0] || !(std::abs(latitudes[0]) <= 90.0))
        return Error{ErrorCode::NotSupported, "CRS \"" + name + "\" does not tell where " +
                                                  CPLSPrintf("%.10g, %.10g", x, y) +
                                                  " lies on Earth"};
    EarthPlace place{longitudes[0], latitudes[0], 0.0};
    // One-sided at the edge of what the CRS can do, such as a pole.
    const int from = good[1] ? 1 : 0;
    const int to = good[2] ? 2 : 0;
    if (from != to)
    {
        const MetresPerRadian ground = metresPerRadian(place.latitude * radiansPerDegree,
                                                       wgs84.GetSemiMajor(), wgs84.GetSemiMinor());
        const double east = std::remainder(longitudes[to] - longitudes[from], 360.0) * ground.east;
        const double north = (latitudes[to] - latitudes[from]) * ground.north;
        place.convergence = std::atan2(east, north) / radiansPerDegree;
    }
    return place;
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

Result<EarthPlace> placeInstead(const std::optional<EarthPlace>& given,
                                const Result<EarthPlace>& own)
{
    if (!given)
        return own;
    EarthPlace place = *given;
    if (own)
        place.convergence = own->convergence;
    else if (own.error().code != ErrorCode::NotFound)
        return own;
    return place;
}

} // namespace osgTerrainLight
