#include "core/AzimuthSet.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;

TEST(AzimuthSet, CountIsAMultipleOfFour)
{
    for (int count : {4, 8, 12, 32, 72, 256})
        EXPECT_TRUE(AzimuthSet::isValidCount(count)) << count;
    for (int count : {-4, 0, 1, 2, 6, 31, 258, 260})
        EXPECT_FALSE(AzimuthSet::isValidCount(count)) << count;
}

TEST(AzimuthSet, CompassIsClockwiseFromNorth)
{
    const struct
    {
        double degrees, east, north;
    } cases[] = {{0, 0, 1}, {90, 1, 0}, {180, 0, -1}, {270, -1, 0}, {360, 0, 1}, {-90, -1, 0}};
    for (const auto& c : cases)
    {
        EXPECT_EQ(directionOfCompass(c.degrees).east, c.east) << c.degrees;
        EXPECT_EQ(directionOfCompass(c.degrees).north, c.north) << c.degrees;
    }
    EXPECT_NEAR(directionOfCompass(30.0).east, 0.5, 1e-15);
    EXPECT_NEAR(directionOfCompass(30.0).north, std::sqrt(0.75), 1e-15);
}

TEST(AzimuthSet, DirectionsAreUnitVectorsCounterClockwiseFromEast)
{
    for (int count : {4, 12, 32, 256})
    {
        const AzimuthSet azimuths(count);
        for (int k = 0; k < count; ++k)
        {
            const MapDirection d = azimuths.direction(k);
            const double angle = 2.0 * 3.14159265358979323846 * k / count;
            EXPECT_NEAR(d.east, std::cos(angle), 1e-14);
            EXPECT_NEAR(d.north, std::sin(angle), 1e-14);
            const MapDirection back = azimuths.direction((k + count / 2) % count);
            EXPECT_EQ(back.east, -d.east);
            EXPECT_EQ(back.north, -d.north);
        }
        EXPECT_EQ(azimuths.direction(count / 4).east, 0.0);
        EXPECT_EQ(azimuths.direction(count / 4).north, 1.0);
    }
}

TEST(AzimuthSet, BandsAreTheSameDirectionsClockwiseFromNorth)
{
    for (int count : {4, 20, 64})
    {
        const AzimuthSet azimuths(count);
        for (int band = 0; band < count; ++band)
        {
            const int index = azimuths.indexOfBand(band);
            EXPECT_EQ(azimuths.indexOfBand(index), band);
            const MapDirection a = azimuths.direction(index);
            const MapDirection b = directionOfCompass(azimuths.compassDegreesOfBand(band));
            EXPECT_NEAR(a.east, b.east, 1e-14);
            EXPECT_NEAR(a.north, b.north, 1e-14);
        }
        EXPECT_EQ(azimuths.indexOfBand(0), count / 4);
        EXPECT_EQ(azimuths.compassDegreesOfBand(count / 4), 90.0);
    }
}
