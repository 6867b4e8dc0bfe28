#pragma once

#include "reference/ReferenceLight.h"

#include "core/Raster.h"
#include "core/Result.h"

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/SkyLight.h>

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace osgTerrainLight::reference
{

/// Linear red, green, blue, in double.
using LinearRgb = std::array<double, 3>;

/// A diffuse triangle, both sides alike. Corners in metres from post (0, 0): x east, y north, z
/// above the tile's heightOrigin. Its front is the side that sees them counter-clockwise.
struct Triangle
{
    std::array<Vector3, 3> corners = {};
    LinearRgb albedo = {0.0, 0.0, 0.0};   ///< 0 … 1
    LinearRgb emission = {0.0, 0.0, 0.0}; ///< radiance, ≥ 0
};

/// What rays meet: the bilinear surface of a tile, and triangles.
struct SceneDescription
{
    /// All rows must have the same east spacing. Where they have not, directions differ in meaning
    /// from row to row, and light that bounces between rows has no one geometry to be traced in.
    DemTile tile;
    /// Of the ground, 0 … 1 in each colour, …
    Rgb albedo = {0.0f, 0.0f, 0.0f};
    /// … or, where not empty, one per post, bilinear between them; those of void posts are ignored.
    Raster<Rgb> albedos;
    /// Of the ground besides: radiance sent towards o is albedo · E/π + gloss · ∫ lobe(r·d) L(d) dd
    /// over the d above the surface, with the Phong lobe (s + 1) / 2π max(cos, 0)ˢ about r =
    /// 2(N·o)N − o.
    double gloss = 0.0;         ///< 0 … 1
    double glossExponent = 8.0; ///< s, 1 … 1000
    /// Where not 0, only as many bands l = 0, 1, … of the lobe are left, 1 … 16: light as spherical
    /// harmonics of that order would have it.
    int glossBands = 0;
    std::vector<Triangle> triangles;
};

/// A place on a surface: where rays end, and where they start.
struct SurfacePoint
{
    Vector3 grid = {};   ///< column, row (both may have a fraction), metres above heightOrigin
    Vector3 normal = {}; ///< unit; of two sides, the one that the ray came from
    LinearRgb albedo = {};
    LinearRgb emission = {};
    /// False where the ray came from below the ground, through a void: no light there.
    bool above = true;
    /// The place lies on the surface of these cells …
    int firstColumn = 0, lastColumn = -1, firstRow = 0, lastRow = -1;
    /// … or on this triangle; −1: none.
    int triangle = -1;
};

/// First hits of rays, in double. Embree (robust mode) finds the cells and triangles whose boxes a
/// ray may meet; the intersection itself is solved here.
///
/// The ground is solid below its surface: a ray is stopped where it is first at or below the
/// surface of a cell. That makes cells join without cracks, and it is what a horizon means:
/// whatever is below the slope to a visible point is hidden. Cells with a void corner have no
/// surface and nothing below. So an edge between two valid posts with no complete cell beside it
/// stops no ray; exhaustiveHorizon() counts it.
///
/// Where a ray starts, the surface's height above it is 0 without rounding, in all cells that share
/// the place. A ray that starts downwards from the surface of the cell that it enters is stopped at
/// once, in the same place but with that cell's normal: the limit of a start just above the
/// surface.
class RayScene
{
public:
    /// Errors: Invalid where an albedo is not within 0 … 1, `albedos` is not of the tile's size, a
    /// spacing is not positive, a triangle is not finite, has no area or emits less than 0;
    /// NotSupported where east spacings differ; Failed where Embree gives no device.
    static Result<std::unique_ptr<RayScene>> build(SceneDescription description);
    ~RayScene();

    const SceneDescription& description() const;
    bool hasEmission() const;

    /// A valid post, with the normal of surfaceNormal().
    SurfacePoint post(int column, int row) const;
    /// The front of triangle `index` at corner 0 + s·(corner 1 − corner 0) + t·(corner 2 − corner
    /// 0).
    SurfacePoint pointOfTriangle(int index, double s, double t) const;
    /// A place that lies on nothing: metres from post (0, 0), and a unit normal.
    SurfacePoint pointAt(const Vector3& metres, const Vector3& normal) const;

    /// Does a ray from `start` in `direction` (unit; x east, y north, z up) meet anything? Safe
    /// from any thread, as is firstHit().
    bool isOccluded(const SurfacePoint& start, const Vector3& direction) const;
    std::optional<SurfacePoint> firstHit(const SurfacePoint& start, const Vector3& direction) const;

private:
    struct Embree;
    explicit RayScene(std::unique_ptr<Embree> embree);
    std::unique_ptr<Embree> _embree;
};

} // namespace osgTerrainLight::reference
