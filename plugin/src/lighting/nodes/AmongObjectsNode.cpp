#include "lighting/nodes/AmongObjectsNode.h"

#include "core/ConeSet.h"
#include "fields/ObjectClusters.h"
#include "lighting/LampUniforms.h"

#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;

osg::Vec3f vector(const glm::dvec3& v)
{
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

osg::Vec3f vector(const Rgb& v)
{
    return {v[0], v[1], v[2]};
}
} // namespace

AmongObjectsNode::AmongObjectsNode(const std::string& name, const std::string& pass,
                                   const TileInputs& inputs, const TileSurface& surface,
                                   const ObjectSurroundings& light, int cones)
    : Node(name), _inputs(&inputs), _surface(&surface), _hasHorizon(light.horizon),
      _pass(own(new GpuPass(pass)))
{
    reads(surface.heights());
    reads(light.direct);
    if (light.shading != light.direct)
        reads(light.shading);
    if (light.horizon)
        reads(light.horizon);
    reads(light.skyPicture);
    reads(inputs.light);
    reads(inputs.objectsValue);
    _pass->set("size", surface.width(), surface.height());
    _pass->set("frame", surface.frame());
    _pass->reads("heights", surface.heights());
    _pass->reads("direct", light.direct);
    _pass->reads("shading", light.shading);
    _pass->reads("horizon", light.horizon);
    _pass->reads("sky", light.skyPicture);
    const ConeSet set = ConeSet::of(cones);
    std::vector<osg::Vec4f> values;
    for (const std::array<float, 4>& each : set.packed())
        values.emplace_back(each[0], each[1], each[2], each[3]);
    osg::ref_ptr<osg::UIntArray> around = new osg::UIntArray;
    for (const ConeSet::Cone& cone : set.cones)
        around->push_back(cone.around);
    _pass->setBlock(values, 0);
    _pass->setStorage(0, around);
}

void AmongObjectsNode::setLight()
{
    std::vector<std::string> defines = {"AMONG_OBJECTS"};
    if (_hasHorizon && _inputs->hasSky())
        defines.emplace_back("HORIZON");
    if (_inputs->hasSkyTable())
        defines.emplace_back("SKY_PICTURE");
    if (_inputs->hasSun())
    {
        defines.emplace_back("SUN_AMONG_OBJECTS");
        const SkyLight sky = _inputs->lightAtGround();
        const std::array<double, 3> direction = sky.sunDirection();
        _pass->set("sunDirection", vector(glm::dvec3(direction[0], direction[1], direction[2])));
        _pass->set("sunIrradiance", vector(sky.sunIrradiance));
        _pass->set("sunRadius", static_cast<float>(sky.sunAngularRadius * radiansPerDegree));
    }
    _pass->set("skyRadiance", vector(skyGain(_inputs->sky)));
    _pass->setDefines(std::move(defines));
}

bool AmongObjectsNode::setObject(const osg::State& state, const TileObject& object)
{
    _pass->set("spacings", osg::Vec2f(static_cast<float>(object.spacing.x),
                                      static_cast<float>(object.spacing.y)));
    _pass->set("corner", vector(object.corner));
    _pass->set("volumeSize", vector(object.voxel * glm::dvec3(object.voxels)));
    _pass->set("voxel", static_cast<float>(object.voxel));
    _pass->set("reach", static_cast<float>(object.voxel * ObjectCluster::reach));
    _pass->set("contentLow", vector(object.low - object.corner));
    _pass->set("contentHigh", vector(object.high - object.corner));
    for (const auto& uniform : lampUniforms(object.lamps))
        _pass->set(uniform.get());
    _pass->reads("volume", object.volume);
    const osg::Texture* volume = object.volume->texture();
    return volume && volume->getTextureObject(state.getContextID());
}

} // namespace osgTerrainLight
