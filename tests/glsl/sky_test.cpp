#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <vector>

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;

/// Of elevationOfSlope: its polynomial, and rounding (angle_test).
template <class Real>
constexpr double arcBound = 2e-8 + 4.0 * roundoff<Real>;

template <class Real>
class SkyFunctions : public testing::Test
{
};
TYPED_TEST_SUITE(SkyFunctions, Precisions);

/// Simpson's rule. Where the fourth derivative is below 16, as here, its error is below
/// 16·(b − a)·h⁴/180: for a range of 3 and 200 halves 1e-9.
double integral(double a, double b, const std::function<double(double)>& f, int halves = 200)
{
    const double h = (b - a) / (2.0 * halves);
    double sum = f(a) + f(b);
    for (int i = 1; i < 2 * halves; ++i)
        sum += (i % 2 == 1 ? 4.0 : 2.0) * f(a + h * i);
    return sum * h / 3.0;
}
constexpr double quadrature = 1e-8;

/// The definition: ∫∫ N·e sin θ dθ dφ over a slice about φ = 0, with N = (nh, aside, nz).
double sliceByQuadrature(double theta, double nz, double nh, double aside, double width)
{
    return integral(
        -0.5 * width, 0.5 * width,
        [&](double phi)
        {
            const double across = nh * std::cos(phi) + aside * std::sin(phi);
            return integral(
                0.0, theta,
                [&](double t) { return (nz * std::cos(t) + across * std::sin(t)) * std::sin(t); },
                200);
        },
        40);
}

double sliceByQuadrature(double theta, double nz, double nh, double width)
{
    return sliceByQuadrature(theta, nz, nh, 0.0, width);
}
} // namespace

TYPED_TEST(SkyFunctions, SliceIrradianceIsItsIntegral)
{
    CheckedGlsl<TypeParam> glsl;
    for (const double width : {2.0 * pi / 4.0, 2.0 * pi / 16.0, 2.0 * pi / 64.0})
        for (const double theta : {0.0, 0.01, 0.4, 1.0, pi / 2.0, 2.0, 3.0})
            for (const double slant : {0.0, 0.3, 0.9})
                for (const double aim : {0.0, 1.0, 2.5, 4.0})
                {
                    const double nz = std::sqrt(1.0 - slant * slant);
                    const double nh = slant * std::cos(aim);
                    const double aside = slant * std::sin(aim);
                    const double found = static_cast<double>(glsl.sliceIrradiance(
                        static_cast<TypeParam>(theta), static_cast<TypeParam>(nz),
                        static_cast<TypeParam>(nh), static_cast<TypeParam>(width)));
                    // The terms are at most width/2 and width·π/2; eight operations each, and the
                    // rounded arguments.
                    const double bound =
                        quadrature * width + 10.0 * roundoff<TypeParam> * width * (0.5 + pi / 2.0);
                    ASSERT_NEAR(found, sliceByQuadrature(theta, nz, nh, aside, width), bound)
                        << width << ' ' << theta << ' ' << slant << ' ' << aim;
                }
}

// Expected: the definition, from the highest elevation down to the horizon, the lowest one or the
// surface's plane.
TYPED_TEST(SkyFunctions, KeySliceIsItsIntegral)
{
    CheckedGlsl<TypeParam> glsl;
    const auto real = [](double x) { return static_cast<TypeParam>(x); };
    const double width = 0.2;
    for (const double horizon : {-0.5, 0.0, 0.3, 0.9, 1.5})
        for (const auto& [lowest, highest] :
             {std::pair{0.0, 0.5}, {0.2, 0.8}, {0.7, pi / 2.0}, {0.0, pi / 2.0}, {0.4, 0.41}})
            for (const double slant : {0.0, 0.4, 0.95})
                for (const double aim : {0.0, 2.0, pi})
                {
                    const double nz = std::sqrt(1.0 - slant * slant);
                    const typename CheckedGlsl<TypeParam>::vec3 normal(real(slant), real(0.0),
                                                                       real(nz));
                    const double nh = slant * std::cos(aim);
                    const double top = pi / 2.0 - highest;
                    const double bottom = std::min(pi / 2.0 - std::max(horizon, lowest),
                                                   pi / 2.0 + std::atan2(nh, nz));
                    const double expected = bottom > top
                                                ? (sliceByQuadrature(bottom, nz, nh, width) -
                                                   sliceByQuadrature(top, nz, nh, width)) /
                                                      pi
                                                : 0.0;
                    // Two of SliceIrradianceIsItsIntegral's, and the angle at which it ends.
                    const double bound =
                        width * (2.0 * quadrature + 20.0 * roundoff<TypeParam> * (0.5 + pi / 2.0) +
                                 arcBound<TypeParam>);
                    const double found = static_cast<double>(
                        glsl.keySlice(real(horizon), real(lowest), real(highest), normal,
                                      real(std::cos(aim)), real(std::sin(aim)), real(width)));
                    ASSERT_NEAR(found, expected, bound)
                        << horizon << ' ' << lowest << ' ' << highest << ' ' << slant << ' ' << aim;
                }
}

