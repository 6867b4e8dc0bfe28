#pragma once

#include "fields/ObjectClusters.h"
#include "gpu/WorkGraph.h"
#include "lighting/TileObjects.h"
#include "lighting/nodes/ObjectVolumeNode.h"

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/SkyLight.h>

#include <osg/Referenced>

#include <map>
#include <mutex>
#include <vector>

namespace osgTerrainLight
{

/// The placed objects of a scene as volumes of distances on the GPU, one per cluster of objects.
///
/// set() may be called from any thread, and never waits for what is computed. update() needs the
/// current context of its state.
class ObjectLight : public osg::Referenced
{
public:
    /// Finest voxels [m], and most volumes: 16 MiB at most.
    static constexpr double finest = 0.25;
    static constexpr int mostClusters = 8;

    /// Objects that there are now. Whether that is a change.
    bool set(const std::vector<ObjectShape>& shapes);

    /// A cluster and what its distances are in.
    struct Placed
    {
        ObjectCluster cluster;
        osg::ref_ptr<ObjectVolumeNode> node;
        std::vector<ObjectLamp> lamps; ///< of it, in the frame of its volume
    };
    /// As of the last set(). The nodes may be read in any thread, but for what run() does.
    const std::vector<Placed>& placed() const { return _placed; }

    /// Computes what has changed in this context, and notes shapes for it.
    Status update(osg::State& state, WorkPace* pace = nullptr);
    bool isDirty(unsigned context) const;

    std::size_t bytes() const { return _graph.bytes(); }
    std::vector<StageCost> costs() const { return _graph.costs(); }
    void releaseGLObjects(osg::State* state);
    void resizeGLObjectBuffers(unsigned size);

private:
    ~ObjectLight() override = default;

    std::vector<ObjectShape> _shapes;
    std::vector<Placed> _placed;

    mutable std::mutex _computing; ///< held while the graph runs; taken before _mutex
    mutable std::mutex _mutex;     ///< of _latest and _changed
    std::vector<Placed> _latest;   ///< not taken up yet where _changed
    bool _changed = false;
    WorkGraph _graph;
};

/// How far shadows of objects reach per metre of their height, away from the sun, in whole steps,
/// so that they seldom change while the sun moves; 0 without a sun. At most eight heights: longer
/// shadows fade out there.
glm::dvec2 shadowReach(const SkyLight& sky);

/// What of a tile's ground objects of a cluster may change the light of. corner: of the lit tile's
/// post (0, 0), at its heightOrigin, in the scene [m]. spacing: as of a TileObject. Nothing where
/// the tile is too far away: it ends three of the objects' heights beyond them, and where their
/// shadows do.
TileObjects objectsOn(const std::vector<ObjectLight::Placed>& placed, const glm::dvec3& corner,
                      const DemTile& tile, const glm::dvec2& spacing, const glm::dvec2& shadows);

} // namespace osgTerrainLight
