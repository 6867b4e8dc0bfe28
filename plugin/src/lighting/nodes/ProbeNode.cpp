#include "lighting/nodes/ProbeNode.h"

#include "core/KeySlices.h"
#include "gpu/GlConstants.h"
#include "lighting/sources/Sun.h"

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

ProbeNode::ProbeNode(const TileInputs& inputs, const TileSurface& surface, Resource* shading,
                     Resource* skyPicture)
    : Node("probe"), _inputs(&inputs), _surface(&surface), _skyPicture(skyPicture),
      _panorama(own(new Resource("panorama of a probe", {rows, rows, 0, GL_RGBA32F_ARB}))),
      _sunHorizon(own(new Resource("horizon of a probe", {3, 1, 0, GL_R32F}))),
      _look(own(new GpuPass("probe_panorama"))), _project(own(new EnvironmentHarmonicsPass(order))),
      _evaluate(own(new IrradianceMapPass(_project->harmonics(), order)))
{
    reads(surface.heights());
    reads(shading, surface.perPost(GL_RGBA16F_ARB));
    reads(own(inputs.albedoTexture.get()));
    reads(skyPicture);
    reads(inputs.light);
    reads(inputs.probePlaces);
    _light = {surface.heights(), shading, inputs.albedoTexture.get(), skyPicture, inputs.light};
    _look->set("size", surface.width(), surface.height());
    _look->set("frame", surface.frame());
    _look->reads("heights", surface.heights());
    _look->reads("shading", shading);
    _look->reads("albedo", inputs.albedoTexture);
    _look->reads("sky", skyPicture);
    _look->writes(0, _panorama);
    _look->writes(1, _sunHorizon);
}

void ProbeNode::setKeyLights(const SkyLight& light)
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

/// What all probes of the tile have in common.
void ProbeNode::setLight()
{
    const bool hasTable = _inputs->hasSkyTable();
    // Two columns of the sky's picture in each of the panorama's: whole ones, as those are even.
    const int columns = hasTable ? _skyPicture->layout().width / 2 : rows;
    _panorama->setLayout({columns, rows, 0, GL_RGBA32F_ARB});
    _look->setDefines(hasTable ? std::vector<std::string>{"SKY_PICTURE"}
                               : std::vector<std::string>{});
    const Rgb radiance = skyGain(_inputs->sky);
    _look->set("skyRadiance", osg::Vec3f(radiance[0], radiance[1], radiance[2]));
    const auto sun = sunDirections(_inputs->sky);
    _look->set("sunAzimuths", osg::Vec3f(azimuthOf(sun[0]), azimuthOf(sun[1]), azimuthOf(sun[2])));
    setKeyLights(_inputs->sky);
}

Status ProbeNode::light(osg::State& state, const ProbePlace& place)
{
    const DemTile& tile = _surface->tile();
    const int row = std::clamp(static_cast<int>(place.row + 0.5), 0, tile.height() - 1);
    _look->set("spacings", osg::Vec2f(static_cast<float>(tile.eastSpacing(row)),
                                      static_cast<float>(tile.northSpacing)));
    _look->set("place",
               osg::Vec2f(static_cast<float>(place.column), static_cast<float>(place.row)));
    _look->set("height", static_cast<float>(place.height));
    _look->set("aboveGround", place.aboveGround);
    Status done =
        _look->dispatch(state, {GpuPass::groupsFor(_panorama->layout().width + 3, 8), 1, 1});
    if (done)
        done = _project->dispatch(state, _panorama);
    IrradianceMapPass::Sun sun;
    sun.horizon = _inputs->hasSun() ? _sunHorizon : nullptr;
    sun.elevation = _inputs->sky.sunElevation;
    sun.radius = _inputs->sky.sunAngularRadius;
    sun.fraction = _inputs->sky.sunEnabled ? 0.0 : 1.0;
    if (done)
        done = _evaluate->dispatchDiffuse(state, place.diffuse, sun);
    if (done)
        done = _evaluate->dispatchGlossy(state, place.glossy, place.exponent, sun);
    return done;
}

Status ProbeNode::run(osg::State& state)
{
    setLight();
    const unsigned id = state.getContextID();
    std::vector<Resource::Version> versions;
    for (const auto& resource : _light)
        versions.push_back(resource->version(id));
    Lit& before = _lit[id];
    const bool isSameLight = before.light == versions;
    for (const ProbePlace& place : _inputs->probes)
    {
        if (isSameLight &&
            std::find(before.probes.begin(), before.probes.end(), place) != before.probes.end())
            continue;
        if (Status done = light(state, place); !done)
            return done;
        if (place.written)
            place.written->add(id);
    }
    before = {std::move(versions), _inputs->probes};
    return Nothing{};
}

} // namespace osgTerrainLight
