#include "reference/RayScene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

namespace osgTerrainLight::reference
{

namespace
{
constexpr double infinity = std::numeric_limits<double>::infinity();

Vector3 minus(const Vector3& a, const Vector3& b)
{
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double dot(const Vector3& a, const Vector3& b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector3 cross(const Vector3& a, const Vector3& b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector3 times(const Vector3& a, double factor)
{
    return {a[0] * factor, a[1] * factor, a[2] * factor};
}

Vector3 normalised(const Vector3& a)
{
    return times(a, 1.0 / std::sqrt(dot(a, a)));
}

LinearRgb linear(const Rgb& rgb)
{
    return {double(rgb[0]), double(rgb[1]), double(rgb[2])};
}

template <class Colour>
bool isWithin(const Colour& colour, double lowest, double highest)
{
    return std::all_of(colour.begin(), colour.end(),
                       [&](auto c) { return double(c) >= lowest && double(c) <= highest; });
}

/// A ray in double, and its nearest hit so far. Embree carries the first part through to the
/// callbacks.
struct Query : RTCIntersectContext
{
    const SurfacePoint* start = nullptr;
    Vector3 direction = {};  ///< unit
    Vector3 perMetre = {};   ///< columns, rows and metres up, per metre of the ray
    Vector3 fromOrigin = {}; ///< the start in metres

    double distance = infinity; ///< to the hit [m]
    int primitive = -1;         ///< a column + row · width, or a triangle
    bool isTriangle = false;
    bool above = true;
    double u = 0.0, v = 0.0; ///< place in the cell, or weights of the triangle's corners 1 and 2

    /// The nearer hit wins; of equal ones the lower cell, whatever the order of traversal.
    void offer(double t, int hitPrimitive, bool hitsTriangle, double hitU, double hitV,
               bool fromAbove)
    {
        const auto key = std::pair(hitsTriangle, hitPrimitive);
        if (t > distance || (t == distance && key > std::pair(isTriangle, primitive)))
            return;
        distance = t;
        primitive = hitPrimitive;
        isTriangle = hitsTriangle;
        u = hitU;
        v = hitV;
        above = fromAbove;
    }
};

bool liesOn(const SurfacePoint& point, int column, int row)
{
    return column >= point.firstColumn && column <= point.lastColumn && row >= point.firstRow &&
           row <= point.lastRow;
}

/// Narrows t0 … t1 to where start + t·rate is within lower … lower + 1. Neighbours compute the
/// place of their common border by the same arithmetic, so they agree on it to the last bit.
void clip(double start, double rate, int lower, double& t0, double& t1)
{
    if (rate == 0.0)
    {
        if (start < lower || start > lower + 1)
            t1 = -infinity;
        return;
    }
    const double a = (lower - start) / rate;
    const double b = (lower + 1 - start) / rate;
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
}
} // namespace

struct RayScene::Embree
{
    SceneDescription description;
    double eastStep = 1.0;
    double northStep = 1.0;
    double lowest = 0.0;         ///< of all posts [m]
    double belowTolerance = 0.0; ///< [m]
    double nearest = 0.0;        ///< hit on a triangle that counts [m]
    bool hasEmission = false;
    std::vector<int> cells;       ///< the complete ones, column + row · width
    std::vector<Vector3> normals; ///< of the triangles, unit

    /// Embree computes in float, from the scene's middle.
    Vector3 middle = {};
    double margin = 0.0;
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    ~Embree()
    {
        if (scene)
            rtcReleaseScene(scene);
        if (device)
            rtcReleaseDevice(device);
    }

    Vector3 metres(const Vector3& grid) const
    {
        return {grid[0] * eastStep, grid[1] * northStep, grid[2]};
    }

    /// z00 + zx·u + zy·v + zxy·u·v [m].
    struct Patch
    {
        double z00, zx, zy, zxy;
        double height(double u, double v) const { return z00 + zx * u + (zy + zxy * u) * v; }
    };
    Patch patch(int column, int row) const
    {
        const DemTile& tile = description.tile;
        const double z00 = double(tile.heightAt(column, row));
        const double zx = double(tile.heightAt(column + 1, row)) - z00;
        const double zy = double(tile.heightAt(column, row + 1)) - z00;
        const double z11 = double(tile.heightAt(column + 1, row + 1));
        return {z00, zx, zy, z11 - z00 - zx - zy};
    }

    void intersectCell(int cell, Query& query) const;
    void intersectTriangle(int index, Query& query) const;
    SurfacePoint hitOf(const Query& query) const;

    Query queryFrom(const SurfacePoint& start, const Vector3& direction) const
    {
        Query query;
        rtcInitIntersectContext(&query);
        query.start = &start;
        query.direction = direction;
        query.perMetre = {direction[0] / eastStep, direction[1] / northStep, direction[2]};
        query.fromOrigin = metres(start.grid);
        return query;
    }

    RTCRay floatRay(const Query& query) const
    {
        const Vector3 origin = minus(query.fromOrigin, middle);
        RTCRay ray = {};
        ray.org_x = static_cast<float>(origin[0]);
        ray.org_y = static_cast<float>(origin[1]);
        ray.org_z = static_cast<float>(origin[2]);
        ray.dir_x = static_cast<float>(query.direction[0]);
        ray.dir_y = static_cast<float>(query.direction[1]);
        ray.dir_z = static_cast<float>(query.direction[2]);
        ray.tfar = std::numeric_limits<float>::infinity();
        ray.mask = ~0u;
        return ray;
    }

    void setBounds(const Vector3& low, const Vector3& high, RTCBounds& bounds) const
    {
        bounds.lower_x = static_cast<float>(low[0] - middle[0] - margin);
        bounds.lower_y = static_cast<float>(low[1] - middle[1] - margin);
        bounds.lower_z = static_cast<float>(low[2] - middle[2] - margin);
        bounds.upper_x = static_cast<float>(high[0] - middle[0] + margin);
        bounds.upper_y = static_cast<float>(high[1] - middle[1] + margin);
        bounds.upper_z = static_cast<float>(high[2] - middle[2] + margin);
    }

    static void cellBounds(const RTCBoundsFunctionArguments* arguments);
    static void triangleBounds(const RTCBoundsFunctionArguments* arguments);
    template <bool isTriangle>
    static void intersect(const RTCIntersectFunctionNArguments* arguments);
    template <bool isTriangle>
    static void occlude(const RTCOccludedFunctionNArguments* arguments);

    void measure();
    bool commit();
    template <bool isTriangle>
    void attach(std::size_t count, RTCBoundsFunction bounds);
};

/// Along the ray the height above the cell's surface is f(t) = f0 + b·s + c·s², s = t − t0, t0
/// being where the ray enters the cell. It is stopped at the first t with f ≤ 0.
void RayScene::Embree::intersectCell(int cell, Query& query) const
{
    const int column = cell % description.tile.width();
    const int row = cell / description.tile.width();
    const SurfacePoint& start = *query.start;
    const Vector3& rate = query.perMetre;
    double t0 = 0.0;
    double t1 = query.distance;
    clip(start.grid[0], rate[0], column, t0, t1);
    clip(start.grid[1], rate[1], row, t0, t1);
    if (!(t0 <= t1))
        return;

    const Patch p = patch(column, row);
    const auto uAt = [&](double t)
    { return std::clamp(start.grid[0] + rate[0] * t - column, 0., 1.); };
    const auto vAt = [&](double t)
    { return std::clamp(start.grid[1] + rate[1] * t - row, 0., 1.); };
    const double u = uAt(t0);
    const double v = vAt(t0);
    const double b =
        rate[2] - p.zx * rate[0] - p.zy * rate[1] - p.zxy * (u * rate[1] + v * rate[0]);
    const double c = -p.zxy * rate[0] * rate[1];
    const auto offer = [&](double t, bool fromAbove)
    { query.offer(t, cell, false, uAt(t), vAt(t), fromAbove); };

    if (liesOn(start, column, row))
    {
        // f = b·s + c·s². A cell that shares the start but is not entered has no length.
        if (!(t1 > 0.0))
            return;
        if (b < 0.0 || (b == 0.0 && c <= 0.0))
            offer(0.0, true);
        else if (c < 0.0 && -b / c <= t1)
            offer(-b / c, true);
        return;
    }
    const double f0 = start.grid[2] + rate[2] * t0 - p.height(u, v);
    if (f0 <= 0.0)
    {
        offer(t0, f0 > -belowTolerance);
        return;
    }
    const double discriminant = b * b - 4.0 * c * f0;
    if (discriminant < 0.0 || (b >= 0.0 && c >= 0.0))
        return;
    // The root that cancels nothing: of two positive ones (b < 0 < c) the smaller, else the
    // positive.
    const double root = std::sqrt(discriminant);
    const double s = b < 0.0 ? 2.0 * f0 / (root - b) : -(b + root) / (2.0 * c);
    if (t0 + s <= t1)
        offer(t0 + s, true);
}

/// By the signed volumes that the ray spans with the edges. Of two triangles the common edge has
/// volumes that differ in sign alone, so no ray passes between them.
void RayScene::Embree::intersectTriangle(int index, Query& query) const
{
    if (index == query.start->triangle)
        return;
    const auto& corners = description.triangles[static_cast<std::size_t>(index)].corners;
    const Vector3 a = minus(corners[0], query.fromOrigin);
    const Vector3 b = minus(corners[1], query.fromOrigin);
    const Vector3 c = minus(corners[2], query.fromOrigin);
    const double wa = dot(cross(b, c), query.direction);
    const double wb = dot(cross(c, a), query.direction);
    const double wc = dot(cross(a, b), query.direction);
    const double sum = wa + wb + wc;
    if ((std::min({wa, wb, wc}) < 0.0 && std::max({wa, wb, wc}) > 0.0) || sum == 0.0)
        return;
    const double along =
        wa * dot(a, query.direction) + wb * dot(b, query.direction) + wc * dot(c, query.direction);
    if (along / sum > nearest)
        query.offer(along / sum, index, true, wb / sum, wc / sum, true);
}

SurfacePoint RayScene::Embree::hitOf(const Query& query) const
{
    SurfacePoint hit;
    hit.above = query.above;
    const double u = query.u;
    const double v = query.v;
    if (query.isTriangle)
    {
        const std::size_t index = static_cast<std::size_t>(query.primitive);
        const Triangle& triangle = description.triangles[index];
        hit.triangle = query.primitive;
        const double w = 1.0 - u - v;
        const auto& [a, b, c] = triangle.corners;
        hit.grid = {(a[0] * w + b[0] * u + c[0] * v) / eastStep,
                    (a[1] * w + b[1] * u + c[1] * v) / northStep, a[2] * w + b[2] * u + c[2] * v};
        const bool front = dot(normals[index], query.direction) < 0.0;
        hit.normal = times(normals[index], front ? 1.0 : -1.0);
        hit.albedo = triangle.albedo;
        hit.emission = triangle.emission;
        return hit;
    }
    const int column = query.primitive % description.tile.width();
    const int row = query.primitive / description.tile.width();
    const Patch p = patch(column, row);
    hit.grid = {column + u, row + v, p.height(u, v)};
    hit.normal = normalised({-(p.zx + p.zxy * v) / eastStep, -(p.zy + p.zxy * u) / northStep, 1.0});
    hit.firstColumn = hit.lastColumn = column;
    hit.firstRow = hit.lastRow = row;
    if (query.distance == 0.0 && liesOn(*query.start, column, row))
    {
        // Stopped at once: the same place, and all the start's cells share it.
        hit.grid = query.start->grid;
        hit.firstColumn = query.start->firstColumn;
        hit.lastColumn = query.start->lastColumn;
        hit.firstRow = query.start->firstRow;
        hit.lastRow = query.start->lastRow;
    }
    const Raster<Rgb>& albedos = description.albedos;
    hit.albedo = linear(description.albedo);
    if (!albedos.empty())
        for (std::size_t k = 0; k < 3; ++k)
        {
            const auto at = [&](int i, int j)
            { return double(albedos.at(column + i, row + j)[k]); };
            hit.albedo[k] = (1.0 - v) * ((1.0 - u) * at(0, 0) + u * at(1, 0)) +
                            v * ((1.0 - u) * at(0, 1) + u * at(1, 1));
        }
    return hit;
}

void RayScene::Embree::cellBounds(const RTCBoundsFunctionArguments* arguments)
{
    const auto& self = *static_cast<const Embree*>(arguments->geometryUserPtr);
    const DemTile& tile = self.description.tile;
    const int cell = self.cells[arguments->primID];
    const int column = cell % tile.width();
    const int row = cell / tile.width();
    const float top =
        std::max({tile.heightAt(column, row), tile.heightAt(column + 1, row),
                  tile.heightAt(column, row + 1), tile.heightAt(column + 1, row + 1)});
    // Solid down to the lowest post: below that no ray comes up again.
    self.setBounds(self.metres({double(column), double(row), self.lowest}),
                   self.metres({column + 1.0, row + 1.0, double(top)}), *arguments->bounds_o);
}

void RayScene::Embree::triangleBounds(const RTCBoundsFunctionArguments* arguments)
{
    const auto& self = *static_cast<const Embree*>(arguments->geometryUserPtr);
    const auto& [a, b, c] = self.description.triangles[arguments->primID].corners;
    Vector3 low = {};
    Vector3 high = {};
    for (std::size_t k = 0; k < 3; ++k)
    {
        low[k] = std::min({a[k], b[k], c[k]});
        high[k] = std::max({a[k], b[k], c[k]});
    }
    self.setBounds(low, high, *arguments->bounds_o);
}

template <bool isTriangle>
void RayScene::Embree::intersect(const RTCIntersectFunctionNArguments* arguments)
{
    const auto& self = *static_cast<const Embree*>(arguments->geometryUserPtr);
    auto& query = *static_cast<Query*>(arguments->context);
    if (arguments->valid[0] == 0)
        return;
    const double before = query.distance;
    if constexpr (isTriangle)
        self.intersectTriangle(static_cast<int>(arguments->primID), query);
    else
        self.intersectCell(self.cells[arguments->primID], query);
    if (query.distance < before)
    {
        // Not nearer than the true hit, so that equally near ones are still offered.
        const double end = query.distance + self.margin;
        RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, 1), 1, 0) = static_cast<float>(end);
        RTCHitN_geomID(RTCRayHitN_HitN(arguments->rayhit, 1), 1, 0) = arguments->geomID;
    }
}

template <bool isTriangle>
void RayScene::Embree::occlude(const RTCOccludedFunctionNArguments* arguments)
{
    const auto& self = *static_cast<const Embree*>(arguments->geometryUserPtr);
    auto& query = *static_cast<Query*>(arguments->context);
    if (arguments->valid[0] == 0)
        return;
    if constexpr (isTriangle)
        self.intersectTriangle(static_cast<int>(arguments->primID), query);
    else
        self.intersectCell(self.cells[arguments->primID], query);
    if (query.distance < infinity)
        RTCRayN_tfar(arguments->ray, 1, 0) = -std::numeric_limits<float>::infinity();
}

/// Extent, margin and what else follows from the description.
void RayScene::Embree::measure()
{
    const DemTile& tile = description.tile;
    eastStep = tile.eastSpacing(0);
    northStep = tile.northSpacing;
    for (int row = 0; row + 1 < tile.height(); ++row)
        for (int column = 0; column + 1 < tile.width(); ++column)
            if (tile.isValid(column, row) && tile.isValid(column + 1, row) &&
                tile.isValid(column, row + 1) && tile.isValid(column + 1, row + 1))
                cells.push_back(column + row * tile.width());

    lowest = infinity;
    double highest = -infinity;
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column)
            if (tile.isValid(column, row))
            {
                lowest = std::min(lowest, double(tile.heightAt(column, row)));
                highest = std::max(highest, double(tile.heightAt(column, row)));
            }
    if (lowest > highest)
        lowest = highest = 0.0;
    // Heights of a ray and of a patch round by 1e-13 of their size; real passages below the ground
    // are seldom within 1e-9 of it.
    belowTolerance = 1e-9 * std::max({eastStep, northStep, std::abs(lowest), std::abs(highest)});

