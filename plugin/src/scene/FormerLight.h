#pragma once

#include <osg/Matrixd>
#include <osg/Texture2D>

#include <optional>
#include <set>

namespace osgTerrainLight
{

/// Light that a tile is drawn with until its own is there, and then fades from: what it had before,
/// or that of a tile above it.
struct FormerLight
{
    osg::ref_ptr<osg::Texture2D> shading;
    osg::ref_ptr<osg::Texture2D> edges; ///< of shadows; null where there are none
    /// To its texture coordinates, from the place on the tile that is drawn with it: (0, 0) at the
    /// south-western post, (1, 1) at the north-eastern one. Affine.
    osg::Matrixd toTexture;
    std::set<unsigned> contexts;  ///< that have computed it
    std::optional<double> fading; ///< since when [s]; none while the tile's own light is not there
};

} // namespace osgTerrainLight
