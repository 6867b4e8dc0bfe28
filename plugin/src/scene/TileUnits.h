#pragma once

#include "scene/TileRegistry.h"
#include <osgTerrainLight/ShadingTexture.h>

#include <string>

namespace osgTerrainLight
{

/// Texture units that tiles are bound with; those that are bound already keep theirs.
struct TileUnits
{
    static constexpr unsigned last = 31;

    unsigned shading = ShadingTexture::defaultUnit;
    unsigned gloss = ShadingTexture::glossUnit;

    /// Why light sent by gloss may not have the unit: the shading of some tile has it, or the
    /// heights of a DynamicTerrain. Empty where it may.
    std::string glossProblem(unsigned unit, const TileRegistry& registry) const;
};

} // namespace osgTerrainLight
