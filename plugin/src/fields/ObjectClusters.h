#pragma once

#include "fields/ObjectShape.h"

#include <vector>

namespace osgTerrainLight
{

/// Objects that share a volume of distances.
struct ObjectCluster
{
    /// Of the volume: its first corner [m, scene], whole bricks of voxels along each axis.
    glm::dvec3 origin{0.0};
    glm::ivec3 voxels{0}; ///< at most maxVoxels
    double voxel = 0.25;  ///< [m]
    ObjectBounds content; ///< of the shapes
    std::vector<ObjectShape> shapes;

    static constexpr int maxVoxels = 128; ///< along an axis
    static constexpr int brick = 8;       ///< voxels that are computed together
    static constexpr int cell = 4;        ///< voxels along a side that send light as one
    static constexpr int margin = 4;      ///< voxels around the content
    /// What a stored distance of 1 is, in voxels.
    static constexpr int reach = 8;

    bool sameVolume(const ObjectCluster& other) const
    {
        return origin == other.origin && voxels == other.voxels && voxel == other.voxel;
    }
};

/// Groups objects that fit into a volume, with voxels of `finest` [m], or twice, four times … that
/// where there would be more than `most` clusters otherwise, or an object is larger than a volume.
/// before: of the last call: its volumes stay where they are while what is in them fits, so that
/// what stands still in them need not be computed again.
std::vector<ObjectCluster> clusterObjects(const std::vector<ObjectShape>& shapes, double finest,
                                          int most, const std::vector<ObjectCluster>& before = {});

} // namespace osgTerrainLight
