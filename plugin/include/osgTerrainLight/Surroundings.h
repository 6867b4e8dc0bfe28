#pragma once

#include <osgTerrainLight/Export.h>

#include <functional>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Posts that heights are asked for: post (column, row) lies at (west + column · eastStep, south +
/// row · northStep) on the map, in units of its CRS. All values are finite, steps are > 0, and
/// there is at least one column and one row.
struct PostGrid
{
    double west = 0.0, south = 0.0;
    double eastStep = 1.0, northStep = 1.0;
    int columns = 1, rows = 1;
};

/// The ground around tiles of addTile(), for an application that does not load it as tiles.
struct OSGTERRAINLIGHT_EXPORT Surroundings
{
    /// The CRS of the map, the same text as DemTile::crs of the tiles that it surrounds.
    std::string crs;

    /// The rectangle of the map where there is ground, in units of the CRS. West < east and south <
    /// north. Beyond it nothing is asked for, and there is nothing that casts shadows.
    double west = 0.0, south = 0.0, east = 0.0, north = 0.0;

    /// Returns a height for each post of the grid [m above the vertical datum, as DemTile's height
    /// and heightOrigin together]: columns from west to east, rows from south to north, row 0
    /// first. A height that is not finite or beyond ±1e6 m is void. All posts lie in the rectangle,
    /// within a thousandth of a step.
    ///
    /// It is called in the update traversal, on its thread, several times for each tile that is
    /// lit: for posts at the tile's own spacing near it, and for coarser ones, of which each stands
    /// for the ground around it, farther away. For a tile of 257 × 257 posts these are one to two
    /// million posts per level of doubled spacing. It must not call the lighting. Where it throws,
    /// or returns another number of heights than the grid has posts, these posts are void, and one
    /// warning says so.
    std::function<std::vector<float>(const PostGrid& grid)> heights;

    /// Says what is wrong with the rectangle or the function. Empty where nothing is.
    std::string complaint() const;
};

} // namespace osgTerrainLight
