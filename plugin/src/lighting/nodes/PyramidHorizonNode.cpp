#include "lighting/nodes/PyramidHorizonNode.h"

#include "gpu/GlConstants.h"
#include "lighting/nodes/PyramidRays.h"

namespace osgTerrainLight
{

PyramidHorizonNode::PyramidHorizonNode(const PyramidNode& pyramid, const BounceScheme& scheme,
                                       int azimuths, Join join)
    : Node("pyramid horizon"), _surface(&pyramid.surface()), _azimuths(azimuths),
      _horizon(writes(own(new Resource("horizon", _surface->perPost(GL_R16, azimuths))))),
      _scan(own(new GpuPass("pyramid_horizon")))
{
    reads(_surface->heights());
    reads(pyramid.pyramid(), pyramid.layout().texture(GL_RG32F));
    setPyramidScan(*_scan, scheme, pyramid);
    const DemTile& tile = _surface->tile();
    std::vector<osg::Vec4f> rays =
        raySteps(tile.nominalEastSpacing(), tile.northSpacing, directionsOf(AzimuthSet(azimuths)));
    rays.resize(256);
    _scan->setBlock(rays);
    _scan->set("smoothly", join == Join::BSpline);
    _scan->writes(0, _horizon);
}

Status PyramidHorizonNode::run(osg::State& state)
{
    GpuPass::Groups groups = _surface->groups();
    groups.z = static_cast<unsigned>(_azimuths);
    return _scan->dispatch(state, groups);
}

} // namespace osgTerrainLight
