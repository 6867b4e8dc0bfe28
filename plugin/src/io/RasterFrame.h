#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace osgTerrainLight
{

/// Where a raster lies and how its rows and columns run: what a result needs to be written so that
/// its pixels coincide with the input's.
struct RasterFrame
{
    int width = 0;
    int height = 0;
    /// False where the geotransform below was made up from a cell size; it is then not written.
    bool hasGeoTransform = false;
    /// GDAL's order: pixel corner to map; no rotation.
    std::array<double, 6> geoTransform = {0.0, 1.0, 0.0, 0.0, 0.0, -1.0};
    bool northUp = true;          ///< row 0 of the file is its northernmost
    bool westFirst = true;        ///< column 0 of the file is its westernmost
    std::string crs;              ///< WKT 2; empty where unknown
    double coordinateEpoch = 0.0; ///< of a dynamic CRS, decimal year; 0 where the file has none

    /// Row and column of the file that hold a tile's row and column (and the other way round).
    int fileRow(int tileRow) const { return northUp ? height - 1 - tileRow : tileRow; }
    int fileColumn(int tileColumn) const { return westFirst ? tileColumn : width - 1 - tileColumn; }
    /// Of the same extent with other cells.
    RasterFrame scaledTo(int newWidth, int newHeight) const
    {
        RasterFrame result = *this;
        result.width = newWidth;
        result.height = newHeight;
        for (const std::size_t i : {1u, 4u})
            result.geoTransform[i] *= static_cast<double>(width) / newWidth;
        for (const std::size_t i : {2u, 5u})
            result.geoTransform[i] *= static_cast<double>(height) / newHeight;
        return result;
    }
    /// Map coordinates of a post of the tile.
    double mapX(double tileColumn) const
    {
        const double column = westFirst ? tileColumn : width - 1 - tileColumn;
        return geoTransform[0] + (column + 0.5) * geoTransform[1];
    }
    double mapY(double tileRow) const
    {
        const double row = northUp ? height - 1 - tileRow : tileRow;
        return geoTransform[3] + (row + 0.5) * geoTransform[5];
    }
};

} // namespace osgTerrainLight
