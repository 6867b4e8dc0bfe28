#include "fields/SurfaceDistance.h"

#ifdef OSGTERRAINLIGHT_EMBREE
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace osgTerrainLight
{

#ifdef OSGTERRAINLIGHT_EMBREE

namespace
{
/// The point of a triangle that is nearest to p (Ericson 2005, section 5.1.5).
glm::dvec3 nearestOf(const TriangleCorners& triangle, const glm::dvec3& p)
{
    const auto& [a, b, c] = triangle;
    const glm::dvec3 ab = b - a, ac = c - a, ap = p - a;
    const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0.0 && d2 <= 0.0)
        return a;
    const glm::dvec3 bp = p - b;
    const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0.0 && d4 <= d3)
        return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0)
        return a + ab * (d1 / (d1 - d3));
    const glm::dvec3 cp = p - c;
    const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0.0 && d5 <= d6)
        return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0)
        return a + ac * (d2 / (d2 - d6));
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 >= d3 && d5 >= d6)
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    const double sum = va + vb + vc;
    return a + ab * (vb / sum) + ac * (vc / sum);
}
} // namespace

struct SurfaceDistance::Embree
{
    std::vector<TriangleCorners> triangles;
    glm::dvec3 middle{0.0}; ///< Embree computes in float, from here
    double margin = 0.0;    ///< of Embree's float places [m]
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    ~Embree()
    {
        if (scene)
            rtcReleaseScene(scene);
        if (device)
            rtcReleaseDevice(device);
    }

    bool commit();
};

namespace
{
struct Nearest
{
    const std::vector<TriangleCorners>* triangles;
    glm::dvec3 point;
    double margin;
    double squared; ///< of the distance to the nearest so far [m²]
};

bool offer(RTCPointQueryFunctionArguments* arguments)
{
    auto& nearest = *static_cast<Nearest*>(arguments->userPtr);
    const TriangleCorners& triangle = (*nearest.triangles)[arguments->primID];
    const glm::dvec3 away = nearestOf(triangle, nearest.point) - nearest.point;
    const double squared = glm::dot(away, away);
    if (!(squared < nearest.squared))
        return false;
    nearest.squared = squared;
    arguments->query->radius = static_cast<float>(std::sqrt(squared) + nearest.margin);
    return true; // the radius has changed
}
} // namespace

bool SurfaceDistance::Embree::commit()
{
    glm::dvec3 low(std::numeric_limits<double>::infinity());
    glm::dvec3 high = -low;
    for (const TriangleCorners& triangle : triangles)
        for (const glm::dvec3& corner : triangle)
        {
            low = glm::min(low, corner);
            high = glm::max(high, corner);
        }
    middle = 0.5 * (low + high);
    // Places round by 2⁻²⁴ of their distance from the middle; the queried points lie within a few
    // times the mesh's size. 64 times that rounding costs nothing.
    margin = glm::length(high - low) * 0x1p-18;

    device = rtcNewDevice(nullptr);
    if (!device)
        return false;
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* places = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               3 * triangles.size()));
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), triangles.size()));
    if (places && indices)
    {
        for (const TriangleCorners& triangle : triangles)
            for (const glm::dvec3& corner : triangle)
                for (int k = 0; k < 3; ++k)
                    *places++ = static_cast<float>(corner[k] - middle[k]);
        for (std::size_t i = 0; i < 3 * triangles.size(); ++i)
            indices[i] = static_cast<unsigned>(i);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcCommitScene(scene);
    }
    rtcReleaseGeometry(geometry);
    return places && indices && rtcGetDeviceError(device) == RTC_ERROR_NONE;
}

Result<std::unique_ptr<SurfaceDistance>>
SurfaceDistance::build(std::vector<TriangleCorners> triangles)
{
    auto embree = std::make_unique<Embree>();
    embree->triangles = std::move(triangles);
    if (!embree->commit())
        return Error{ErrorCode::Failed, "distance field: Embree cannot build the tree of the mesh"};
    return std::unique_ptr<SurfaceDistance>(new SurfaceDistance(std::move(embree)));
}

double SurfaceDistance::to(const glm::dvec3& point, double atMost) const
{
    Nearest nearest{&_embree->triangles, point, _embree->margin, atMost * atMost};
    const glm::dvec3 place = point - _embree->middle;
    RTCPointQuery query;
    query.x = static_cast<float>(place.x);
    query.y = static_cast<float>(place.y);
    query.z = static_cast<float>(place.z);
    query.time = 0.0f;
    query.radius = static_cast<float>(atMost + _embree->margin);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(_embree->scene, &query, &context, offer, &nearest);
    return std::sqrt(nearest.squared);
}

#else

struct SurfaceDistance::Embree
{
};

Result<std::unique_ptr<SurfaceDistance>> SurfaceDistance::build(std::vector<TriangleCorners>)
{
    return Error{ErrorCode::NotSupported,
                 "distance field: this library was built without Embree, which fields of meshes "
                 "need"};
}

double SurfaceDistance::to(const glm::dvec3&, double atMost) const
{
    return atMost;
}

#endif

SurfaceDistance::SurfaceDistance(std::unique_ptr<Embree> embree) : _embree(std::move(embree)) {}
SurfaceDistance::~SurfaceDistance() = default;

} // namespace osgTerrainLight
