#include "core/ClearSky.h"
#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;

template <class Real>
class ClearSkyFunctions : public testing::Test
{
};
TYPED_TEST_SUITE(ClearSkyFunctions, Precisions);
} // namespace

TYPED_TEST(ClearSkyFunctions, OvercastIsAThirdAtTheHorizontal)
{
    CheckedGlsl<TypeParam> glsl;
    EXPECT_EQ(glsl.overcastGradation(TypeParam(1)), TypeParam(1));
    EXPECT_EQ(glsl.overcastGradation(TypeParam(0)), TypeParam(1) / TypeParam(3));
    EXPECT_EQ(glsl.overcastGradation(TypeParam(0.25)), TypeParam(0.5));
}

// Expected: the angle they were made with. 2e-8 for the polynomial, and rounding of the vectors.
TYPED_TEST(ClearSkyFunctions, AngleBetweenSmallAndGreatAngles)
{
    CheckedGlsl<TypeParam> glsl;
    using vec3 = typename CheckedGlsl<TypeParam>::vec3;
    for (const double angle : {0.0, 1e-4, 0.005, 0.3, 1.0, 1.5, 2.5, 3.14})
        for (const double turn : {0.0, 1.0, 4.0})
        {
            const vec3 a(TypeParam(0), TypeParam(0), TypeParam(1));
            const vec3 b(static_cast<TypeParam>(std::sin(angle) * std::cos(turn)),
                         static_cast<TypeParam>(std::sin(angle) * std::sin(turn)),
                         static_cast<TypeParam>(std::cos(angle)));
            EXPECT_NEAR(static_cast<double>(glsl.angleBetween(a, b)), angle,
                        4e-8 + 8.0 * roundoff<TypeParam>);
        }
    const vec3 up(TypeParam(0), TypeParam(0), TypeParam(1));
    EXPECT_NEAR(static_cast<double>(glsl.angleBetween(up, -up)), pi, 2e-6);
}

// Expected: the CIE standard clear sky as published (Kittler 1967; CIE S 011, type 12), over its
// zenith's luminance, with the published roundings 0.91 and 0.274: within 0.2 %. Perez's form has
// no constant in the brightness about the sun, so its c and e are those of CIE over 0.91.
TYPED_TEST(ClearSkyFunctions, PerezIsTheCieClearSky)
{
    CheckedGlsl<TypeParam> glsl;
    const auto real = [](double x) { return static_cast<TypeParam>(x); };
    const double constant = 1.0 - 10.0 * std::exp(-1.5 * pi);
    const typename CheckedGlsl<TypeParam>::vec4 abcd(real(-1.0), real(-0.32), real(10.0 / constant),
                                                     real(-3.0));
    const TypeParam e = real(0.45 / constant);
    for (const double sun : {0.2, 0.7, 1.3})
        for (const double zenith : {0.0, 0.5, 1.0, 1.4})
            for (const double turn : {0.0, 1.0, 2.0, 3.1})
            {
                const double cosine = std::cos(sun) * std::cos(zenith) +
                                      std::sin(sun) * std::sin(zenith) * std::cos(turn);
                const double gamma = std::acos(std::min(cosine, 1.0));
                const auto indicatrix = [](double angle) {
                    return 0.91 + 10.0 * std::exp(-3.0 * angle) +
                           0.45 * std::cos(angle) * std::cos(angle);
                };
                const double expected = indicatrix(gamma) *
                                        (1.0 - std::exp(-0.32 / std::cos(zenith))) /
                                        (indicatrix(sun) * 0.274);
                const double found = static_cast<double>(glsl.perez(abcd, e, real(std::cos(zenith)),
                                                                    real(gamma), real(cosine))) /
                                     static_cast<double>(glsl.perez(abcd, e, real(1.0), real(sun),
                                                                    real(std::cos(sun))));
                EXPECT_NEAR(found, expected, 2e-3 * expected)
                    << sun << ' ' << zenith << ' ' << turn;
            }
}

// Float against double, over the brightest. Measured 9e-7.
TEST(ClearSkyRadiance, FloatAgreesWithDouble)
{
    double worst = 0.0;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (const double turbidity : {2.0, 3.0, 10.0})
        for (const double elevation : {90.0, 40.0, 3.0, 0.0, -5.0, -90.0})
        {
            SkyLight light;
            light.skyModel = SkyModel::Clear;
            light.turbidity = turbidity;
            light.sunElevation = elevation;
            const auto exact = clearSky(light);
            CheckedGlsl<float>::ClearSky rounded;
            rounded.sun = exact.sun;
            rounded.luminance = exact.luminance;
            rounded.x = exact.x;
            rounded.y = exact.y;
            rounded.e = exact.e;
            rounded.zenith = exact.zenith;
            rounded.gain = exact.gain;
            double brightest = 0.0, difference = 0.0;
            for (int i = 0; i < 2000; ++i)
            {
                // The float's direction is the double's: its own rounding is not the function's.
                const double z = std::pow(unit(random), 2.0), turn = 2.0 * pi * unit(random);
                const double side = std::sqrt(1.0 - z * z);
                const CheckedGlsl<float>::vec3 d(
                    CheckedGlsl<double>::vec3(side * std::cos(turn), side * std::sin(turn), z));
                const auto expected = Glsl<double>().clearSkyRadiance(exact, Glsl<double>::vec3(d));
                const auto found = CheckedGlsl<float>().clearSkyRadiance(rounded, d);
                for (int c = 0; c < 3; ++c)
                {
                    brightest = std::max(brightest, expected[c]);
                    difference =
                        std::max(difference, std::abs(static_cast<double>(found[c]) - expected[c]));
                }
            }
            worst = std::max(worst, difference / brightest);
        }
    std::printf("worst %g of the brightest\n", worst);
    EXPECT_LT(worst, 2e-6);
}
