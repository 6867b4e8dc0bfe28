#include "lighting/nodes/GlossPass.h"

#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "lighting/nodes/HorizonPass.h"

#include <cmath>
#include <string>

namespace osgTerrainLight
{

namespace
{
constexpr int harmonicLayers = GlossPass::layers - 1;

osg::Vec3f vec3(const std::array<float, 3>& v)
{
    return {v[0], v[1], v[2]};
}

osg::Vec3f vec3(const std::array<double, 3>& v)
{
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}
} // namespace

GlossPass::GlossPass(const DemTile& tile, osg::Texture2D* heights, osg::Texture2D* eastSpacings,
                     osg::Texture2D* material, osg::Texture2DArray* light, int azimuths,
                     int bounces, GlossTransfer transfer, const std::array<double, 3>& viewer)
    : _width(tile.width()), _height(tile.height()), _transfer(transfer), _light(light),
      _direct(new GpuPass("gloss", {"DIRECT"})),
      _gather(new GpuPass("gloss", transfer == GlossTransfer::Scalar
                                       ? std::vector<std::string>{"SCALAR"}
                                       : std::vector<std::string>{}))
{
    const auto target = [&](bool whole)
    {
        return createLayeredTarget(whole ? _width : 1, whole ? _height : 1, harmonicLayers,
                                   GL_RGBA16F_ARB);
    };
    _exit = {target(bounces > 0), target(bounces > 1)};
    for (const auto& pass : {_direct, _gather})
    {
        pass->reads("heights", heights);
        pass->reads("eastSpacings", eastSpacings);
        pass->reads("material", material);
        pass->set("size", _width, _height);
        pass->set("frame", int(HorizonPass::frame));
        pass->set("azimuths", azimuths);
        pass->set("northSpacing", static_cast<float>(tile.northSpacing));
        pass->writes(0, light, GpuPass::Access::ReadWrite);
    }
    if (bounces == 0)
        return;
    if (transfer == GlossTransfer::Vector)
    {
        const PyramidLayout posts = PyramidLayout::ofPosts(_width, _height);
        _pyramid = createLayeredTarget(posts.width, posts.height, harmonicLayers, GL_RGBA16F_ARB);
        _gather->reads("exitPyramid", _pyramid);
        _reduce = new GpuPass("pyramid", {"ON_POSTS", "LAYERED"});
        return;
    }
    osg::Vec3d towards(viewer[0], viewer[1], viewer[2]);
    towards.normalize();
    _shade = new GpuPass("gloss_shade");
    _shade->set("size", _width, _height);
    _shade->set("towards", osg::Vec3f(towards));
}

Status GlossPass::dispatchDirect(osg::State& state, const SkyLight& sky, const AreaLights& lights,
                                 osg::Texture2DArray* horizon, osg::Texture2D* shading)
{
    AreaLights keys;
    keys.keyHorizon = lights.keyHorizon;
    keys.keys = lights.keys;
    if (sky.skyHarmonics.empty())
        keys.apply(*_direct, {"DIRECT"});
    else
    {
        keys.apply(*_direct, {"DIRECT", "HARMONICS"});
        _direct->set(harmonicsUniform(sky.skyHarmonics));
    }
    _direct->reads("horizon", horizon);
    _direct->reads("shading", shading);
    _direct->writes(1, _exit[0]);
    _direct->set("hasSky", sky.skyEnabled);
    _direct->set("skyRadiance", vec3(sky.skyEnabled ? sky.skyRadiance : Rgb{}));
    _direct->set("sunIrradiance", vec3(sky.sunEnabled ? sky.sunIrradiance : Rgb{}));
    _direct->set("sunDirection", vec3(sky.sunDirection()));
    return _direct->dispatch(state,
                             {GpuPass::groupsFor(_width, 8), GpuPass::groupsFor(_height, 8), 1});
}

Status GlossPass::dispatchSent(osg::State& state, int bounce, const PyramidLayout& posts,
                               osg::Texture2D* radiance)
{
    const auto& sent = _exit[static_cast<std::size_t>(bounce % 2)];
    if (_transfer == GlossTransfer::Vector)
        return reducePyramid(state, posts, *_reduce, sent, 0, *_reduce, _pyramid);
    _shade->reads("lastExit", sent);
    _shade->writes(0, radiance, GpuPass::Access::ReadWrite);
    return _shade->dispatch(state,
                            {GpuPass::groupsFor(_width, 8), GpuPass::groupsFor(_height, 8), 1});
}

Status GlossPass::dispatchBounce(osg::State& state, int bounce, osg::Texture2DArray* horizon,
                                 osg::Texture2D* shading, osg::Texture2D* bounced)
{
    _gather->reads("horizon", horizon);
    _gather->writes(1, _exit[static_cast<std::size_t>((bounce + 1) % 2)]);
    if (_transfer == GlossTransfer::Vector)
    {
        _gather->reads("lastExit", _exit[static_cast<std::size_t>(bounce % 2)]);
        _gather->writes(2, shading, GpuPass::Access::ReadWrite);
        _gather->writes(3, bounced, GpuPass::Access::ReadWrite);
    }
    return _gather->dispatch(state,
                             {GpuPass::groupsFor(_width, 8), GpuPass::groupsFor(_height, 8), 1});
}

std::vector<osg::Texture*> GlossPass::textures() const
{
    std::vector<osg::Texture*> all = {_exit[0], _exit[1]};
    if (_pyramid)
        all.push_back(_pyramid);
    return all;
}

std::vector<GpuPass*> GlossPass::passes() const
{
    std::vector<GpuPass*> all = {_direct, _gather};
    for (const auto& pass : {_shade, _reduce})
        if (pass)
            all.push_back(pass);
    return all;
}

std::size_t GlossPass::bytes() const
{
    std::size_t sum = 0;
    for (const osg::Texture* texture : textures())
        sum += textureBytes(*texture);
    return sum;
}

void GlossPass::releaseGLObjects(osg::State* state) const
{
    for (const GpuPass* pass : passes())
        pass->releaseGLObjects(state);
    for (const osg::Texture* texture : textures())
        texture->releaseGLObjects(state);
}

void GlossPass::resizeGLObjectBuffers(unsigned size)
{
    for (GpuPass* pass : passes())
        pass->resizeGLObjectBuffers(size);
    for (osg::Texture* texture : textures())
        texture->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
