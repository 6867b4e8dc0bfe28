#pragma once

#include "core/Raster.h"
#include "scene/SceneTile.h"
#include <osgTerrainLight/SkyLight.h>

#include <array>
#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

// Values that a host gives a tile: one per post, row 0 in the south.

bool isTileSized(const SceneTile& tile, std::size_t posts);

/// Whether there is a legal albedo per post, or none.
bool areAlbedo(const SceneTile& tile, const std::vector<Rgb>& values);
/// The same of gloss and exponent.
bool areGloss(const SceneTile& tile, const std::vector<std::array<float, 2>>& values);

/// Of the posts that are drawn. Empty where there are none. Precondition: else there are as many as
/// posts.
template <class T>
Raster<T> rasterOf(const SceneTile& tile, const std::vector<T>& values)
{
    if (values.empty())
        return {};
    Raster<T> raster(tile.lit->drawnWidth(), tile.lit->drawnHeight());
    raster.values() = values;
    return raster;
}

} // namespace osgTerrainLight
