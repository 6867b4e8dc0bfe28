// Sky light around forms that are sampled anew in every frame, against rays that meet the same
// triangles; and what other ways to find distances from the same samples would give.
#include "fields/SampledForm.h"
#include "fields/SolidTriangles.h"
#include "fields/SurfaceDistance.h"
#include "reference/PathTracer.h"
#include "support/ConeLight.h"
#include "support/GlslForm.h"
#include "support/SampledBodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{

using G = Glsl<double, true>;
using Distance = std::function<double(const glm::dvec3&)>;

constexpr double voxel = 0.25;
constexpr double reach = 8.0 * voxel;

/// A body on level ground z = 0, or above it, about a place.
struct Body
{
    TriangleMesh mesh; ///< about its own origin
    glm::dvec3 place;
    std::shared_ptr<const SampledForm> form;
    std::function<bool(const glm::dvec3&)> isInside; ///< in its own frame
};

struct Method
{
    std::string name;
    Distance distance; ///< in the body's frame
};

double signedBy(const Body& body, const SurfaceDistance& surface, const glm::dvec3& own)
{
    const double size = surface.to(own, reach);
    return body.isInside(own) ? -size : size;
}

/// As object_volume.comp stores them.
Volume<double> volumeOf(const Distance& distance, const glm::dvec3& corner, const glm::ivec3& size)
{
    Volume<double> volume(size.x, size.y, size.z);
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x)
                volume.at(x, y, z) =
                    std::round(
                        127.0 *
                        std::clamp(distance(corner + voxel * (glm::dvec3(x, y, z) + 0.5)) / reach,
                                   -1.0, 1.0)) /
                    127.0;
    return volume;
}

/// Half on the ground around, half on the body's triangles, but for those that face down or lie
/// below the ground.
std::vector<Receiver> receiversOf(const Body& body, int count, unsigned seed)
{
    std::mt19937 random(seed);
    const auto between = [&](double a, double b)
    { return a + (b - a) * (double(random() >> 5) / double(1u << 27)); };
    const double around = 1.5 * std::max(body.form->high.x, body.form->high.y);
    std::vector<Receiver> receivers;
    while (int(receivers.size()) < count)
    {
        Receiver receiver;
        if (receivers.size() % 2 == 0)
        {
            receiver = {{body.place.x + between(-around, around),
                         body.place.y + between(-around, around), 1.0e-4},
                        {0, 0, 1}};
            if (body.isInside(receiver.place - body.place))
                continue;
        }
        else
        {
            const auto& triangle = body.mesh.triangles[random() % body.mesh.triangles.size()];
            const glm::dvec3 a(body.mesh.vertices[triangle[0]]), b(body.mesh.vertices[triangle[1]]),
                c(body.mesh.vertices[triangle[2]]);
            const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
            receiver = {body.place + (a + b + c) / 3.0 + 1.0e-4 * normal, normal};
            if (normal.z < -0.5 || receiver.place.z < 0.05)
                continue;
        }
        receivers.push_back(receiver);
    }
    return receivers;
}

std::vector<double> byRays(const Body& body, const std::vector<Receiver>& receivers)
{
    reference::SceneDescription description;
    description.tile = DemTile(33, 33, 2.0);
    for (int row = 0; row < 33; ++row)
        for (int column = 0; column < 33; ++column)
            description.tile.setHeight(column, row, 0.0f);
    for (const auto& corners : body.mesh.triangles)
    {
        reference::Triangle triangle;
        for (std::size_t i = 0; i < 3; ++i)
        {
            const glm::dvec3 corner = body.place + glm::dvec3(body.mesh.vertices[corners[i]]);
            triangle.corners[i] = {corner.x, corner.y, corner.z};
        }
        description.triangles.push_back(triangle);
    }
    const auto tracer = reference::PathTracer::build(std::move(description));
    EXPECT_TRUE(tracer.ok()) << (tracer ? "" : tracer.error().message);
    reference::Illumination illumination;
    illumination.light.sunEnabled = false;
    illumination.light.skyRadiance = {1.0f, 1.0f, 1.0f};
    std::vector<reference::Receiver> places;
    for (const Receiver& each : receivers)
    {
        reference::Receiver place;
        place.place = reference::FreePlace{{each.place.x, each.place.y, each.place.z},
                                           {each.normal.x, each.normal.y, each.normal.z}};
        places.push_back(place);
    }
    reference::PathTracerOptions options;
    options.samples = 4096;
    options.batches = 4;
    const auto light = tracer->trace(illumination, places, options);
    EXPECT_TRUE(light.ok());
    std::vector<double> found;
    for (const auto& each : *light)
        found.push_back(each.sky.mean[0]);
    return found;
}

