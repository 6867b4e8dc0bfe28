#include "fields/DistanceGrid.h"
#include "fields/WindingNumber.h"
#include "support/TestMeshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

using namespace osgTerrainLight;

namespace
{
/// A grid of 3 × 4 × 5 voxels of a function.
template <class Function>
DistanceGrid gridOf(Function function)
{
    DistanceGrid grid;
    grid.size = {3, 4, 5};
    grid.first = {1.0f, -2.0f, 10.0f};
    grid.spacing = 0.5f;
    for (int z = 0; z < 5; ++z)
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 3; ++x)
                grid.distances.push_back(static_cast<float>(function(grid.centre(x, y, z))));
    return grid;
}
} // namespace

// Expected: x is fastest, then y, then z, and a trilinear function comes back. Its values are
// multiples of 1/8, which a float holds.
TEST(DistanceGrid, TrilinearFunctionsAreExact)
{
    const auto function = [](const glm::dvec3& p)
    { return 3.0 * p.x - 2.0 * p.y + p.z + p.x * p.y * p.z - p.x * p.z; };
    const DistanceGrid grid = gridOf(function);
    EXPECT_EQ(double(grid.at(2, 1, 3)), function({2.0, -1.5, 11.5}));
    std::mt19937 random(3);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    for (int i = 0; i < 100; ++i)
    {
        const glm::dvec3 p(1.0 + share(random), -2.0 + 1.5 * share(random),
                           10.0 + 2.0 * share(random));
        EXPECT_NEAR(grid.distanceAt(p), function(p), 1e-13); // some 20 operations on 30, in double
    }
}

// Expected: the nearest place between the outermost centres.
TEST(DistanceGrid, ClampsBeyondItsCentres)
{
    const DistanceGrid grid = gridOf([](const glm::dvec3& p) { return p.x + p.y + p.z; });
    EXPECT_EQ(grid.distanceAt({-9.0, -1.75, 10.5}), 1.0 - 1.75 + 10.5);
    EXPECT_EQ(grid.distanceAt({1.5, 9.0, 99.0}), 1.5 - 0.5 + 12.0);
    DistanceGrid one;
    one.size = {1, 1, 1};
    one.distances = {4.0f};
    EXPECT_EQ(one.distanceAt({0.3, -5.0, 7.0}), 4.0);
}

// Expected: the sum over all triangles, to a tenth of the 0.5 that would change a sign next to a
// closed part, and a quarter of the 0.2 that would call it ambiguous.
TEST(WindingNumber, GroupsAgreeWithAllTriangles)
{
    for (const TriangleMesh& mesh :
         {makeSphere(3.0, 3), makeTree(40).mesh, withoutBottom(makeTree(40).mesh)})
    {
        const std::vector<TriangleCorners> triangles = solidTriangles(mesh);
        const WindingNumber winding(triangles);
        std::mt19937 random(5);
        std::uniform_real_distribution<double> place(-4.0, 4.0);
        double squares = 0.0, most = 0.0;
        constexpr int points = 2000;
        for (int i = 0; i < points; ++i)
        {
            const glm::dvec3 p(place(random), place(random), place(random) + 4.0);
            const double error = std::abs(winding.at(p) - winding.exactlyAt(p));
            squares += error * error;
            most = std::max(most, error);
        }
        std::printf("  %zu triangles: RMS %.1e, greatest %.1e\n", triangles.size(),
                    std::sqrt(squares / points), most);
        EXPECT_LE(most, 0.05);
    }
}

// Expected: how many parts a point is in, with the exact sum.
TEST(WindingNumber, CountsOverlappingParts)
{
    TestMesh boxes;
    boxes.addBox({0, 0, 0}, {2, 2, 2});
    boxes.addBox({1, 0, 0}, {3, 2, 2});
    const WindingNumber winding(solidTriangles(boxes.mesh));
    EXPECT_NEAR(winding.exactlyAt({0.5, 1.1, 1.2}), 1.0, 1e-12);
    EXPECT_NEAR(winding.exactlyAt({1.5, 1.1, 1.2}), 2.0, 1e-12);
    EXPECT_NEAR(winding.exactlyAt({3.5, 1.1, 1.2}), 0.0, 1e-12);
}
