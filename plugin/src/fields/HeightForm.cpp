#include "fields/SampledForm.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace osgTerrainLight
{

namespace
{

constexpr float none = 1.0e30f; ///< the lower of no solid at all; the upper is minus that

/// Highest and lowest surface at posts.
struct Surfaces
{
    Raster<float> values; ///< as of SampledForm
    int side;
    glm::dvec2 spacing;

    Surfaces(int count, const glm::dvec2& size)
        : values(count, 2 * count, -none), side(count), spacing(size / double(count - 1))
    {
        std::fill(values.values().begin() + std::ptrdiff_t(count) * count, values.values().end(),
                  none);
    }

    /// Corners are from the first post.
    void add(const std::array<glm::dvec3, 3>& corners)
    {
        const glm::dvec2 a(corners[0]), b = glm::dvec2(corners[1]) - a,
                                        c = glm::dvec2(corners[2]) - a;
        const double area = b.x * c.y - b.y * c.x;
        if (area == 0.0)
            return;
        glm::dvec2 low = a, high = a;
        for (const glm::dvec3& corner : corners)
        {
            low = glm::min(low, glm::dvec2(corner));
            high = glm::max(high, glm::dvec2(corner));
        }
        // Posts on the box's edge belong to it, for all that is rounded.
        constexpr double room = 1.0e-6;
        const auto post = [&](double at) { return std::clamp(static_cast<int>(at), 0, side - 1); };
        const glm::dvec2 first = glm::ceil(low / spacing - room);
        const glm::dvec2 last = glm::floor(high / spacing + room);
        for (int y = post(first.y); y <= post(last.y); ++y)
            for (int x = post(first.x); x <= post(last.x); ++x)
            {
                const glm::dvec2 at = spacing * glm::dvec2(x, y) - a;
                const double u = (at.x * c.y - at.y * c.x) / area;
                const double v = (b.x * at.y - b.y * at.x) / area;
                if (u < -room || v < -room || u + v > 1.0 + room)
                    continue;
                const auto height =
                    static_cast<float>(corners[0].z + u * (corners[1].z - corners[0].z) +
                                       v * (corners[2].z - corners[0].z));
                float& upper = values.at(x, y);
                float& lower = values.at(x, side + y);
                upper = std::max(upper, height);
                lower = std::min(lower, height);
            }
    }
};

} // namespace

std::shared_ptr<const SampledForm> sampleHeights(const TriangleMesh& mesh, HeightSurfaces surfaces,
                                                 int side)
{
    if (!mesh.complaint().empty())
        return nullptr;
    const auto form = std::make_shared<SampledForm>();
    form->side = side;
    const auto [low, high] = mesh.box();
    const glm::dvec3 size = glm::max(high - low, glm::dvec3(1.0e-6));
    form->centre = 0.5 * (low + high);
    form->low = low - form->centre;
    form->high = high - form->centre;
    form->first = form->low;
    form->range = {form->low.z, form->high.z};
    Surfaces found(side, glm::dvec2(size));
    form->spacing = found.spacing;
    for (const auto& triangle : mesh.triangles)
    {
        std::array<glm::dvec3, 3> corners;
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] =
                glm::dvec3(mesh.vertices[triangle[i]]) - glm::dvec3(low.x, low.y, form->centre.z);
        found.add(corners);
    }
    bool isAny = false;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            if (found.values.at(x, y) > -none)
            {
                isAny = true;
                if (surfaces == HeightSurfaces::Upper)
                    found.values.at(x, side + y) = static_cast<float>(form->low.z);
            }
    if (!isAny)
        return nullptr;
    form->values = std::move(found.values);
    return form;
}

} // namespace osgTerrainLight
