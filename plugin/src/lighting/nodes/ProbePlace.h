#pragma once

#include "gpu/ContextSet.h"

#include <osg/TextureCubeMap>
#include <osg/ref_ptr>

#include <memory>

namespace osgTerrainLight
{

/// Where a probe stands on a tile, and what is computed for it.
struct ProbePlace
{
    double column = 0.0, row = 0.0; ///< posts, with fractions, within the tile
    double height = 0.0;            ///< [m] above the ground, or above heightOrigin
    bool aboveGround = true;
    double exponent = 16.0; ///< of the glossy map's lobe, 1 … 64
    osg::ref_ptr<osg::TextureCubeMap> diffuse, glossy;
    /// Contexts in which the maps are there; null: nobody asks. Not compared.
    std::shared_ptr<ContextSet> written;

    bool operator==(const ProbePlace& other) const
    {
        return column == other.column && row == other.row && height == other.height &&
               aboveGround == other.aboveGround && exponent == other.exponent &&
               diffuse == other.diffuse && glossy == other.glossy;
    }
};

} // namespace osgTerrainLight
