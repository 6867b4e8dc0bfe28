#include "lighting/nodes/PyramidHorizonPass.h"

#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "lighting/nodes/HorizonPass.h"
#include "lighting/nodes/PyramidRays.h"

namespace osgTerrainLight
{

PyramidHorizonPass::PyramidHorizonPass(const DemTile& tile, osg::Texture2D* heights,
                                       const BounceScheme& scheme, int azimuths, Join join)
    : _width(tile.width()), _height(tile.height()), _azimuths(azimuths),
      _pyramid(new HeightPyramid(tile, heights, HorizonPass::frame)),
      _eastSpacings(createSpacingTexture(tile)),
      _horizon(createLayeredTarget(_width, _height, azimuths, GL_R16)),
      _scan(new GpuPass("pyramid_horizon"))
{
    setPyramidScan(*_scan, tile, scheme, *_pyramid, _eastSpacings);
    std::vector<osg::Vec4f> rays =
        raySteps(tile.nominalEastSpacing(), tile.northSpacing, directionsOf(AzimuthSet(azimuths)));
    rays.resize(256);
    _scan->setBlock(rays);
    _scan->set("smoothly", join == Join::BSpline);
    _scan->writes(0, _horizon);
}

Status PyramidHorizonPass::dispatch(osg::State& state)
{
    const Status done = _pyramid->dispatch(state);
    return done ? _scan->dispatch(state,
                                  {GpuPass::groupsFor(_width, 8), GpuPass::groupsFor(_height, 8),
                                   static_cast<unsigned>(_azimuths)})
                : done;
}

std::size_t PyramidHorizonPass::bytes() const
{
    return _pyramid->bytes() + textureBytes(*_eastSpacings) + textureBytes(*_horizon);
}

void PyramidHorizonPass::releaseGLObjects(osg::State* state) const
{
    _pyramid->releaseGLObjects(state);
    _scan->releaseGLObjects(state);
    _eastSpacings->releaseGLObjects(state);
    _horizon->releaseGLObjects(state);
}

void PyramidHorizonPass::resizeGLObjectBuffers(unsigned size)
{
    _pyramid->resizeGLObjectBuffers(size);
    _scan->resizeGLObjectBuffers(size);
    _eastSpacings->resizeGLObjectBuffers(size);
    _horizon->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
