#pragma once

#include "lighting/TileSurface.h"
#include "lighting/nodes/GridDirection.h"

#include <osg/Vec4f>
#include <osg/ref_ptr>

#include <vector>

namespace osgTerrainLight
{

/// Most azimuths that the blocks of directions in the shaders have room for.
constexpr std::size_t maxAzimuths = 256;

/// What the block Rays of the shaders has for every azimuth of AzimuthSet: drift along the minor
/// axis per step, look, 1 where the major axis is north, lineShift() of lines a post apart. Filled
/// up to maxAzimuths.
std::vector<osg::Vec4f> azimuthRays(const TileSurface& surface, int azimuths);

/// Lines, one post apart, that an azimuth's sweep walks over the tile.
int lineCount(const TileSurface& surface, const osg::Vec4f& ray);

/// How far a sweep's lines are moved along the minor axis, so that they are the same lines in all
/// tiles of a terrain, those of the whole lit as one tile [posts]. 0 where nothing surrounds it.
double lineShift(const TileSurface& surface, const GridDirection& grid, int linesPerPost);

/// Steps that lines of the whole terrain have walked where they come to the tile's first posts; < 0
/// for a tile beyond the terrain's end.
int stepsBefore(const TileSurface& surface, const GridDirection& grid);

/// R32F [m]: ground length of a step of azimuth x in row y.
osg::ref_ptr<Resource> createStepLengths(const TileSurface& surface, int azimuths);

} // namespace osgTerrainLight
