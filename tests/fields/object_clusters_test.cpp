#include "fields/ObjectClusters.h"

#include "fields/DistanceGrid.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <limits>
#include <random>

using namespace osgTerrainLight;

namespace
{

ObjectShape boxAt(const glm::dvec3& centre, const glm::dvec3& half, double turn = 0.0)
{
    ObjectShape shape;
    shape.size = half;
    shape.toScene = glm::rotate(glm::translate(glm::dmat4(1.0), centre), turn, {0.0, 0.0, 1.0});
    return shape;
}

/// Whatever the shapes: every one is in one cluster, whose volume holds it with its margin.
void expectWhole(const std::vector<ObjectCluster>& clusters, std::size_t shapes, int most)
{
    EXPECT_LE(int(clusters.size()), most);
    std::size_t count = 0;
    for (const ObjectCluster& cluster : clusters)
    {
        count += cluster.shapes.size();
        for (const ObjectShape& shape : cluster.shapes)
        {
            const ObjectBounds bounds = boundsOf(shape);
            for (int axis = 0; axis < 3; ++axis)
            {
                const double margin = cluster.voxel * ObjectCluster::margin;
                EXPECT_GE(bounds.low[axis] - margin, cluster.origin[axis]);
                EXPECT_LE(bounds.high[axis] + margin,
                          cluster.origin[axis] + cluster.voxel * cluster.voxels[axis]);
                EXPECT_LE(cluster.voxels[axis], ObjectCluster::maxVoxels);
                EXPECT_EQ(cluster.voxels[axis] % ObjectCluster::brick, 0);
            }
        }
    }
    EXPECT_EQ(count, shapes);
}

} // namespace

TEST(ObjectClusters, ObjectsNearOneAnotherShareAVolume)
{
    EXPECT_TRUE(clusterObjects({}, 0.25, 8).empty());
    const auto one =
        clusterObjects({boxAt({0, 0, 1}, {1, 1, 1}), boxAt({20, 5, 1}, {1, 1, 1})}, 0.25, 8);
    ASSERT_EQ(one.size(), 1u);
    EXPECT_EQ(one.front().voxel, 0.25);
    expectWhole(one, 2, 8);
    const auto two =
        clusterObjects({boxAt({0, 0, 1}, {1, 1, 1}), boxAt({200, 5, 1}, {1, 1, 1})}, 0.25, 8);
    ASSERT_EQ(two.size(), 2u);
    expectWhole(two, 2, 8);
}

TEST(ObjectClusters, ManyOrLargeOnesHaveLargerVoxels)
{
    std::mt19937 random(1);
    std::vector<ObjectShape> town;
    for (int i = 0; i < 300; ++i)
        town.push_back(boxAt({double(random() % 1000), double(random() % 1000), 3.0},
                             {4.0, 6.0, 3.0}, double(i)));
    const auto clusters = clusterObjects(town, 0.25, 8);
    expectWhole(clusters, town.size(), 8);
    // 1 km² in at most 8 volumes of 120 voxels: 8 (120 v)² ≥ 1000² asks for v ≥ 2.95 m.
    EXPECT_GE(clusters.front().voxel, 4.0);
    EXPECT_LE(clusters.front().voxel, 16.0);

    const auto tower = clusterObjects({boxAt({0, 0, 200}, {10, 10, 200})}, 0.25, 8);
    expectWhole(tower, 1, 8);
    EXPECT_EQ(tower.front().voxel, 4.0); // 400 m in 120 voxels
}

// A vehicle that drives through a village leaves the village's volume where it is.
TEST(ObjectClusters, VolumesStayWhileTheyHoldWhatIsInThem)
{
    std::vector<ObjectShape> shapes = {boxAt({1000000, 0, 2}, {3, 3, 2}),
                                       boxAt({1000022, 20, 2}, {3, 3, 2}),
                                       boxAt({1000010, 2, 1}, {2, 1, 1})};
    auto clusters = clusterObjects(shapes, 0.25, 8);
    ASSERT_EQ(clusters.size(), 1u);
    for (int step = 0; step < 40; ++step)
    {
        shapes[2] = boxAt({1000010, 2 + 0.4 * step, 1}, {2, 1, 1}, 0.05 * step);
        const auto next = clusterObjects(shapes, 0.25, 8, clusters);
        ASSERT_EQ(next.size(), 1u);
        EXPECT_TRUE(next.front().sameVolume(clusters.front())) << step;
        expectWhole(next, 3, 8);
        clusters = next;
    }
    // One that has left a volume for good lets it shrink.
    const auto alone = clusterObjects({shapes[0]}, 0.25, 8, clusters);
    EXPECT_LT(alone.front().voxels.x, clusters.front().voxels.x);
}

TEST(ObjectShapes, TheirScalesAreInTheirSizes)
{
    ObjectShape shape = boxAt({5, 6, 7}, {1, 2, 3}, 0.7);
    shape.toScene = shape.toScene * glm::scale(glm::dmat4(1.0), glm::dvec3(2, 3, 0.5));
    const RigidShape box = rigid(shape);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(box.size[axis], glm::dvec3(2, 6, 1.5)[axis], 1e-12);
    // Its corner, from the scene to metres about the shape.
    const glm::dvec4 corner = box.fromScene * (shape.toScene * glm::dvec4(1, 2, 3, 1));
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(corner[axis], box.size[axis], 1e-12);

    auto grid = std::make_shared<DistanceGrid>();
    grid->size = {3, 4, 5};
    grid->first = {-1.0f, 0.0f, 2.0f};
    grid->spacing = 0.5f;
    ObjectShape mesh;
    mesh.kind = ObjectShape::Kind::Mesh;
    mesh.grid = grid;
    mesh.toScene = glm::scale(glm::translate(glm::dmat4(1.0), {10.0, 0.0, 0.0}), {2.0, 3.0, 4.0});
    EXPECT_EQ(rigid(mesh).scale, 2.0) << "distances are never too large";
    const ObjectBounds bounds = boundsOf(mesh);
    EXPECT_EQ(bounds.low, glm::dvec3(8, 0, 8));
    EXPECT_EQ(bounds.high, glm::dvec3(10, 4.5, 16));
}

// What is not finite has no volume; it is kept away from here by the scene.
TEST(ObjectClusters, WithoutAPlaceThereIsNone)
{
    ObjectShape lost = boxAt({0, 0, 0}, {1, 1, 1});
    lost.toScene[3].x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(clusterObjects({lost}, 0.25, 8).empty());
}
