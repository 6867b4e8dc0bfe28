#include "fields/SampledForm.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace osgTerrainLight
{

namespace
{

using Polygon = std::vector<glm::dvec3>;

/// What of a polygon is on the positive side of an axis that is turned by sign.
void clip(Polygon& polygon, Polygon& clipped, int axis, double sign)
{
    clipped.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i)
    {
        const glm::dvec3& a = polygon[i];
        const glm::dvec3& b = polygon[(i + 1) % polygon.size()];
        const double toA = sign * a[axis], toB = sign * b[axis];
        if (toA >= 0.0)
            clipped.push_back(a);
        if ((toA >= 0.0) != (toB >= 0.0))
            clipped.push_back(glm::mix(a, b, toA / (toA - toB)));
    }
    polygon.swap(clipped);
}

/// The octahedral map of shaders/lib/sampled_form.glsl, which is projective within each octant.
/// There a triangle fills what its corners' places are around.
class RadialMap
{
public:
    explicit RadialMap(int side) : _side(side), _radii(side, side, 0.0f), _directions(side, side)
    {
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
                _directions.at(x, y) = directionAt(x, y);
    }

    void add(const std::array<glm::dvec3, 3>& corners)
    {
        for (int octant = 0; octant < 8; ++octant)
        {
            const glm::dvec3 signs(octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1);
            _polygon.assign(corners.begin(), corners.end());
            for (int axis = 0; axis < 3 && _polygon.size() > 2; ++axis)
                clip(_polygon, _clipped, axis, signs[axis]);
            if (_polygon.size() > 2)
                addWithin(corners, signs);
        }
    }

    /// Gives directions without a surface the mean of those around. Whether there is any surface.
    bool fill()
    {
        for (bool isMissing = true; isMissing;)
        {
            isMissing = false;
            bool isAny = false;
            const Raster<float> before = _radii;
            for (int y = 0; y < _side; ++y)
                for (int x = 0; x < _side; ++x)
                {
                    if (before.at(x, y) > 0.0f)
                    {
                        isAny = true;
                        continue;
                    }
                    isMissing = true;
                    float sum = 0.0f, count = 0.0f;
                    // Over an edge the map goes on at the mirrored place of the same edge.
                    const int places[4][2] = {{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}};
                    for (const auto& [i, j] : places)
                    {
                        const bool isBeyondX = i < 0 || i >= _side, isBeyondY = j < 0 || j >= _side;
                        const float radius = isBeyondX   ? before.at(x, _side - 1 - y)
                                             : isBeyondY ? before.at(_side - 1 - x, y)
                                                         : before.at(i, j);
                        sum += radius;
                        count += radius > 0.0f ? 1.0f : 0.0f;
                    }
                    if (count > 0.0f)
                        _radii.at(x, y) = sum / count;
                }
            if (!isAny)
                return false;
        }
        return true;
    }

    const Raster<float>& radii() const { return _radii; }

private:
    glm::dvec3 directionAt(int x, int y) const
    {
        const glm::dvec2 at = (glm::dvec2(x, y) + 0.5) * 2.0 / double(_side) - 1.0;
        glm::dvec3 direction(at, 1.0 - std::abs(at.x) - std::abs(at.y));
        const double folded = std::max(-direction.z, 0.0);
        for (int axis = 0; axis < 2; ++axis)
            direction[axis] += direction[axis] < 0.0 ? folded : -folded;
        return glm::normalize(direction);
    }
    static glm::dvec2 placeOf(const glm::dvec3& v, const glm::dvec3& signs)
    {
        const double size = std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
        const glm::dvec2 at(v.x / size, v.y / size);
        if (signs.z > 0.0)
            return at;
        return {signs.x * (1.0 - std::abs(at.y)), signs.y * (1.0 - std::abs(at.x))};
    }

    void addWithin(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& signs)
    {
        glm::dvec2 low(2.0), high(-2.0);
        for (const glm::dvec3& corner : _polygon)
            if (corner != glm::dvec3(0.0))
            {
                const glm::dvec2 at = placeOf(corner, signs);
                low = glm::min(low, at);
                high = glm::max(high, at);
            }
        const auto texel = [&](double at)
        { return std::clamp(static_cast<int>((at + 1.0) * 0.5 * _side), 0, _side - 1); };
        const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        std::array<glm::dvec3, 3> sides;
        for (std::size_t i = 0; i < 3; ++i)
            sides[i] = glm::cross(corners[i], corners[(i + 1) % 3]);
        const double away = glm::dot(normal, corners[0]);
        for (int y = texel(low.y); y <= texel(high.y); ++y)
            for (int x = texel(low.x); x <= texel(high.x); ++x)
            {
                const glm::dvec3& direction = _directions.at(x, y);
                // Within the triangle's cone, whichever way round its corners run. On a side that
                // two triangles share one of them has it.
                const double a = glm::dot(direction, sides[0]), b = glm::dot(direction, sides[1]),
                             c = glm::dot(direction, sides[2]);
                if (!((a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0)))
                    continue;
                const double radius = away / glm::dot(direction, normal);
                if (radius > 0.0 && std::isfinite(radius))
                    _radii.at(x, y) = std::max(_radii.at(x, y), static_cast<float>(radius));
            }
    }

    int _side;
    Raster<float> _radii;
    Raster<glm::dvec3> _directions;
    Polygon _polygon, _clipped;
};

/// A place that sees as much of the surface from inside as can be: from the middle of the box it
/// goes behind the plane of the triangle that it is farthest in front of, again and again (Agmon
/// 1954). Triangles run counter-clockwise as seen from outside, or all the other way round.
glm::dvec3 centreOf(const TriangleMesh& mesh, const glm::dvec3& low, const glm::dvec3& high)
{
    struct Plane
    {
        glm::dvec3 normal; ///< unit, outwards
        double away;       ///< from the box's middle
    };
    const glm::dvec3 middle = 0.5 * (low + high);
    std::vector<Plane> planes;
    double volume = 0.0;
    for (const auto& triangle : mesh.triangles)
    {
        const glm::dvec3 a = glm::dvec3(mesh.vertices[triangle[0]]) - middle,
                         b = glm::dvec3(mesh.vertices[triangle[1]]) - middle,
                         c = glm::dvec3(mesh.vertices[triangle[2]]) - middle;
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        const double size = glm::length(normal);
        if (size == 0.0)
            continue;
        planes.push_back({normal / size, glm::dot(normal, a) / size});
        volume += glm::dot(a, normal);
    }
    if (volume < 0.0)
        for (Plane& plane : planes)
            plane = {-plane.normal, -plane.away};
    constexpr int steps = 64;
    const double room = 0.02 * glm::length(high - low); // off the planes, so that none is grazed
    glm::dvec3 best(0.0), centre(0.0);
    double least = 1.0e300;
    for (int step = 0; step < steps; ++step)
    {
        const Plane* worst = nullptr;
        double deficit = -1.0e300;
        for (const Plane& plane : planes)
            if (const double d = glm::dot(plane.normal, centre) - plane.away + room; d > deficit)
            {
                deficit = d;
                worst = &plane;
            }
        if (deficit < least)
        {
            least = deficit;
            best = centre;
        }
        if (!worst || deficit <= 0.0)
            break;
        centre -= deficit * worst->normal;
    }
    return middle + best;
}

} // namespace

std::shared_ptr<const SampledForm> sampleStar(const TriangleMesh& mesh, int side)
{
    if (!mesh.complaint().empty())
        return nullptr;
    const auto form = std::make_shared<SampledForm>();
    form->side = side;
    const auto [low, high] = mesh.box();
    form->centre = centreOf(mesh, low, high);
    form->low = low - form->centre;
    form->high = high - form->centre;
    RadialMap map(side);
    for (const auto& triangle : mesh.triangles)
    {
        std::array<glm::dvec3, 3> corners;
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = glm::dvec3(mesh.vertices[triangle[i]]) - form->centre;
        map.add(corners);
    }
    if (!map.fill())
        return nullptr;
    form->values = map.radii();
    double sum = 0.0;
    for (const float radius : form->values.values())
    {
        sum += double(radius);
        form->range.y = std::max(form->range.y, double(radius));
    }
    form->range.x = sum / double(form->values.size());
    return form;
}

} // namespace osgTerrainLight
