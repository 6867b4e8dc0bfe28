#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

// Expected values: the standard library's Legendre functions, quadrature with enough nodes to be
// exact for the polynomials at hand, closed forms, and OpenGL's table of cube map faces.

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;

template <class Real>
class EnvironmentFunctions : public testing::Test
{
};
TYPED_TEST_SUITE(EnvironmentFunctions, Precisions);

/// Y of (l, m) from std::assoc_legendre, which has no sign (−1)^m.
double expectedHarmonic(int l, int m, double z, double azimuth)
{
    const int order = std::abs(m);
    const double norm = std::sqrt((order == 0 ? 1.0 : 2.0) * (2 * l + 1) / (4.0 * pi) *
                                  std::tgamma(l - order + 1) / std::tgamma(l + order + 1));
    return norm * std::assoc_legendre(static_cast<unsigned>(l), static_cast<unsigned>(order), z) *
           (m < 0 ? std::sin(order * azimuth) : std::cos(order * azimuth));
}

template <class Real>
typename CheckedGlsl<Real>::vec3 direction(double z, double azimuth)
{
    const double r = std::sqrt(1.0 - z * z);
    return typename CheckedGlsl<Real>::vec3(static_cast<Real>(r * std::cos(azimuth)),
                                            static_cast<Real>(r * std::sin(azimuth)),
                                            static_cast<Real>(z));
}

/// Values up to 1.8, slopes up to 1.8 l per radian of a rounded direction, and a recurrence of five
/// steps.
template <class Real>
constexpr double termBound = 64.0 * roundoff<Real>;

/// ∫ f(z) dz over −1 … 1 by midpoints: enough for the bands of kernels, which have a kink.
template <class Function>
double integralOfZ(const Function& f)
{
    constexpr int count = 200000;
    double sum = 0.0;
    for (int i = 0; i < count; ++i)
        sum += f(-1.0 + (2 * i + 1.0) / count);
    return sum * 2.0 / count;
}
} // namespace

TYPED_TEST(EnvironmentFunctions, TermsAreTheLibrarys)
{
    CheckedGlsl<TypeParam> glsl;
    for (double z = -1.0; z <= 1.0; z += 0.125)
        for (double azimuth = 0.0; azimuth < 6.3; azimuth += 0.37)
        {
            const auto terms = glsl.shTerms(direction<TypeParam>(z, azimuth));
            for (int l = 0; l < 6; ++l)
                for (int m = -l; m <= l; ++m)
                    EXPECT_NEAR(static_cast<double>(terms.y[l * (l + 1) + m]),
                                expectedHarmonic(l, m, z, azimuth), termBound<TypeParam>)
                        << l << " " << m << " at z " << z;
        }
}

TYPED_TEST(EnvironmentFunctions, TermsContinueTheBasisOfOrder4)
{
    CheckedGlsl<TypeParam> glsl;
    for (double z = -1.0; z <= 1.0; z += 0.25)
        for (double azimuth = 0.0; azimuth < 6.3; azimuth += 0.7)
        {
            const auto d = direction<TypeParam>(z, azimuth);
            const auto terms = glsl.shTerms(d);
            const auto basis = glsl.shBasis(d);
            for (int i = 0; i < 16; ++i)
                EXPECT_NEAR(static_cast<double>(terms.y[i]),
                            static_cast<double>(basis.c[i / 4][i % 4]), termBound<TypeParam>);
        }
}

TYPED_TEST(EnvironmentFunctions, TermsAreOrthonormal)
{
    // Products are of degree 10: 6 Gauss nodes in z and 12 azimuths are exact.
    const std::array<double, 3> places = {0.2386191860831969, 0.6612093864662645,
                                          0.9324695142031521};
    const std::array<double, 3> weights = {0.4679139345726910, 0.3607615730481386,
                                           0.1713244923791704};
    CheckedGlsl<TypeParam> glsl;
    std::array<std::array<double, 36>, 36> products = {};
    for (std::size_t node = 0; node < 6; ++node)
        for (int turn = 0; turn < 12; ++turn)
        {
            const double z = (node < 3 ? 1.0 : -1.0) * places[node % 3];
            const auto terms = glsl.shTerms(direction<TypeParam>(z, 2.0 * pi * turn / 12.0));
            for (std::size_t a = 0; a < 36; ++a)
                for (std::size_t b = 0; b < 36; ++b)
                    products[a][b] += weights[node % 3] * 2.0 * pi / 12.0 *
                                      static_cast<double>(terms.y[a]) *
                                      static_cast<double>(terms.y[b]);
        }
    for (std::size_t a = 0; a < 36; ++a)
        for (std::size_t b = 0; b < 36; ++b)
            EXPECT_NEAR(products[a][b], a == b ? 1.0 : 0.0, 8.0 * pi * termBound<TypeParam>)
                << a << " " << b;
}

// Expected: Funk and Hecke, 2π ∫ kernel(z) P_l(z) dz.
TYPED_TEST(EnvironmentFunctions, BandsOfKernels)
{
    CheckedGlsl<TypeParam> glsl;
    const auto band = [](int l, const auto& kernel)
    {
        return 2.0 * pi *
               integralOfZ([&](double z)
                           { return kernel(z) * std::legendre(static_cast<unsigned>(l), z); });
    };
    const auto lambert = glsl.lambertBands();
    for (int l = 0; l < 6; ++l)
        EXPECT_NEAR(static_cast<double>(lambert.b[l]),
                    band(l, [](double z) { return std::max(z, 0.0); }),
                    1e-9 + 4.0 * roundoff<TypeParam>)
            << l;
    for (const double s : {1.0, 2.5, 8.0, 64.0})
    {
        const auto phong = glsl.phongBands(static_cast<TypeParam>(s));
        const auto order4 = glsl.phongEigenvalues(static_cast<TypeParam>(s));
        for (int l = 0; l < 6; ++l)
        {
            EXPECT_NEAR(static_cast<double>(phong.b[l]),
                        band(l, [s](double z)
                             { return z > 0.0 ? (s + 1.0) / (2.0 * pi) * std::pow(z, s) : 0.0; }),
                        1e-6 + 8.0 * roundoff<TypeParam>)
                << l << " of exponent " << s;
        }
        for (int l = 0; l < 4; ++l)
            EXPECT_NEAR(static_cast<double>(phong.b[l]), static_cast<double>(order4[l]),
                        4.0 * roundoff<TypeParam>);
    }
}

// Expected: OpenGL 4.3, table 8.18, backwards: s = (sc / |ma| + 1) / 2 and t likewise.
TYPED_TEST(EnvironmentFunctions, DirectionsOfCubeFaces)
{
    CheckedGlsl<TypeParam> glsl;
    for (int face = 0; face < 6; ++face)
        for (const double across : {-0.75, 0.0, 0.5})
            for (const double down : {-0.5, 0.25, 0.875})
            {
                const auto d = glsl.cubeDirection(face, static_cast<TypeParam>(across),
                                                  static_cast<TypeParam>(down));
                const double x = static_cast<double>(d.x), y = static_cast<double>(d.y),
                             z = static_cast<double>(d.z);
                const std::array<std::array<double, 3>, 6> table = {
                    {{-z, -y, x}, {z, -y, -x}, {x, z, y}, {x, -z, -y}, {x, -y, z}, {-x, -y, -z}}};
                const auto& [sc, tc, ma] = table[static_cast<std::size_t>(face)];
                EXPECT_EQ(ma, 1.0) << face;
                EXPECT_EQ(sc, across) << face;
                EXPECT_EQ(tc, down) << face;
            }
}