TYPED_TEST(SkyFunctions, PlaneZenithAngleLiesInThePlane)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    EXPECT_EQ(glsl.planeZenithAngle(TypeParam(1), TypeParam(0)), G::HALF_PI);
    for (double slant = -0.999; slant < 1.0; slant += 0.037)
        for (const double nz :
             {std::sqrt(1.0 - slant * slant), 0.5 * std::sqrt(1.0 - slant * slant)})
        {
            const double found = static_cast<double>(
                glsl.planeZenithAngle(static_cast<TypeParam>(nz), static_cast<TypeParam>(slant)));
            EXPECT_GT(found, 0.0);
            EXPECT_LT(found, pi);
            // The sum is up to π: two roundoffs more; the quotient moves the angle by half of its
            // own three.
            const double bound = arcBound<TypeParam> + 4.0 * roundoff<TypeParam>;
            EXPECT_NEAR((nz * std::cos(found) + slant * std::sin(found)) / std::hypot(nz, slant),
                        0.0, bound);
            EXPECT_EQ(found > pi / 2.0, slant > 0.0);
        }
}

TYPED_TEST(SkyFunctions, VisibleDiscIsACircularSegment)
{
    CheckedGlsl<TypeParam> glsl;
    const TypeParam r = static_cast<TypeParam>(0.2666 * pi / 180.0);
    EXPECT_EQ(glsl.visibleDiscFraction(TypeParam(0), r), TypeParam(0.5));
    for (const TypeParam above : {r, r * TypeParam(1.5), TypeParam(1)})
    {
        EXPECT_EQ(glsl.visibleDiscFraction(above, r), TypeParam(1));
        EXPECT_EQ(glsl.visibleDiscFraction(-above, r), TypeParam(0));
    }
    // The arc's error and a few roundoffs of 1. In double alone, closer to the rim than 5e-15, the
    // root's least value 1e-7 stands in for a smaller one and bends the arc by less than 1e-7.
    const double bound = arcBound<TypeParam> / pi + 4.0 * roundoff<TypeParam>;
    double last = 0.0;
    for (int i = -1000; i <= 1000; ++i)
    {
        const TypeParam above = static_cast<TypeParam>(i / 1000.0) * r;
        const double found = static_cast<double>(glsl.visibleDiscFraction(above, r));
        const double x = static_cast<double>(above) / static_cast<double>(r);
        const double d = std::min(1.0, std::max(-1.0, x));
        ASSERT_NEAR(found, 1.0 - (std::acos(d) - d * std::sqrt(1.0 - d * d)) / pi, bound) << x;
        ASSERT_GE(found, last) << x;
        ASSERT_NEAR(found + static_cast<double>(glsl.visibleDiscFraction(-above, r)), 1.0,
                    2.0 * roundoff<TypeParam>);
        last = found;
    }
    for (const TypeParam d :
         {std::nextafter(TypeParam(1), TypeParam(0)), std::nextafter(TypeParam(-1), TypeParam(0))})
        EXPECT_NEAR(static_cast<double>(glsl.visibleDiscFraction(d, TypeParam(1))),
                    d > TypeParam(0) ? 1.0 : 0.0, bound + 1e-7 / pi);
}

