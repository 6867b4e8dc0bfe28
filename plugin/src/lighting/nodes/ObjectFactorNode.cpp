#include "lighting/nodes/ObjectFactorNode.h"

#include "fields/ObjectClusters.h"
#include "gpu/GlConstants.h"

#include <algorithm>
#include <utility>

namespace osgTerrainLight
{

ObjectFactorNode::ObjectFactorNode(const TileInputs& inputs, const TileSurface& surface,
                                   const ObjectSurroundings& light, Radiosities sent,
                                   Resource* factor)
    : AmongObjectsNode("object factor", "object_factor", inputs, surface, light,
                       inputs.settings.objectCones),
      _sent(std::move(sent))
{
    // It is drawn.
    factor->keepWhole();
    for (const TileObject& object : inputs.objects)
        reads(object.volume);
    for (const auto& node : _sent)
        reads(node->radiosity());
    writes(own(factor));
    pass().writes(0, factor);
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

Status ObjectFactorNode::dispatch(osg::State& state, const TileObject& object)
{
    pass().set("known", setObject(state, object));
    const auto sent =
        std::find_if(_sent.begin(), _sent.end(),
                     [&](const auto& node) { return node->volume() == object.volume; });
    pass().set("sending", sent != _sent.end());
    pass().reads("radiosity", sent != _sent.end() ? (*sent)->radiosity() : nullptr);
    pass().reads("groundShare", nullptr);
    pass().set("slabVoxels", static_cast<float>(object.voxels.z / ObjectCluster::cell));
    pass().set("first",
               osg::Vec2f(static_cast<float>(object.first.x), static_cast<float>(object.first.y)));
    pass().set("pitch", static_cast<float>(object.pitch));
    pass().set("texels", object.texels.x, object.texels.y);
    pass().set("row", object.row);
    return pass().dispatch(
        state, {GpuPass::groupsFor(object.texels.x, 8), GpuPass::groupsFor(object.texels.y, 8), 1});
}

Status ObjectFactorNode::run(osg::State& state)
{
    setLight();
    for (const TileObject& object : inputs().objects)
        if (Status done = dispatch(state, object); !done)
            return done;
    return Nothing{};
}

} // namespace osgTerrainLight
