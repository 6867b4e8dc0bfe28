#include <osgTerrainLight/SkyLight.h>

#include <gtest/gtest.h>

#include <cmath>

using osgTerrainLight::SkyLight;

namespace
{
std::array<double, 3> direction(double azimuth, double elevation)
{
    SkyLight light;
    light.sunAzimuth = azimuth;
    light.sunElevation = elevation;
    return light.sunDirection();
}

void expectVector(const std::array<double, 3>& v, double x, double y, double z)
{
    EXPECT_NEAR(v[0], x, 1e-15);
    EXPECT_NEAR(v[1], y, 1e-15);
    EXPECT_NEAR(v[2], z, 1e-15);
}
} // namespace

TEST(SkyLight, SunDirectionIsEastNorthUp)
{
    const double half = std::sqrt(0.5);
    expectVector(direction(0, 0), 0, 1, 0);
    expectVector(direction(90, 0), 1, 0, 0);
    expectVector(direction(180, 45), 0, -half, half);
    expectVector(direction(270, -45), -half, 0, -half);
    expectVector(direction(315, 0), -half, half, 0);
    expectVector(direction(123, 90), 0, 0, 1);
    expectVector(direction(123, -90), 0, 0, -1);
}

TEST(SkyLight, AzimuthIsModulo360AndTheVectorUnit)
{
    for (double azimuth : {12.0, 99.5, 200.0, 333.0})
        for (double elevation : {-80.0, -3.0, 0.1, 35.0, 89.0})
        {
            const std::array<double, 3> v = direction(azimuth, elevation);
            EXPECT_NEAR(v[0] * v[0] + v[1] * v[1] + v[2] * v[2], 1.0, 1e-15);
            const std::array<double, 3> again = direction(azimuth - 720.0, elevation);
            for (std::size_t i = 0; i < 3; ++i)
                EXPECT_NEAR(again[i], v[i], 1e-14);
        }
}
