#include "lighting/nodes/SentNode.h"

#include "gpu/GlConstants.h"

#include <algorithm>

namespace osgTerrainLight
{

SentNode::SentNode(const TileInputs& inputs, const TileSurface& surface,
                   std::vector<std::string> defines)
    : Node("sent"), _inputs(&inputs), _surface(&surface),
      _faces(writes(own(new Resource(
          "sent light", {2 * surface.width(), 2 * surface.height(), 0, GL_RGBA16F_ARB})))),
      _pass(own(new GpuPass("faces", std::move(defines))))
{
    reads(surface.heights());
    reads(own(inputs.albedoTexture.get()));
    surface.bind(*_pass);
    _pass->reads("albedo", inputs.albedoTexture);
    _pass->writes(0, _faces);
}

SentNode::SentNode(const TileInputs& inputs, const TileSurface& surface, const LightSources& lights,
                   Resource* horizon)
    : SentNode(inputs, surface, std::vector<std::string>{"DIRECT"})
{
    _ofDirect = true;
    _lights = lights;
    reads(inputs.settingsValue);
    reads(inputs.bouncesDue);
    reads(horizon, surface.perPost(GL_R16, inputs.settings.azimuths));
    followsLight(inputs.light, inputs.isPaced());
    for (const auto& light : lights)
        for (Resource* value : light->values())
            followsLight(value, inputs.isPaced());
    _pass->reads("horizon", horizon);
    _pass->set("azimuths", inputs.settings.azimuths);
}

SentNode::SentNode(const TileInputs& inputs, const TileSurface& surface, Resource* horizon,
                   Resource* light)
    : SentNode(inputs, surface, std::vector<std::string>{})
{
    reads(horizon, surface.perPost(GL_R16, inputs.settings.azimuths));
    _pass->reads("horizon", horizon);
    _pass->set("azimuths", inputs.settings.azimuths);
    reads(light, surface.perPost(GL_RGBA16F_ARB));
    _pass->reads("light", light);
}

void SentNode::addPyramid(const PyramidLayout& cells)
{
    _layout = cells;
    _radiance = writes(own(
        new Resource("mean sent light", {std::max(1, _surface->width() - 1),
                                         std::max(1, _surface->height() - 1), 0, GL_RGBA16F_ARB})));
    _cells = own(new GpuPass("radiance"));
    _surface->bind(*_cells);
    _cells->reads("faces", _faces);
    _cells->reads("albedo", _inputs->albedoTexture);
    _cells->writes(0, _radiance);
    _pyramid = writes(own(new Resource("sent light, far", cells.texture(GL_RGBA16F_ARB))));
    _first = own(new GpuPass("pyramid", {"FROM_CELLS"}));
    _next = own(new GpuPass("pyramid"));
}

void SentNode::addGloss(const GlossWork& gloss, Resource* exit)
{
    reads(exit);
    _addGloss = own(gloss.createShadePass());
    _addGloss->reads("lastExit", exit);
    _addGloss->writes(0, _faces, GpuPass::Access::ReadWrite);
}

Status SentNode::run(osg::State& state)
{
    if (_ofDirect)
        bindLights(*_pass, _lights, {"DIRECT"});
    Status done = _pass->dispatch(state, _surface->groups());
    if (done && _addGloss)
        done = _addGloss->dispatch(state, _surface->groups());
    if (done && _pyramid)
    {
        bindLights(*_cells, varyingInCells(_lights));
        done = _cells->dispatch(state, _surface->groups());
    }
    if (done && _pyramid)
        done = reducePyramid(state, _layout, *_first, _radiance, 0, *_next, _pyramid);
    return done;
}

} // namespace osgTerrainLight