/// Root mean squares: of light, in percent of open level ground's, and of distances within reach
/// [m]; by how much a distance is too large at most, and how far beyond the true surface a ray that
/// steps by the distances may first stop [m].
struct Errors
{
    double light = 0.0, distance = 0.0, beyond = 0.0;
    int places = 0, voxels = 0;
};

/// Adds those of a body to the methods'.
void measure(const Body& body, const std::vector<Method>& methods, std::vector<Errors>& errors,
             unsigned seed)
{
    const auto surface = SurfaceDistance::build(solidTriangles(body.mesh));
    ASSERT_TRUE(surface.ok());
    const auto truth = [&](const glm::dvec3& place)
    { return signedBy(body, **surface, place - body.place); };
    const glm::dvec3 low = body.place + body.form->centre + body.form->low;
    const glm::dvec3 high = body.place + body.form->centre + body.form->high;
    const glm::dvec3 corner = glm::floor((low - 1.0) / voxel) * voxel;
    const glm::ivec3 size(glm::ceil((high + 1.0 - corner) / voxel));
    const std::vector<Receiver> receivers = receiversOf(body, 80, seed);
    const std::vector<double> expected = byRays(body, receivers);
    G::DistanceField field;
    field.size = voxel * glm::dvec3(size);
    field.voxel = voxel;
    field.reach = reach;
    field.low = low - corner;
    field.high = high - corner;
    const ConeSet cones = ConeSet::of(16);
    for (std::size_t i = 0; i <= methods.size(); ++i)
    {
        const bool isTruth = i == methods.size();
        const Distance distance =
            isTruth ? Distance(truth)
                    : Distance([&](const glm::dvec3& place)
                               { return methods[i].distance(place - body.place); });
        const Volume<double> volume = volumeOf(distance, corner, size);
        for (std::size_t k = 0; k < receivers.size(); ++k)
        {
            Receiver own = receivers[k];
            own.place -= corner;
            const double error =
                skyByCones(volume, {field.size, field.voxel, field.reach, field.low, field.high},
                           own, cones) -
                expected[k];
            errors[i].light += error * error;
            ++errors[i].places;
        }
        if (isTruth)
            continue;
        for (int z = 0; z < size.z; z += 2)
            for (int y = 0; y < size.y; y += 2)
                for (int x = 0; x < size.x; x += 2)
                {
                    const glm::dvec3 place = corner + voxel * (glm::dvec3(x, y, z) + 0.5);
                    const double right = truth(place);
                    if (place.z < 0.0 || std::abs(right) >= reach)
                        continue;
                    const double error = std::clamp(distance(place), -reach, reach) - right;
                    errors[i].distance += error * error;
                    errors[i].beyond = std::max(errors[i].beyond, right > 0.0 ? error : -error);
                    ++errors[i].voxels;
                }
    }
}

std::vector<Errors> report(const std::string& what, const std::vector<Method>& methods,
                           std::vector<Errors> errors)
{
    for (std::size_t i = 0; i < errors.size(); ++i)
    {
        Errors& error = errors[i];
        error.light = 100.0 * std::sqrt(error.light / std::max(error.places, 1));
        error.distance = std::sqrt(error.distance / std::max(error.voxels, 1));
        if (i < methods.size())
            std::printf("%-28s %-22s light %5.2f %%, distance %.3f m, too large by up to %.2f m\n",
                        what.c_str(), methods[i].name.c_str(), error.light, error.distance,
                        error.beyond);
        else
            std::printf("%-28s %-22s light %5.2f %%\n", what.c_str(), "triangles", error.light);
    }
    return errors;
}

} // namespace

