#include "gpu/passes/Bounces.h"

#include "gpu/GpuPass.h"
#include "gpu/Textures.h"

namespace osgTerrainLight
{

std::size_t Bounces::bytes() const
{
    std::size_t sum = 0;
    for (const osg::Texture2D* texture : textures())
        sum += textureBytes(*texture);
    return sum;
}

void Bounces::releaseGLObjects(osg::State* state) const
{
    for (const GpuPass* pass : passes())
        pass->releaseGLObjects(state);
    for (const osg::Texture2D* texture : textures())
        texture->releaseGLObjects(state);
}

void Bounces::resizeGLObjectBuffers(unsigned size)
{
    for (GpuPass* pass : passes())
        pass->resizeGLObjectBuffers(size);
    for (osg::Texture2D* texture : textures())
        texture->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
