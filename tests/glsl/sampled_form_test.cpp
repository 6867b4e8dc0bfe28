#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

using namespace osgTerrainLight;

namespace
{

template <class Real>
class SampledFormFunctions : public testing::Test
{
};
TYPED_TEST_SUITE(SampledFormFunctions, Precisions);

constexpr int side = 32;
constexpr double reach = 2.0;

template <class Real>
struct Star
{
    using G = CheckedGlsl<Real>;
    Raster<Real> radii{side, side};
    typename G::SampledForm form;

    explicit Star(const std::function<double(const glm::dvec3&)>& radius)
    {
        double sum = 0.0, greatest = 0.0;
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
            {
                const glm::dvec2 at = (glm::dvec2(x, y) + 0.5) * (2.0 / side) - 1.0;
                const double r = radius(CheckedGlsl<double>().octahedronDirection(at));
                radii.at(x, y) = Real(r);
                sum += r;
                greatest = std::max(greatest, r);
            }
        form.row = 0;
        form.side = side;
        form.first = form.spacing = typename G::vec2(0);
        form.range = typename G::vec2(Real(sum / (side * side)), Real(greatest));
    }
    double distance(const glm::dvec3& p) const
    {
        return double(G().starDistance(radii, form, typename G::vec3(p), Real(reach)));
    }
};

/// Over -4 ... 4 m along x and y.
template <class Real>
struct Columns
{
    using G = CheckedGlsl<Real>;
    Raster<Real> heights{side, 2 * side};
    typename G::SampledForm form;
    static constexpr double spacing = 8.0 / (side - 1);

    /// solid: from x to y.
    explicit Columns(const std::function<glm::dvec2(double, double)>& solid)
    {
        glm::dvec2 range(1.0e30, -1.0e30);
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
            {
                const glm::dvec2 between = solid(spacing * x - 4.0, spacing * y - 4.0);
                heights.at(x, y) = Real(between.y);
                heights.at(x, side + y) = Real(between.x);
                if (between.x <= between.y)
                    range = {std::min(range.x, between.x), std::max(range.y, between.y)};
            }
        form.row = 0;
        form.side = side;
        form.first = typename G::vec2(Real(-4));
        form.spacing = typename G::vec2(Real(spacing));
        form.range = typename G::vec2(range);
    }
    double distance(const glm::dvec3& p) const
    {
        return double(G().columnsDistance(heights, form, typename G::vec3(p), Real(reach)));
    }
};

std::vector<glm::dvec3> points(double within)
{
    std::mt19937 random(4);
    std::uniform_real_distribution<double> place(-within, within);
    std::vector<glm::dvec3> found;
    for (int i = 0; i < 400; ++i)
        found.emplace_back(glm::vec3(place(random), place(random), place(random)));
    return found;
}

} // namespace

TYPED_TEST(SampledFormFunctions, TheOctahedralMapGoesBothWays)
{
    CheckedGlsl<TypeParam> glsl;
    using vec3 = typename CheckedGlsl<TypeParam>::vec3;
    for (const glm::dvec3& p : points(1.0))
    {
        const glm::dvec3 direction = glm::normalize(p);
        const auto at = glsl.octahedronPlace(vec3(p));
        EXPECT_LE(double(std::max(std::abs(at.x), std::abs(at.y))), 1.0);
        // Some ten roundings of numbers up to 1, over a map that is at most 3 times as dense.
        EXPECT_LT(glm::distance(glm::dvec3(glsl.octahedronDirection(at)), direction),
                  64.0 * roundoff<TypeParam>);
    }
}

