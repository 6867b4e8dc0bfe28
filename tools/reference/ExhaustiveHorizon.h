#pragma once

#include "core/AzimuthSet.h"

#include <osgTerrainLight/DemTile.h>

#include <limits>

namespace osgTerrainLight::reference
{

struct HorizonOptions
{
    /// Also the maximum inside each bilinear cell, not only on grid-line crossings.
    bool insideCells = true;
    /// A height that no post exceeds [m above the tile's heightOrigin]. The scan stops where not
    /// even that could rise above the horizon found: the same result, sooner. See highestPost().
    double highest = std::numeric_limits<double>::infinity();
};

/// What bounds the view from a post in one direction.
struct Horizon
{
    /// Tangent of the elevation above the horizontal; −∞ where nothing lies ahead.
    double slope = -std::numeric_limits<double>::infinity();
    /// Horizontal distance to the point that makes the horizon [m]; 0: the surface at the post.
    double distance = 0.0;

    /// −90 … 90 [degrees]; −90 where nothing lies ahead.
    double elevationDegrees() const;
};

/// The oracle: supremum of the slope from post (column, row) to every point of the bilinear surface
/// along a ray towards `direction` (any length but 0), up to the edge of the data, in double. The
/// value is not clamped at 0.
///
/// Every crossing of a column or a row is tested, and the maximum inside each cell. A cell with a
/// void corner has no surface inside; a crossing counts where both its posts are valid, or the one
/// that it hits. Beyond the data the horizon is open. A void receiver sees nothing: −∞.
///
/// Where the east spacing differs from row to row, the ray is straight on a grid with the tile's
/// nominal east spacing, and the east part of a distance is measured with the receiver's row's.
Horizon exhaustiveHorizon(const DemTile& tile, int column, int row, const MapDirection& direction,
                          const HorizonOptions& options = {});

/// Highest valid post [m above heightOrigin]; −∞ where all are void.
double highestPost(const DemTile& tile);

} // namespace osgTerrainLight::reference
