#include "lighting/nodes/SkyTablePass.h"

#include "core/ClearSky.h"
#include "gpu/EnvironmentTexture.h"
#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "lighting/nodes/AreaLights.h"

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
      _model(new GpuPass("sky_model")), _sum(new GpuPass("sky_table"))
{
    _harmonics->writes(0, _sky);
    _environment->writes(0, _sky);
    _model->writes(0, _sky);
    _sum->reads("sky", _sky);
    _sum->writes(0, _table);
    _sum->set("azimuths", azimuths);
}

void SkyTablePass::setModel(const SkyLight& sky)
{
    if (sky.skyModel != SkyModel::Clear)
    {
        _model->setDefines({});
        _model->set("skyRadiance",
                    osg::Vec3f(sky.skyRadiance[0], sky.skyRadiance[1], sky.skyRadiance[2]));
        _model->set("overcast", sky.skyModel == SkyModel::Overcast);
        return;
    }
    const auto model = clearSky(sky);
    const auto vec3 = [](const auto& v) {
        return osg::Vec3f(static_cast<float>(v.x), static_cast<float>(v.y),
                          static_cast<float>(v.z));
    };
    const auto vec4 = [](const auto& v)
    {
        return osg::Vec4f(static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z),
                          static_cast<float>(v.w));
    };
    _model->setDefines({"CLEAR"});
    _model->set("sunDirection", vec3(model.sun));
    _model->set("luminance", vec4(model.luminance));
    _model->set("x", vec4(model.x));
    _model->set("y", vec4(model.y));
    _model->set("e", vec3(model.e));
    _model->set("zenith", vec3(model.zenith));
    _model->set("gain", vec3(model.gain));
}

Status SkyTablePass::dispatch(osg::State& state, const SkyLight& sky)
{
    GpuPass& picture = sky.environment            ? *_environment
                       : sky.skyHarmonics.empty() ? *_model
                                                  : *_harmonics;
    if (!sky.environment)
        _environment->reads("environment", nullptr); // large: not held for longer than it is used
    _panorama = sky.environment ? environmentTexture(sky.environment) : nullptr;
    if (sky.environment)
    {
        constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;
        picture.reads("environment", _panorama);
        picture.set("heading", static_cast<float>(std::remainder(sky.environmentHeading, 360.0) *
                                                  radiansPerDegree));
        picture.set("gain", static_cast<float>(sky.environmentGain));
    }
    else if (sky.skyHarmonics.empty())
        setModel(sky);
    else
        picture.set(harmonicsUniform(sky.skyHarmonics));
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
    _model->releaseGLObjects(state);
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
    _model->resizeGLObjectBuffers(size);
    if (_panorama)
        _panorama->resizeGLObjectBuffers(size);
    _sum->resizeGLObjectBuffers(size);
    _sky->resizeGLObjectBuffers(size);
    _table->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
