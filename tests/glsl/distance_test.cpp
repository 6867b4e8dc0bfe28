#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;

template <class Real>
class DistanceFunctions : public testing::Test
{
};
TYPED_TEST_SUITE(DistanceFunctions, Precisions);

/// Random points with components of -4 … 4; every third one lies in a plane of symmetry.
class Points
{
public:
    glm::dvec3 next()
    {
        std::uniform_real_distribution<double> place(-4.0, 4.0);
        glm::dvec3 p(place(_random), place(_random), place(_random));
        if (++_count % 3 == 0)
            p[_count / 3 % 3] = 0.0;
        // Numbers that a float holds, so that both precisions are asked the same.
        return glm::dvec3(glm::vec3(p));
    }

private:
    std::mt19937 _random{11};
    int _count = 0;
};

/// Distance of the nearest point of an ellipsoid's surface, found by looking: over a grid of both
/// angles of an octant, and then over grids about the best, smaller wherever that stays the best.
double sought(const glm::dvec3& p, const glm::dvec3& radii)
{
    const glm::dvec3 q = glm::abs(p);
    double bestTheta = pi / 4.0, bestPhi = pi / 4.0,
           least = std::numeric_limits<double>::infinity();
    double width = pi / 4.0;
    bool isFirst = true;
    while (width > 1e-8) // the distance is flat there: its error goes with the square
    {
        const double theta0 = bestTheta, phi0 = bestPhi;
        const int steps = isFirst ? 40 : 2;
        for (int i = -steps; i <= steps; ++i)
            for (int j = -steps; j <= steps; ++j)
            {
                const double theta = std::clamp(theta0 + width * i / steps, 0.0, pi / 2.0);
                const double phi = std::clamp(phi0 + width * j / steps, 0.0, pi / 2.0);
                const glm::dvec3 x(radii.x * std::sin(theta) * std::cos(phi),
                                   radii.y * std::sin(theta) * std::sin(phi),
                                   radii.z * std::cos(theta));
                const double distance = glm::distance(x, q);
                if (distance < least)
                {
                    least = distance;
                    bestTheta = theta;
                    bestPhi = phi;
                }
            }
        if (isFirst)
            width *= 0.1; // four steps of the first grid
        else if (bestTheta == theta0 && bestPhi == phi0)
            width *= 0.5;
        isFirst = false;
    }
    const glm::dvec3 s = p / radii;
    return glm::dot(s, s) < 1.0 ? -least : least;
}

const glm::dvec3 manyRadii[] = {{1, 1, 1},     {2, 1, 0.5}, {3, 0.25, 0.3},
                                {0.2, 3, 2.5}, {1, 1, 3},   {20, 1, 1.5}};
} // namespace

// Expected: outside, the way to the nearest point of the box; inside, to the nearest face. A few
// roundings of numbers below 8.
TYPED_TEST(DistanceFunctions, BoxIsExact)
{
    CheckedGlsl<TypeParam> glsl;
    using vec3 = typename CheckedGlsl<TypeParam>::vec3;
    const glm::dvec3 halfSize(1.5, 0.5, 2.25);
    Points points;
    for (int i = 0; i < 1000; ++i)
    {
        const glm::dvec3 p = points.next();
        const glm::dvec3 nearest = glm::clamp(p, -halfSize, halfSize), in = halfSize - glm::abs(p);
        const double expected =
            nearest == p ? -std::min({in.x, in.y, in.z}) : glm::distance(p, nearest);
        EXPECT_NEAR(double(glsl.boxDistance(vec3(p), vec3(halfSize))), expected,
                    8.0 * 8.0 * roundoff<TypeParam>);
    }
    EXPECT_EQ(glsl.boxDistance(vec3(0), vec3(0)), TypeParam(0));
}

// Expected: the same by way of the profile, radius against height.
TYPED_TEST(DistanceFunctions, CylinderIsExact)
{
    CheckedGlsl<TypeParam> glsl;
    using vec3 = typename CheckedGlsl<TypeParam>::vec3;
    const double radius = 1.25, halfHeight = 2.5;
    Points points;
    for (int i = 0; i < 1000; ++i)
    {
        const glm::dvec3 p = points.next();
        const double across = std::hypot(p.x, p.y), up = std::abs(p.z);
        const bool isInside = across < radius && up < halfHeight;
        const double expected =
            isInside ? -std::min(radius - across, halfHeight - up)
                     : std::hypot(across - std::min(across, radius), up - std::min(up, halfHeight));
        EXPECT_NEAR(double(glsl.cylinderDistance(vec3(p), static_cast<TypeParam>(radius),
                                                 static_cast<TypeParam>(halfHeight))),
                    expected, 8.0 * 8.0 * roundoff<TypeParam>);
    }
}

