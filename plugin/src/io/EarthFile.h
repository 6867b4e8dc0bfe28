#pragma once

#include "core/Result.h"
#include "io/DemReader.h"
#include "io/EarthModel.h"
#include "io/EarthViewpoint.h"
#include "io/LightParameters.h"

#include <string>
#include <vector>

namespace osgTerrainLight
{

/// A layer that GDAL reads.
struct EarthLayer
{
    std::string what; ///< its element, as messages call it: <GDALImage name="base">
    std::string url;  ///< as written, with / for \; relative to the file's folder
    int line = 0;
    DemReadOptions read;       ///< of an elevation: cell_size, unit, z_factor
    std::string verticalDatum; ///< of an elevation, as osgEarth names it; empty: none is named
    double opacity = 1.0;      ///< of an image, 0 … 1
    std::string driver;        ///< gdal, mbtiles, tms or xyz
    std::string profile;       ///< of tiles by xyz, in lower case; may be empty
    bool fromSouth = false;    ///< rows of tiles by xyz count from the south
};

/// What we read of an .earth file (docs/EARTH_FILE.md).
struct EarthMap
{
    std::string name;
    bool geocentric = false;   ///< its terrain lies on a globe
    std::string verticalDatum; ///< that heights are brought to (<profile>); empty: none is named
    std::vector<EarthLayer> elevations;
    std::vector<EarthLayer> images; ///< bottom first
    std::vector<EarthModel> models; ///< that stand on the terrain
    LightParameters light;
    std::vector<EarthViewpoint> viewpoints; ///< in their order, from the home on
    std::string leftOut;                    ///< all elements that are not drawn, and why; one list
    std::vector<std::string> warnings;      ///< those that somebody may look for in the picture
    std::vector<std::string> notes;         ///< what else was left out, and why
};

/// Names of elements and keys may be in any case; a key is an attribute or a child. A layer that is
/// switched off (open, enabled or visible is false, no or off), has no url or is of another kind is
/// left out and named; where no other is left, that is the error. Of a key that is empty in one
/// place, the other place counts.
/// source: what messages call the text. Errors name source, line, key, value and what is needed.
Result<EarthMap> parseEarth(const std::string& text, const std::string& source);

Result<EarthMap> readEarthFile(const std::string& path);

} // namespace osgTerrainLight
