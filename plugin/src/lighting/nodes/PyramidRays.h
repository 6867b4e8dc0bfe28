#pragma once

#include <osgTerrainLight/DemTile.h>

#include "core/AzimuthSet.h"
#include "gpu/GpuPass.h"
#include "lighting/nodes/BouncePass.h"
#include "lighting/nodes/HeightPyramid.h"

#include <osg/Vec4f>

#include <vector>

namespace osgTerrainLight
{

/// A step along each direction, as the shaders that scan a pyramid have it: posts to the east and
/// to the north, one of them ±1; the direction on the ground. eastSpacing: the tile's nominal one.
std::vector<osg::Vec4f> raySteps(double eastSpacing, double northSpacing,
                                 const std::vector<MapDirection>& directions);

/// All directions of a set, in its order.
std::vector<MapDirection> directionsOf(const AzimuthSet& set);

/// Sets what a pass that scans a pyramid from every post needs beside the rays: heights,
/// eastSpacings, northSpacing, heightPyramid, size, frame, samplesPerOctave, offset, sampleCount,
/// levelCount and levels. eastSpacings: createSpacingTexture(tile).
void setPyramidScan(GpuPass& pass, const DemTile& tile, const BounceScheme& scheme,
                    const HeightPyramid& pyramid, osg::Texture2D* eastSpacings);

} // namespace osgTerrainLight
