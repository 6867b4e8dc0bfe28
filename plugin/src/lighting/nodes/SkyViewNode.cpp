#include "lighting/nodes/SkyViewNode.h"

#include "gpu/GlConstants.h"

namespace osgTerrainLight
{

SkyViewNode::SkyViewNode(const TileInputs& inputs, const TileSurface& surface, Resource* horizon,
                         Resource* table)
    : Node("sky"), _inputs(&inputs), _surface(&surface),
      _view(writes(own(new Resource("sky view", surface.perPost(GL_R32F))))),
      _pass(own(new GpuPass("sky_view")))
{
    reads(horizon, surface.perPost(GL_R16, inputs.settings.azimuths));
    reads(table);
    surface.bind(*_pass);
    _pass->reads("horizon", horizon);
    _pass->reads("skyTable", table);
    _pass->writes(0, _view);
    _pass->set("azimuths", inputs.settings.azimuths);
    _pass->set("definition", static_cast<int>(inputs.definition));
    followFormat();
}

void SkyViewNode::followFormat()
{
    _view->setLayout(_surface->perPost(_inputs->hasSkyTable() ? GL_RGBA16F_ARB : GL_R32F));
}

Status SkyViewNode::run(osg::State& state)
{
    _pass->setDefines(_inputs->hasSkyTable() ? std::vector<std::string>{"SKY_TABLE"}
                                             : std::vector<std::string>{});
    return _pass->dispatch(state, _surface->groups());
}

} // namespace osgTerrainLight
