#include "core/LegendreKeys.h"
#include "core/ShProduct.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

// Expected values come from the standard library's Legendre functions and the midpoint rule over
// the sphere, and from closed forms.

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;

double harmonic(int l, int m, double z, double azimuth)
{
    const int order = std::abs(m);
    return std::sqrt((m == 0 ? 1.0 : 2.0) * (2 * l + 1) / (4.0 * pi) * std::tgamma(l - order + 1) /
                     std::tgamma(l + order + 1)) *
           std::assoc_legendre(static_cast<unsigned>(l), static_cast<unsigned>(order), z) *
           (m < 0 ? std::sin(order * azimuth) : std::cos(order * azimuth));
}

ShFunction basisAt(double z, double azimuth)
{
    ShFunction basis = {};
    for (int l = 0; l < 4; ++l)
        for (int m = -l; m <= l; ++m)
            basis[static_cast<std::size_t>(l * (l + 1) + m)] = harmonic(l, m, z, azimuth);
    return basis;
}

double dot(const ShFunction& a, const ShFunction& b)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < 16; ++i)
        sum += a[i] * b[i];
    return sum;
}

ShFunction someFunction(unsigned seed)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    ShFunction f = {};
    for (double& coefficient : f)
        coefficient = number(random);
    return f;
}
} // namespace

TEST(ShProduct, IsTheProjectedProduct)
{
    const ShFunction f = someFunction(1);
    const ShFunction g = someFunction(2);
    ShFunction expected = {};
    constexpr int rings = 4000;
    constexpr int turns = 16; // exact: at most 9 turns of azimuth
    for (int ring = 0; ring < rings; ++ring)
        for (int turn = 0; turn < turns; ++turn)
        {
            const ShFunction basis =
                basisAt(2.0 * (ring + 0.5) / rings - 1.0, 2.0 * pi * turn / turns);
            const double value = dot(f, basis) * dot(g, basis) * 4.0 * pi / (rings * turns);
            for (std::size_t i = 0; i < 16; ++i)
                expected[i] += value * basis[i];
        }
    const ShMatrix<16> product = shProduct(f);
    for (std::size_t i = 0; i < 16; ++i)
    {
        // The midpoint rule with h = 2/rings errs by h²/24 times the change of the derivative:
        // polynomials of degree 9 below 20 in all have one below 2·9²·20.
        EXPECT_NEAR(dot(product[i], g), expected[i], 2.0 * 2.0 / rings / rings / 6.0 * 3240.0) << i;
        for (std::size_t j = 0; j < 16; ++j)
            EXPECT_NEAR(product[i][j], product[j][i], 1e-13);
    }
}

TEST(ShProduct, ConstantFunctionMultiplies)
{
    ShFunction constant = {};
    constant[0] = 3.0 * std::sqrt(4.0 * pi); // 3 everywhere
    const ShMatrix<16> product = shProduct(constant);
    for (std::size_t i = 0; i < 16; ++i)
        for (std::size_t j = 0; j < 16; ++j)
            EXPECT_NEAR(product[i][j], i == j ? 3.0 : 0.0, 1e-13);
}

TEST(LegendreKeys, PaperHasThreeWhereALightIsNarrow)
{
    SkyLight sky;
    sky.sunEnabled = false;
    KeyLight light;
    light.azimuth = 350.0;
    light.width = 40.0;
    light.lowest = -10.0;
    light.highest = 30.0;
    sky.keyLights = {light};
    const std::vector<LegendreKey> slices = legendreKeys(sky);
    ASSERT_EQ(slices.size(), 3u);
    double width = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
    {
        // Counter-clockwise from 10° to 330°, clockwise from north.
        const double azimuth = (10.0 - 20.0 * static_cast<double>(i)) * pi / 180.0;
        EXPECT_NEAR(slices[i].direction.east, std::sin(azimuth), 1e-12);
        EXPECT_NEAR(slices[i].direction.north, std::cos(azimuth), 1e-12);
        EXPECT_DOUBLE_EQ(slices[i].lowest, -10.0 * pi / 180.0);
        EXPECT_DOUBLE_EQ(slices[i].highest, 30.0 * pi / 180.0);
        EXPECT_EQ(slices[i].perSun, 0.0);
        width += slices[i].weights.even[0];
    }
    EXPECT_NEAR(width, 40.0 * pi / 180.0, 1e-12);

    // More where they would be more than 45° apart; none where all of it is below the horizontal.
    for (const auto& [degrees, count] : {std::pair{90.0, 3u}, {91.0, 4u}, {360.0, 9u}})
    {
        sky.keyLights[0].width = degrees;
        EXPECT_EQ(legendreKeys(sky).size(), count) << degrees;
    }
    sky.keyLights[0].highest = 0.0;
    EXPECT_TRUE(legendreKeys(sky).empty());
}

TEST(LegendreKeys, SunGivesItsIrradiance)
{
    SkyLight sky;
    for (const double radius : {0.01, 0.2666, 3.0, 10.0})
        for (const double elevation : {-0.005, 5.0, 40.0, 89.9, 90.0})
        {
            SCOPED_TRACE(::testing::Message() << "radius " << radius << " at " << elevation);
            sky.sunAngularRadius = radius;
            sky.sunElevation = elevation;
            const std::vector<LegendreKey> slices = legendreKeys(sky);
            ASSERT_GE(slices.size(), 3u);
            double width = 0.0;
            for (const LegendreKey& slice : slices)
                width += slice.weights.even[0];
            const LegendreKey& first = slices.front();
            // The midpoint rule over the light's rectangle.
            constexpr int steps = 400;
            double irradiance = 0.0;
            const double e = elevation * pi / 180.0;
            for (int i = 0; i < steps; ++i)
                for (int j = 0; j < steps; ++j)
                {
                    const double w =
                        first.lowest + (first.highest - first.lowest) * (i + 0.5) / steps;
                    const double azimuth = width * ((j + 0.5) / steps - 0.5);
                    irradiance += (std::cos(e) * std::cos(w) * std::cos(azimuth) +
                                   std::sin(e) * std::sin(w)) *
                                  std::cos(w);
                }
            irradiance *= width * (first.highest - first.lowest) / (steps * steps);
            EXPECT_NEAR(static_cast<double>(first.radiance[0]) * irradiance, 3.0, 3.0 * 1e-5);
            EXPECT_NEAR(first.perSun * std::sqrt(0.25 / pi) * width *
                            (std::sin(first.highest) - std::sin(first.lowest)),
                        1.0, 1e-12);
        }
    sky.sunElevation = -30.0;
    EXPECT_TRUE(legendreKeys(sky).empty());
    sky.sunElevation = 30.0;
    sky.sunEnabled = false;
    EXPECT_TRUE(legendreKeys(sky).empty());
}
