#include "core/Raster.h"

#include <gtest/gtest.h>

using osgTerrainLight::Raster;

TEST(Raster, IsRowMajor)
{
    Raster<int> raster(3, 2, 9);
    EXPECT_EQ(raster.width(), 3);
    EXPECT_EQ(raster.height(), 2);
    EXPECT_EQ(raster.size(), 6u);
    EXPECT_EQ(raster.at(2, 1), 9);
    raster.at(2, 0) = 1;
    raster.at(0, 1) = 2;
    EXPECT_EQ(raster.values(), (std::vector<int>{9, 9, 1, 2, 9, 9}));
    EXPECT_EQ(raster.data()[3], 2);
}

TEST(Raster, KnowsItsBounds)
{
    const Raster<float> raster(3, 2);
    EXPECT_TRUE(raster.contains(0, 0));
    EXPECT_TRUE(raster.contains(2, 1));
    for (const auto& [x, y] : {std::pair{-1, 0}, {0, -1}, {3, 0}, {0, 2}})
        EXPECT_FALSE(raster.contains(x, y)) << x << "," << y;
    EXPECT_EQ(raster.at(1, 1), 0.0f);
    EXPECT_TRUE(Raster<float>().empty());
    EXPECT_FALSE(raster.empty());
}
