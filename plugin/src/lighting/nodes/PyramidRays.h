#pragma once

#include "core/AzimuthSet.h"
#include "gpu/GpuPass.h"
#include "lighting/nodes/BounceRays.h"
#include "lighting/nodes/PyramidNode.h"

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

/// Sets what a pass that scans a pyramid from every post needs beside the rays: what the surface
/// binds, heightPyramid, samplesPerOctave, offset, sampleCount, levelCount and levels.
void setPyramidScan(GpuPass& pass, const BounceScheme& scheme, const PyramidNode& pyramid);

} // namespace osgTerrainLight
