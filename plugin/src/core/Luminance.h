#pragma once

#include <osgTerrainLight/SkyLight.h>

namespace osgTerrainLight
{

/// Luminance of linear red, green, blue, in their unit (ITU-R BT.709 primaries).
inline double luminance(const Rgb& c)
{
    return 0.2126 * static_cast<double>(c[0]) + 0.7152 * static_cast<double>(c[1]) +
           0.0722 * static_cast<double>(c[2]);
}

} // namespace osgTerrainLight
