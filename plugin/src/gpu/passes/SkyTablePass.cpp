#include "gpu/passes/SkyTablePass.h"

#include "core/SkyRadiance.h"
#include "gpu/EnvironmentTexture.h"
#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "gpu/passes/AreaLights.h"

#include <cmath>

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
      _harmonics(new GpuPass("sky_harmonics")), _environment(new GpuPass("sky_environment")),
      _sum(new GpuPass("sky_table"))
{
    _harmonics->writes(0, _sky);
    _environment->writes(0, _sky);
    _sum->reads("sky", _sky);
    _sum->writes(0, _table);
    _sum->set("azimuths", azimuths);
}

Status SkyTablePass::dispatch(osg::State& state, const SkyLight& sky)
{
    GpuPass& picture = sky.environment ? *_environment : *_harmonics;
    _panorama = sky.environment ? environmentTexture(sky.environment) : nullptr;
    if (sky.environment)
    {
        constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;
        picture.reads("environment", _panorama);
        picture.set("heading", static_cast<float>(std::remainder(sky.environmentHeading, 360.0) *
                                                  radiansPerDegree));
        picture.set("gain", static_cast<float>(sky.environmentGain));
    }
    else
        picture.set(harmonicsUniform(harmonicsOf(sky)));
    Status done = picture.dispatch(state, {GpuPass::groupsFor(_sky->getTextureWidth(), 8),
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
    _environment->releaseGLObjects(state);
    if (_panorama)
        _panorama->releaseGLObjects(state);
    _sum->releaseGLObjects(state);
    _sky->releaseGLObjects(state);
    _table->releaseGLObjects(state);
}

void SkyTablePass::resizeGLObjectBuffers(unsigned size)
{
    _harmonics->resizeGLObjectBuffers(size);
    _environment->resizeGLObjectBuffers(size);
    if (_panorama)
        _panorama->resizeGLObjectBuffers(size);
    _sum->resizeGLObjectBuffers(size);
    _sky->resizeGLObjectBuffers(size);
    _table->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
