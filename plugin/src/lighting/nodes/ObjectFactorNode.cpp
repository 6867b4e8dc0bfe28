#include "lighting/nodes/ObjectFactorNode.h"

#include "core/ConeSet.h"
#include "fields/ObjectClusters.h"
#include "gpu/GlConstants.h"

#include <algorithm>
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

osg::Vec2f vector(const glm::dvec2& v)
{
    return {static_cast<float>(v.x), static_cast<float>(v.y)};
}
} // namespace

ObjectFactorNode::ObjectFactorNode(const TileInputs& inputs, const TileSurface& surface,
                                   const Light& light, Resource* factor)
    : Node("object factor"), _inputs(&inputs), _surface(&surface), _hasHorizon(light.horizon),
      _pass(own(new GpuPass("object_factor")))
{
    // It is drawn.
    factor->keepWhole();
    reads(surface.heights());
    reads(light.direct);
    if (light.shading != light.direct)
        reads(light.shading);
    if (light.horizon)
        reads(light.horizon);
    reads(light.skyPicture);
    reads(inputs.light);
    reads(inputs.objectsValue);
    for (const TileObject& object : inputs.objects)
        reads(object.volume);
    writes(own(factor));
    _pass->set("size", surface.width(), surface.height());
    _pass->set("frame", surface.frame());
    _pass->reads("heights", surface.heights());
    _pass->reads("direct", light.direct);
    _pass->reads("shading", light.shading);
    _pass->reads("horizon", light.horizon);
    _pass->reads("sky", light.skyPicture);
    _pass->writes(0, factor);
    setCones();
}

TextureLayout ObjectFactorNode::layoutOf(const TileObjects& objects)
{
    TextureLayout layout{1, 1, 0, GL_RGBA16F_ARB};
    for (const TileObject& object : objects)
    {
        layout.width = std::max(layout.width, object.texels.x);
        layout.height = std::max(layout.height, object.row + object.texels.y);
    }
    return layout;
}

void ObjectFactorNode::setCones()
{
    const ConeSet set = ConeSet::of(16);
    std::vector<osg::Vec4f> values;
    for (const std::array<float, 4>& each : set.packed())
        values.emplace_back(each[0], each[1], each[2], each[3]);
    osg::ref_ptr<osg::UIntArray> around = new osg::UIntArray;
    for (const ConeSet::Cone& cone : set.cones)
        around->push_back(cone.around);
    _pass->setBlock(values, 0);
    _pass->setStorage(0, around);
}

Status ObjectFactorNode::dispatch(osg::State& state, const TileObject& object)
{
    _pass->set("spacings", vector(object.spacing));
    _pass->set("corner", vector(object.corner));
    _pass->set("volumeSize", vector(object.voxel * glm::dvec3(object.voxels)));
    _pass->set("voxel", static_cast<float>(object.voxel));
    _pass->set("reach", static_cast<float>(object.voxel * ObjectCluster::reach));
    _pass->set("contentLow", vector(object.low - object.corner));
    _pass->set("contentHigh", vector(object.high - object.corner));
    _pass->set("first", vector(object.first));
    _pass->set("pitch", static_cast<float>(object.pitch));
    _pass->set("texels", object.texels.x, object.texels.y);
    _pass->set("row", object.row);
    // A volume that was replaced, or could not be computed.
    const osg::Texture* volume = object.volume->texture();
    _pass->set("known", volume && volume->getTextureObject(state.getContextID()));
    _pass->reads("volume", object.volume);
    return _pass->dispatch(
        state, {GpuPass::groupsFor(object.texels.x, 8), GpuPass::groupsFor(object.texels.y, 8), 1});
}

Status ObjectFactorNode::run(osg::State& state)
{
    std::vector<std::string> defines;
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
        _pass->set("sunIrradiance",
                   osg::Vec3f(sky.sunIrradiance[0], sky.sunIrradiance[1], sky.sunIrradiance[2]));
        _pass->set("sunRadius", static_cast<float>(sky.sunAngularRadius * radiansPerDegree));
    }
    _pass->setDefines(std::move(defines));
    for (const TileObject& object : _inputs->objects)
        if (Status done = dispatch(state, object); !done)
            return done;
    return Nothing{};
}

} // namespace osgTerrainLight
