#include "gpu/passes/SkyTablePass.h"

#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "gpu/passes/AreaLights.h"

namespace osgTerrainLight
{

namespace
{
/// Of the sky's picture: at least 256, and an even number for each slice, as slices begin half of
/// one beside the east.
int columnsFor(int azimuths)
{
    return 2 * azimuths * ((128 + azimuths - 1) / azimuths);
}
} // namespace

SkyTablePass::SkyTablePass(int azimuths, int rows)
    : _azimuths(azimuths), _sky(createTarget(columnsFor(azimuths), rows, GL_RGBA32F_ARB)),
      _table(createTarget(azimuths, 3 * (rows + 1), GL_RGBA32F_ARB)),
      _harmonics(new GpuPass("sky_harmonics")), _sum(new GpuPass("sky_table"))
{
    _harmonics->writes(0, _sky);
    _sum->reads("sky", _sky);
    _sum->writes(0, _table);
    _sum->set("azimuths", azimuths);
}

Status SkyTablePass::dispatch(osg::State& state, const std::vector<Rgb>& harmonics)
{
    _harmonics->set(harmonicsUniform(harmonics));
    Status done = _harmonics->dispatch(state, {GpuPass::groupsFor(_sky->getTextureWidth(), 8),
                                               GpuPass::groupsFor(_sky->getTextureHeight(), 8), 1});
    if (!done)
        return done;
    return _sum->dispatch(state, {GpuPass::groupsFor(_azimuths, 16), 1, 1});
}

std::size_t SkyTablePass::bytes() const
{
    return textureBytes(*_sky) + textureBytes(*_table);
}

void SkyTablePass::releaseGLObjects(osg::State* state) const
{
    _harmonics->releaseGLObjects(state);
    _sum->releaseGLObjects(state);
    _sky->releaseGLObjects(state);
    _table->releaseGLObjects(state);
}

void SkyTablePass::resizeGLObjectBuffers(unsigned size)
{
    _harmonics->resizeGLObjectBuffers(size);
    _sum->resizeGLObjectBuffers(size);
    _sky->resizeGLObjectBuffers(size);
    _table->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
