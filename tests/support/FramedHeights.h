#pragma once

#include "core/Raster.h"
#include "glsl_host.h"

#include <osgTerrainLight/DemTile.h>

namespace osgTerrainLight
{

/// Heights of a tile as in its texture: void posts hold VOID_HEIGHT, and `frame` of them stand on
/// every side.
template <class Real>
Raster<Real> framedHeights(const DemTile& tile, int frame)
{
    Raster<Real> heights(tile.width() + 2 * frame, tile.height() + 2 * frame,
                         Glsl<Real>::VOID_HEIGHT);
    for (int y = 0; y < tile.height(); ++y)
        for (int x = 0; x < tile.width(); ++x)
            if (tile.isValid(x, y))
                heights.at(x + frame, y + frame) = static_cast<Real>(tile.heightAt(x, y));
    return heights;
}

} // namespace osgTerrainLight
