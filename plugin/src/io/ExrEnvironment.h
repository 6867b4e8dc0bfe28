#pragma once

#include "core/Result.h"
#include "io/EnvironmentFile.h"

#include <cstddef>
#include <string>

namespace osgTerrainLight
{

/// Reads an OpenEXR file as an environment: latitude-longitude or a cube, after the attribute
/// envmap; without it a picture of 2 : 1 is latitude-longitude and one of 1 : 6 a cube. Of layers,
/// of all parts, lightLayers() says which is the picture; where there is more than one, the warning
/// says which was taken. With RY and BY, Y is luminance and these are chroma.
/// Other chromaticities than those of Rec. 709 are converted. The display window counts; what of it
/// is outside the data window is black. Throws what OpenEXR throws (readGuarded()).
Result<EnvironmentPicture> readExrEnvironment(const std::string& path, std::size_t maxPixels);

} // namespace osgTerrainLight
