#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

class OGRCoordinateTransformation;
class OGRSpatialReference;

namespace osgTerrainLight
{

/// A point of a map on the ground, and what a step along each map axis is there [m per map unit],
/// split into true east and true north of the longitude given.
struct GroundPoint
{
    double longitude = 0.0, latitude = 0.0; ///< geodetic [rad]; at a pole any longitude is true
    double eastAlongX = 0.0, northAlongX = 0.0;
    double eastAlongY = 0.0, northAlongY = 0.0;

    double metresPerX() const;
    double metresPerY() const;
    /// Clockwise from true north to the map's y axis [rad]: the meridian convergence.
    double convergence() const;
};

/// Takes points of a map to the ellipsoid of a geographic CRS. Steps are central differences of
/// geocentric vectors, which are smooth where longitudes are not: across a pole and the 180°
/// meridian. They are over 1e-4 of the body's radius, so their error is below 1e-8 of them.
class MapGround
{
public:
    /// Nothing where PROJ has no way from one CRS to the other. The map's axes count as x before y.
    static std::optional<MapGround> between(const OGRSpatialReference& map,
                                            const OGRSpatialReference& geographic);
    MapGround(MapGround&&) noexcept;
    ~MapGround();

    /// Points of the map; nothing for one that the CRS cannot take to the ground.
    std::vector<std::optional<GroundPoint>>
    at(const std::vector<std::pair<double, double>>& points) const;

    /// As at(), with axes split at the given longitude and latitude [rad] of the same point: where
    /// it is a pole, another longitude gives another north.
    std::optional<GroundPoint> at(double x, double y, double longitude, double latitude) const;

    /// Map coordinates of a longitude and latitude [rad]; nothing where the map does not show it.
    std::optional<std::pair<double, double>> toMap(double longitude, double latitude) const;

    /// Of the ellipsoid [m].
    double semiMajor() const { return _semiMajor; }
    double semiMinor() const { return _semiMinor; }

private:
    MapGround() = default;

    std::unique_ptr<OGRSpatialReference> _map, _geographic; ///< x before y
    std::unique_ptr<OGRCoordinateTransformation> _toGround;
    double _semiMajor = 0.0, _semiMinor = 0.0;
    double _radiansPerUnit = 1.0; ///< of the geographic CRS
    double _step = 0.0;           ///< of a difference [map units]
    double _eastOfMap = 0.0;      ///< x of the map less x of _map
};

} // namespace osgTerrainLight
