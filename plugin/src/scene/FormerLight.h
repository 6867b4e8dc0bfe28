#pragma once

#include <osg/Matrixd>
#include <osg/Texture2D>

#include <algorithm>
#include <array>
#include <set>

namespace osgTerrainLight
{

/// Parts of the light along the borders of a tile, 0 … 1; each falls to 0 over 8 posts.
struct BorderParts
{
    std::array<float, 4> sides{};   ///< west, south, east, north
    std::array<float, 4> corners{}; ///< south-west, south-east, north-west, north-east

    bool any() const
    {
        const auto some = [](float part) { return part > 0.0f; };
        return std::any_of(sides.begin(), sides.end(), some) ||
               std::any_of(corners.begin(), corners.end(), some);
    }
    bool operator==(const BorderParts& other) const
    {
        return sides == other.sides && corners == other.corners;
    }
};

/// Light that a tile is drawn with until its own is there, and then fades from: what it had before,
/// or that of a tile above it. That of a tile above stays along borders with coarser tiles.
struct FormerLight
{
    osg::ref_ptr<osg::Texture2D> shading;
    osg::ref_ptr<osg::Texture2D> edges; ///< of shadows; null where there are none
    /// To its texture coordinates, from the place on the tile that is drawn with it: (0, 0) at the
    /// south-western post, (1, 1) at the north-eastern one. Affine.
    osg::Matrixd toTexture;
    std::set<unsigned> contexts; ///< that have computed it
    bool isAbove = false;        ///< that of a tile above
    bool waits = true;           ///< for the tile's own light
    double part = 1.0;           ///< of the light that is drawn, 1 … 0
};

} // namespace osgTerrainLight
