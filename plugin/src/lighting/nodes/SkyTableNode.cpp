#include "lighting/nodes/SkyTableNode.h"

#include "core/ClearSky.h"
#include "gpu/EnvironmentTexture.h"
#include "gpu/GlConstants.h"

#include <cassert>
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

osg::ref_ptr<osg::Uniform> harmonicsUniform(const std::vector<Rgb>& harmonics)
{
    assert(harmonics.size() <= 16);
    osg::ref_ptr<osg::Uniform> uniform =
        new osg::Uniform(osg::Uniform::FLOAT_VEC3, "harmonics", 16);
    for (unsigned i = 0; i < 16; ++i)
    {
        const Rgb c = i < harmonics.size() ? harmonics[i] : Rgb{};
        uniform->setElement(i, osg::Vec3f(c[0], c[1], c[2]));
    }
    return uniform;
}

SkyTableNode::SkyTableNode(const TileInputs& inputs, int azimuths, int rows)
    : Node("table"), _inputs(&inputs), _azimuths(azimuths),
      _picture(writes(own(
          new Resource("picture of the sky", {columnsFor(azimuths), rows, 0, GL_RGBA32F_ARB})))),
      _table(writes(
          own(new Resource("table of the sky", {azimuths, 3 * (rows + 1), 0, GL_RGBA32F_ARB})))),
      _panorama(own(new Resource("panorama"))), _harmonics(own(new GpuPass("sky_harmonics"))),
      _environment(own(new GpuPass("sky_environment"))), _model(own(new GpuPass("sky_model"))),
      _sum(own(new GpuPass("sky_table")))
{
    reads(inputs.settingsValue);
    reads(inputs.skyValue);
    for (GpuPass* pass : {_harmonics, _environment, _model})
        pass->writes(0, _picture);
    _environment->reads("environment", _panorama);
    _sum->reads("sky", _picture);
    _sum->writes(0, _table);
    _sum->set("azimuths", azimuths);
}

void SkyTableNode::setModel(const SkyLight& sky)
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

/// The pass that draws the sky's picture, with what it needs.
GpuPass& SkyTableNode::choosePass()
{
    const SkyLight& sky = _inputs->sky;
    if (sky.environment)
    {
        constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;
        _panorama->share(environmentTexture(sky.environment));
        _environment->set(
            "heading",
            static_cast<float>(std::remainder(sky.environmentHeading, 360.0) * radiansPerDegree));
        _environment->set("gain", static_cast<float>(sky.environmentGain));
        return *_environment;
    }
    _panorama->drop(); // large: not held for longer than it is used
    if (sky.skyHarmonics.empty())
    {
        setModel(sky);
        return *_model;
    }
    _harmonics->set(harmonicsUniform(sky.skyHarmonics));
    return *_harmonics;
}

Status SkyTableNode::run(osg::State& state)
{
    const TextureLayout& size = _picture->layout();
    Status done = choosePass().dispatch(
        state, {GpuPass::groupsFor(size.width, 8), GpuPass::groupsFor(size.height, 8), 1});
    return done ? _sum->dispatch(state, {GpuPass::groupsFor(_azimuths, 16), 1, 1}) : done;
}

} // namespace osgTerrainLight
