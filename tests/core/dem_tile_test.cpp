#include <osgTerrainLight/DemTile.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using osgTerrainLight::DemTile;

TEST(DemTile, StartsVoid)
{
    const DemTile tile(3, 2, 30.0);
    EXPECT_EQ(tile.width(), 3);
    EXPECT_EQ(tile.height(), 2);
    EXPECT_EQ(tile.postCount(), 6u);
    EXPECT_EQ(tile.validCount(), 0u);
    EXPECT_EQ(tile.northSpacing, 30.0);
    EXPECT_EQ(tile.eastSpacing(1), 30.0);
    EXPECT_EQ(tile.nominalEastSpacing(), 30.0);
    EXPECT_EQ(DemTile().postCount(), 0u);
}

TEST(DemTile, RowsRunFromTheSouthColumnsFromTheWest)
{
    DemTile tile(3, 2, 1.0);
    tile.setHeight(2, 1, 7.0f);
    EXPECT_EQ(tile.heights()[5], 7.0f);
    tile.setHeight(1, 0, 3.0f);
    EXPECT_EQ(tile.heights()[1], 3.0f);
    EXPECT_EQ(tile.heightAt(1, 0), 3.0f);
    EXPECT_EQ(tile.validCount(), 2u);
}

TEST(DemTile, VoidsAreAMaskWithHeightZero)
{
    DemTile tile(2, 1, 1.0);
    tile.setHeight(0, 0, 5.0f);
    EXPECT_TRUE(tile.isValid(0, 0));
    tile.setVoid(0, 0);
    EXPECT_FALSE(tile.isValid(0, 0));
    EXPECT_EQ(tile.heightAt(0, 0), 0.0f);
}

TEST(DemTile, HeightsThatCannotBeAreVoid)
{
    DemTile tile(1, 1, 1.0);
    for (float h : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                    -std::numeric_limits<float>::infinity(), 1.1e6f, -1.1e6f, -3.4e38f})
    {
        tile.setHeight(0, 0, 1.0f);
        tile.setHeight(0, 0, h);
        EXPECT_FALSE(tile.isValid(0, 0)) << h;
        EXPECT_EQ(tile.heightAt(0, 0), 0.0f);
    }
    for (float h : {1.0e6f, -1.0e6f, 0.0f, -0.0f})
    {
        tile.setHeight(0, 0, h);
        EXPECT_TRUE(tile.isValid(0, 0)) << h;
    }
}

TEST(DemTile, EastSpacingMayDifferFromRowToRow)
{
    DemTile tile(2, 5, 30.0);
    tile.eastSpacings = {25.0, 24.0, 23.0, 22.0, 21.0};
    EXPECT_EQ(tile.eastSpacing(0), 25.0);
    EXPECT_EQ(tile.eastSpacing(4), 21.0);
    EXPECT_EQ(tile.nominalEastSpacing(), 23.0);
}