TYPED_TEST(SkyFunctions, VisibleDiscIsItsAreaByQuadrature)
{
    CheckedGlsl<TypeParam> glsl;
    for (double x = -0.95; x < 1.0; x += 0.19)
    {
        // Chords of a unit disc above height −x, with sin t for the height: smooth at the rim.
        const double area = integral(std::asin(-x), pi / 2.0,
                                     [](double t) { return 2.0 * std::cos(t) * std::cos(t); });
        EXPECT_NEAR(static_cast<double>(glsl.visibleDiscFraction(static_cast<TypeParam>(0.01 * x),
                                                                 static_cast<TypeParam>(0.01))),
                    area / pi, quadrature + arcBound<TypeParam> / pi + 6.0 * roundoff<TypeParam>);
    }
}

TYPED_TEST(SkyFunctions, VisibleDiscAcrossAStraightHorizonIsTheSegment)
{
    CheckedGlsl<TypeParam> glsl;
    const TypeParam r = TypeParam(0.00465);
    for (int k = -40; k <= 40; ++k)
    {
        const TypeParam above = TypeParam(0.05 * k) * r;
        EXPECT_EQ(glsl.visibleDiscFractionAcross(above, above, above, r),
                  glsl.visibleDiscFraction(above, r));
    }
    // Far from the disc the horizon's shape does not matter.
    EXPECT_EQ(glsl.visibleDiscFractionAcross(2 * r, 3 * r, 9 * r, r), TypeParam(1));
    EXPECT_EQ(glsl.visibleDiscFractionAcross(-3 * r, -2 * r, -2 * r, r), TypeParam(0));
}

TYPED_TEST(SkyFunctions, VisibleDiscAcrossABentHorizonIsItsArea)
{
    // Bent as the function says: through three places, level beyond. By quadrature in 20,000 strips
    // of equal width, exact to 1e-5.
    CheckedGlsl<TypeParam> glsl;
    const double side = static_cast<double>(CheckedGlsl<TypeParam>::SUN_SIDE);
    double worst = 0.0, gentle = 0.0;
    for (const auto& [left, centre, right] : std::vector<std::array<double, 3>>{{0.5, 0.0, -0.5},
                                                                                {-3.0, 0.0, 3.0},
                                                                                {0.4, -0.2, 0.4},
                                                                                {2.0, 0.3, -0.9},
                                                                                {-1.5, 0.6, -1.5},
                                                                                {1.5, -0.9, 1.5},
                                                                                {5.0, -0.5, -5.0},
                                                                                {0.1, 0.0, 0.0}})
    {
        const int count = 20000;
        double area = 0.0;
        for (int i = 0; i < count; ++i)
        {
            const double u = -1.0 + 2.0 * (i + 0.5) / count;
            const double place = std::min(1.0, std::abs(u) / side);
            const double above = centre + ((u < 0.0 ? left : right) - centre) * place;
            const double half = std::sqrt(1.0 - u * u);
            area += 2.0 / count * 2.0 * half * std::clamp(0.5 + 0.5 * above / half, 0.0, 1.0);
        }
        const TypeParam r = TypeParam(0.01);
        const double found = static_cast<double>(glsl.visibleDiscFractionAcross(
            TypeParam(left) * r, TypeParam(centre) * r, TypeParam(right) * r, r));
        const double difference = std::abs(found - area / 3.14159265358979323846);
        worst = std::max(worst, difference);
        if (std::abs(left - centre) <= 1.0 && std::abs(right - centre) <= 1.0)
            gentle = std::max(gentle, difference);
    }
    // A strip may be wrong by half its weight where the horizon cuts through it upright, and weighs
    // at most 1/4 of the disc; an upright horizon cuts one. A horizon that is no steeper than the
    // disc is round differs by what eight strips make of any segment, 0.005.
    std::printf("worst difference from the area: %.4f of the disc, %.4f where gently bent\n", worst,
                gentle);
    EXPECT_LE(worst, 0.125);
    EXPECT_LE(gentle, 0.005);
}

