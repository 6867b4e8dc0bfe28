#include "lighting/nodes/BounceNode.h"

#include "gpu/GlConstants.h"

namespace osgTerrainLight
{

Gather::Gather(const TileInputs& inputs, const TileSurface& surface, BounceRays* rays,
               const LightSources& lights, Resource* horizon, Resource* far, bool first)
    : _surface(&surface), _lights(first ? lights : LightSources()), _isFirst(first),
      _stride(inputs.settings.subsampling), _near(own(new GpuPass("bounce")))
{
    own(rays);
    own(inputs.albedoTexture.get());
    if (far)
    {
        own(far);
        _far = own(new GpuPass("bounce"));
        _far->writes(0, far);
        _near->reads("farRadiance", far);
    }
    for (GpuPass* pass : {_near, _far})
    {
        if (!pass)
            continue;
        rays->bind(*pass);
        pass->reads("horizon", horizon);
        pass->reads("albedo", inputs.albedoTexture);
        pass->set("stride", _stride);
    }
}

TextureLayout Gather::farLayout(const TileSurface& surface, const LightingSettings& settings)
{
    const int stride = settings.subsampling;
    return {(surface.width() - 1) / stride + 1, (surface.height() - 1) / stride + 1,
            settings.azimuths, GL_RGBA16F_ARB};
}

Status Gather::dispatch(osg::State& state, const SentNode& sent, Resource* before, Resource* light)
{
    std::vector<std::string> near, far = {"FAR"};
    if (_isFirst)
        near = {"DIRECT"}, far = {"DIRECT", "FAR"};
    if (_far)
        near.emplace_back("NEAR");
    bindLights(*_near, _lights, near);
    _near->reads(_isFirst ? "direct" : "lastLight", before);
    _near->writes(0, light);
    for (GpuPass* pass : {_near, _far})
    {
        if (!pass)
            continue;
        pass->reads("radiance", sent.radiance());
        pass->reads("radiancePyramid", sent.pyramid());
    }
    if (_far)
    {
        // Cells have what other lights give; of the sun they have the mean.
        LightSources single;
        for (const auto& source : _lights)
            if (source->variesInCells())
                single.push_back(source);
        bindLights(*_far, single, far);
        if (Status done = _far->dispatch(state, _surface->groups(_stride)); !done)
            return done;
    }
    return _near->dispatch(state, _surface->groups());
}

BounceNode::BounceNode(const TileSurface& surface, const PyramidNode& pyramid, Gather* gather,
                       SentNode* sent, Resource* horizon, Resource* before, Resource* light)
    : Node("bounce"), _sent(sent), _gather(own(gather)), _before(before), _light(light)
{
    reads(surface.heights());
    reads(pyramid.pyramid(), pyramid.layout().texture(GL_RG32F));
    reads(horizon);
    reads(sent->radiance());
    reads(sent->pyramid());
    writes(own(light));
}

void BounceNode::followsLight(const TileInputs& inputs, const LightSources& lights)
{
    Node::followsLight(_before, inputs.isPaced());
    Node::followsLight(inputs.light, inputs.isPaced());
    for (const auto& light : lights)
        for (Resource* value : light->values())
            Node::followsLight(value, inputs.isPaced());
}

Status BounceNode::run(osg::State& state)
{
    return _gather->dispatch(state, *_sent, _before, _light);
}

} // namespace osgTerrainLight
