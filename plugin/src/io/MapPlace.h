#pragma once

#include "core/Result.h"
#include "io/DemReader.h"
#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/SunPosition.h>

#include <optional>
#include <string>

namespace osgTerrainLight
{

/// Longitude, latitude and meridian convergence of a place in map coordinates of a CRS (WKT, x
/// before y). The convergence is measured: the bearing on WGS 84 of a few metres along the map's y
/// axis. Errors: there is no CRS, it is tied to no place on Earth, or it is another body's, since
/// only the Earth's turning and orbit are known by time.
OSGTERRAINLIGHT_EXPORT Result<EarthPlace> placeOnMap(const std::string& crs, double x, double y);

/// Of the middle of a raster, and of a tile.
OSGTERRAINLIGHT_EXPORT Result<EarthPlace> placeOf(const RasterFrame& frame);
OSGTERRAINLIGHT_EXPORT Result<EarthPlace> placeOf(const DemTile& tile);

/// The place that was given instead of the terrain's own, or that. The map's north stays that of
/// the terrain's CRS; where it has none, its rows are taken to run from west to east.
OSGTERRAINLIGHT_EXPORT Result<EarthPlace> placeInstead(const std::optional<EarthPlace>& given,
                                                       const Result<EarthPlace>& own);

} // namespace osgTerrainLight
