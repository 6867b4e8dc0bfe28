#include "lighting/nodes/ObjectRadiosityNode.h"

#include "fields/ObjectClusters.h"
#include "gpu/GlConstants.h"

#include <algorithm>

namespace osgTerrainLight
{

namespace
{
/// Light on a surface that is seen by what it sends counts less than what is drawn.
constexpr int cones = 6;
} // namespace

ObjectRadiosityNode::ObjectRadiosityNode(const TileInputs& inputs, const TileSurface& surface,
                                         const ObjectSurroundings& light, const TileObject& object)
    : AmongObjectsNode("object radiosity", "object_radiosity", inputs, surface, light, cones),
      _volume(object.volume), _cells(object.voxels / ObjectCluster::cell)
{
    reads(_volume);
    reads(own(inputs.albedoTexture.get()));
    for (int i = 0; i < std::min(inputs.settings.bounces, 2); ++i)
    {
        _sent.push_back(own(new Resource("light sent by objects",
                                         {_cells.x, _cells.y, 0, GL_RGBA16F_ARB, 6 * _cells.z})));
        _ground.push_back(
            own(new Resource("ground among objects", {_cells.x, _cells.y, 0, GL_RGBA16F_ARB})));
        // They are drawn with, and each is made of the other.
        _sent.back()->keepWhole();
        _ground.back()->keepWhole();
    }
    writes(radiosity());
    writes(groundShare());
    pass().reads("albedo", inputs.albedoTexture);
    pass().set(new osg::Uniform("cells", _cells.x, _cells.y, _cells.z));
    pass().set("slabVoxels", static_cast<float>(_cells.z));
}

Status ObjectRadiosityNode::run(osg::State& state)
{
    const auto object =
        std::find_if(inputs().objects.begin(), inputs().objects.end(),
                     [this](const TileObject& each) { return each.volume == _volume; });
    if (object == inputs().objects.end() || !setObject(state, *object))
        return Nothing{};
    setLight();
    pass().reads("albedos", object->albedo);
    const std::size_t bounces = static_cast<std::size_t>(inputs().settings.bounces);
    for (std::size_t bounce = 0; bounce < bounces; ++bounce)
    {
        const std::size_t to = (bounce + _sent.size() - bounces % _sent.size()) % _sent.size();
        const std::size_t from = (to + 1) % _sent.size();
        pass().set("sending", bounce > 0);
        pass().reads("radiosity", bounce > 0 ? _sent[from] : nullptr);
        pass().reads("groundShare", bounce > 0 ? _ground[from] : nullptr);
        pass().writes(0, _sent[to]);
        pass().writes(1, _ground[to]);
        if (Status done = pass().dispatch(state, {GpuPass::groupsFor(_cells.x, 4),
                                                  GpuPass::groupsFor(_cells.y, 4),
                                                  GpuPass::groupsFor(6 * _cells.z + 1, 4)});
            !done)
            return done;
    }
    _written.add(state.getContextID());
    return Nothing{};
}

} // namespace osgTerrainLight