// Expected: beside the line the distance by the area of a parallelogram, beyond its ends that of
// the end.
TYPED_TEST(DistanceFunctions, CapsuleIsExact)
{
    CheckedGlsl<TypeParam> glsl;
    using vec3 = typename CheckedGlsl<TypeParam>::vec3;
    const glm::dvec3 a(-1.0, 0.5, -2.0), b(1.5, 1.0, 1.0);
    const double radius = 0.75;
    Points points;
    for (int i = 0; i < 1000; ++i)
    {
        const glm::dvec3 p = points.next();
        const double area = glm::length(glm::cross(b - a, p - a));
        const double expected = glm::dot(p - a, b - a) < 0.0   ? glm::distance(p, a)
                                : glm::dot(p - b, b - a) > 0.0 ? glm::distance(p, b)
                                                               : area / glm::distance(a, b);
        EXPECT_NEAR(
            double(glsl.capsuleDistance(vec3(p), vec3(a), vec3(b), static_cast<TypeParam>(radius))),
            expected - radius, 8.0 * 8.0 * roundoff<TypeParam>);
    }
    EXPECT_EQ(glsl.capsuleDistance(vec3(0, 3, 0), vec3(0, 1, 0), vec3(0, 1, 0), TypeParam(0.5)),
              TypeParam(1.5));
}

// Expected in double: the nearest point that was sought. Outside at most 0.1 % less, ten times
// better than the 1 % that cones need; inside at most 1 % of the least axis. Never more than the
// distance. All but that points are moved off planes of symmetry by 1e-6 of the least axis.
TEST(EllipsoidDistance, IsWithinAThousandthOutside)
{
    CheckedGlsl<double> glsl;
    const double moved = std::sqrt(3.0) * 1e-6;
    for (const glm::dvec3& radii : manyRadii)
    {
        Points points;
        double outside = 0.0, inside = 0.0, above = 0.0;
        for (int i = 0; i < 100; ++i)
        {
            glm::dvec3 p = points.next() * (i % 2 == 0 ? 1.0 : 0.25);
            if (i % 5 == 0)
                p *= radii / 2.0; // near the surface of long ones, too
            const double expected = sought(p, radii), found = glsl.ellipsoidDistance(p, radii);
            const double least = std::min({radii.x, radii.y, radii.z});
            const double size = std::abs(expected);
            above = std::max(above, (std::abs(found) - size) / least);
            if (expected > 0.0)
                outside = std::max(outside, (size - found - moved * least) / size);
            else
                inside = std::max(inside, (size + found) / least);
        }
        std::printf("  radii %4.2f %4.2f %4.2f: outside at most %.1e of itself too small, inside "
                    "%.1e of the least axis, too large by %.1e of it\n",
                    radii.x, radii.y, radii.z, outside, inside, above);
        EXPECT_LE(outside, 1e-3);
        EXPECT_LE(inside, 1e-2);
        EXPECT_LE(above, moved);
    }
}

// Expected: spheres, and the axes of any ellipsoid, where points are moved by up to √3 · 1e-6 of
// the least axis, here of 2 at most.
TYPED_TEST(DistanceFunctions, EllipsoidsOnTheirAxes)
{
    CheckedGlsl<TypeParam> glsl;
    using vec3 = typename CheckedGlsl<TypeParam>::vec3;
    const vec3 radii(3, 1, 0.5);
    const double tolerance = std::sqrt(3.0) * 2e-6 + 32.0 * roundoff<TypeParam>;
    EXPECT_NEAR(double(glsl.ellipsoidDistance(vec3(5, 0, 0), radii)), 2.0, tolerance);
    EXPECT_NEAR(double(glsl.ellipsoidDistance(vec3(0, -5, 0), radii)), 4.0, tolerance);
    EXPECT_NEAR(double(glsl.ellipsoidDistance(vec3(0, 0, 0.75), radii)), 0.25, tolerance);
    EXPECT_NEAR(double(glsl.ellipsoidDistance(vec3(0, 0, 0.25), radii)), -0.25, tolerance);
    EXPECT_NEAR(double(glsl.ellipsoidDistance(vec3(0, 0, 0), radii)), -0.5, tolerance);
    EXPECT_NEAR(double(glsl.ellipsoidDistance(vec3(1, 2, 2), vec3(2, 2, 2))), 1.0, tolerance);
    EXPECT_NEAR(double(glsl.ellipsoidDistance(vec3(0, 0, 0), vec3(2, 2, 2))), -2.0, tolerance);
}

// Expected: double. The excess over 1 rounds by a few units, and the size is half of that over the
// slope of the excess, which is at least 1 / the greatest axis: 16 roundings of the greatest axis,
// and 16 of the distance. Inside and near the middle the root may be a pole, and the points that
// are moved off it differ: 1e-4 of the least axis.
TEST(EllipsoidDistance, FloatIsNearDouble)
{
    CheckedGlsl<float> single;
    CheckedGlsl<double> exact;
    for (const glm::dvec3& radii : manyRadii)
    {
        const glm::vec3 rounded(radii);
        const double greatest = std::max({radii.x, radii.y, radii.z});
        const double least = std::min({radii.x, radii.y, radii.z});
        Points points;
        double most = 0.0;
        for (int i = 0; i < 3000; ++i)
        {
            const glm::dvec3 p = points.next() * (i % 2 == 0 ? 1.0 : 0.25);
            const double expected = exact.ellipsoidDistance(p, glm::dvec3(rounded));
            const double found = double(single.ellipsoidDistance(glm::vec3(p), rounded));
            const double allowed = 16.0 * roundoff<float> * (greatest + std::abs(expected)) +
                                   (expected < 0.0 ? 1e-4 * least : 0.0);
            most = std::max(most, std::abs(found - expected) / allowed);
        }
        std::printf("  radii %4.2f %4.2f %4.2f: %.2f of what is allowed\n", radii.x, radii.y,
                    radii.z, most);
        EXPECT_LE(most, 1.0);
    }
}
