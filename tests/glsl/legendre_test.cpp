#include "core/WedgeMatrices.h"
#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

// Expected values come from the standard library's Legendre functions, from Gauss quadrature with
// enough nodes to be exact for the polynomials at hand, and from closed forms named where they
// stand.

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;

template <class Real>
class LegendreFunctions : public testing::Test
{
};
TYPED_TEST_SUITE(LegendreFunctions, Precisions);

/// Gauss-Legendre, 5 nodes: exact for polynomials up to degree 9.
double integral(double a, double b, const std::function<double(double)>& f)
{
    const double inner = std::sqrt(10.0 / 7.0);
    double sum = 128.0 / 225.0 * f(0.5 * (a + b));
    for (const double sign : {-1.0, 1.0})
    {
        const double near = std::sqrt(5.0 - 2.0 * inner) / 3.0;
        const double far = std::sqrt(5.0 + 2.0 * inner) / 3.0;
        const double root = 13.0 * std::sqrt(70.0);
        sum += (322.0 + root) / 900.0 * f(0.5 * (a + b) + 0.5 * (b - a) * sign * near);
        sum += (322.0 - root) / 900.0 * f(0.5 * (a + b) + 0.5 * (b - a) * sign * far);
    }
    return 0.5 * (b - a) * sum;
}

double expectedLegendre(int c, double z)
{
    return std::sqrt(c + 0.5) * std::legendre(static_cast<unsigned>(c), z);
}

/// N_lm(z): Y_lm is it times cos or sin of |m| azimuth.
double expectedElevationPart(int l, int m, double z)
{
    return std::sqrt((m == 0 ? 1.0 : 2.0) * (2 * l + 1) / (4.0 * pi) * std::tgamma(l - m + 1) /
                     std::tgamma(l + m + 1)) *
           std::assoc_legendre(static_cast<unsigned>(l), static_cast<unsigned>(m), z);
}

using Sh = std::array<double, 16>;

Sh expectedBasis(double z, double azimuth)
{
    Sh sh = {};
    for (int l = 0; l < 4; ++l)
        for (int m = -l; m <= l; ++m)
            sh[static_cast<std::size_t>(l * (l + 1) + m)] =
                expectedElevationPart(l, std::abs(m), z) *
                (m < 0 ? std::sin(-m * azimuth) : std::cos(m * azimuth));
    return sh;
}

template <class Real>
Sh toArray(const typename CheckedGlsl<Real>::ShVector& sh)
{
    Sh result = {};
    for (std::size_t i = 0; i < 16; ++i)
        result[i] = static_cast<double>(sh.c[i / 4][static_cast<glm::length_t>(i % 4)]);
    return result;
}

template <class Real>
typename CheckedGlsl<Real>::ShVector fromArray(const Sh& sh)
{
    typename CheckedGlsl<Real>::ShVector result;
    for (std::size_t i = 0; i < 16; ++i)
        result.c[i / 4][static_cast<glm::length_t>(i % 4)] = static_cast<Real>(sh[i]);
    return result;
}

template <class Real>
typename CheckedGlsl<Real>::vec4 toVector(const std::array<double, 4>& a)
{
    return typename CheckedGlsl<Real>::vec4(static_cast<Real>(a[0]), static_cast<Real>(a[1]),
                                            static_cast<Real>(a[2]), static_cast<Real>(a[3]));
}

template <class Real>
typename CheckedGlsl<Real>::vec3 direction(double z, double azimuth)
{
    const double r = std::sqrt(1.0 - z * z);
    return typename CheckedGlsl<Real>::vec3(static_cast<Real>(r * std::cos(azimuth)),
                                            static_cast<Real>(r * std::sin(azimuth)),
                                            static_cast<Real>(z));
}

template <class Real>
typename CheckedGlsl<Real>::vec2 elevation(double angle)
{
    return typename CheckedGlsl<Real>::vec2(static_cast<Real>(std::cos(angle)),
                                            static_cast<Real>(std::sin(angle)));
}

