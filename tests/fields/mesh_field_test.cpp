#include "fields/MeshField.h"

#include "fields/Signs.h"
#include "support/TestMeshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;

BakedField bake(const TriangleMesh& mesh, int cells = 32)
{
    BakeOptions options;
    options.cells = cells;
    const Result<BakedField> field = bakeMesh(mesh, options);
    EXPECT_TRUE(field) << field.error().message;
    return field ? *field : BakedField{};
}

/// A grid holds a float: half a unit in the last place of the largest distance, in voxels.
double rounding(const DistanceGrid& grid)
{
    float greatest = 0.0f;
    for (const float distance : grid.distances)
        greatest = std::max(greatest, std::abs(distance));
    return double(greatest / grid.spacing) * 0x1p-24;
}

/// The distance by all triangles, signed by the union of the parts that the mesh was made of.
auto truthOf(const TestMesh& whole)
{
    return [&whole](const glm::dvec3& point)
    {
        const double distance = bruteDistance(whole.mesh, point);
        return whole.isInside(point) ? -distance : distance;
    };
}

void print(const char* name, const FieldErrors& errors, const BakedField& field)
{
    std::printf("  %-28s RMS %.2e, greatest %.2e, interpolated %.3f voxels; wrong signs %.3f %%, "
                "ambiguous %.1f %%\n",
                name, errors.voxels, errors.greatest, errors.interpolated,
                100.0 * errors.wrongSigns, 100.0 * field.ambiguousShare);
}

/// The mesh with a share of its triangles, at random, turned or left out.
TriangleMesh damaged(const TriangleMesh& mesh, double turned, double leftOut)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    TriangleMesh result;
    result.vertices = mesh.vertices;
    for (auto triangle : mesh.triangles)
    {
        if (share(random) < leftOut)
            continue;
        if (share(random) < turned)
            std::swap(triangle[1], triangle[2]);
        result.triangles.push_back(triangle);
    }
    return result;
}

/// The share of centres that are in the box of a mesh and outside of the mesh.
double wrongOfBox(const TestMesh& whole, const DistanceGrid& grid)
{
    glm::vec3 low = whole.mesh.vertices[0], high = low;
    for (const glm::vec3& vertex : whole.mesh.vertices)
    {
        low = glm::min(low, vertex);
        high = glm::max(high, vertex);
    }
    double wrong = 0.0;
    for (int z = 0; z < grid.size.z; ++z)
        for (int y = 0; y < grid.size.y; ++y)
            for (int x = 0; x < grid.size.x; ++x)
            {
                const glm::dvec3 p = grid.centre(x, y, z);
                const bool isInBox = glm::all(glm::greaterThan(p, glm::dvec3(low))) &&
                                     glm::all(glm::lessThan(p, glm::dvec3(high)));
                wrong += isInBox && !whole.isInside(p) ? 1.0 : 0.0;
            }
    return wrong / double(grid.distances.size());
}

/// The mesh with every triangle cut into 4, some times.
TriangleMesh refined(TriangleMesh mesh, int times)
{
    for (int i = 0; i < times; ++i)
    {
        TriangleMesh finer;
        for (const auto& [a, b, c] : mesh.triangles)
        {
            const glm::vec3 p = mesh.vertices[a], q = mesh.vertices[b], r = mesh.vertices[c];
            const auto n = static_cast<std::uint32_t>(finer.vertices.size());
            finer.vertices.insert(finer.vertices.end(),
                                  {p, q, r, 0.5f * (p + q), 0.5f * (q + r), 0.5f * (r + p)});
            finer.triangles.insert(finer.triangles.end(), {{n, n + 3, n + 5},
                                                           {n + 3, n + 1, n + 4},
                                                           {n + 5, n + 4, n + 2},
                                                           {n + 3, n + 4, n + 5}});
        }
        mesh = finer;
    }
    return mesh;
}
} // namespace