// Neighbours across an edge, and across a corner, are as near to one another as others are.
TYPED_TEST(SampledFormFunctions, TheOctahedralMapGoesOnBeyondItsEdges)
{
    CheckedGlsl<TypeParam> glsl;
    const auto direction = [&](int x, int y)
    {
        const glm::ivec2 texel = glsl.octahedronTexel(x, y, side);
        EXPECT_TRUE(texel.x >= 0 && texel.y >= 0 && texel.x < side && texel.y < side);
        using vec2 = typename CheckedGlsl<TypeParam>::vec2;
        const vec2 at = (vec2(texel) + TypeParam(0.5)) * TypeParam(2.0 / side) - TypeParam(1);
        return glm::dvec3(glsl.octahedronDirection(at));
    };
    // A step along x of the map is sqrt(2) of that along a face of the octahedron, which is at
    // least 1 / sqrt(3) away from its middle.
    const double most = std::sqrt(6.0) * 2.0 / side;
    for (int i = -4; i < side + 4; ++i)
        for (int j = -4; j < side + 4; ++j)
            EXPECT_LE(glm::distance(direction(i, j), direction(i + 1, j)), most) << i << ' ' << j;
    for (int y = 0; y < side; ++y)
        EXPECT_EQ(direction(-1, y), direction(0, side - 1 - y));
}

// Beside a plane that is met at an angle the way to it times the cosine; far from it the way.
TYPED_TEST(SampledFormFunctions, ASlopeCountsNearTheSurface)
{
    CheckedGlsl<TypeParam> glsl;
    using Real = TypeParam;
    EXPECT_NEAR(double(glsl.slopedDistance(Real(1.0e-3), Real(0.25), Real(1))), 0.5e-3, 1.0e-6);
    EXPECT_NEAR(double(glsl.slopedDistance(Real(30), Real(0.25), Real(1))), 30.0, 1.0e-4);
    EXPECT_EQ(glsl.slopedDistance(Real(2), Real(1), Real(1)), Real(2));
    EXPECT_EQ(glsl.slopedDistance(Real(0), Real(0.5), Real(1)), Real(0));
}

// Expected: the distance to a sphere. Lines are the way to it from everywhere; the normal that is
// taken of four samples is off by at most half the angle between them, 0.1, whose square is what
// the slope makes of the way.
TYPED_TEST(SampledFormFunctions, OfASphereIsTheWayToIt)
{
    const Star<TypeParam> star([](const glm::dvec3&) { return 1.5; });
    for (const glm::dvec3& p : points(3.0))
    {
        const double expected = glm::length(p) - 1.5;
        if (std::abs(expected) > reach)
            continue;
        EXPECT_NEAR(star.distance(p), expected, 0.005 * std::abs(expected) + 1.0e-5);
    }
    EXPECT_NEAR(star.distance({0, 0, 0}), -1.5, 1.0e-5);
    EXPECT_GE(star.distance({9, 0, 0}), reach);
}

// A long body, as the ellipsoid whose distance is known. Samples are an eighth of a metre apart and
// stand for what is between them. From a distance d the nearest of them is d + e^2 / 2d away, and
// the slope alone is right at the surface: in between, with d = e, the error is about e / 3.
TYPED_TEST(SampledFormFunctions, OfAnEllipsoidIsNearlyItsDistance)
{
    const glm::dvec3 radii(2.0, 1.0, 0.7);
    const Star<TypeParam> star([&](const glm::dvec3& d) { return 1.0 / glm::length(d / radii); });
    double squares = 0.0, count = 0.0;
    for (const glm::dvec3& p : points(3.0))
    {
        const double expected = CheckedGlsl<double>().ellipsoidDistance(p, radii);
        if (std::abs(expected) > reach)
            continue;
        const double error = star.distance(p) - expected;
        EXPECT_LT(std::abs(error), 0.06) << p.x << ' ' << p.y << ' ' << p.z;
        squares += error * error;
        count += 1.0;
    }
    EXPECT_LT(std::sqrt(squares / count), 0.02);
}

// Never farther than any sample of the surface: what makes steps safe.
TYPED_TEST(SampledFormFunctions, IsAtMostTheDistanceToASample)
{
    const auto radius = [](const glm::dvec3& d)
    { return 1.5 + 0.6 * std::sin(5.0 * d.x) * std::cos(4.0 * d.y + d.z); };
    const Star<TypeParam> star(radius);
    for (const glm::dvec3& p : points(3.0))
    {
        double least = reach;
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
                least =
                    std::min(least, glm::distance(p, glm::dvec3(CheckedGlsl<TypeParam>().starPoint(
                                                         star.radii, star.form, x, y))));
        const double distance = std::abs(star.distance(p));
        if (least >= reach)
            continue;
        EXPECT_LE(distance, least + 1.0e-5);
    }
}