template <class Vector>
void expectNear(const Vector& found, const std::array<double, 4>& expected, double bound,
                double where)
{
    for (int c = 0; c < 4; ++c)
        EXPECT_NEAR(static_cast<double>(found[c]), expected[static_cast<std::size_t>(c)], bound)
            << c << " at " << where;
}

void expectNear(const Sh& found, const Sh& expected, double bound)
{
    for (std::size_t i = 0; i < 16; ++i)
        EXPECT_NEAR(found[i], expected[i], bound) << i;
}

/// By quadrature of the polynomials: 1 between two elevations, 0 elsewhere.
std::array<double, 4> expectedSlice(double from, double to)
{
    std::array<double, 4> slice = {};
    for (int c = 0; c < 4; ++c)
        slice[static_cast<std::size_t>(c)] = integral(
            std::sin(from), std::sin(to), [c](double z) { return expectedLegendre(c, z); });
    return slice;
}

/// Of a slice: numbers up to 1.5, a handful of operations, and a rounded sine and cosine that enter
/// with derivatives up to 4.
template <class Real>
constexpr double sliceBound = 16.0 * roundoff<Real>;

/// Of a harmonic: up to 2.9·(1 − z²)z and the like, below 1; polynomials of degree 3 with
/// coefficients up to 5 times a rounded direction.
template <class Real>
constexpr double basisBound = 16.0 * roundoff<Real>;

constexpr std::array<double, 9> angles = {-pi / 2.0, -1.2,   -0.5, -1e-4,   0.0,
                                          0.3,       pi / 4, 1.3,  pi / 2.0};
} // namespace

TYPED_TEST(LegendreFunctions, PolynomialsAreTheLibrarysAndOrthonormal)
{
    CheckedGlsl<TypeParam> glsl;
    for (double z = -1.0; z <= 1.0; z += 0.03125)
        expectNear(glsl.legendre(static_cast<TypeParam>(z)),
                   {expectedLegendre(0, z), expectedLegendre(1, z), expectedLegendre(2, z),
                    expectedLegendre(3, z)},
                   16.0 * roundoff<TypeParam>, z);
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b)
            EXPECT_NEAR(integral(-1.0, 1.0,
                                 [&](double z)
                                 {
                                     const auto p = glsl.legendre(static_cast<TypeParam>(z));
                                     return static_cast<double>(p[a]) * static_cast<double>(p[b]);
                                 }),
                        a == b ? 1.0 : 0.0, 64.0 * roundoff<TypeParam>);
}

TYPED_TEST(LegendreFunctions, DirectionOfASlopeNeedsNoAngle)
{
    CheckedGlsl<TypeParam> glsl;
    for (const double slope : {-1e4, -3.0, -1.0, -1e-6, 0.0, 1e-6, 0.2, 1.0, 7.0, 1e4})
    {
        const auto found = glsl.risingDirection(static_cast<TypeParam>(slope));
        const double angle = std::atan(slope);
        EXPECT_NEAR(static_cast<double>(found.x), std::cos(angle), 4.0 * roundoff<TypeParam>);
        EXPECT_NEAR(static_cast<double>(found.y), std::sin(angle), 4.0 * roundoff<TypeParam>);
    }
    // No horizon at all, and the same upwards.
    const auto down = glsl.risingDirection(CheckedGlsl<TypeParam>::NO_HORIZON);
    EXPECT_NEAR(static_cast<double>(down.x), 0.0, 2e-15);
    EXPECT_EQ(down.y, TypeParam(-1));
    EXPECT_EQ(glsl.risingDirection(TypeParam(1e30)).y, TypeParam(1));
}

TYPED_TEST(LegendreFunctions, OcclusionIsTheIntegralOfThePolynomials)
{
    CheckedGlsl<TypeParam> glsl;
    for (const double angle : angles)
    {
        const auto at = elevation<TypeParam>(angle);
        expectNear(glsl.occlusionBelow(at), expectedSlice(-pi / 2.0, angle), sliceBound<TypeParam>,
                   angle);
        expectNear(glsl.visibleAbove(at), expectedSlice(angle, pi / 2.0), sliceBound<TypeParam>,
                   angle);
    }
    // Closed form: everything is (√2, 0, 0, 0).
    const auto none = glsl.risingDirection(CheckedGlsl<TypeParam>::NO_HORIZON);
    expectNear(glsl.visibleAbove(none), {std::sqrt(2.0), 0.0, 0.0, 0.0}, sliceBound<TypeParam>,
               -pi / 2.0);
    expectNear(glsl.occlusionBelow(none), {0.0, 0.0, 0.0, 0.0}, sliceBound<TypeParam>, -pi / 2.0);
}

