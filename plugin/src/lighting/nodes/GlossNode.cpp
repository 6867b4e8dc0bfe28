#include "lighting/nodes/GlossNode.h"

#include "gpu/GlConstants.h"
#include "lighting/nodes/SentNode.h"
#include "lighting/nodes/SkyTableNode.h"

#include <string>

namespace osgTerrainLight
{

namespace
{
constexpr int harmonicLayers = GlossWork::layers - 1;

osg::Vec3f vec3(const std::array<float, 3>& v)
{
    return {v[0], v[1], v[2]};
}

osg::Vec3f vec3(const std::array<double, 3>& v)
{
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}
} // namespace

GlossWork::GlossWork(const TileInputs& inputs, const TileSurface& surface, BounceRays* rays,
                     Resource* horizon)
    : _inputs(&inputs), _surface(&surface), _transfer(inputs.settings.glossTransfer),
      _posts(PyramidLayout::ofPosts(surface.width(), surface.height())),
      _direct(own(new GpuPass("gloss", {"DIRECT"}))),
      _gather(own(new GpuPass("gloss", isVector() ? std::vector<std::string>{}
                                                  : std::vector<std::string>{"SCALAR"}))),
      _reduce(own(new GpuPass("pyramid", {"ON_POSTS", "LAYERED"})))
{
    own(inputs.materialTexture.get());
    if (rays)
        own(rays)->bind(*_gather);
    for (GpuPass* pass : {_direct, _gather})
    {
        surface.bind(*pass);
        pass->reads("material", inputs.materialTexture);
        pass->reads("horizon", horizon);
        pass->set("azimuths", inputs.settings.azimuths);
    }
    if (!rays || !isVector())
        return;
    _exitPyramid =
        own(new Resource("exit light, far", _posts.texture(GL_RGBA16F_ARB, harmonicLayers)));
    _gather->reads("exitPyramid", _exitPyramid);
}

Resource* GlossWork::createLight() const
{
    return new Resource("light of gloss", _surface->perPost(GL_RGBA16F_ARB, layers));
}

Resource* GlossWork::createExit(bool isRead) const
{
    return new Resource("exit light", isRead ? _surface->perPost(GL_RGBA16F_ARB, harmonicLayers)
                                             : TextureLayout{1, 1, harmonicLayers, GL_RGBA16F_ARB});
}

GpuPass* GlossWork::createShadePass() const
{
    const std::array<double, 3>& viewer = _inputs->settings.glossViewer;
    osg::Vec3d towards(viewer[0], viewer[1], viewer[2]);
    towards.normalize();
    GpuPass* pass = new GpuPass("gloss_shade");
    pass->set("size", _surface->width(), _surface->height());
    pass->set("towards", osg::Vec3f(towards));
    return pass;
}

Status GlossWork::dispatch(osg::State& state, const Bounce& bounce)
{
    if (isVector())
    {
        if (Status done = reducePyramid(state, _posts, *_reduce, bounce.exitBefore, 0, *_reduce,
                                        _exitPyramid);
            !done)
            return done;
        _gather->reads("lastExit", bounce.exitBefore);
        _gather->reads("diffuse", bounce.diffuse);
        _gather->writes(2, bounce.bounced);
    }
    _gather->reads("radiance", bounce.sent->radiance());
    _gather->reads("radiancePyramid", bounce.sent->pyramid());
    _gather->reads("lightBefore", bounce.lightBefore);
    _gather->writes(0, bounce.light);
    _gather->writes(1, bounce.exit);
    return _gather->dispatch(state, _surface->groups());
}

GlossNode::GlossNode(const TileInputs& inputs, GlossWork* work, const LightSources& lights,
                     Resource* horizon, Resource* direct, Resource* light, Resource* exit)
    : Node("gloss"), _inputs(&inputs), _work(own(work)), _lights(lights), _light(light), _exit(exit)
{
    reads(inputs.light);
    reads(inputs.materialTexture);
    reads(horizon, work->_surface->perPost(GL_R16, inputs.settings.azimuths));
    reads(direct, work->_surface->perPost(GL_RGBA16F_ARB));
    for (const auto& source : lights)
        for (Resource* value : source->values())
            reads(value);
    writes(own(light));
    writes(own(exit));
    work->_direct->reads("shading", direct);
}

Status GlossNode::run(osg::State& state)
{
    SkyLight sky = _inputs->lightInHarmonics();
    GpuPass& pass = *_work->_direct;
    if (sky.skyHarmonics.empty())
        bindLights(pass, _lights, {"DIRECT"});
    else
    {
        bindLights(pass, _lights, {"DIRECT", "HARMONICS"});
        pass.set(harmonicsUniform(sky.skyHarmonics));
    }
    pass.writes(0, _light);
    pass.writes(1, _exit);
    pass.set("hasSky", sky.skyEnabled);
    pass.set("skyRadiance", vec3(sky.skyEnabled ? sky.skyRadiance : Rgb{}));
    pass.set("sunIrradiance", vec3(_inputs->hasSun() ? sky.sunIrradiance : Rgb{}));
    pass.set("sunDirection", vec3(sky.sunDirection()));
    return pass.dispatch(state, _work->_surface->groups());
}

GlossBounceNode::GlossBounceNode(const TileSurface& surface, const PyramidNode& pyramid,
                                 GlossWork* work, SentNode* sent, Resource* horizon,
                                 const GlossWork::Bounce& bounce)
    : Node("gloss"), _work(own(work)), _sent(sent),
      _bounce(bounce), _held{bounce.exitBefore, bounce.lightBefore}
{
    reads(surface.heights());
    reads(pyramid.pyramid());
    reads(horizon);
    reads(sent->radiance());
    reads(sent->pyramid());
    reads(bounce.exitBefore, surface.perPost(GL_RGBA16F_ARB, harmonicLayers));
    reads(bounce.lightBefore, surface.perPost(GL_RGBA16F_ARB, GlossWork::layers));
    writes(own(bounce.light));
    writes(own(bounce.exit));
    if (!work->isVector())
        return;
    reads(bounce.diffuse, surface.perPost(GL_RGBA16F_ARB));
    writes(own(bounce.bounced));
    _held.emplace_back(bounce.diffuse);
}

Status GlossBounceNode::run(osg::State& state)
{
    return _work->dispatch(state, _bounce);
}

} // namespace osgTerrainLight
