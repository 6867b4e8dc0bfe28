#include <osgTerrainLight/HorizonMap.h>

#include <gtest/gtest.h>

#include <cmath>

using osgTerrainLight::HorizonMap;

TEST(HorizonMap, CodesRoundTrip)
{
    EXPECT_EQ(HorizonMap::encode(0.0), HorizonMap::levelCode);
    EXPECT_EQ(HorizonMap::decode(HorizonMap::levelCode), 0.0);
    EXPECT_EQ(HorizonMap::decode(1), -90.0);
    EXPECT_EQ(HorizonMap::decode(65535), 90.0);
    for (int code = 1; code <= 65535; ++code)
        ASSERT_EQ(HorizonMap::encode(HorizonMap::decode(static_cast<std::uint16_t>(code))), code);
}

TEST(HorizonMap, EncodingErrsByHalfAStep)
{
    int last = 0;
    for (int k = -90000; k <= 90000; ++k)
    {
        const double degrees = 0.001 * k;
        const std::uint16_t code = HorizonMap::encode(degrees);
        ASSERT_GE(code, last);
        ASSERT_NEAR(HorizonMap::decode(code), degrees, 0.5 * 90.0 / 32767.0 + 1e-12);
        last = code;
    }
}

TEST(HorizonMap, BeyondTheRangeIsItsEnd)
{
    EXPECT_EQ(HorizonMap::encode(-90.001), 1);
    EXPECT_EQ(HorizonMap::encode(-1e9), 1);
    EXPECT_EQ(HorizonMap::encode(1e9), 65535);
}

TEST(HorizonMap, IsVoidUntilWritten)
{
    HorizonMap map(3, 2, 4);
    EXPECT_EQ(map.codes().size(), 24u);
    EXPECT_FALSE(map.isValid(2, 1));
    // Azimuth by azimuth, row by row.
    for (std::size_t k = 0; k < map.codes().size(); ++k)
        map.codes()[k] = static_cast<std::uint16_t>(HorizonMap::levelCode + k);
    EXPECT_EQ(map.codeAt(1, 0, 0), HorizonMap::levelCode + 1);
    EXPECT_EQ(map.codeAt(0, 1, 0), HorizonMap::levelCode + 3);
    EXPECT_EQ(map.codeAt(2, 1, 3), HorizonMap::levelCode + 23);
    EXPECT_TRUE(map.isValid(2, 1));
    EXPECT_EQ(map.elevationAt(0, 0, 0), 0.0);
    EXPECT_NEAR(map.elevationAt(1, 0, 0), 0.0027467, 1e-7);
}
