#pragma once

#include "Options.h"
#include "core/Result.h"
#include "io/RasterSource.h"
#include "lighting/TileWindows.h"

#include <functional>
#include <memory>

/// The terrain that a run lights, and what that sees.
namespace osgTerrainLight::tool
{

/// Whether what is lit of INPUT sees more than itself: the rest of it, or surroundings.
bool seesOutside(const RasterOptions& options, const DemInfo& info);

/// INPUT, of any size, with what surrounds it. progress: of coarse levels that are made, 0 … 1.
Result<std::unique_ptr<RasterSource>> openTerrain(const RasterOptions& options,
                                                  std::function<void(double)> progress);

/// A tile by itself: all that there is.
std::shared_ptr<const TileWindows> aloneOf(DemTile tile);

} // namespace osgTerrainLight::tool
