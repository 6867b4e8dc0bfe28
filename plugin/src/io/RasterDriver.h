#pragma once

#include "core/Result.h"

#include <string>

class GDALDriver;

namespace osgTerrainLight
{

/// The driver of GDAL that writes a raster file: by its short name, or, where that is empty, by the
/// path's extension as GDAL's own tools choose it (GTiff where it has none). NotSupported: GDAL has
/// none, or it writes no raster files.
Result<GDALDriver*> findRasterDriver(const std::string& path, const std::string& name);

} // namespace osgTerrainLight
