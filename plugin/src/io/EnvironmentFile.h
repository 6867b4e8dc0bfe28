#pragma once

#include "core/Result.h"
#include <osgTerrainLight/Environment.h>
#include <osgTerrainLight/Export.h>

#include <cstddef>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// A picture of all directions, laid out as an Environment is.
struct EnvironmentPicture
{
    int columns = 0;
    int rows = 0;
    std::vector<Rgb> radiance; ///< finite and ≥ 0
    std::string warning;       ///< what was replaced; empty where nothing worth a word was
};

/// Reads an OpenEXR file as an environment: latitude-longitude or a cube, after the attribute
/// envmap; without it a picture of 2 : 1 is latitude-longitude and one of 1 : 6 a cube. Of several
/// parts and layers, the first that has R, G and B or Y counts; with RY and BY, Y is luminance and
/// these are chroma. Other chromaticities than those of Rec. 709 are converted. The display window
/// counts; what of it is outside the data window is black. docs/CONVENTIONS.md has the orientation.
///
/// NaN, infinite and negative values: as makeUsable() has them. A cube becomes 4 n × 2 n texels,
/// each the mean of what it covers, so that no light is lost.
///
/// Errors: NotFound; Invalid where the file is damaged, its windows are empty or of no
/// environment's shape, or they hold more than maxPixels pixels, which is looked at before any is
/// allocated; NotSupported for deep parts and where no part has R, G, B or Y.
OSGTERRAINLIGHT_EXPORT Result<EnvironmentPicture>
readEnvironmentFile(const std::string& path, std::size_t maxPixels = std::size_t(1) << 27);

/// Of a latitude-longitude picture of width · height pixels, row 0 = zenith: its middle is north,
/// what is right of it in the east (docs/CONVENTIONS.md). Turned by whole texels.
OSGTERRAINLIGHT_EXPORT EnvironmentPicture fromLatitudeLongitude(int width, int height,
                                                                const std::vector<Rgb>& pixels);

/// Makes values what light can be: NaN, −∞ and what is negative become 0, +∞ and what is beyond
/// 1e30 become 65504, the greatest half float, of which an infinity is the usual overflow. Returns
/// a sentence where any was not finite; filters leave small negative values in most pictures, so
/// these pass in silence.
OSGTERRAINLIGHT_EXPORT std::string makeUsable(std::vector<Rgb>& pixels);

} // namespace osgTerrainLight
