#pragma once

#include "lighting/nodes/AmongObjectsNode.h"
#include "lighting/nodes/ObjectRadiosityNode.h"

#include <vector>

namespace osgTerrainLight
{

/// What placed objects leave of the light of a tile's ground, and send to it, at texels of its own
/// around each volume of TileInputs::objects (object_factor.comp).
class ObjectFactorNode : public AmongObjectsNode
{
public:
    using Radiosities = std::vector<osg::ref_ptr<ObjectRadiosityNode>>;

    /// sent: what objects send, of each volume; empty: nothing.
    ObjectFactorNode(const TileInputs& inputs, const TileSurface& surface,
                     const ObjectSurroundings& light, Radiosities sent, Resource* factor);

    Status run(osg::State& state) override;

    /// RGBA16F: the texels of all objects, one below the other.
    static TextureLayout layoutOf(const TileObjects& objects);

private:
    ~ObjectFactorNode() override = default;
    Status dispatch(osg::State& state, const TileObject& object);

    Radiosities _sent;
};

} // namespace osgTerrainLight
