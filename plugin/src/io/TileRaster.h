#pragma once

#include "core/Result.h"

#include <memory>
#include <string>

namespace osgTerrainLight
{

/// Tiles of a map in folders level/x/y.png, as one raster that GDAL reads by its path for as long
/// as this lives: the finest level of at most 1024 tiles. Between tiles it is void. Tiles have the
/// size and the bands of the first one.
class TileRaster
{
public:
    /// description: a TileMap of OSGeo's Tile Map Service (tilemapresource.xml, tms.xml).
    static Result<TileRaster> ofTileMap(const std::string& description);

    /// pattern: a path that ends in {z}/{x}/{y} and an extension. profile: spherical-mercator or
    /// global-geodetic; the first where empty. fromSouth: whether rows count from the south.
    static Result<TileRaster> ofPattern(const std::string& pattern, const std::string& profile,
                                        bool fromSouth);

    const std::string& path() const { return *_path; }

private:
    explicit TileRaster(const std::string& virtualRaster);

    std::shared_ptr<const std::string> _path; ///< of a file in memory, which goes with it
};

} // namespace osgTerrainLight
