#pragma once

#include "fields/ObjectClusters.h"
#include "gpu/ContextSet.h"
#include "gpu/WorkGraph.h"

#include <osg/Image>

#include <map>
#include <vector>

namespace osgTerrainLight
{

/// Distances to the objects of a cluster in a volume on the GPU. Where some have moved, only the
/// bricks of voxels are computed anew that they were or are within reach of.
class ObjectVolumeNode : public Node
{
public:
    explicit ObjectVolumeNode(const ObjectCluster& cluster);

    /// Other shapes in the same volume. Precondition: cluster().sameVolume(cluster).
    void set(const ObjectCluster& cluster);
    const ObjectCluster& cluster() const { return _cluster; }

    /// R8_SNORM: distance over ObjectCluster::reach voxels, −1 … 1; 1 where nothing is nearer.
    Resource* volume() const { return _volume; }
    /// RGBA16F, a texel per cell of ObjectCluster::cell voxels a side: albedo of the nearest
    /// object.
    Resource* albedo() const { return _albedo; }
    /// Whether it holds distances to all shapes of some run. In any thread.
    bool isWritten(unsigned context) const { return _complete.has(context); }
    /// Whether it does in all contexts in which the other does.
    bool isWrittenWhere(const ObjectVolumeNode& other) const
    {
        return _complete.hasAllOf(other._complete);
    }
    /// A context (all: ~0u) has lost it.
    void forget(unsigned context);
    /// Bricks that the last run computed.
    std::size_t bricks() const { return _lastBricks; }

    Status run(osg::State& state) override;

private:
    ~ObjectVolumeNode() override = default;
    /// By brick, x fastest.
    using Bricks = std::vector<bool>;
    void mark(Bricks& bricks, const ObjectShape& shape) const;
    void setShapes();
    void setForms();

    ObjectCluster _cluster;
    Resource *_shapesValue, *_volume, *_albedo, *_formsTexture;
    GpuPass* _pass;
    struct Written
    {
        std::vector<ObjectShape> shapes; ///< of the last run
        Bricks unfinished;               ///< of runs that have stopped; empty: none
        bool any = false;
    };
    std::map<unsigned, Written> _written;      ///< by context
    ContextSet _complete;                      ///< contexts in which a run has ended
    std::vector<ObjectShape> _shapesSet;       ///< on the pass
    std::map<const DistanceGrid*, int> _grids; ///< likewise, and where each begins
    bool _isSet = false;
    osg::ref_ptr<osg::Image> _forms;             ///< samples of forms one above the other, R32F
    std::map<const SampledForm*, int> _formRows; ///< where each begins
    std::size_t _lastBricks = 0;
};

} // namespace osgTerrainLight
