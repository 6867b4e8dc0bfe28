#include "lighting/nodes/LegendreBounceNode.h"

#include "gpu/GlConstants.h"
#include "lighting/nodes/PyramidRays.h"

namespace osgTerrainLight
{

TextureLayout blockLayout(const TileSurface& surface, int stride)
{
    return {(surface.width() - 1) / stride + 1, (surface.height() - 1) / stride + 1, 0,
            GL_RGBA16F_ARB};
}

LegendreSentNode::LegendreSentNode(const TileInputs& inputs, const TileSurface& surface, int stride,
                                   Resource* light, bool byBlock, bool paced)
    : Node("sent"), _surface(&surface), _stride(stride),
      _blocks(PyramidLayout::ofPosts((surface.width() - 1) / stride + 1,
                                     (surface.height() - 1) / stride + 1)),
      _radiance(writes(own(new Resource("sent light", blockLayout(surface, stride))))),
      _pyramid(writes(own(new Resource("sent light, far", _blocks.texture(GL_RGBA16F_ARB))))),
      _pass(own(new GpuPass("post_radiance"))), _reduce(own(new GpuPass("pyramid", {"ON_POSTS"})))
{
    reads(surface.heights());
    reads(own(inputs.albedoTexture.get()));
    reads(inputs.settingsValue);
    reads(inputs.bouncesDue);
    followsLight(light, paced);
    surface.bind(*_pass);
    _pass->reads("albedo", inputs.albedoTexture);
    _pass->reads("light", light);
    _pass->set("byBlock", byBlock);
    _pass->set("stride", stride);
    _pass->writes(0, _radiance);
}

Status LegendreSentNode::run(osg::State& state)
{
    const Status done = _pass->dispatch(state, _surface->groups(_stride));
    return done ? reducePyramid(state, _blocks, *_reduce, _radiance, 0, *_reduce, _pyramid) : done;
}

LegendreGather::LegendreGather(const PyramidNode& pyramid, const LegendreScheme& scheme)
    : _surface(&pyramid.surface()), _scheme(scheme),
      _last(own(createLegendreLight({}, pyramid, scheme).get())),
      _other(own(createLegendreLight({"SENDS_ON"}, pyramid, scheme).get()))
{
    const DemTile& tile = _surface->tile();
    std::vector<osg::Vec4f> rays = raySteps(tile.nominalEastSpacing(), tile.northSpacing,
                                            directionsOf(AzimuthSet(scheme.azimuths)));
    rays.resize(256);
    for (GpuPass* pass : {_last, _other})
    {
        pass->setBlock(rays);
        pass->set("azimuths", scheme.azimuths);
    }
}

Status LegendreGather::dispatch(osg::State& state, const LegendreSentNode& sent, Resource* light,
                                Resource* blocks)
{
    GpuPass& pass = blocks ? *_other : *_last;
    setLevels(pass, "radianceLevels", sent.blocks());
    pass.set("radianceLevelCount", static_cast<int>(sent.blocks().levels.size()));
    pass.reads("radiance", sent.radiance());
    pass.reads("radiancePyramid", sent.pyramid());
    pass.writes(0, light);
    if (blocks)
        pass.writes(1, blocks);
    return pass.dispatch(state, legendreGroups(*_surface, _scheme.stride));
}

LegendreBounceNode::LegendreBounceNode(const PyramidNode& pyramid, LegendreGather* gather,
                                       LegendreSentNode* sent, Resource* light, Resource* blocks)
    : Node("bounce"), _gather(own(gather)), _sent(sent), _light(light), _blocks(blocks)
{
    reads(pyramid.surface().heights());
    reads(pyramid.pyramid(), pyramid.layout().texture(GL_RG32F));
    reads(sent->radiance(), blockLayout(pyramid.surface(), gather->scheme().stride));
    reads(sent->pyramid());
    writes(own(light));
    if (blocks)
        writes(own(blocks));
}

Status LegendreBounceNode::run(osg::State& state)
{
    return _gather->dispatch(state, *_sent, _light, _blocks);
}

} // namespace osgTerrainLight
