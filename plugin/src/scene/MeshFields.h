#pragma once

#include "fields/DistanceGrid.h"
#include "fields/TriangleMesh.h"

#include <memory>
#include <string>

namespace osgTerrainLight
{

/// A mesh that is being sampled, or has been. Objects with the same triangles share one.
class MeshSampling
{
public:
    virtual ~MeshSampling() = default;
    /// False as long as it is being sampled.
    virtual bool isDone() const = 0;
    /// Null before it is done, and where it cannot be sampled: that has been said.
    virtual std::shared_ptr<const DistanceGrid> grid() const = 0;
};

/// Begins to sample a mesh, in a thread of its own, one mesh at a time, unless that has been done
/// before: in this process, or in the user's folder of caches. What nobody has any more is given
/// up. name: of the object, for messages. From one thread at a time.
std::shared_ptr<const MeshSampling> sampleMesh(TriangleMesh mesh, const std::string& name);

} // namespace osgTerrainLight