// Expected: the sphere's distance. The mesh lies between the sphere and the nearest plane of a
// triangle, so its distance differs by at most that.
TEST(MeshField, SphereWithinItsTessellation)
{
    const TriangleMesh mesh = makeSphere(2.0, 5);
    const BakedField field = bake(mesh);
    const auto truth = [](const glm::dvec3& p) { return glm::length(p) - 2.0; };
    const FieldErrors errors = compareField(field.grid, truth);
    print("sphere, 20480 triangles", errors, field);
    const double tessellation = (2.0 - leastPlaneDistance(mesh)) / double(field.grid.spacing);
    EXPECT_LE(errors.greatest, tessellation + rounding(field.grid));
    EXPECT_EQ(errors.wrongSigns, 0.0);
    EXPECT_EQ(field.ambiguousShare, 0.0);
    EXPECT_LT(errors.interpolated, 0.5);
}

// Expected: the torus's distance. Its quads are planar: a circle of chords, swept along chords, so
// the mesh is off by at most the heights of both arcs.
TEST(MeshField, TorusWithinItsTessellation)
{
    const BakedField field = bake(makeTorus(3.0, 1.0, 128, 64));
    const auto truth = [](const glm::dvec3& p)
    { return std::hypot(std::hypot(p.x, p.y) - 3.0, p.z) - 1.0; };
    const FieldErrors errors = compareField(field.grid, truth);
    print("torus, 16384 triangles", errors, field);
    const double heights = 4.0 * (1.0 - std::cos(pi / 128)) + 1.0 * (1.0 - std::cos(pi / 64));
    EXPECT_LE(errors.greatest, heights / double(field.grid.spacing) + rounding(field.grid));
    EXPECT_LE(errors.wrongSigns, 0.001);
    EXPECT_EQ(field.ambiguousShare, 0.0);
    EXPECT_LT(errors.interpolated, 0.5);
}

// Expected: the closed form of a box, exactly: to the float that the grid holds.
TEST(MeshField, BoxIsExact)
{
    TestMesh box;
    box.addBox({-1.0, 2.0, 10.0}, {3.0, 5.0, 11.0});
    const BakedField field = bake(box.mesh);
    const auto truth = [](const glm::dvec3& p)
    {
        const glm::dvec3 q = glm::abs(p - glm::dvec3(1.0, 3.5, 10.5)) - glm::dvec3(2.0, 1.5, 0.5);
        return glm::length(glm::max(q, 0.0)) + std::min(std::max({q.x, q.y, q.z}), 0.0);
    };
    const FieldErrors errors = compareField(field.grid, truth);
    print("box", errors, field);
    EXPECT_LE(errors.greatest, rounding(field.grid));
    EXPECT_EQ(errors.wrongSigns, 0.0);
    EXPECT_EQ(field.ambiguousShare, 0.0);
    EXPECT_LT(errors.interpolated, 0.5);
    // A margin of 4 voxels around 32 × 24 × 8.
    EXPECT_EQ(field.grid.size, glm::ivec3(40, 32, 16));
    EXPECT_EQ(field.grid.spacing, 0.125f);
}

// Expected: the distance by all triangles and the sign of the union of convex parts. Signs of
// closed parts are right however they overlap; 0.1 % is what placed objects need.
TEST(MeshField, OverlappingPartsAreOneSolid)
{
    for (const bool isHouse : {true, false})
    {
        const TestMesh whole = isHouse ? makeHouse() : makeTree(24);
        const BakedField field = bake(whole.mesh);
        const FieldErrors errors = compareField(field.grid, truthOf(whole));
        print(isHouse ? "house" : "tree", errors, field);
        EXPECT_LE(errors.wrongSigns, 0.001);
        EXPECT_LE(errors.voxels, 0.5);
        EXPECT_LE(errors.interpolated, 0.5);
        EXPECT_TRUE(field.isWellSigned());
    }
}

// Expected: the field of the whole, up to half a voxel where the floor is not there; 1 % of wrong
// signs is what placed objects need, since their bottom stands on the ground.
TEST(MeshField, OpenBottom)
{
    for (const bool isHouse : {true, false})
    {
        const TestMesh whole = isHouse ? makeHouse() : makeTree(24);
        const TriangleMesh open = withoutBottom(whole.mesh);
        const BakedField field = bake(open);
        const FieldErrors errors = compareField(field.grid, truthOf(whole));
        print(isHouse ? "house, open below" : "tree, open below", errors, field);
        EXPECT_LE(errors.wrongSigns, 0.01);
        EXPECT_LE(errors.voxels, 0.5);
        EXPECT_LE(errors.interpolated, 0.5);
        EXPECT_TRUE(field.isWellSigned());
    }
}

