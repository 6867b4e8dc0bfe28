#pragma once

#include "fields/ObjectShape.h"

#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

/// An object that emits light, as what it lights sees it from afar: a sphere.
struct ObjectLamp
{
    glm::dvec3 centre{0.0}; ///< in the scene [m]
    double radius = 0.0;    ///< [m]: of the same surface, which shows the same area in the mean
    glm::dvec3 radiance{0.0};

    static constexpr std::size_t most = 16; ///< as in object_light.glsl

    bool operator==(const ObjectLamp& other) const
    {
        return centre == other.centre && radius == other.radius && radiance == other.radiance;
    }
};

/// Those of the shapes that emit, at most ObjectLamp::most: those with the most light.
std::vector<ObjectLamp> lampsOf(const std::vector<ObjectShape>& shapes);

} // namespace osgTerrainLight
