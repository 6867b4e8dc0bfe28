#pragma once

#include "lighting/TileSurface.h"

#include <osg/Vec4f>
#include <osg/ref_ptr>

#include <vector>

namespace osgTerrainLight
{

/// Most azimuths that the blocks of directions in the shaders have room for.
constexpr std::size_t maxAzimuths = 256;

/// What the block Rays of the shaders has for every azimuth of AzimuthSet: drift along the minor
/// axis per step, look, 1 where the major axis is north, 0. Filled up to maxAzimuths.
std::vector<osg::Vec4f> azimuthRays(const DemTile& tile, int azimuths);

/// Lines, one post apart, that an azimuth's sweep walks over the tile.
int lineCount(const DemTile& tile, const osg::Vec4f& ray);

/// R32F [m]: ground length of a step of azimuth x in row y.
osg::ref_ptr<Resource> createStepLengths(const TileSurface& surface, int azimuths);

} // namespace osgTerrainLight