// Expected: boxDistance(). Its faces are the outermost posts.
TYPED_TEST(SampledFormFunctions, OfABoxOfColumnsIsItsDistance)
{
    const Columns<TypeParam> columns([](double, double) { return glm::dvec2(-1.0, 1.5); });
    for (const glm::dvec3& p : points(6.0))
    {
        const double expected =
            CheckedGlsl<double>().boxDistance(p - glm::dvec3(0, 0, 0.25), {4.0, 4.0, 1.25});
        EXPECT_NEAR(std::min(std::abs(columns.distance(p)), reach),
                    std::min(std::abs(expected), reach), 1.0e-5);
        EXPECT_EQ(columns.distance(p) > 0.0, expected > 0.0);
    }
}

// A slope of 1 : 2, exact near it; farther off the columns beside, which are a quarter of a metre
// apart, bound what the slope no longer says: by e^2 / 2d as above.
TYPED_TEST(SampledFormFunctions, OfAnInclinedPlaneIsTheWayAcross)
{
    const Columns<TypeParam> columns([](double x, double) { return glm::dvec2(-4.0, 0.5 * x); });
    const double cosine = 1.0 / std::sqrt(1.25);
    for (const double height : {-1.0, -0.5, -0.1, -0.01, 0.0, 0.01, 0.1, 0.5, 1.0, 1.8})
        for (const double x : {-0.4, 0.1, 0.53})
            EXPECT_NEAR(columns.distance({x, 0.3, 0.5 * x + height}), height * cosine,
                        0.01 + 0.02 * std::abs(height));
}

// Two cones back to back within a circle, and nothing solid around.
TYPED_TEST(SampledFormFunctions, OfTwoHeightFieldsEndsWhereTheyMeet)
{
    const Columns<TypeParam> columns(
        [](double x, double y)
        {
            const double left = 3.0 - std::hypot(x, y);
            return left < 0.0 ? glm::dvec2(1.0e30, -1.0e30) : glm::dvec2(-left, 0.5 * left);
        });
    // A tip between four posts is cut off: by half of their diagonal times the slope.
    const double cut = 0.5 * std::sqrt(2.0) * Columns<TypeParam>::spacing;
    EXPECT_NEAR(columns.distance({0, 0, 3.0}), 1.5 + 0.5 * cut, 1.0e-3) << "above its tip";
    EXPECT_NEAR(columns.distance({0, 0, -4.5}), 1.5 + cut, 1.0e-3) << "below the other";
    // Beside its edge: a post is up to a spacing within it.
    EXPECT_NEAR(columns.distance({4.0, 0, 0}), 1.0, 0.26);
    EXPECT_GT(columns.distance({3.3, 0.0, 0.0}), 0.0);
    EXPECT_GE(columns.distance({3.9, 3.9, 0.0}), reach);
    // Inside: the nearest is the upper cone, 2.5 - height below it, across its slope.
    EXPECT_NEAR(columns.distance({1.0, 0.0, 0.5}), -0.5 / std::sqrt(1.25), 0.03);
    EXPECT_LT(columns.distance({2.5, 0.0, 0.0}), 0.0);
}

TYPED_TEST(SampledFormFunctions, FloatIsAsGoodAsDouble)
{
    const auto radius = [](const glm::dvec3& d) { return 1.5 + 0.4 * std::sin(4.0 * d.x + d.z); };
    const Star<TypeParam> star(radius);
    const Star<double> exact(radius);
    for (const glm::dvec3& p : points(3.0))
        // Lines are chosen alike but for rounding, and a distance is 1-Lipschitz in samples.
        EXPECT_NEAR(star.distance(p), exact.distance(p), 200.0 * roundoff<TypeParam>);
}
