#include "gpu/passes/PyramidHorizonPass.h"

#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "gpu/passes/HorizonPass.h"
#include "gpu/passes/PyramidRays.h"

namespace osgTerrainLight
{

PyramidHorizonPass::PyramidHorizonPass(const DemTile& tile, osg::Texture2D* heights,
                                       const BounceScheme& scheme, int azimuths, Join join)
    : _width(tile.width()), _height(tile.height()), _azimuths(azimuths),
      _posts(PyramidLayout::ofPosts(_width, _height)), _heights(heights),
      _firstHeights(new GpuPass("pyramid", {"HEIGHTS", "FROM_POSTS"})),
      _nextHeights(new GpuPass("pyramid", {"HEIGHTS"})), _scan(new GpuPass("pyramid_horizon"))
{
    _heightPyramid = createTarget(_posts.width, _posts.height, GL_RG32F);
    _horizon = createLayeredTarget(_width, _height, azimuths, GL_R16);
    _stepLengths = setPyramidRays(*_scan, tile, scheme, azimuths, heights, _posts, _heightPyramid);
    _scan->set("smoothly", join == Join::BSpline);
    _scan->writes(0, _horizon);
}

Status PyramidHorizonPass::dispatch(osg::State& state)
{
    const Status done = reducePyramid(state, _posts, *_firstHeights, _heights, HorizonPass::frame,
                                      *_nextHeights, _heightPyramid);
    return done ? _scan->dispatch(state,
                                  {GpuPass::groupsFor(_width, 8), GpuPass::groupsFor(_height, 8),
                                   static_cast<unsigned>(_azimuths)})
                : done;
}

std::size_t PyramidHorizonPass::bytes() const
{
    return textureBytes(*_heightPyramid) + textureBytes(*_stepLengths) + textureBytes(*_horizon);
}

void PyramidHorizonPass::releaseGLObjects(osg::State* state) const
{
    for (const auto& pass : {_firstHeights, _nextHeights, _scan})
        pass->releaseGLObjects(state);
    for (const osg::Texture* texture :
         {static_cast<osg::Texture*>(_heightPyramid), static_cast<osg::Texture*>(_stepLengths),
          static_cast<osg::Texture*>(_horizon)})
        texture->releaseGLObjects(state);
}

void PyramidHorizonPass::resizeGLObjectBuffers(unsigned size)
{
    for (const auto& pass : {_firstHeights, _nextHeights, _scan})
        pass->resizeGLObjectBuffers(size);
    for (osg::Texture* texture :
         {static_cast<osg::Texture*>(_heightPyramid), static_cast<osg::Texture*>(_stepLengths),
          static_cast<osg::Texture*>(_horizon)})
        texture->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
