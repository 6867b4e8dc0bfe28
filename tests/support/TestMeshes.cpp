#include "support/TestMeshes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

namespace osgTerrainLight
{

namespace
{
constexpr double pi = 3.14159265358979323846;

double distanceToEdge(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& p)
{
    const glm::dvec3 edge = b - a;
    const double along = std::clamp(glm::dot(p - a, edge) / glm::dot(edge, edge), 0.0, 1.0);
    return glm::distance(p, a + along * edge);
}

double distanceToTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                          const glm::dvec3& p)
{
    const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
    const auto isLeftOf = [&](const glm::dvec3& from, const glm::dvec3& to)
    { return glm::dot(glm::cross(normal, to - from), p - from) >= 0.0; };
    if (isLeftOf(a, b) && isLeftOf(b, c) && isLeftOf(c, a))
        return std::abs(glm::dot(normal, p - a));
    return std::min({distanceToEdge(a, b, p), distanceToEdge(b, c, p), distanceToEdge(c, a, p)});
}
} // namespace

bool TestMesh::isInside(const glm::dvec3& point) const
{
    return std::any_of(parts.begin(), parts.end(),
                       [&](const std::vector<Plane>& planes)
                       {
                           return std::all_of(
                               planes.begin(), planes.end(),
                               [&](const Plane& plane)
                               { return glm::dot(plane.normal, point) < plane.offset; });
                       });
}

void TestMesh::addConvex(const std::vector<glm::dvec3>& corners,
                         const std::vector<std::vector<int>>& faces)
{
    glm::dvec3 middle(0.0);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const glm::dvec3& corner : corners)
    {
        mesh.vertices.emplace_back(corner);
        middle += corner / double(corners.size());
    }
    const auto corner = [&](int i)
    { return glm::dvec3(mesh.vertices[first + static_cast<std::uint32_t>(i)]); };
    std::vector<Plane> planes;
    for (const std::vector<int>& face : faces)
    {
        glm::dvec3 normal = glm::normalize(
            glm::cross(corner(face[1]) - corner(face[0]), corner(face[2]) - corner(face[0])));
        const bool isReversed = glm::dot(normal, corner(face[0]) - middle) < 0.0;
        if (isReversed)
            normal = -normal;
        planes.push_back({normal, glm::dot(normal, corner(face[0]))});
        for (std::size_t i = 1; i + 1 < face.size(); ++i)
        {
            const std::uint32_t a = first + static_cast<std::uint32_t>(face[0]);
            const std::uint32_t b = first + static_cast<std::uint32_t>(face[i]);
            const std::uint32_t c = first + static_cast<std::uint32_t>(face[i + 1]);
            mesh.triangles.push_back({a, isReversed ? c : b, isReversed ? b : c});
        }
    }
    parts.push_back(planes);
}

void TestMesh::addBox(const glm::dvec3& low, const glm::dvec3& high)
{
    std::vector<glm::dvec3> corners;
    for (int i = 0; i < 8; ++i)
        corners.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y,
                             i & 4 ? high.z : low.z);
    addConvex(corners,
              {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}});
}

void TestMesh::addFrustum(const glm::dvec3& base, double height, double radius, double topRadius,
                          int sides)
{
    std::vector<glm::dvec3> corners;
    std::vector<std::vector<int>> faces(1);
    for (int i = 0; i < sides; ++i)
    {
        const double turn = 2.0 * pi * i / sides;
        corners.push_back(base + radius * glm::dvec3(std::cos(turn), std::sin(turn), 0.0));
        faces[0].push_back(i);
    }
    const glm::dvec3 up(0.0, 0.0, height);
    if (topRadius == 0.0)
    {
        corners.push_back(base + up);
        for (int i = 0; i < sides; ++i)
            faces.push_back({i, (i + 1) % sides, sides});
    }
    else
    {
        std::vector<int> top;
        for (int i = 0; i < sides; ++i)
        {
            corners.push_back(base + up +
                              (corners[static_cast<std::size_t>(i)] - base) * (topRadius / radius));
            top.push_back(sides + i);
            const int next = (i + 1) % sides;
            faces.push_back({i, next, sides + next, sides + i});
        }
        faces.push_back(top);
    }
    addConvex(corners, faces);
}

TestMesh makeHouse()
{
    TestMesh house;
    house.addBox({-5.0, -3.5, 0.0}, {5.0, 3.5, 4.2});
    house.addBox({3.0, -2.0, 0.0}, {7.0, 1.5, 2.6});  // annexe, overlapping
    house.addBox({-3.2, 0.8, 3.0}, {-2.4, 1.6, 7.9}); // chimney, through the roof
    // The roof: a prism with its lower face 0.2 m below the walls' top and eaves of 0.7 m.
    house.addConvex({{-5.6, -4.2, 4.0},
                     {-5.6, 4.2, 4.0},
                     {-5.6, 0.0, 7.0},
                     {5.6, -4.2, 4.0},
                     {5.6, 4.2, 4.0},
                     {5.6, 0.0, 7.0}},
                    {{0, 1, 2}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {0, 2, 5, 3}});
    return house;
}

TestMesh makeTree(int sides)
{
    TestMesh tree;
    tree.addFrustum({0.1, -0.2, 0.0}, 4.0, 0.35, 0.25, sides);
    tree.addFrustum({0.1, -0.2, 1.8}, 3.0, 2.4, 0.0, sides);
    tree.addFrustum({0.0, -0.2, 3.3}, 2.8, 1.9, 0.0, sides);
    tree.addFrustum({0.15, -0.1, 4.9}, 3.1, 1.4, 0.0, sides);
    return tree;
}

