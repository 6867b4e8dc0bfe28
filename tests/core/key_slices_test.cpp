#include "core/KeySlices.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;

namespace
{
SkyLight withKey(double azimuth, double width, double lowest, double highest)
{
    SkyLight sky;
    sky.keyLights.resize(1);
    sky.keyLights[0].azimuth = azimuth;
    sky.keyLights[0].width = width;
    sky.keyLights[0].lowest = lowest;
    sky.keyLights[0].highest = highest;
    return sky;
}
} // namespace

TEST(KeySlices, CoverTheLightAtLeastAsFinelyAsTheMap)
{
    for (const double width : {0.1, 1.0, 30.0, 33.75, 45.0, 90.0, 271.3, 360.0})
        for (const int azimuths : {4, 32, 64, 256})
        {
            const auto lights = keySlices(withKey(300.0, width, 20.0, 50.0), azimuths);
            ASSERT_EQ(lights.size(), 1u);
            const KeySlices& light = lights[0];
            EXPECT_GE(light.count, 3);
            EXPECT_LE(light.count, 256);
            EXPECT_NEAR(light.count * light.width, width, 1e-9);
            EXPECT_NEAR(light.first + 0.5 * (light.count - 1) * light.width, 300.0, 1e-9);
            EXPECT_LE(light.width,
                      360.0 / azimuths * (1.0 + 1e-9) + (light.count == 3 ? 120.0 : 0));
            if (light.count > 3) // and no finer
            {
                EXPECT_GT(width / (light.count - 1), 360.0 / azimuths);
            }
        }
}

TEST(KeySlices, EightFullCirclesStayWithinAPass)
{
    SkyLight sky = withKey(0.0, 360.0, 0.0, 90.0);
    sky.keyLights.resize(maxKeyLights, sky.keyLights[0]);
    const auto lights = keySlices(sky, 256);
    EXPECT_EQ(lights.size(), maxKeyLights);
    EXPECT_EQ(directionsOf(lights).size(), 256u);
}

TEST(KeySlices, WhatGivesNoLightHasNone)
{
    EXPECT_TRUE(keySlices(SkyLight(), 32).empty());
    EXPECT_TRUE(keySlices(withKey(0.0, 30.0, -20.0, 0.0), 32).empty());
    SkyLight black = withKey(0.0, 30.0, 20.0, 50.0);
    black.keyLights[0].radiance = {0.0f, 0.0f, 0.0f};
    EXPECT_TRUE(keySlices(black, 32).empty());
    const auto partly = keySlices(withKey(0.0, 30.0, -20.0, 5.0), 32);
    ASSERT_EQ(partly.size(), 1u);
    EXPECT_EQ(partly[0].lowest, 0.0);
    EXPECT_EQ(partly[0].highest, 5.0);
}

// Clockwise from north, so the middle one of three towards east looks east.
TEST(KeySlices, DirectionsRunClockwise)
{
    const auto directions = directionsOf(keySlices(withKey(90.0, 90.0, 20.0, 50.0), 4));
    ASSERT_EQ(directions.size(), 3u);
    EXPECT_NEAR(directions[0].north, 0.5, 1e-12);
    EXPECT_NEAR(directions[1].east, 1.0, 1e-12);
    EXPECT_NEAR(directions[2].north, -0.5, 1e-12);
}
