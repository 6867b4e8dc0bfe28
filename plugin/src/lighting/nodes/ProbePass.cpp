#include "lighting/nodes/ProbePass.h"

#include "core/KeySlices.h"
#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "lighting/nodes/AreaLights.h"

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;
constexpr int rows = 128;

float azimuthOf(const MapDirection& direction)
{
    return static_cast<float>(std::atan2(direction.north, direction.east));
}
} // namespace

ProbePass::ProbePass(const DemTile& tile)
    : _tile(tile), _panorama(createTarget(rows, rows, GL_RGBA32F_ARB)),
      _sunHorizon(createTarget(3, 1, GL_R32F)), _look(new GpuPass("probe_panorama")),
      _project(new EnvironmentHarmonicsPass(order)),
      _evaluate(new IrradianceMapPass(_project->harmonics(), order))
{
    _look->set("size", tile.width(), tile.height());
    _look->writes(1, _sunHorizon);
}

void ProbePass::setKeyLights(const SkyLight& light)
{
    // By its slices a light is what lights the ground, above the horizontal.
    const std::vector<KeySlices> keys = keySlices(light, 4);
    osg::ref_ptr<osg::Uniform> areas =
        new osg::Uniform(osg::Uniform::FLOAT_VEC4, "keyAreas", static_cast<int>(maxKeyLights));
    osg::ref_ptr<osg::Uniform> radiances = new osg::Uniform(
        osg::Uniform::FLOAT_VEC3, "keyLightRadiances", static_cast<int>(maxKeyLights));
    for (unsigned i = 0; i < keys.size(); ++i)
    {
        const KeySlices& key = keys[i];
        const double width = key.width * key.count;
        const double middle = key.first + 0.5 * (width - key.width);
        areas->setElement(i, osg::Vec4f(azimuthOf(directionOfCompass(middle)),
                                        static_cast<float>(0.5 * width * radiansPerDegree),
                                        static_cast<float>(key.lowest * radiansPerDegree),
                                        static_cast<float>(key.highest * radiansPerDegree)));
        radiances->setElement(i, osg::Vec3f(key.radiance[0], key.radiance[1], key.radiance[2]));
    }
    _look->set(areas);
    _look->set(radiances);
    _look->set("keyLightCount", static_cast<int>(keys.size()));
}

Status ProbePass::dispatch(osg::State& state, const ProbePlace& place, const Light& light)
{
    // Two columns of the sky's picture in each of the panorama's: whole ones, as those are even.
    const int columns = light.sky ? light.sky->getTextureWidth() / 2 : rows;
    if (_panorama->getTextureWidth() != columns)
        _panorama = createTarget(columns, rows, GL_RGBA32F_ARB);
    GpuPass& look = *_look;
    look.setDefines(light.sky ? std::vector<std::string>{"SKY_PICTURE"}
                              : std::vector<std::string>{});
    look.writes(0, _panorama);
    look.reads("heights", light.heights);
    look.reads("shading", light.shading);
    look.reads("albedo", light.albedo);
    look.reads("sky", light.sky);
    look.set("frame", light.frame);
    const int row = std::clamp(static_cast<int>(place.row + 0.5), 0, _tile.height() - 1);
    look.set("spacings", osg::Vec2f(static_cast<float>(_tile.eastSpacing(row)),
                                    static_cast<float>(_tile.northSpacing)));
    look.set("place", osg::Vec2f(static_cast<float>(place.column), static_cast<float>(place.row)));
    look.set("height", static_cast<float>(place.height));
    look.set("aboveGround", place.aboveGround);
    const Rgb radiance = skyGain(light.light);
    look.set("skyRadiance", osg::Vec3f(radiance[0], radiance[1], radiance[2]));
    look.set("sunAzimuths",
             osg::Vec3f(azimuthOf(light.sun[0]), azimuthOf(light.sun[1]), azimuthOf(light.sun[2])));
    setKeyLights(light.light);
    Status done = look.dispatch(state, {GpuPass::groupsFor(columns + 3, 8), 1, 1});
    if (done)
        done = _project->dispatch(state, _panorama);
    IrradianceMapPass::Sun sun;
    sun.horizon = light.hasSun ? _sunHorizon.get() : nullptr;
    sun.elevation = light.light.sunElevation;
    sun.radius = light.light.sunAngularRadius;
    sun.fraction = light.light.sunEnabled ? 0.0 : 1.0;
    if (done)
        done = _evaluate->dispatchDiffuse(state, place.diffuse, sun);
    if (done)
        done = _evaluate->dispatchGlossy(state, place.glossy, place.exponent, sun);
    return done;
}

std::size_t ProbePass::bytes() const
{
    return textureBytes(*_panorama) + textureBytes(*_sunHorizon) + _project->bytes();
}

void ProbePass::releaseGLObjects(osg::State* state) const
{
    _look->releaseGLObjects(state);
    _project->releaseGLObjects(state);
    _evaluate->releaseGLObjects(state);
    _panorama->releaseGLObjects(state);
    _sunHorizon->releaseGLObjects(state);
}

void ProbePass::resizeGLObjectBuffers(unsigned size)
{
    _look->resizeGLObjectBuffers(size);
    _project->resizeGLObjectBuffers(size);
    _evaluate->resizeGLObjectBuffers(size);
    _panorama->resizeGLObjectBuffers(size);
    _sunHorizon->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