// Expected: the field of the whole. With some triangles missing as good as with an open bottom;
// with a fifth turned still better than the mesh's box, which a caller takes where there is no
// field.
TEST(MeshField, DamagedMeshes)
{
    for (const bool isHouse : {true, false})
        for (const bool isTurned : {false, true})
        {
            TestMesh whole = isHouse ? makeHouse() : makeTree(24);
            const TriangleMesh fine = refined(whole.mesh, 2);
            const TriangleMesh mesh = damaged(fine, isTurned ? 0.2 : 0.0, isTurned ? 0.0 : 0.02);
            const BakedField field = bake(mesh);
            const FieldErrors errors = compareField(field.grid, truthOf(whole), 7);
            char name[64];
            std::snprintf(name, sizeof name, "%s, %s", isHouse ? "house" : "tree",
                          isTurned ? "20 % turned" : "2 % missing");
            print(name, errors, field);
            EXPECT_LE(errors.wrongSigns, isTurned ? wrongOfBox(whole, field.grid) : 0.01);
            EXPECT_EQ(field.isWellSigned(), !isTurned);
        }
}

// Expected: the sign of every voxel's own winding number, within the mesh's box.
TEST(MeshField, FillIsEveryVoxelsWindingNumber)
{
    const TriangleMesh house = makeHouse().mesh, fine = refined(house, 2);
    for (const TriangleMesh& mesh : {house, withoutBottom(house), damaged(fine, 0.0, 0.02),
                                     damaged(fine, 0.2, 0.0), makeTree(12).mesh})
    {
        DistanceGrid grid = bake(mesh).grid;
        const std::vector<TriangleCorners> triangles = solidTriangles(mesh);
        const WindingNumber winding(triangles);
        glm::dvec3 low = triangles[0][0], high = low;
        for (const TriangleCorners& triangle : triangles)
            for (const glm::dvec3& corner : triangle)
            {
                low = glm::min(low, corner);
                high = glm::max(high, corner);
            }
        for (float& distance : grid.distances)
            distance = std::abs(distance);
        const auto report = giveSigns(grid, winding, low, high, {});
        ASSERT_TRUE(report);
        int different = 0, within = 0;
        for (int z = 0; z < grid.size.z; ++z)
            for (int y = 0; y < grid.size.y; ++y)
                for (int x = 0; x < grid.size.x; ++x)
                {
                    const glm::dvec3 p = grid.centre(x, y, z);
                    if (glm::any(glm::lessThan(p, low)) || glm::any(glm::greaterThan(p, high)))
                        continue;
                    ++within;
                    const bool isInside = std::abs(winding.at(p)) > 0.5;
                    different += isInside != (grid.at(x, y, z) < 0.0f) && grid.at(x, y, z) != 0.0f;
                }
        EXPECT_EQ(different, 0);
        std::printf("  %4zu triangles: winding numbers of %zu of %d voxels within the box\n",
                    triangles.size(), report->windingNumbers, within);
    }
}

// Expected: positive everywhere, and the distance by all triangles: a sheet has no inside.
TEST(MeshField, SheetsArePositiveAllAround)
{
    TriangleMesh quad;
    quad.vertices = {{0, 0, 0}, {4, 0, 1}, {4, 3, 1}, {0, 3, 0}};
    quad.triangles = {{0, 1, 2}, {0, 2, 3}};
    TriangleMesh twice = quad; // and the same again, from both sides
    twice.triangles.insert(twice.triangles.end(), {{0, 1, 2}, {1, 2, 0}, {2, 1, 0}, {3, 2, 0}});
    for (const TriangleMesh& mesh : {quad, twice})
    {
        const BakedField field = bake(mesh);
        const FieldErrors errors =
            compareField(field.grid, [&](const glm::dvec3& p) { return bruteDistance(quad, p); });
        EXPECT_EQ(errors.wrongSigns, 0.0);
        EXPECT_LE(errors.greatest, rounding(field.grid));
    }
    EXPECT_FALSE(bake(quad).isWellSigned());
    EXPECT_TRUE(bake(twice).isWellSigned());
}

