#include "lighting/nodes/Bounces.h"

#include "gpu/GlConstants.h"
#include "gpu/Textures.h"

namespace osgTerrainLight
{

LightSum::LightSum(int width, int height)
    : _groups{GpuPass::groupsFor(width, 8), GpuPass::groupsFor(height, 8), 1},
      _sum(createTarget(width, height, GL_RGBA16F_ARB)), _add(new GpuPass("add_light")),
      _addToShading(new GpuPass("add_light", {"SHADING"}))
{
    for (const auto& pass : {_add, _addToShading})
        pass->set("size", width, height);
    _add->writes(0, _sum, GpuPass::Access::ReadWrite);
    _addToShading->reads("added", _sum);
}

Status LightSum::add(osg::State& state, osg::Texture2D* light, bool first)
{
    _add->reads("added", light);
    _add->set("first", first);
    return _add->dispatch(state, _groups);
}

Status LightSum::addTo(osg::State& state, osg::Texture2D* shading)
{
    _addToShading->writes(0, shading, GpuPass::Access::ReadWrite);
    return _addToShading->dispatch(state, _groups);
}

void LightSum::releaseGLObjects(osg::State* state) const
{
    for (const auto& pass : {_add, _addToShading})
        pass->releaseGLObjects(state);
    _sum->releaseGLObjects(state);
}

void LightSum::resizeGLObjectBuffers(unsigned size)
{
    for (const auto& pass : {_add, _addToShading})
        pass->resizeGLObjectBuffers(size);
    _sum->resizeGLObjectBuffers(size);
}

Status Bounces::keep(osg::State& state, osg::Texture2D* light, int bounce)
{
    return _sum ? _sum->add(state, light, bounce == 0) : Nothing{};
}

std::size_t Bounces::bytes() const
{
    std::size_t sum = 0;
    for (const osg::Texture* texture : textures())
        sum += textureBytes(*texture);
    return sum;
}

void Bounces::releaseGLObjects(osg::State* state) const
{
    for (const GpuPass* pass : passes())
        pass->releaseGLObjects(state);
    for (const osg::Texture* texture : textures())
        texture->releaseGLObjects(state);
}

void Bounces::resizeGLObjectBuffers(unsigned size)
{
    for (GpuPass* pass : passes())
        pass->resizeGLObjectBuffers(size);
    for (osg::Texture* texture : textures())
        texture->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
