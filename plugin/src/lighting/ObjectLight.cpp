#include "lighting/ObjectLight.h"

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
using Lock = std::lock_guard<std::mutex>;

/// Ground around objects whose light they change, over their height.
constexpr double aroundHeight = 3.0;
/// Of a shadow, over the object's height.
constexpr double longestShadow = 8.0;
/// Light of a lamp that faces it that is too little to be looked at, irradiance / pi, and how far
/// away a lamp's is looked at [m].
constexpr double leastLampLight = 1.0e-3, farthestLamp = 48.0;
/// Texels of the factor along a side, at most.
constexpr int mostTexels = 256;
} // namespace

bool ObjectLight::set(const std::vector<ObjectShape>& shapes)
{
    if (shapes == _shapes)
        return false;
    _shapes = shapes;
    std::vector<ObjectCluster> before;
    for (const Placed& placed : _placed)
        before.push_back(placed.cluster);
    std::vector<Placed> now;
    for (const ObjectCluster& cluster : clusterObjects(shapes, finest, mostClusters, before))
    {
        const auto same =
            std::find_if(_placed.begin(), _placed.end(),
                         [&](const Placed& placed) { return placed.cluster.sameVolume(cluster); });
        now.push_back({cluster,
                       same != _placed.end() ? same->node.get() : new ObjectVolumeNode(cluster),
                       lampsOf(cluster.shapes)});
        for (ObjectLamp& lamp : now.back().lamps)
            lamp.centre -= cluster.origin;
    }
    _placed = now;
    Lock lock(_mutex);
    _latest = std::move(now);
    _changed = true;
    return true;
}

Status ObjectLight::update(osg::State& state, WorkPace* pace)
{
    Lock computing(_computing);
    {
        Lock lock(_mutex);
        if (_changed)
        {
            WorkGraph::Nodes nodes;
            for (const Placed& placed : _latest)
            {
                placed.node->set(placed.cluster);
                nodes.push_back(placed.node);
            }
            if (Status declared = _graph.declare(nodes); !declared)
                return declared;
            _changed = false;
            _latest.clear();
        }
    }
    return _graph.run(state, pace);
}

bool ObjectLight::isDirty(unsigned context) const
{
    Lock lock(_mutex);
    return _changed || _graph.isDirty(context);
}

void ObjectLight::releaseGLObjects(osg::State* state)
{
    Lock computing(_computing);
    _graph.releaseGLObjects(state);
    for (const Placed& placed : _placed)
        placed.node->forget(state ? state->getContextID() : ~0u);
}

void ObjectLight::resizeGLObjectBuffers(unsigned size)
{
    Lock computing(_computing);
    _graph.resizeGLObjectBuffers(size);
}

glm::dvec2 shadowReach(const SkyLight& sky)
{
    const std::array<double, 3> sun = sky.sunDirection();
    if (!sky.sunEnabled || sky.sunElevation <= 0.0)
        return glm::dvec2(0.0);
    const glm::dvec2 level(-sun[0], -sun[1]);
    const double length = glm::length(level);
    if (length < 1.0e-9)
        return glm::dvec2(0.0);
    const glm::dvec2 reach = level * (std::min(length / sun[2], longestShadow) / length);
    const glm::dvec2 step(0.5);
    return glm::sign(reach) * glm::ceil(glm::abs(reach) / step) * step;
}

TileObjects objectsOn(const std::vector<ObjectLight::Placed>& placed, const glm::dvec3& corner,
                      const DemTile& tile, const glm::dvec2& spacing, const glm::dvec2& shadows)
{
    TileObjects objects;
    int row = 0;
    for (const ObjectLight::Placed& each : placed)
    {
        const ObjectCluster& cluster = each.cluster;
        TileObject object;
        object.spacing = spacing;
        object.volume = each.node->volume();
        object.albedo = each.node->albedo();
        object.lamps = each.lamps;
        object.corner = cluster.origin - corner;
        object.voxels = cluster.voxels;
        object.voxel = cluster.voxel;
        object.low = cluster.content.low - corner;
        object.high = cluster.content.high - corner;
        const double tall = object.high.z - object.low.z;
        const glm::dvec2 shadow = tall * shadows;
        // Texels lie on a grid of the tile's, so that they do not move with what grows.
        glm::dvec2 low =
            glm::dvec2(object.low) + glm::min(shadow, glm::dvec2(-aroundHeight * tall));
        glm::dvec2 high =
            glm::dvec2(object.high) + glm::max(shadow, glm::dvec2(aroundHeight * tall));
        // Lamps shine on.
        for (const ObjectLamp& lamp : object.lamps)
        {
            const double brightest = std::max({lamp.radiance.x, lamp.radiance.y, lamp.radiance.z});
            const double reach =
                std::min(lamp.radius * std::sqrt(brightest / leastLampLight), farthestLamp);
            const glm::dvec2 centre(lamp.centre + object.corner);
            low = glm::min(low, centre - reach);
            high = glm::max(high, centre + reach);
        }
        const double longest = std::max(high.x - low.x, high.y - low.y);
        object.pitch = cluster.voxel;
        while (longest / object.pitch > mostTexels - 2)
            object.pitch *= 2.0;
        object.first = glm::floor(low / object.pitch) * object.pitch;
        object.texels = glm::ivec2(glm::ceil((high - object.first) / object.pitch)) + 1;
        const glm::dvec2 end = object.first + object.pitch * glm::dvec2(object.texels);
        const glm::dvec2 size = spacing * glm::dvec2(tile.width() - 1, tile.height() - 1);
        if (object.first.x > size.x || object.first.y > size.y || end.x < 0.0 || end.y < 0.0)
            continue;
        object.row = row;
        row += object.texels.y;
        objects.push_back(object);
    }
    return objects;
}

} // namespace osgTerrainLight
