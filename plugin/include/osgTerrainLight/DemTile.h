#pragma once

#include <osgTerrainLight/Export.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// The heights of one tile as plain values, without scene graph and file.
///
/// Posts are height samples. The surface is bilinear between them. Row 0 is the southernmost row,
/// and column 0 is the westernmost column. A height is a float, in metres above `heightOrigin`,
/// which is a double, so that large heights keep their digits. Voids are kept in a mask: a void
/// post has validity 0 and height 0. It does not cast shadows, and it receives and sends no light.
class OSGTERRAINLIGHT_EXPORT DemTile
{
public:
    DemTile() = default;

    /// A tile of width × height posts, all void, with square cells of `spacing` metres.
    DemTile(int width, int height, double spacing);

    int width() const { return _width; }
    int height() const { return _height; }
    std::size_t postCount() const { return _heights.size(); }

    /// The height of a post above heightOrigin [m]; 0 where it is void.
    float heightAt(int column, int row) const { return _heights[index(column, row)]; }
    bool isValid(int column, int row) const { return _valid[index(column, row)] != 0; }

    /// Sets a post's height above heightOrigin [m] and makes the post valid. A height that is not
    /// finite or beyond ±1e6 m makes the post void instead.
    void setHeight(int column, int row, float heightAboveOrigin);
    void setVoid(int column, int row);

    const std::vector<float>& heights() const { return _heights; }
    const std::vector<std::uint8_t>& validity() const { return _valid; }
    std::size_t validCount() const;

    /// Says why the tile cannot be lit: it has no post, or a spacing is missing or not legal. Empty
    /// where nothing is wrong.
    std::string complaint() const;

    /// The height that 0 in heights() stands for [m above the DEM's vertical datum].
    double heightOrigin = 0.0;

    /// The distance between rows, from south to north [m], > 0.
    double northSpacing = 1.0;

    /// The distance between columns, from west to east [m], > 0. There is one entry where it is the
    /// same in all rows (a projected CRS), else one entry per row (a geographic CRS).
    std::vector<double> eastSpacings = {1.0};
    double eastSpacing(int row) const;

    /// The east spacing in the middle of the tile [m]. Azimuths are laid out with it.
    double nominalEastSpacing() const;

    /// How far the ground of a planet lies below the plane that touches it in the middle of the
    /// tile, at a post [m]. bodyRadius: of the planet [m]; 0 stands for flat ground and gives 0.
    double sinkAt(int column, int row, double bodyRadius) const;

    /// Map coordinates of post (0, 0), and the steps between posts, in units of the CRS. They place
    /// the tile among others (TerrainLighting::addTile()); the light of one tile does not use them.
    double mapOriginX = 0.0, mapOriginY = 0.0;
    double mapStepX = 1.0, mapStepY = 1.0;

    /// The CRS as WKT; empty where it is not known.
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
