#include "lighting/nodes/ScreenEdgesNode.h"

namespace osgTerrainLight
{

ScreenEdgesNode::ScreenEdgesNode(const TileInputs& inputs, const TileSurface& surface,
                                 const LightSources& lights, Resource* edges)
    : Node("edges"), _surface(&surface), _sun(varyingInCells(lights)),
      _pass(own(new GpuPass("screen_edges")))
{
    reads(surface.heights());
    reads(inputs.settingsValue);
    reads(inputs.light);
    for (const auto& light : _sun)
        for (Resource* value : light->values())
            reads(value);
    writes(own(edges));
    surface.bind(*_pass);
    _pass->writes(0, edges);
    neededWhere([in = osg::ref_ptr<const TileInputs>(&inputs)] { return in->hasSun(); });
}

Status ScreenEdgesNode::run(osg::State& state)
{
    bindLights(*_pass, _sun);
    return _pass->dispatch(state, _surface->groups());
}

} // namespace osgTerrainLight
