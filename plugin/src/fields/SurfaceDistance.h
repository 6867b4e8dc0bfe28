#pragma once

#include "core/Result.h"
#include "fields/SolidTriangles.h"

#include <memory>
#include <vector>

namespace osgTerrainLight
{

/// Finds how far a point is from the nearest of many triangles, through Embree's tree and point
/// query (Wald et al. 2014). The distance to a triangle is exact, in double.
class SurfaceDistance
{
public:
    /// triangles: at least one, each with an area. Error: NotSupported where the library was built
    /// without Embree, Failed where Embree refuses.
    static Result<std::unique_ptr<SurfaceDistance>> build(std::vector<TriangleCorners> triangles);

    ~SurfaceDistance();
    SurfaceDistance(const SurfaceDistance&) = delete;
    SurfaceDistance& operator=(const SurfaceDistance&) = delete;

    /// Distance to the nearest triangle [m], >= 0. atMost: a bound that is known already [m]; where
    /// nothing is within it, the answer is that bound. May be called by several threads at once.
    double to(const glm::dvec3& point, double atMost) const;

private:
    struct Embree;
    explicit SurfaceDistance(std::unique_ptr<Embree> embree);
    std::unique_ptr<Embree> _embree;
};

} // namespace osgTerrainLight
