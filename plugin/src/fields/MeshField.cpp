#include "fields/MeshField.h"

#include "fields/Caps.h"
#include "fields/Signs.h"
#include "fields/Slices.h"
#include "fields/SurfaceDistance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

namespace osgTerrainLight
{

namespace
{
constexpr double leastSide = 1e-6, mostSide = 1e9; // [m]: squares and cubes of these fit a float

/// The box of all triangles [m].
struct Box
{
    glm::dvec3 low{std::numeric_limits<double>::infinity()};
    glm::dvec3 high{-std::numeric_limits<double>::infinity()};
};

Box boxOf(const std::vector<TriangleCorners>& triangles)
{
    Box box;
    for (const TriangleCorners& triangle : triangles)
        for (const glm::dvec3& corner : triangle)
        {
            box.low = glm::min(box.low, corner);
            box.high = glm::max(box.high, corner);
        }
    return box;
}

/// Voxels over the box and its margin, in its middle. Distances are not set.
DistanceGrid layOut(const Box& box, const BakeOptions& options)
{
    const glm::dvec3 extent = box.high - box.low;
    DistanceGrid grid;
    grid.spacing =
        static_cast<float>(std::max({extent.x, extent.y, extent.z}) / double(options.cells));
    for (int k = 0; k < 3; ++k)
    {
        // A side of a whole number of voxels rounds to that.
        const double cells = std::ceil(extent[k] / double(grid.spacing) - 1e-4);
        grid.size[k] = static_cast<int>(cells) + 2 * options.margin;
        grid.first[k] = static_cast<float>(0.5 * (box.low[k] + box.high[k]) -
                                           0.5 * double(grid.spacing) * (grid.size[k] - 1));
    }
    grid.distances.resize(grid.indexOf(0, 0, grid.size.z));
    return grid;
}

/// Distances of a slice, without sign. What is known of a voxel bounds its neighbour's distance.
void measure(DistanceGrid& grid, const SurfaceDistance& surface, const Box& box, int z)
{
    const double step = double(grid.spacing) * (1.0 + 1e-6);
    double atMost = std::numeric_limits<double>::infinity();
    for (int y = 0; y < grid.size.y; ++y)
        for (int i = 0; i < grid.size.x; ++i)
        {
            const int x = y % 2 == 0 ? i : grid.size.x - 1 - i; // to and fro, so that all are near
            const glm::dvec3 centre = grid.centre(x, y, z);
            if (!std::isfinite(atMost)) // as far as the farthest corner of the box
                atMost =
                    glm::length(glm::max(glm::abs(centre - box.low), glm::abs(centre - box.high)));
            const double distance = surface.to(centre, atMost);
            grid.distances[grid.indexOf(x, y, z)] = static_cast<float>(distance);
            atMost = distance + step;
        }
}

/// Brings distances to what closes the holes, too. Without that they would jump from negative to
/// positive in a hole.
void measureCaps(DistanceGrid& grid, const SurfaceDistance& caps, int z)
{
    for (int y = 0; y < grid.size.y; ++y)
        for (int x = 0; x < grid.size.x; ++x)
        {
            float& distance = grid.distances[grid.indexOf(x, y, z)];
            const double size = caps.to(grid.centre(x, y, z), double(std::abs(distance)));
            distance = std::copysign(static_cast<float>(size), distance);
        }
}
} // namespace

std::string BakeOptions::complaint() const
{
    const auto outOf = [](const char* name, int value, int least, int most)
    {
        return std::string(name) + " is " + std::to_string(value) + ", must be within " +
               std::to_string(least) + " … " + std::to_string(most);
    };
    if (cells < 4 || cells > 512)
        return outOf("cells", cells, 4, 512);
    if (margin < 1 || margin > 64)
        return outOf("margin", margin, 1, 64);
    return {};
}

Result<BakedField> bakeMesh(const TriangleMesh& mesh, const BakeOptions& options)
{
    const auto invalid = [](const std::string& what) {
        return Error{ErrorCode::Invalid, "distance field: " + what};
    };
    if (const std::string complaint = mesh.complaint(); !complaint.empty())
        return invalid(complaint);
    if (const std::string complaint = options.complaint(); !complaint.empty())
        return invalid(complaint);
    try
    {
        const std::vector<TriangleCorners> triangles = solidTriangles(mesh);
        if (triangles.empty())
            return invalid("no triangle of the mesh has an area");
        const auto surface = SurfaceDistance::build(triangles);
        if (!surface)
            return surface.error();
        const Error givenUp{ErrorCode::Failed, "distance field: given up"};
        const auto told = [&](double from, double to)
        {
            return [&options, from, to](double share)
            { return !options.progress || options.progress(from + (to - from) * share); };
        };
        BakedField field;
        const Box box = boxOf(triangles);
        const glm::dvec3 extent = box.high - box.low;
        const double longest = std::max({extent.x, extent.y, extent.z});
        if (!(longest >= leastSide && longest <= mostSide))
            return invalid("the longest side of the mesh's box is " + std::to_string(longest) +
                           " m, must be within 1e-6 … 1e9 m");
        // Voxels' centres are floats in the mesh's frame.
        const glm::dvec3 farthest = glm::max(glm::abs(box.low), glm::abs(box.high));
        const double away = std::max({farthest.x, farthest.y, farthest.z});
        if (away > 1e-2 * longest / options.cells * 16777216.0)
            return invalid("the mesh is " + std::to_string(longest) + " m long and lies " +
                           std::to_string(away) +
                           " m from the origin of its frame, whose floats do not tell its voxels "
                           "apart; needs to lie about the origin");
        field.grid = layOut(box, options);
        if (!forEachSlice(
                field.grid.size.z, [&](int z) { measure(field.grid, **surface, box, z); },
                told(0.0, 0.4)))
            return givenUp;
        const auto report =
            giveSigns(field.grid, WindingNumber(triangles), box.low, box.high, told(0.4, 0.9));
        if (!report)
            return givenUp;
        if (std::vector<TriangleCorners> caps = capsOf(field.grid); !caps.empty())
        {
            const auto closing = SurfaceDistance::build(std::move(caps));
            if (!closing)
                return closing.error();
            if (!forEachSlice(
                    field.grid.size.z, [&](int z) { measureCaps(field.grid, **closing, z); },
                    told(0.9, 1.0)))
                return givenUp;
        }
        if (report->nearVoxels > 0)
            field.ambiguousShare = double(report->ambiguousVoxels) / double(report->nearVoxels);
        return field;
    }
    catch (const std::bad_alloc&)
    {
        return Error{ErrorCode::Failed, "distance field: not enough memory"};
    }
}

} // namespace osgTerrainLight