TriangleMesh withoutBottom(const TriangleMesh& mesh)
{
    TriangleMesh result = mesh;
    auto& all = result.triangles;
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const std::array<std::uint32_t, 3>& corners)
                             {
                                 return std::all_of(corners.begin(), corners.end(),
                                                    [&](std::uint32_t i)
                                                    { return mesh.vertices[i].z == 0.0f; });
                             }),
              all.end());
    return result;
}

TriangleMesh makeSphere(double radius, int subdivisions)
{
    const double golden = (1.0 + std::sqrt(5.0)) / 2.0;
    std::vector<glm::dvec3> corners;
    for (const double one : {-1.0, 1.0})
        for (const double other : {-golden, golden})
        {
            corners.emplace_back(0.0, one, other);
            corners.emplace_back(one, other, 0.0);
            corners.emplace_back(other, 0.0, one);
        }
    std::vector<std::array<std::uint32_t, 3>> triangles;
    const auto areNear = [&](std::uint32_t a, std::uint32_t b)
    { return glm::distance(corners[a], corners[b]) < 2.1; }; // edges are 2 long
    for (std::uint32_t a = 0; a < 12; ++a)
        for (std::uint32_t b = a + 1; b < 12; ++b)
            for (std::uint32_t c = b + 1; c < 12; ++c)
                if (areNear(a, b) && areNear(b, c) && areNear(c, a))
                {
                    const double volume = glm::dot(corners[a], glm::cross(corners[b], corners[c]));
                    triangles.push_back({a, volume > 0.0 ? b : c, volume > 0.0 ? c : b});
                }
    for (int i = 0; i < subdivisions; ++i)
    {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b)
        {
            const auto [at, isNew] = middles.insert(
                {{std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(corners.size())});
            if (isNew)
                corners.push_back(glm::normalize(corners[a] + corners[b]) *
                                  glm::length(corners[0]));
            return at->second;
        };
        std::vector<std::array<std::uint32_t, 3>> finer;
        for (const auto& [a, b, c] : triangles)
        {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        triangles = finer;
    }
    TriangleMesh mesh;
    for (const glm::dvec3& corner : corners)
        mesh.vertices.emplace_back(glm::normalize(corner) * radius);
    mesh.triangles = triangles;
    return mesh;
}

double leastPlaneDistance(const TriangleMesh& mesh)
{
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : mesh.triangles)
    {
        const glm::dvec3 corner(mesh.vertices[a]);
        const glm::dvec3 normal = glm::cross(glm::dvec3(mesh.vertices[b]) - corner,
                                             glm::dvec3(mesh.vertices[c]) - corner);
        least = std::min(least, glm::dot(glm::normalize(normal), corner));
    }
    return least;
}

TriangleMesh makeTorus(double majorRadius, double minorRadius, int around, int across)
{
    TriangleMesh mesh;
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j)
        {
            const double u = 2.0 * pi * i / around, v = 2.0 * pi * j / across;
            const double r = majorRadius + minorRadius * std::cos(v);
            mesh.vertices.emplace_back(r * std::cos(u), r * std::sin(u), minorRadius * std::sin(v));
        }
    const auto index = [&](int i, int j)
    { return static_cast<std::uint32_t>((i % around) * across + j % across); };
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j)
        {
            mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
            mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
        }
    return mesh;
}

double bruteDistance(const TriangleMesh& mesh, const glm::dvec3& point)
{
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : mesh.triangles)
        least = std::min(least, distanceToTriangle(glm::dvec3(mesh.vertices[a]),
                                                   glm::dvec3(mesh.vertices[b]),
                                                   glm::dvec3(mesh.vertices[c]), point));
    return least;
}

FieldErrors compareField(const DistanceGrid& grid,
                         const std::function<double(const glm::dvec3&)>& truth, int stride)
{
    FieldErrors errors;
    double count = 0.0, squares = 0.0, between = 0.0, wrong = 0.0;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    const glm::dvec3 end = grid.centre(grid.size.x - 1, grid.size.y - 1, grid.size.z - 1);
    int index = 0;
    for (int z = 0; z < grid.size.z; ++z)
        for (int y = 0; y < grid.size.y; ++y)
            for (int x = 0; x < grid.size.x; ++x)
            {
                if (index++ % stride != 0)
                    continue;
                const double found = double(grid.at(x, y, z));
                const double expected = truth(grid.centre(x, y, z));
                const double error = std::abs(found - expected) / double(grid.spacing);
                count += 1.0;
                squares += error * error;
                errors.greatest = std::max(errors.greatest, error);
                // On the surface, to rounding, either sign is right.
                if (std::abs(expected) > 1e-5 * double(grid.spacing) &&
                    (found < 0.0) != (expected < 0.0))
                    wrong += 1.0;
                const glm::dvec3 point =
                    glm::mix(glm::dvec3(grid.first), end,
                             glm::dvec3(share(random), share(random), share(random)));
                const double off = (grid.distanceAt(point) - truth(point)) / double(grid.spacing);
                between += off * off;
            }
    errors.voxels = std::sqrt(squares / count);
    errors.interpolated = std::sqrt(between / count);
    errors.wrongSigns = wrong / count;
    return errors;
}

} // namespace osgTerrainLight
