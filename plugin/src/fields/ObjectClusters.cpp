#include "fields/ObjectClusters.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace osgTerrainLight
{

namespace
{

using Clusters = std::vector<ObjectCluster>;

/// A volume about the content; none where it would be too large.
bool layOut(ObjectCluster& cluster)
{
    // Corners lie on a grid of bricks that is the scene's, so that a content that grows does not
    // move what was there.
    const double brick = cluster.voxel * ObjectCluster::brick;
    const double margin = cluster.voxel * ObjectCluster::margin;
    for (int axis = 0; axis < 3; ++axis)
    {
        const double first = std::floor((cluster.content.low[axis] - margin) / brick);
        const double last = std::ceil((cluster.content.high[axis] + margin) / brick);
        // Not of numbers that are not finite.
        if (!(last > first &&
              (last - first) * ObjectCluster::brick <= double(ObjectCluster::maxVoxels)))
            return false;
        cluster.origin[axis] = first * brick;
        cluster.voxels[axis] = static_cast<int>(last - first) * ObjectCluster::brick;
    }
    return true;
}

double volumeOf(const ObjectBounds& bounds)
{
    const glm::dvec3 size = bounds.high - bounds.low;
    return size.x * size.y * std::max(size.z, 1.0);
}

/// Each shape goes where the content grows least. Empty where one fits nowhere.
Clusters groupBy(const std::vector<ObjectShape>& shapes, double voxel, std::size_t most)
{
    Clusters clusters;
    for (const ObjectShape& shape : shapes)
    {
        const ObjectBounds bounds = boundsOf(shape);
        std::size_t best = clusters.size();
        double least = 1.0e300;
        for (std::size_t i = 0; i < clusters.size(); ++i)
        {
            ObjectCluster grown;
            grown.voxel = voxel;
            grown.content = clusters[i].content;
            grown.content.include(bounds);
            const double growth = volumeOf(grown.content) - volumeOf(clusters[i].content);
            if (growth < least && layOut(grown))
            {
                least = growth;
                best = i;
            }
        }
        if (best == clusters.size())
        {
            if (clusters.size() == most)
                return {};
            clusters.emplace_back();
            clusters.back().voxel = voxel;
        }
        clusters[best].content.include(bounds);
        if (!layOut(clusters[best]))
            return {};
        clusters[best].shapes.push_back(shape);
    }
    return clusters;
}

/// Whether a volume that was there holds the content, and is not much too large for it.
bool holds(const ObjectCluster& before, const ObjectCluster& now)
{
    if (before.voxel != now.voxel)
        return false;
    const double margin = now.voxel * ObjectCluster::margin;
    for (int axis = 0; axis < 3; ++axis)
        if (now.content.low[axis] - margin < before.origin[axis] ||
            now.content.high[axis] + margin >
                before.origin[axis] + before.voxel * before.voxels[axis] ||
            before.voxels[axis] > 2 * now.voxels[axis] + ObjectCluster::brick)
            return false;
    return true;
}

} // namespace

std::vector<ObjectCluster> clusterObjects(const std::vector<ObjectShape>& shapes, double finest,
                                          int most, const std::vector<ObjectCluster>& before)
{
    if (shapes.empty())
        return {};
    Clusters clusters;
    for (double voxel = finest; clusters.empty() && voxel < 1.0e6 * finest; voxel *= 2.0)
        clusters = groupBy(shapes, voxel, static_cast<std::size_t>(most));
    std::vector<bool> taken(before.size(), false);
    for (ObjectCluster& cluster : clusters)
        for (std::size_t i = 0; i < before.size(); ++i)
            if (!taken[i] && holds(before[i], cluster))
            {
                taken[i] = true;
                cluster.origin = before[i].origin;
                cluster.voxels = before[i].voxels;
                break;
            }
    return clusters;
}

} // namespace osgTerrainLight
