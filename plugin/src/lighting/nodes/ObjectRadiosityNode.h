#pragma once

#include "gpu/ContextSet.h"
#include "lighting/nodes/AmongObjectsNode.h"

#include <vector>

namespace osgTerrainLight
{

/// What the objects of a volume send in the light of a tile, after as many bounces as the settings
/// have (object_radiosity.comp).
class ObjectRadiosityNode : public AmongObjectsNode
{
public:
    /// object: of the inputs; the node is for its volume, wherever that moves.
    ObjectRadiosityNode(const TileInputs& inputs, const TileSurface& surface,
                        const ObjectSurroundings& light, const TileObject& object);

    Resource* volume() const { return _volume; }
    /// RGBA16F: radiance by cell of ObjectCluster::cell voxels a side, in six slabs by the way that
    /// surfaces face.
    Resource* radiosity() const { return _sent.back(); }
    /// RGBA16F, by column of cells: the ground's light with the objects over that without them, in
    /// the bounce before.
    Resource* groundShare() const { return _ground.back(); }
    /// Contexts in which they have been computed. In any thread.
    const ContextSet& written() const { return _written; }
    /// A context (all: ~0u) has lost it.
    void forget(unsigned context) { _written.remove(context); }

    Status run(osg::State& state) override;

private:
    ~ObjectRadiosityNode() override = default;

    osg::ref_ptr<Resource> _volume;
    glm::ivec3 _cells;
    std::vector<Resource*> _sent, _ground; ///< by turns; the last bounce is in the last one
    ContextSet _written;
};

} // namespace osgTerrainLight