TYPED_TEST(LegendreFunctions, LightOfARangeIsWhatTheHorizonLeaves)
{
    CheckedGlsl<TypeParam> glsl;
    for (const double horizon : angles)
        for (const double low : angles)
            for (const double high : angles)
                if (low <= high)
                {
                    const double start = std::max(horizon, low);
                    expectNear(glsl.visibleBetween(elevation<TypeParam>(horizon),
                                                   elevation<TypeParam>(low),
                                                   elevation<TypeParam>(high)),
                               start < high ? expectedSlice(start, high) : std::array<double, 4>{},
                               2.0 * sliceBound<TypeParam>, horizon);
                }
}

TYPED_TEST(LegendreFunctions, SumOverACastingSetTelescopes)
{
    // NS09, Eq. 12, against the pieces it is made of (Eq. 8), each by quadrature.
    CheckedGlsl<TypeParam> glsl;
    const std::vector<double> edges = {-0.4, -0.1, 0.0, 0.35, 0.8, 1.1}; // from ω_min on
    const std::vector<double> light = {0.3, 2.0, 0.05, 1.0, 0.7, 0.0};   // 0 beyond the last
    auto sum = glsl.occlusionBelow(elevation<TypeParam>(edges[0])) * static_cast<TypeParam>(-0.3);
    std::array<double, 4> expected = {};
    for (std::size_t i = 0; i + 1 < edges.size(); ++i)
    {
        sum += glsl.occlusionBelow(elevation<TypeParam>(edges[i + 1])) *
               static_cast<TypeParam>(light[i] - light[i + 1]);
        const std::array<double, 4> piece = expectedSlice(edges[i], edges[i + 1]);
        for (std::size_t c = 0; c < 4; ++c)
            expected[c] += light[i] * piece[c];
    }
    // The weights sum to 5.6.
    expectNear(sum, expected, 6.0 * sliceBound<TypeParam>, 0.0);
}

TYPED_TEST(LegendreFunctions, BasisIsTheLibrarysAndOrthonormal)
{
    CheckedGlsl<TypeParam> glsl;
    for (double z = -1.0; z <= 1.0; z += 0.125)
        for (double azimuth = 0.0; azimuth < 6.3; azimuth += 0.37)
            expectNear(toArray<TypeParam>(glsl.shBasis(direction<TypeParam>(z, azimuth))),
                       expectedBasis(z, azimuth), basisBound<TypeParam>);
    // Products are of degree 6: Gauss in z and 8 azimuths are exact.
    std::array<Sh, 16> products = {};
    for (int k = 0; k < 8; ++k)
        for (std::size_t a = 0; a < 16; ++a)
            for (std::size_t b = 0; b < 16; ++b)
                products[a][b] += 2.0 * pi / 8.0 *
                                  integral(-1.0, 1.0,
                                           [&](double z)
                                           {
                                               const Sh sh = toArray<TypeParam>(glsl.shBasis(
                                                   direction<TypeParam>(z, 2.0 * pi * k / 8.0)));
                                               return sh[a] * sh[b];
                                           });
    for (std::size_t a = 0; a < 16; ++a)
        for (std::size_t b = 0; b < 16; ++b)
            EXPECT_NEAR(products[a][b], a == b ? 1.0 : 0.0, 8.0 * pi * basisBound<TypeParam>);
}

