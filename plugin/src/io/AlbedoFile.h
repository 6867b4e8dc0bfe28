#pragma once

#include "core/Raster.h"
#include "core/Result.h"
#include "io/DemReader.h"
#include <osgTerrainLight/SkyLight.h>

#include <string>

namespace osgTerrainLight
{

/// What the ground reflects, from any raster that GDAL reads, of the size of the DEM's, in the
/// DEM's window, in tile order. Bands by pictureBandsOf(). Bytes without scale and offset are sRGB
/// colours, everything else is linear, 0 … 1 after its scale. Pixels that are nodata, masked or not
/// finite are 0: black.
///
/// Errors: NotFound or Failed where GDAL cannot read it; NotSupported where it has a palette,
/// complex numbers or other channels; Invalid where size, place or CRS are not the DEM's or a value
/// is beyond 0 … 1.
Result<Raster<Rgb>> readAlbedo(const std::string& path, const DemInfo& dem);

/// Linear value of an sRGB one, both 0 … 1 (IEC 61966-2-1).
float linearOfSrgb(float encoded);

} // namespace osgTerrainLight