TYPED_TEST(SkyFunctions, SkySliceIsTheIntegralOfItsDefinition)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int trial = 0; trial < 400; ++trial)
    {
        const double elevation = 1.5 * uniform(random);
        const double slope = 3.0 * std::abs(uniform(random));
        const double aim = pi * uniform(random);
        const double azimuth = pi * uniform(random);
        const double width = 2.0 * pi / 32.0;
        const double nz = 1.0 / std::hypot(1.0, slope);
        const typename G::vec3 normal(static_cast<TypeParam>(slope * nz * std::cos(aim)),
                                      static_cast<TypeParam>(slope * nz * std::sin(aim)),
                                      static_cast<TypeParam>(nz));
        const auto found = [&](int definition)
        {
            return static_cast<double>(glsl.skySlice(static_cast<TypeParam>(elevation), normal,
                                                     static_cast<TypeParam>(std::cos(azimuth)),
                                                     static_cast<TypeParam>(std::sin(azimuth)),
                                                     static_cast<TypeParam>(width), definition));
        };
        // The sky above horizon and horizontal, and, to the normal, above the surface's plane:
        // there the integrand is 0, so the arc's error counts only squared.
        const double zenith = pi / 2.0 - std::max(elevation, 0.0);
        const double nh = slope * nz * std::cos(aim - azimuth);
        const double plane = std::acos(-nh / std::hypot(nh, nz));
        const double bound = width * (quadrature + 16.0 * roundoff<TypeParam>);
        EXPECT_NEAR(found(0), sliceByQuadrature(std::min(zenith, plane), nz, nh, width) / pi,
                    bound);
        EXPECT_NEAR(found(1), sliceByQuadrature(zenith, 1.0, 0.0, width) / pi, bound);
        EXPECT_NEAR(found(2),
                    width * integral(0.0, zenith, [](double t) { return std::sin(t); }) /
                        (2.0 * pi),
                    bound);
    }
}

TYPED_TEST(SkyFunctions, SlicesOfAPlaneAndAPitSumToTheirClosedForms)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    const int count = 256;
    const double width = 2.0 * pi / count;
    const auto sum = [&](int definition, const typename G::vec3& normal,
                         const std::function<double(double)>& slopeAt)
    {
        double total = 0.0;
        for (int k = 0; k < count; ++k)
        {
            const double phi = width * k;
            total += static_cast<double>(glsl.skySlice(
                static_cast<TypeParam>(std::atan(slopeAt(phi))), normal,
                static_cast<TypeParam>(std::cos(phi)), static_cast<TypeParam>(std::sin(phi)),
                static_cast<TypeParam>(width), definition));
        }
        return total;
    };
    // Sums of 256 shares of 1, each a few roundoffs off.
    const double rounding = 12.0 * roundoff<TypeParam> + 1e-12;
    const typename G::vec3 up(TypeParam(0), TypeParam(0), TypeParam(1));
    for (const int definition : {0, 1, 2})
    {
        EXPECT_NEAR(sum(definition, up, [](double) { return 0.0; }), 1.0, rounding);
        // A horizon below the horizontal opens no more sky.
        EXPECT_NEAR(sum(definition, up, [](double) { return -0.7; }), 1.0, rounding);
        EXPECT_NEAR(sum(definition, up, [](double) { return 1.0; }),
                    definition == 2 ? 1.0 - std::sqrt(0.5) : 0.5, rounding);
    }

    // A ramp of angle S that rises eastwards: 1 − S/π by solid angle, else (1 + cos S)/2. Two kinks
    // of the integrand stand at φ = ±π/2, on slices: the sum is off by width²/12 times the change
    // of slope there, at most tan S/π in all; and a slice clamps N·e >= 0 at its centre only, which
    // with a width of 1.4° costs 4e-4·(64/256)² (MATHS gives 4e-4 at 64).
    for (const double degrees : {5.0, 30.0, 45.0, 70.0})
    {
        const double angle = degrees * pi / 180.0;
        const typename G::vec3 normal(static_cast<TypeParam>(-std::sin(angle)), TypeParam(0),
                                      static_cast<TypeParam>(std::cos(angle)));
        const auto rampSlope = [&](double phi) { return std::tan(angle) * std::cos(phi); };
        // The next term of the series is smaller by width²/60·(1 + 3 tan² S); doubled for the rest.
        const double kinks =
            width * width / 12.0 * std::tan(angle) / pi *
            (1.0 + width * width / 30.0 * (1.0 + 3.0 * std::pow(std::tan(angle), 2)));
        const double half = 0.5 * (1.0 + std::cos(angle));
        EXPECT_NEAR(sum(2, normal, rampSlope), 1.0 - angle / pi, kinks + rounding);
        EXPECT_NEAR(sum(1, normal, rampSlope), half, kinks + rounding);
        EXPECT_NEAR(sum(0, normal, rampSlope), half, kinks + 4e-4 / 16.0 + rounding);
    }
}
