#include "fields/ObjectLamps.h"

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr double pi = 3.14159265358979323846;

/// [m²]; what is sampled counts as the ellipsoid in its bounds.
double surfaceOf(const ObjectShape& shape)
{
    const glm::dvec3 size = rigid(shape).size;
    switch (shape.kind)
    {
    case ObjectShape::Kind::Box:
        return 8.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
    case ObjectShape::Kind::Cylinder:
        return 2.0 * pi * size.x * (size.x + 2.0 * size.z);
    case ObjectShape::Kind::Capsule:
        return 4.0 * pi * size.x * (size.x + size.z);
    default:
    {
        // Thomsen's formula, right to 1.1 %.
        const ObjectBounds bounds = boundsOf(shape);
        const glm::dvec3 half =
            shape.kind == ObjectShape::Kind::Ellipsoid ? size : 0.5 * (bounds.high - bounds.low);
        constexpr double p = 1.6075;
        const auto power = [&](int a, int b) { return std::pow(half[a] * half[b], p); };
        return 4.0 * pi * std::pow((power(0, 1) + power(1, 2) + power(2, 0)) / 3.0, 1.0 / p);
    }
    }
}
} // namespace

std::vector<ObjectLamp> lampsOf(const std::vector<ObjectShape>& shapes)
{
    std::vector<ObjectLamp> lamps;
    for (const ObjectShape& shape : shapes)
        if (shape.emission != glm::dvec3(0.0))
        {
            const ObjectBounds bounds = boundsOf(shape);
            lamps.push_back({0.5 * (bounds.low + bounds.high),
                             std::sqrt(surfaceOf(shape) / (4.0 * pi)), shape.emission});
        }
    const auto light = [](const ObjectLamp& lamp)
    { return lamp.radius * lamp.radius * (lamp.radiance.x + lamp.radiance.y + lamp.radiance.z); };
    std::stable_sort(lamps.begin(), lamps.end(),
                     [&](const ObjectLamp& a, const ObjectLamp& b) { return light(a) > light(b); });
    if (lamps.size() > ObjectLamp::most)
        lamps.resize(ObjectLamp::most);
    return lamps;
}

} // namespace osgTerrainLight
