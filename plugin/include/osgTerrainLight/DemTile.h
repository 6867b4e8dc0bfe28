#pragma once

#include <osgTerrainLight/Export.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Heights of one tile: plain values, no scene graph, no file.
///
/// Posts are height samples at cell corners of the surface, which is bilinear between them. Row 0
/// is the southernmost row, column 0 the westernmost. Heights are float metres above
/// `heightOrigin`, which is double: nothing large reaches a float. Voids are a mask, not a value: a
/// void post has valid == 0 and its height is 0 and means nothing; it neither casts, receives nor
/// emits light.
class OSGTERRAINLIGHT_EXPORT DemTile
{
public:
    DemTile() = default;

    /// An all-void tile of width × height posts with square cells of `spacing` metres.
    DemTile(int width, int height, double spacing);

    int width() const { return _width; }
    int height() const { return _height; }
    std::size_t postCount() const { return _heights.size(); }

    /// Height of post (column, row) above heightOrigin [m]; 0 where void.
    float heightAt(int column, int row) const { return _heights[index(column, row)]; }
    bool isValid(int column, int row) const { return _valid[index(column, row)] != 0; }

    /// Sets a post's height above heightOrigin [m] and makes it valid. A non-finite height, or one
    /// beyond ±1e6 m, makes the post void instead.
    void setHeight(int column, int row, float heightAboveOrigin);
    void setVoid(int column, int row);

    const std::vector<float>& heights() const { return _heights; }
    const std::vector<std::uint8_t>& validity() const { return _valid; }
    std::size_t validCount() const;

    /// Height that 0 in heights() stands for [m, above the DEM's vertical datum].
    double heightOrigin = 0.0;

    /// Distance between rows, south to north [m], > 0.
    double northSpacing = 1.0;

    /// Distance between columns, west to east [m], > 0, of each row; one entry where all rows agree
    /// (a projected CRS), height() entries where they do not (a geographic CRS).
    std::vector<double> eastSpacings = {1.0};
    double eastSpacing(int row) const;

    /// East spacing of the middle of the tile [m]: the one that azimuths are laid out with.
    double nominalEastSpacing() const;

    /// How far the ground of a planet of that radius lies at a post below the plane that touches it
    /// in the middle of the tile [m]; 0 for a radius of 0, which stands for a flat one.
    double sinkAt(int column, int row, double bodyRadius) const;

    /// Map coordinates of post (0, 0) and the steps between posts, in units of the CRS; information
    /// for the caller that places the tile, never used in lighting.
    double mapOriginX = 0.0, mapOriginY = 0.0;
    double mapStepX = 1.0, mapStepY = 1.0;

    /// CRS as WKT; empty where unknown.
    std::string crs;

private:
    std::size_t index(int column, int row) const
    {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(_width) +
               static_cast<std::size_t>(column);
    }

    int _width = 0;
    int _height = 0;
    std::vector<float> _heights;
    std::vector<std::uint8_t> _valid;
};

} // namespace osgTerrainLight