TYPED_TEST(LegendreFunctions, SumsAndProducts)
{
    CheckedGlsl<TypeParam> glsl;
    Sh a = {}, b = {};
    double dot = 0.0;
    for (std::size_t i = 0; i < 16; ++i)
    {
        a[i] = static_cast<double>(i) - 5.0;
        b[i] = 3.0 + static_cast<double>(i * i);
        dot += a[i] * b[i];
    }
    const auto sum = glsl.shAdd(fromArray<TypeParam>(a), fromArray<TypeParam>(b), TypeParam(0.5));
    // Small integers and halves: exact in either precision.
    for (std::size_t i = 0; i < 16; ++i)
        EXPECT_EQ(toArray<TypeParam>(sum)[i], a[i] + 0.5 * b[i]);
    EXPECT_EQ(static_cast<double>(glsl.shDot(fromArray<TypeParam>(a), fromArray<TypeParam>(b))),
              dot);
    EXPECT_EQ(toArray<TypeParam>(glsl.shZero()), Sh{});
    const Sh bands = toArray<TypeParam>(
        glsl.shScaleBands(fromArray<TypeParam>(b), toVector<TypeParam>({1.0, 2.0, 4.0, 8.0})));
    const Sh orders = toArray<TypeParam>(
        glsl.shWeighOrders(fromArray<TypeParam>(b), toVector<TypeParam>({1.0, 2.0, 4.0, 8.0})));
    for (int l = 0; l < 4; ++l)
        for (int m = -l; m <= l; ++m)
        {
            const auto i = static_cast<std::size_t>(l * (l + 1) + m);
            EXPECT_EQ(bands[i], std::exp2(l) * b[i]);
            EXPECT_EQ(orders[i], std::exp2(std::abs(m)) * b[i]);
        }
}

TYPED_TEST(LegendreFunctions, TurnedFunctionHasItsValuesAtTurnedDirections)
{
    CheckedGlsl<TypeParam> glsl;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int trial = 0; trial < 50; ++trial)
    {
        Sh sh = {};
        for (double& coefficient : sh)
            coefficient = uniform(random);
        const double turn = 4.0 * uniform(random);
        const auto turned =
            glsl.shTurn(fromArray<TypeParam>(sh), static_cast<TypeParam>(std::cos(turn)),
                        static_cast<TypeParam>(std::sin(turn)));
        for (int i = 0; i < 8; ++i)
        {
            const double z = uniform(random);
            const double azimuth = pi * uniform(random);
            const Sh basis = expectedBasis(z, azimuth);
            double expected = 0.0;
            for (std::size_t c = 0; c < 16; ++c)
                expected += sh[c] * basis[c];
            // 16 products of numbers up to 1, and cos 3φ of a rounded cos φ: 9 times its error.
            EXPECT_NEAR(static_cast<double>(glsl.shDot(
                            turned, glsl.shBasis(direction<TypeParam>(z, azimuth + turn)))),
                        expected, 16.0 * (basisBound<TypeParam> + 12.0 * roundoff<TypeParam>));
        }
    }
}

// Expected: the library's functions at the directions themselves, with north and up exchanged or
// mirrored about the normal.
TYPED_TEST(LegendreFunctions, HalfTurnIsTheValueAtTheMirrorDirection)
{
    CheckedGlsl<TypeParam> glsl;
    // Each of 16 products may be off by a few rounding errors of sums of terms up to 2.
    const double bound = 100.0 * static_cast<double>(std::numeric_limits<TypeParam>::epsilon());
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int i = 0; i < 400; ++i)
    {
        Sh sh;
        for (double& c : sh)
            c = uniform(random);
        const auto function = fromArray<TypeParam>(sh);
        const auto value =
            [&](const typename CheckedGlsl<TypeParam>::ShVector& of, double z, double azimuth)
        {
            const Sh basis = expectedBasis(z, azimuth);
            const Sh found = toArray<TypeParam>(of);
            return std::inner_product(basis.begin(), basis.end(), found.begin(), 0.0);
        };
        const double z = uniform(random);
        const double azimuth = pi * uniform(random);
        const auto d = direction<double>(z, azimuth);
        EXPECT_NEAR(value(glsl.shExchangeNorthUp(function), z, azimuth),
                    value(function, d.y, std::atan2(d.z, d.x)), bound);

        // Upright normals, exactly and nearly, are on every level post.
        const double up = i % 4 == 0 ? 1.0 : i % 4 == 1 ? 1.0 - 1e-12 : std::abs(uniform(random));
        const auto normal = direction<TypeParam>(up, 2.0 * uniform(random));
        const glm::dvec3 n = glm::normalize(glm::dvec3(normal));
        const glm::dvec3 mirror = 2.0 * glm::dot(n, glm::dvec3(d)) * n - glm::dvec3(d);
        const auto turned = glsl.shHalfTurn(function, normal);
        EXPECT_NEAR(
            value(turned, z, azimuth),
            value(function, std::clamp(mirror.z, -1.0, 1.0), std::atan2(mirror.y, mirror.x)), bound)
            << up;
        const auto ours = glsl.mirrored(direction<TypeParam>(z, azimuth), normal);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(static_cast<double>(ours[c]), mirror[c], bound);
    }
}