    Vector3 low = metres({0.0, 0.0, lowest});
    Vector3 high = metres({tile.width() - 1.0, tile.height() - 1.0, highest});
    for (const Triangle& triangle : description.triangles)
    {
        const auto& [a, b, c] = triangle.corners;
        normals.push_back(normalised(cross(minus(b, a), minus(c, a))));
        hasEmission = hasEmission || std::any_of(triangle.emission.begin(), triangle.emission.end(),
                                                 [](double e) { return e > 0.0; });
        for (const Vector3& corner : triangle.corners)
            for (std::size_t k = 0; k < 3; ++k)
            {
                low[k] = std::min(low[k], corner[k]);
                high[k] = std::max(high[k], corner[k]);
            }
    }
    middle = times({low[0] + high[0], low[1] + high[1], low[2] + high[2]}, 0.5);
    const Vector3 diagonal = minus(high, low);
    const double size = std::sqrt(dot(diagonal, diagonal));
    // A start on the common edge of two triangles in one plane is off the other by rounding.
    nearest = 1e-12 * size;
    // Over a scene of diagonal D a float ray strays from the double one by at most D·2⁻²⁵ for its
    // origin and D·√3·2⁻²⁵ for its direction, and boxes are off by D·2⁻²⁵: less than D·2⁻²³. 16
    // times that also covers what robust traversal rounds, and costs nothing: 0.003 cells at 1024².
    margin = std::max(size, eastStep + northStep) * 0x1p-19;
}

template <bool isTriangle>
void RayScene::Embree::attach(std::size_t count, RTCBoundsFunction bounds)
{
    if (count == 0)
        return;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(count));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect<isTriangle>);
    rtcSetGeometryOccludedFunction(geometry, occlude<isTriangle>);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
}

