#pragma once

#include "core/Result.h"
#include "io/EnvironmentFile.h"

#include <cstddef>
#include <string>

namespace osgTerrainLight
{

/// Reads a picture that GDAL reads (PNG, JPEG, TIFF …) as an environment in latitude-longitude, 2
/// : 1. Bytes and 16-bit integers are sRGB colours, floats are linear; one or two bands are grey,
/// or a palette's colours; of more the first three are red, green and blue.
///
/// Errors name the file: NotFound; Invalid where GDAL cannot read it or it has another shape or
/// more than maxPixels pixels; NotSupported for other types of pixels.
Result<EnvironmentPicture> readRasterEnvironment(const std::string& path, std::size_t maxPixels);

} // namespace osgTerrainLight