TYPED_TEST(LegendreFunctions, ZonalFunctionTurnsToADirection)
{
    // Addition theorem: the turned function is the old one of the angle between.
    CheckedGlsl<TypeParam> glsl;
    const std::array<double, 4> zonal = {0.7, -1.1, 0.4, 0.9};
    std::mt19937 random(8);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int trial = 0; trial < 100; ++trial)
    {
        const auto axis = direction<TypeParam>(uniform(random), pi * uniform(random));
        const auto at = direction<TypeParam>(uniform(random), pi * uniform(random));
        const double between = glm::dot(glm::dvec3(axis), glm::dvec3(at));
        double expected = 0.0;
        for (int l = 0; l < 4; ++l)
            expected += zonal[static_cast<std::size_t>(l)] * std::sqrt((2 * l + 1) / (4.0 * pi)) *
                        std::legendre(static_cast<unsigned>(l), between);
        // 16 products; factors up to 3.6, and axes whose length is 1 but for rounding.
        EXPECT_NEAR(static_cast<double>(glsl.shDot(glsl.shOfZonal(toVector<TypeParam>(zonal), axis),
                                                   glsl.shBasis(at))),
                    expected, 16.0 * 4.0 * basisBound<TypeParam>);
    }
    // Upwards it stays what it was.
    const Sh up = toArray<TypeParam>(
        glsl.shOfZonal(toVector<TypeParam>(zonal), direction<TypeParam>(1.0, 0.0)));
    for (int l = 0; l < 4; ++l)
        for (int m = -l; m <= l; ++m)
            EXPECT_NEAR(up[static_cast<std::size_t>(l * (l + 1) + m)],
                        m == 0 ? zonal[static_cast<std::size_t>(l)] : 0.0,
                        4.0 * basisBound<TypeParam>);
}

TYPED_TEST(LegendreFunctions, LambertIsTheProjectedCosine)
{
    CheckedGlsl<TypeParam> glsl;
    // Eigenvalue: 2π ∫ z P_l(z) dz over 0 … 1; zonal coefficient: the same of Y_l0.
    std::array<double, 4> eigenvalues = {}, zonal = {};
    for (int l = 0; l < 4; ++l)
    {
        const auto at = static_cast<std::size_t>(l);
        eigenvalues[at] =
            2.0 * pi *
            integral(0.0, 1.0,
                     [l](double z) { return z * std::legendre(static_cast<unsigned>(l), z); });
        zonal[at] = eigenvalues[at] * std::sqrt((2 * l + 1) / (4.0 * pi));
    }
    expectNear(glsl.lambertEigenvalues(), eigenvalues, 8.0 * roundoff<TypeParam>, 0.0);
    expectNear(glsl.lambertZonal(), zonal, 8.0 * roundoff<TypeParam>, 0.0);
    // As printed in NS09, to its digits.
    expectNear(glsl.lambertZonal(), {0.886227, 1.023327, 0.495416, 0.0}, 1e-6, 0.0);
}