/// False where Embree refuses.
bool RayScene::Embree::commit()
{
    device = rtcNewDevice(nullptr);
    if (!device)
        return false;
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    attach<false>(cells.size(), cellBounds);
    attach<true>(normals.size(), triangleBounds);
    rtcCommitScene(scene);
    return rtcGetDeviceError(device) == RTC_ERROR_NONE;
}

RayScene::RayScene(std::unique_ptr<Embree> embree) : _embree(std::move(embree)) {}
RayScene::~RayScene() = default;

Result<std::unique_ptr<RayScene>> RayScene::build(SceneDescription description)
{
    const auto invalid = [](const std::string& what) {
        return Error{ErrorCode::Invalid, "path tracer: " + what};
    };
    const DemTile& tile = description.tile;
    if (tile.width() < 1 || tile.height() < 1)
        return invalid("the tile has no posts");
    for (double spacing : tile.eastSpacings)
        if (!(spacing > 0.0) || !std::isfinite(spacing))
            return invalid("an east spacing is " + std::to_string(spacing) + " m, must be > 0");
    if (!(tile.northSpacing > 0.0) || !std::isfinite(tile.northSpacing))
        return invalid("north spacing is " + std::to_string(tile.northSpacing) + " m, must be > 0");
    for (int row = 1; row < tile.height(); ++row)
        if (tile.eastSpacing(row) != tile.eastSpacing(0))
            return Error{ErrorCode::NotSupported,
                         "path tracer: east spacings differ from row to row; give the tile one"};
    if (!isWithin(description.albedo, 0.0, 1.0))
        return invalid("the albedo is not within 0 … 1");
    if (!(description.gloss >= 0.0 && description.gloss <= 1.0))
        return invalid("the gloss is not within 0 … 1");
    if (!(description.glossExponent >= 1.0 && description.glossExponent <= 1000.0))
        return invalid("the gloss's exponent is not within 1 … 1000");
    if (description.glossBands < 0 || description.glossBands > 16)
        return invalid("the gloss's bands are not within 0 … 16");
    const Raster<Rgb>& albedos = description.albedos;
    if (!albedos.empty())
    {
        if (albedos.width() != tile.width() || albedos.height() != tile.height())
            return invalid("albedos are " + std::to_string(albedos.width()) + " × " +
                           std::to_string(albedos.height()) + ", the tile has " +
                           std::to_string(tile.width()) + " × " + std::to_string(tile.height()) +
                           " posts");
        for (int row = 0; row < tile.height(); ++row)
            for (int column = 0; column < tile.width(); ++column)
                if (tile.isValid(column, row) && !isWithin(albedos.at(column, row), 0.0, 1.0))
                    return invalid("the albedo of post (" + std::to_string(column) + ", " +
                                   std::to_string(row) + ") is not within 0 … 1");
    }
    for (std::size_t i = 0; i < description.triangles.size(); ++i)
    {
        const Triangle& triangle = description.triangles[i];
        const auto& [a, b, c] = triangle.corners;
        const Vector3 area = cross(minus(b, a), minus(c, a));
        const double size = dot(area, area);
        if (!(size > 0.0) || !std::isfinite(size))
            return invalid("triangle " + std::to_string(i) + " has no finite, positive area");
        if (!isWithin(triangle.albedo, 0.0, 1.0))
            return invalid("the albedo of triangle " + std::to_string(i) + " is not within 0 … 1");
        if (!isWithin(triangle.emission, 0.0, std::numeric_limits<double>::max()))
            return invalid("the emission of triangle " + std::to_string(i) +
                           " is not finite and ≥ 0");
    }

    auto embree = std::make_unique<Embree>();
    embree->description = std::move(description);
    embree->measure();
    if (!embree->commit())
        return Error{ErrorCode::Failed, "path tracer: Embree cannot build the scene"};
    return std::unique_ptr<RayScene>(new RayScene(std::move(embree)));
}

