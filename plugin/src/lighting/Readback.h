#pragma once

#include <osgTerrainLight/HorizonMap.h>

#include "core/Raster.h"
#include "gpu/Resource.h"

#include <osg/State>
#include <osg/Vec4f>

#include <vector>

namespace osgTerrainLight
{

// Values of a tile, read back in tile order (row 0 south). All need a current context in which
// they were written.

/// Four values per texel, layer after layer.
std::vector<float> readColourValues(osg::State& state, const Resource& light);
Raster<osg::Vec4f> readColours(osg::State& state, const Resource& light);
/// Of SkyViewNode, of a uniform sky. NaN where void.
Raster<float> readSkyView(osg::State& state, const Resource& view);
/// Of HorizonNode.
HorizonMap readHorizons(osg::State& state, const Resource& horizon);
/// A single R32UI; 0 where it does not exist.
unsigned readCounter(osg::State& state, const Resource& counter);

} // namespace osgTerrainLight
