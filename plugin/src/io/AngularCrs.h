#pragma once

#include <optional>
#include <string>

namespace osgTerrainLight
{

/// A CRS whose coordinates are longitude and latitude.
struct AngularCrs
{
    double radiansPerUnit = 0.0;             ///< π/180 for degrees
    double semiMajor = 0.0, semiMinor = 0.0; ///< of its ellipsoid [m]
};

/// crs: WKT, or what else PROJ takes for a name. Nothing where its coordinates are lengths, or
/// where it cannot be read.
std::optional<AngularCrs> angularCrs(const std::string& crs);

} // namespace osgTerrainLight