TYPED_TEST(LegendreFunctions, PhongIsTheProjectedPower)
{
    CheckedGlsl<TypeParam> glsl;
    for (const int s : {1, 2, 3, 6})
    {
        std::array<double, 4> expected = {};
        for (int l = 0; l < 4; ++l)
            expected[static_cast<std::size_t>(l)] = integral(
                0.0, 1.0,
                [&](double z)
                { return (s + 1) * std::pow(z, s) * std::legendre(static_cast<unsigned>(l), z); });
        expectNear(glsl.phongEigenvalues(static_cast<TypeParam>(s)), expected,
                   8.0 * roundoff<TypeParam>, s);
    }
    for (const double s : {1.0, 10.0, 300.0})
        expectNear(
            glsl.phongEigenvaluesOfPaper(static_cast<TypeParam>(s)),
            {1.0, std::exp(-1.0 / (2.0 * s)), std::exp(-2.0 / s), std::exp(-9.0 / (2.0 * s))},
            16.0 * roundoff<TypeParam>, s);
    // A narrow lobe is a mirror: all eigenvalues go to 1, the exact ones as 1 − l(l + 1)/2s.
    expectNear(glsl.phongEigenvalues(TypeParam(1e4)), {1.0, 1.0 - 1e-4, 1.0 - 3e-4, 1.0 - 6e-4},
               3e-7 + 8.0 * roundoff<TypeParam>, 1e4);
}

TYPED_TEST(LegendreFunctions, AzimuthTermsAreMultipleAngles)
{
    CheckedGlsl<TypeParam> glsl;
    const std::array<double, 4> even = {0.4, 0.3, 0.2, 0.1};
    const std::array<double, 4> odd = {0.0, 0.05, 0.07, -0.2};
    for (double a = -3.0; a < 7.0; a += 0.31)
    {
        const auto terms = glsl.azimuthTerms(static_cast<TypeParam>(std::cos(a)),
                                             static_cast<TypeParam>(std::sin(a)));
        const auto weighed =
            glsl.weighTerms(terms, toVector<TypeParam>(even), toVector<TypeParam>(odd));
        for (int m = 0; m < 4; ++m)
        {
            const auto at = static_cast<std::size_t>(m);
            const double c = std::cos(m * a), s = std::sin(m * a);
            // cos 3φ of a rounded cos φ: 9 times its error, and three steps.
            const double bound = 16.0 * roundoff<TypeParam>;
            EXPECT_NEAR(static_cast<double>(terms.cosines[m]), c, bound);
            EXPECT_NEAR(static_cast<double>(terms.sines[m]), s, bound);
            EXPECT_NEAR(static_cast<double>(weighed.cosines[m]), even[at] * c - odd[at] * s, bound);
            EXPECT_NEAR(static_cast<double>(weighed.sines[m]), even[at] * s + odd[at] * c, bound);
        }
    }
}

TYPED_TEST(LegendreFunctions, SliceGoesThroughTheColumnsOfTheWedgeMatrices)
{
    // addSlice's numbers against the quadrature of core, turned: Rot_z(φ) K w.
    CheckedGlsl<TypeParam> glsl;
    const WedgeMatrices wedges(2.0 * pi / 12.0);
    const double azimuth = 0.83;
    const std::array<std::pair<ShMatrix<4>, AzimuthWeights>, 4> cases = {
        {{wedges.folded(AzimuthBlend::Linear), wedges.weights(AzimuthBlend::Linear)},
         {wedges.folded(AzimuthBlend::BSpline), wedges.weights(AzimuthBlend::BSpline)},
         {wedges.foldedFirst(), wedges.firstWeights()},
         {wedges.foldedLast(), wedges.lastWeights()}}};
    for (const auto& [matrix, weights] : cases)
        for (std::size_t c = 0; c < 4; ++c)
        {
            std::array<double, 4> slice = {};
            slice[c] = 1.0;
            Sh column = {};
            for (std::size_t row = 0; row < 16; ++row)
                column[row] = matrix[row][c];
            const auto cosine = static_cast<TypeParam>(std::cos(azimuth));
            const auto sine = static_cast<TypeParam>(std::sin(azimuth));
            const auto expected = glsl.shTurn(fromArray<TypeParam>(column), cosine, sine);
            const auto terms = glsl.azimuthTerms(cosine, sine);
            const auto found =
                glsl.addSlice(glsl.shZero(), toVector<TypeParam>(slice),
                              glsl.weighTerms(terms, toVector<TypeParam>(weights.even),
                                              toVector<TypeParam>(weights.odd)));
            // Numbers up to 0.55·0.53, the same multiple angles on both sides.
            expectNear(toArray<TypeParam>(found), toArray<TypeParam>(expected),
                       8.0 * roundoff<TypeParam>);
            if (weights.odd == std::array<double, 4>{})
                expectNear(toArray<TypeParam>(glsl.shWeighOrders(
                               glsl.addSlice(glsl.shZero(), toVector<TypeParam>(slice), terms),
                               toVector<TypeParam>(weights.even))),
                           toArray<TypeParam>(expected), 8.0 * roundoff<TypeParam>);
        }
}

