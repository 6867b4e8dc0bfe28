#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace osgTerrainLight;

namespace
{

template <class Real>
class AmbientCube : public testing::Test
{
};
TYPED_TEST_SUITE(AmbientCube, Precisions);

constexpr int voxels = 4;

template <class Real>
typename CheckedGlsl<Real>::AmbientCubes cubesOf(double width)
{
    typename CheckedGlsl<Real>::AmbientCubes cubes;
    cubes.size = glm::vec<3, Real>(Real(width));
    cubes.slabVoxels = Real(voxels);
    return cubes;
}

} // namespace

// Sums of three squares and of six products of trilinear weights round about 16 times.
TYPED_TEST(AmbientCube, OpenIsOneWhateverTheNormal)
{
    CheckedGlsl<TypeParam> glsl;
    using vec3 = glm::vec<3, TypeParam>;
    const Volume<TypeParam> volume(voxels, voxels, 6 * voxels, TypeParam(1));
    std::mt19937 random(1);
    std::normal_distribution<double> coordinate;
    for (int i = 0; i < 100; ++i)
    {
        const glm::dvec3 normal =
            glm::normalize(glm::dvec3(coordinate(random), coordinate(random), coordinate(random)));
        const glm::dvec3 place(2.0 + coordinate(random), 2.0 + coordinate(random), -3.0 + i * 0.1);
        EXPECT_NEAR(
            double(glsl.ambientCubeLight(volume, cubesOf<TypeParam>(4.0), vec3(place), vec3(normal))
                       .x),
            1.0, 16.0 * roundoff<TypeParam>);
    }
    EXPECT_EQ(
        glsl.ambientCubeLight(volume, cubesOf<TypeParam>(4.0), vec3(2, 2, 2), vec3(0, 0, 1)).x,
        TypeParam(1));
}

// Each axis has the slab of its own, at the lowest and highest place too: a slab does not read the
// next one. Between two axes it is the mean by squared cosines.
TYPED_TEST(AmbientCube, FacesTheLobesOfItsNormal)
{
    CheckedGlsl<TypeParam> glsl;
    using vec3 = glm::vec<3, TypeParam>;
    Volume<TypeParam> volume(voxels, voxels, 6 * voxels);
    for (int lobe = 0; lobe < 6; ++lobe)
        for (int z = 0; z < voxels; ++z)
            for (int y = 0; y < voxels; ++y)
                for (int x = 0; x < voxels; ++x)
                    volume.at(x, y, lobe * voxels + z) = TypeParam(lobe + 1);
    const auto cubes = cubesOf<TypeParam>(8.0);
    const double room = 64.0 * roundoff<TypeParam>;
    for (const double height : {-1.0, 0.0, 0.5, 4.0, 7.9, 8.0, 12.0})
        for (int lobe = 0; lobe < 6; ++lobe)
        {
            vec3 normal(0);
            normal[lobe / 2] = TypeParam(lobe % 2 ? -1 : 1);
            EXPECT_NEAR(
                double(
                    glsl.ambientCubeLight(volume, cubes, vec3(4, 4, TypeParam(height)), normal).x),
                lobe + 1.0, room)
                << height;
        }
    // 0.36 of +x (1), 0.64 of -z (6).
    EXPECT_NEAR(double(glsl.ambientCubeLight(volume, cubes, vec3(4, 4, 4),
                                             vec3(TypeParam(0.6), 0, TypeParam(-0.8)))
                           .x),
                0.36 * 1.0 + 0.64 * 6.0, room);
}

TYPED_TEST(AmbientCube, TakesThreeReads)
{
    using Counting = Glsl<TypeParam, true, true>;
    using vec3 = glm::vec<3, TypeParam>;
    const Volume<TypeParam> volume(voxels, voxels, 6 * voxels, TypeParam(1));
    typename Counting::AmbientCubes cubes;
    cubes.size = vec3(4);
    cubes.slabVoxels = TypeParam(voxels);
    Counting glsl;
    Counting::volumeReads = 0;
    glsl.ambientCubeLight(volume, cubes, vec3(1, 2, 3), vec3(TypeParam(0.6), 0, TypeParam(0.8)));
    EXPECT_EQ(Counting::volumeReads, 3u);
}
