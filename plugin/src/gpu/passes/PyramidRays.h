#pragma once

#include <osgTerrainLight/DemTile.h>

#include "gpu/GpuPass.h"
#include "gpu/passes/BouncePass.h"

#include <osg/Texture2D>

namespace osgTerrainLight
{

/// Tells a pass how to scan a pyramid on posts from every post, in equally spaced azimuths: sets
/// heights, stepLengths, heightPyramid, size, frame, directions, samplesPerOctave, offset,
/// sampleCount, levelCount and levels. heights: createHeightTexture(tile, HorizonPass::frame).
/// Returns the texture of step lengths.
osg::ref_ptr<osg::Texture2D> setPyramidRays(GpuPass& pass, const DemTile& tile,
                                            const BounceScheme& scheme, int azimuths,
                                            osg::Texture2D* heights, const PyramidLayout& posts,
                                            osg::Texture2D* heightPyramid);

} // namespace osgTerrainLight