// Asked: what is asked of cones among boxes, 4 % of open level ground's light. The last row of each
// deformation has exact distances to the triangles: what cones err by anyhow.
TEST(FormLight, OfADeformingStar)
{
    for (const double amplitude : {0.0, 0.1, 0.25, 0.4, 0.6})
    {
        std::vector<Method> methods;
        std::vector<Errors> sums(3);
        for (const double phase : {0.0, 1.0, 2.0, 3.0})
        {
            const bodies::Blob blob{amplitude, phase};
            Body body;
            body.mesh = blob.mesh();
            body.place = {32.0, 32.0, 2.0};
            body.form = sampleStar(body.mesh);
            body.isInside = [&](const glm::dvec3& own)
            { return glm::length(own) < blob.radius(glm::normalize(own)); };
            const Raster<double> radii = inDouble(body.form->values);
            const G::SampledForm form = glslForm<G>(*body.form);
            const glm::dvec3 centre = body.form->centre;
            methods = {
                {"formula alone",
                 [&](const glm::dvec3& own)
                 {
                     // By the radius and its slope, central differences over a texel.
                     const glm::dvec3 p = own - centre;
                     const double away = glm::length(p);
                     const glm::dvec3 d = p / away;
                     const auto radius = [&](const glm::dvec3& v)
                     {
                         const glm::dvec2 at =
                             (G().octahedronPlace(v) + 1.0) * 0.5 * double(form.side) - 0.5;
                         const glm::dvec2 low = glm::floor(at), part = at - low;
                         const int x = int(low.x), y = int(low.y);
                         const auto length = [&](int i, int j)
                         { return glm::length(G().starPoint(radii, form, i, j)); };
                         return glm::mix(glm::mix(length(x, y), length(x + 1, y), part.x),
                                         glm::mix(length(x, y + 1), length(x + 1, y + 1), part.x),
                                         part.y);
                     };
                     const double step = 3.0 / form.side, r = radius(d);
                     const glm::dvec3 side = glm::normalize(glm::cross(
                         d, std::abs(d.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
                     const glm::dvec3 other = glm::cross(d, side);
                     const double u = (radius(glm::normalize(d + side * step)) -
                                       radius(glm::normalize(d - side * step))) /
                                      (2.0 * step * r);
                     const double v = (radius(glm::normalize(d + other * step)) -
                                       radius(glm::normalize(d - other * step))) /
                                      (2.0 * step * r);
                     return (away - r) /
                            std::sqrt(1.0 + (u * u + v * v) * std::exp(-std::max(away - r, 0.0) /
                                                                       (0.15 * form.range.x)));
                 }},
                {"starDistance()", [&](const glm::dvec3& own)
                 { return G().starDistance(radii, form, own - centre, reach); }}};
            measure(body, methods, sums, 7);
        }
        char what[64];
        std::snprintf(what, sizeof(what), "star, amplitude %.2f", amplitude);
        const std::vector<Errors> errors = report(what, methods, sums);
        EXPECT_LE(errors[1].light, 4.0) << what;
        EXPECT_LE(errors[1].distance, errors[0].distance + 1.0e-3) << what;
    }
}

namespace
{

/// With the way to where a height is known.
double beside(const glm::dvec3& p, const glm::dvec2& over, double distance)
{
    const double way = glm::distance(glm::dvec2(p), over);
    return way > 0.0 ? std::hypot(way, std::max(distance, 0.0)) : distance;
}

/// (z - h) / sqrt(1 + |grad h|^2), by central differences over a post.
double sloped(const Raster<double>& heights, const SampledForm& form, const glm::dvec3& p)
{
    const glm::dvec2 over = glm::clamp(glm::dvec2(p), glm::dvec2(form.low), glm::dvec2(form.high));
    const auto height = [&](double x, double y)
    {
        const glm::dvec2 at = glm::clamp((glm::dvec2(x, y) - form.first) / form.spacing,
                                         glm::dvec2(0.0), glm::dvec2(form.side - 1));
        const glm::ivec2 low = glm::min(glm::ivec2(at), glm::ivec2(form.side - 2));
        const glm::dvec2 part = at - glm::dvec2(low);
        const auto post = [&](int i, int j)
        { return std::max(heights.at(low.x + i, low.y + j), form.low.z); };
        return glm::mix(glm::mix(post(0, 0), post(1, 0), part.x),
                        glm::mix(post(0, 1), post(1, 1), part.x), part.y);
    };
    const glm::dvec2 step = form.spacing;
    const double u = (height(over.x + step.x, over.y) - height(over.x - step.x, over.y)) / step.x;
    const double v = (height(over.x, over.y + step.y) - height(over.x, over.y - step.y)) / step.y;
    return beside(p, over,
                  (p.z - height(over.x, over.y)) / std::sqrt(1.0 + 0.25 * (u * u + v * v)));
}

/// (z - mean) / sqrt(1 + variance / width^2), of heights blurred by a Gaussian.
double blurred(const Raster<double>& heights, const SampledForm& form, const glm::dvec3& p,
               double width)
{
    double weights = 0.0, sum = 0.0, squares = 0.0;
    const glm::dvec2 over = glm::clamp(glm::dvec2(p), glm::dvec2(form.low), glm::dvec2(form.high));
    // Within five widths: e^-12.5 is left of a weight there.
    const glm::dvec2 middle = (over - form.first) / form.spacing, wide = 5.0 * width / form.spacing;
    const glm::ivec2 from = glm::max(glm::ivec2(middle - wide), glm::ivec2(0));
    const glm::ivec2 to = glm::min(glm::ivec2(middle + wide) + 1, glm::ivec2(form.side - 1));
    for (int y = from.y; y <= to.y; ++y)
        for (int x = from.x; x <= to.x; ++x)
        {
            const glm::dvec2 away = form.first + form.spacing * glm::dvec2(x, y) - over;
            const double weight = std::exp(-glm::dot(away, away) / (2.0 * width * width));
            const double height = std::max(heights.at(x, y), form.low.z);
            weights += weight;
            sum += weight * height;
            squares += weight * height * height;
        }
    if (weights < 1.0e-30)
        return reach;
    const double mean = sum / weights, variance = std::max(squares / weights - mean * mean, 0.0);
    const double distance = (p.z - mean) / std::sqrt(1.0 + variance / (width * width));
    return beside(p, over, distance);
}

} // namespace

// Asked: as above. Forms are hills of noise in a round place, and rocks that float half a metre
// above the ground: two height fields back to back.
TEST(FormLight, OfHeightFields)
{
    for (const bool isRock : {false, true})
        for (const double height : {1.0, 2.0, 4.0})
        {
            std::vector<Method> methods;
            std::vector<Errors> sums(isRock ? 2 : 6);
            for (const double phase : {0.0, 1.0, 2.0, 3.0})
            {
                const bodies::Mound mound{height, phase, 4.0, isRock};
                Body body;
                body.mesh = mound.mesh();
                body.form =
                    sampleHeights(body.mesh, isRock ? HeightSurfaces::Both : HeightSurfaces::Upper);
                ASSERT_TRUE(body.form);
                const double lowest = body.form->centre.z + body.form->low.z;
                body.place = {32.0, 32.0, isRock ? 0.5 - lowest : 0.0};
                body.isInside = [&](const glm::dvec3& own)
                {
                    return std::hypot(own.x, own.y) < mound.size &&
                           own.z < mound.top(own.x, own.y) && own.z > mound.bottom(own.x, own.y);
                };
                const Raster<double> heights = inDouble(body.form->values);
                const G::SampledForm form = glslForm<G>(*body.form);
                const glm::dvec3 centre = body.form->centre;
                const auto by = [&](double width)
                {
                    return [&, width](const glm::dvec3& own)
                    { return blurred(heights, *body.form, own - centre, width); };
                };
                methods.clear();
                if (!isRock)
                    methods = {{"slope", [&](const glm::dvec3& own)
                                { return sloped(heights, *body.form, own - centre); }},
                               {"variance, width 0.25 m", by(0.25)},
                               {"variance, width 0.5 m", by(0.5)},
                               {"variance, width 1 m", by(1.0)}};
                methods.push_back({"columnsDistance()", [&](const glm::dvec3& own) {
                                       return G().columnsDistance(heights, form, own - centre,
                                                                  reach);
                                   }});
                measure(body, methods, sums, 9);
            }
            char what[64];
            std::snprintf(what, sizeof(what), "%s, %.0f m high", isRock ? "two" : "one", height);
            const std::vector<Errors> errors = report(what, methods, sums);
            const std::size_t own = methods.size() - 1;
            EXPECT_LE(errors[own].light, 4.0) << what;
            for (std::size_t i = 0; i < own; ++i)
                EXPECT_LE(errors[own].distance, errors[i].distance) << what;
        }
}