const SceneDescription& RayScene::description() const
{
    return _embree->description;
}

bool RayScene::hasEmission() const
{
    return _embree->hasEmission;
}

SurfacePoint RayScene::post(int column, int row) const
{
    const DemTile& tile = _embree->description.tile;
    assert(tile.isValid(column, row));
    SurfacePoint point;
    point.grid = {double(column), double(row), double(tile.heightAt(column, row))};
    point.normal = surfaceNormal(tile, column, row);
    point.firstColumn = column - 1;
    point.lastColumn = column;
    point.firstRow = row - 1;
    point.lastRow = row;
    return point;
}

SurfacePoint RayScene::pointOfTriangle(int index, double s, double t) const
{
    const std::size_t i = static_cast<std::size_t>(index);
    const auto& [a, b, c] = _embree->description.triangles[i].corners;
    const double w = 1.0 - s - t;
    SurfacePoint point;
    point.grid = {(a[0] * w + b[0] * s + c[0] * t) / _embree->eastStep,
                  (a[1] * w + b[1] * s + c[1] * t) / _embree->northStep,
                  a[2] * w + b[2] * s + c[2] * t};
    point.normal = _embree->normals[i];
    point.triangle = index;
    return point;
}

SurfacePoint RayScene::pointAt(const Vector3& metres, const Vector3& normal) const
{
    SurfacePoint point;
    point.grid = {metres[0] / _embree->eastStep, metres[1] / _embree->northStep, metres[2]};
    point.normal = normal;
    return point;
}

bool RayScene::isOccluded(const SurfacePoint& start, const Vector3& direction) const
{
    Query query = _embree->queryFrom(start, direction);
    RTCRay ray = _embree->floatRay(query);
    rtcOccluded1(_embree->scene, &query, &ray);
    return query.distance < infinity;
}

std::optional<SurfacePoint> RayScene::firstHit(const SurfacePoint& start,
                                               const Vector3& direction) const
{
    Query query = _embree->queryFrom(start, direction);
    RTCRayHit rayHit = {};
    rayHit.ray = _embree->floatRay(query);
    rayHit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(_embree->scene, &query, &rayHit);
    if (query.distance == infinity)
        return std::nullopt;
    return _embree->hitOf(query);
}

} // namespace osgTerrainLight::reference
