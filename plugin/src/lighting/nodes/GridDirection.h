#pragma once

#include "core/AzimuthSet.h"

#include <osgTerrainLight/DemTile.h>

#include <cmath>

namespace osgTerrainLight
{

/// A horizontal direction as the horizon shaders walk it: one post per step along the axis it
/// crosses faster (major), `drift` posts along the other.
struct GridDirection
{
    bool north = false; ///< the major axis is south to north, not west to east
    int look = 1;       ///< towards + or − along the major axis
    double drift = 0.0; ///< along the minor axis per step towards + of the major, −1 … 1

    /// Azimuths are laid out with the tile's nominal east spacing.
    GridDirection(const DemTile& tile, const MapDirection& direction)
        : GridDirection(tile.nominalEastSpacing(), tile.northSpacing, direction)
    {
    }

    GridDirection(double eastSpacing, double northSpacing, const MapDirection& direction)
    {
        const double x = direction.east / eastSpacing; // posts per metre
        const double y = direction.north / northSpacing;
        north = std::abs(y) > std::abs(x);
        drift = north ? x / y : y / x;
        look = (north ? y : x) < 0.0 ? -1 : 1;
    }

    /// Length of a step on the ground [m] where columns are eastSpacing apart.
    double stepLength(double eastSpacing, double northSpacing) const
    {
        return north ? std::hypot(drift * eastSpacing, northSpacing)
                     : std::hypot(eastSpacing, drift * northSpacing);
    }
};

} // namespace osgTerrainLight
