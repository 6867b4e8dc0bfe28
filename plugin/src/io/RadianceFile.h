#pragma once

#include "core/Result.h"
#include "io/EnvironmentFile.h"

#include <cstddef>
#include <string>

namespace osgTerrainLight
{

/// Reads a picture of Radiance (.hdr, .pic; RGBE or XYZE, run-length coded or flat) as an
/// environment in latitude-longitude. Format: Ward, "Real Pixels", Graphics Gems II, 1991, and
/// "Radiance File Formats" of the Radiance distribution (filefmts.pdf). Our own, since readers at
/// hand leave out the header's variables and most resolution strings, and some crash on damage.
///
/// Of the header: values are divided by the product of all EXPOSURE and, per channel, of all
/// COLORCORR; PIXASPECT (height of a pixel over its width, all multiplied) counts in the shape,
/// which must be 2 : 1; PRIMARIES other than Radiance's and Rec. 709's are converted, white to
/// white; XYZE becomes red, green, blue of Radiance's primaries, 179 lm/W taken off; a view's type
/// (VIEW= -vt) is no latitude-longitude and gives a warning. Each of the eight resolution strings
/// is put upright.
///
/// Errors: Invalid where the file is damaged or of another shape or larger than maxPixels;
/// NotSupported for other formats than RGBE and XYZE. What is allocated grows with what is read.
Result<EnvironmentPicture> readRadianceFile(const std::string& path, std::size_t maxPixels);

} // namespace osgTerrainLight
