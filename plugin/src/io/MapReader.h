#pragma once

#include "core/Result.h"
#include <osgTerrainLight/DemTile.h>

#include <cstdint>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// sRGB colours, 4 bytes per pixel (red, green, blue, alpha), row 0 south.
struct ColourImage
{
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> pixels;
};

/// Reads a picture that GDAL reads (8 bits per channel: grey, palette, RGB; each with or without
/// alpha), warped to the rectangle that the tile's outermost posts span, at the picture's own
/// resolution up to maxSize pixels a side. Alpha is 0 where it has no data. A CRS that tile or
/// picture lacks is taken as the other's. Errors name the file and the reason.
Result<ColourImage> readColour(const std::string& path, const DemTile& tile, int maxSize = 4096);

/// A level tile of 2 × 2 posts that a georeferenced picture covers: what it is draped over where
/// there is no elevation.
Result<DemTile> levelTileUnder(const std::string& path);

} // namespace osgTerrainLight
