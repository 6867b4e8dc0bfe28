#include "core/ConeSet.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace osgTerrainLight
{

namespace
{

constexpr double pi = 3.14159265358979323846;

struct Fitted
{
    std::vector<int> rings;
    float stride;
    std::array<float, 4> fit;
    double narrowing; ///< of a cone, against its cell
};

// The numbers are fitted to 16 scenes of boxes, villages and thin walls, and tested on others.
const std::array<Fitted, 6> fitted = {{
    {{4}, 2.0f, {.750f, 1.41f, 2.29f, .53f}, 0.9},
    {{1, 5}, 2.0f, {.672f, 1.29f, 1.85f, .59f}, 0.9},
    {{1, 8}, 2.0f, {.669f, 1.04f, 1.33f, .58f}, 0.8},
    {{3, 9}, 2.0f, {.633f, 1.09f, 1.17f, .68f}, 0.8},
    {{1, 6, 9}, 2.0f, {.642f, 1.14f, .80f, .79f}, 0.8},
    {{1, 6, 10, 15}, 3.0f, {.596f, .85f, .20f, .93f}, 0.8},
}};

int countOf(const Fitted& set)
{
    int count = 0;
    for (const int ring : set.rings)
        count += ring;
    return count;
}

double angleBetween(const ConeSet::Cone& a, const ConeSet::Cone& b)
{
    double cosine = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
        cosine += double(a.axis[i]) * double(b.axis[i]);
    return std::acos(std::clamp(cosine, -1.0, 1.0));
}

/// Of cosine measure, 0 … 1 from the pole outwards: the polar angle.
double polarAt(double measure)
{
    return std::asin(std::sqrt(measure));
}

} // namespace

ConeSet ConeSet::of(int cones)
{
    const auto found = std::find_if(fitted.begin(), fitted.end() - 1,
                                    [&](const Fitted& set) { return countOf(set) >= cones; });
    ConeSet set;
    set.stride = found->stride;
    set.fit = found->fit;
    const double cell = 1.0 / countOf(*found);
    double inner = 0.0;
    for (std::size_t ring = 0; ring < found->rings.size(); ++ring)
    {
        const int count = found->rings[ring];
        const double outer = inner + cell * count;
        const double polar = count == 1 ? 0.0 : polarAt(0.5 * (inner + outer));
        // The cone of the cell's solid angle, narrowed.
        const double share =
            (std::cos(polarAt(inner)) - std::cos(polarAt(std::min(outer, 1.0)))) / count;
        const double sine = std::sin(found->narrowing * std::acos(1.0 - share));
        for (int i = 0; i < count; ++i)
        {
            const double azimuth = 2.0 * pi * (i + 0.5 * double(ring % 2)) / count;
            set.cones.push_back(
                {{float(std::sin(polar) * std::cos(azimuth)),
                  float(std::sin(polar) * std::sin(azimuth)), float(std::cos(polar))},
                 float(sine),
                 0});
        }
        inner = outer;
    }
    for (Cone& cone : set.cones)
    {
        double nearest = pi;
        for (const Cone& other : set.cones)
            if (&other != &cone)
                nearest = std::min(nearest, angleBetween(cone, other));
        for (std::size_t i = 0; i < set.cones.size(); ++i)
            if (angleBetween(cone, set.cones[i]) < 1.45 * nearest)
                cone.around |= 1u << i;
    }
    return set;
}

std::vector<std::array<float, 4>> ConeSet::packed() const
{
    std::vector<std::array<float, 4>> values(most + 2);
    for (std::size_t i = 0; i < cones.size(); ++i)
        values[i] = {cones[i].axis[0], cones[i].axis[1], cones[i].axis[2], cones[i].sine};
    values[most] = fit;
    values[most + 1] = {static_cast<float>(cones.size()), stride, 0.0f, 0.0f};
    return values;
}

} // namespace osgTerrainLight