TYPED_TEST(LegendreFunctions, SkiesHaveTheirClosedForms)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    for (const int count : {4, 8, 32, 64})
        for (const AzimuthBlend blend : {AzimuthBlend::Linear, AzimuthBlend::BSpline})
        {
            const auto weights =
                toVector<TypeParam>(WedgeMatrices(2.0 * pi / count).weights(blend).even);
            const auto sky = [&](const typename G::vec2& horizon)
            {
                auto sum = glsl.shZero();
                for (int k = 0; k < count; ++k)
                {
                    const double azimuth = 2.0 * pi * k / count;
                    sum =
                        glsl.addSlice(sum, glsl.visibleAbove(horizon),
                                      glsl.azimuthTerms(static_cast<TypeParam>(std::cos(azimuth)),
                                                        static_cast<TypeParam>(std::sin(azimuth))));
                }
                return glsl.shWeighOrders(sum, weights);
            };
            // A sum of `count` terms, each off by its own rounding and the sum's; together 2π of
            // weight times coefficients up to 0.8.
            const double bound = 2.0 * pi * (16.0 + count) * roundoff<TypeParam>;

            // A full sphere of light: 2√π, and nothing else (MATHS: constant environment).
            const auto full = sky(glsl.risingDirection(G::NO_HORIZON));
            Sh expected = {};
            expected[0] = 2.0 * std::sqrt(pi);
            expectNear(toArray<TypeParam>(full), expected, bound);
            // Its irradiance is π for every normal, a mirror lobe of it is 1.
            for (const double z : {1.0, 0.6, -0.2})
            {
                const auto n = direction<TypeParam>(z, 0.9);
                EXPECT_NEAR(static_cast<double>(
                                glsl.shDot(full, glsl.shOfKernel(glsl.lambertEigenvalues(), n))),
                            pi, 4.0 * pi * bound);
                EXPECT_NEAR(
                    static_cast<double>(glsl.shDot(full, glsl.shOfZonal(glsl.lambertZonal(), n))),
                    pi, 4.0 * pi * bound);
                EXPECT_NEAR(static_cast<double>(glsl.shDot(
                                full, glsl.shOfKernel(glsl.phongEigenvalues(TypeParam(20)), n))),
                            1.0, 4.0 * bound);
            }

            // The upper half, on level ground: π, exact in order 4, since the cosine's band 3 is 0
            // and its band 2 integrates to 0 over the half: 2π ∫ (¼ + z/2) dz.
            const auto half = sky(elevation<TypeParam>(0.0));
            const auto up = direction<TypeParam>(1.0, 0.0);
            EXPECT_NEAR(static_cast<double>(
                            glsl.shDot(half, glsl.shOfKernel(glsl.lambertEigenvalues(), up))),
                        pi, 4.0 * pi * bound);
            // Above elevation ω: the cosine up to l = 2 is ¼ + z/2 + (5/32)(3z² − 1), and
            // 2π times its integral over sin ω … 1 is this; the exact irradiance is π cos² ω.
            const double s = std::sin(0.5);
            EXPECT_NEAR(
                static_cast<double>(glsl.shDot(sky(elevation<TypeParam>(0.5)),
                                               glsl.shOfKernel(glsl.lambertEigenvalues(), up))),
                2.0 * pi * (0.25 * (1.0 - s) + 0.25 * (1.0 - s * s) + 5.0 / 32.0 * (s - s * s * s)),
                4.0 * pi * bound);
        }
}
