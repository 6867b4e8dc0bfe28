#include "lighting/nodes/ShadeNode.h"

namespace osgTerrainLight
{

ShadeNode::ShadeNode(const TileInputs& inputs, const TileSurface& surface, Resource* skyView,
                     const LightSources& lights, Resource* direct)
    : Node("shade"), _surface(&surface), _lights(lights), _pass(own(new GpuPass("shade")))
{
    reads(surface.heights());
    reads(skyView);
    reads(inputs.settingsValue);
    reads(inputs.light);
    for (const auto& light : lights)
        for (Resource* value : light->values())
            reads(value);
    writes(own(direct));
    surface.bind(*_pass);
    _pass->reads("skyView", skyView);
    _pass->writes(0, direct);
}

Status ShadeNode::run(osg::State& state)
{
    bindLights(*_pass, _lights);
    return _pass->dispatch(state, _surface->groups());
}

} // namespace osgTerrainLight
