#pragma once

#include "core/Result.h"
#include "io/RasterFrame.h"
#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/SunPosition.h>

#include <optional>
#include <string>

namespace osgTerrainLight
{

/// Longitude, latitude and meridian convergence of a place in map coordinates of a CRS (WKT, x
/// before y). The convergence is the bearing on WGS 84 of the map's y axis there, also at a pole,
/// where it counts from the longitude's meridian. Errors: there is no CRS, it is tied to no place
/// on Earth, or it is another body's, since only the Earth's turning and orbit are known by time.
Result<EarthPlace> placeOnMap(const std::string& crs, double x, double y);

/// Of the middle of a raster, and of a tile.
Result<EarthPlace> placeOf(const RasterFrame& frame);
Result<EarthPlace> placeOf(const DemTile& tile);

/// The place that was given instead of the terrain's own, or that. The convergence is the map's at
/// the given place; 0 where the terrain has no CRS, and rows are taken to run from west to east.
/// Error: the map does not show the place, or is another body's.
Result<EarthPlace> placeInstead(const std::optional<EarthPlace>& given, const std::string& crs,
                                const Result<EarthPlace>& own);

} // namespace osgTerrainLight