// Expected: the same bits. Corners stored once per triangle, triangles without area, a vertex that
// nothing uses, and triangles that are stored twice change nothing.
TEST(MeshField, DegeneratePartsDoNoHarm)
{
    const TriangleMesh clean = makeHouse().mesh;
    TriangleMesh mesh;
    for (const auto& triangle : clean.triangles)
        for (const int copies : {0, 1})
        {
            const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
            for (const std::uint32_t corner : triangle)
                mesh.vertices.push_back(clean.vertices[corner]);
            mesh.triangles.push_back({n, n + 1, n + 2});
            if (copies == 1)
                mesh.triangles.push_back({n, n + 1, n + 1});
        }
    const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {{50, 0, 0}, {51, 1, 1}, {52, 2, 2}});
    mesh.triangles.push_back({n, n + 1, n + 2}); // three points of a line
    EXPECT_EQ(bake(mesh).grid.distances, bake(clean).grid.distances);
}

// Expected: the same field as of the mesh that faces outwards, as a mirrored placement makes it.
TEST(MeshField, MirroredPartsAreSolid)
{
    const TriangleMesh mesh = makeHouse().mesh;
    EXPECT_EQ(bake(damaged(mesh, 1.0, 0.0)).grid.distances, bake(mesh).grid.distances);
}

TEST(MeshField, RefusesWhatHasNoField)
{
    const auto code = [](const TriangleMesh& mesh, const BakeOptions& options = {})
    {
        const Result<BakedField> field = bakeMesh(mesh, options);
        return field ? std::string("a field") : field.error().message;
    };
    TriangleMesh mesh = makeHouse().mesh;
    EXPECT_NE(code({}).find("no triangles"), std::string::npos);
    BakeOptions options;
    options.cells = 3;
    EXPECT_NE(code(mesh, options).find("cells is 3, must be within 4"), std::string::npos);
    mesh.triangles.push_back({0, 1, 1000});
    EXPECT_NE(code(mesh).find("vertex 1000"), std::string::npos);
    mesh.triangles = {{0, 1, 1}};
    EXPECT_NE(code(mesh).find("has an area"), std::string::npos);
    mesh.vertices[0].y = std::nanf("");
    EXPECT_NE(code(mesh).find("vertex 0"), std::string::npos);
}

// Expected: shares that rise to 1, and no field where one of them is answered with no.
TEST(MeshField, CanBeFollowedAndGivenUp)
{
    const TriangleMesh mesh = makeTree(12).mesh;
    BakeOptions options;
    options.cells = 16;
    double last = 0.0;
    options.progress = [&](double share)
    {
        EXPECT_GE(share, last);
        EXPECT_LE(share, 1.0);
        last = share;
        return true;
    };
    EXPECT_TRUE(bakeMesh(mesh, options));
    EXPECT_GT(last, 0.5);
    options.progress = [](double) { return false; };
    const Result<BakedField> field = bakeMesh(mesh, options);
    ASSERT_FALSE(field);
    EXPECT_NE(field.error().message.find("given up"), std::string::npos);
}

// Not a check: the time of fields, for docs/methods/object_fields.md.
TEST(MeshField, DISABLED_Times)
{
    const TestMesh tree = makeTree(62), large = makeTree(40);
    for (const auto& [name, mesh] :
         {std::pair("tree", tree.mesh), std::pair("tree, fine", refined(large.mesh, 3)),
          std::pair("tree, fine, open below", withoutBottom(refined(large.mesh, 3)))})
        for (const int cells : {32, 64})
        {
            const auto start = std::chrono::steady_clock::now();
            const BakedField field = bake(mesh, cells);
            const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
            std::printf("  %-24s %6zu triangles, %d cells: %.2f s\n", name, mesh.triangles.size(),
                        cells, time.count());
        }
}

// Floats beyond 4 000 km step by half a metre.
TEST(MeshField, FarFromItsOriginIsRefused)
{
    TriangleMesh sphere = makeSphere(2.0, 3);
    for (glm::vec3& vertex : sphere.vertices)
        vertex.y += 4649776.0f;
    const Result<BakedField> field = bakeMesh(sphere);
    ASSERT_FALSE(field);
    EXPECT_NE(field.error().message.find("from the origin"), std::string::npos)
        << field.error().message;
}
