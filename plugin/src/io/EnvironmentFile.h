#pragma once

#include "core/Result.h"
#include <osgTerrainLight/Environment.h>

#include <cstddef>
#include <initializer_list>
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
    std::string warning;       ///< what was replaced or chosen; empty where nothing was
};

/// Reads a picture of all directions, by its first bytes, whatever its name: of Radiance
/// (io/RadianceFile.h), OpenEXR (io/ExrEnvironment.h) as latitude-longitude or cube, else any
/// picture that GDAL reads (io/RasterEnvironment.h). A file that is named .exr, .hdr or .pic and is
/// none is an error. docs/CONVENTIONS.md has the orientation. Values that are no light are replaced
/// by makeUsable().
///
/// Errors name the file: NotFound; Invalid where it is damaged, of no environment's shape or holds
/// more than maxPixels pixels, which is looked at before any is allocated; NotSupported where it
/// holds no light of a kind we read.
Result<EnvironmentPicture> readEnvironmentFile(const std::string& path,
                                               std::size_t maxPixels = std::size_t(1) << 27);

/// Those that are not empty, separated by semicolons.
std::string joined(std::initializer_list<std::string> sentences);

/// Of a latitude-longitude picture of width · height pixels, row 0 = zenith: its middle is north,
/// what is right of it in the east (docs/CONVENTIONS.md). Turned by whole texels.
EnvironmentPicture fromLatitudeLongitude(int width, int height, const std::vector<Rgb>& pixels);

/// Makes values what light can be: NaN, −∞ and what is negative become 0, +∞ and what is beyond
/// 1e30 become 65504, the greatest half float, of which an infinity is the usual overflow. Returns
/// a sentence where any was not finite; filters leave small negative values in most pictures, so
/// these pass in silence.
std::string makeUsable(std::vector<Rgb>& pixels);

} // namespace osgTerrainLight
