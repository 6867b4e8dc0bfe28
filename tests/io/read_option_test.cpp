#include "io/ReadOption.h"

#include "io/EarthFile.h"

#include <gtest/gtest.h>

using namespace osgTerrainLight;

TEST(ReadOption, ValuesAndRefusals)
{
    DemReadOptions options;
    ASSERT_TRUE(setReadOption(options, "cell_size", "2.5"));
    ASSERT_TRUE(setReadOption(options, "unit", "us-ft"));
    ASSERT_TRUE(setReadOption(options, "z_factor", "-1"));
    EXPECT_EQ(options.cellSize, 2.5);
    EXPECT_EQ(options.heightUnit, "us-ft");
    EXPECT_EQ(options.heightFactor, -1.0);
    for (const auto& [name, value] :
         std::initializer_list<std::pair<const char*, const char*>>{{"cell_size", "0"},
                                                                    {"cell_size", "1 m"},
                                                                    {"cell_size", ""},
                                                                    {"unit", "parsec"},
                                                                    {"z_factor", "0"},
                                                                    {"z_factor", "nan"},
                                                                    {"band", "1"}})
    {
        const Status set = setReadOption(options, name, value);
        ASSERT_FALSE(set) << name << " = " << value;
        EXPECT_EQ(set.error().message.rfind(name, 0), 0u) << set.error().message;
    }
}

TEST(ReadOption, ElevationsOfAMapHaveThem)
{
    const Result<EarthMap> map =
        parseEarth("<map><elevation driver=\"gdal\" Unit=\"ft\"><url>a.tif</url>"
                   "<z_factor>2</z_factor><cell_size>30</cell_size></elevation></map>",
                   "m.earth");
    ASSERT_TRUE(map) << map.error().message;
    ASSERT_EQ(map->elevations.size(), 1u);
    EXPECT_EQ(map->elevations[0].read.heightUnit, "ft");
    EXPECT_EQ(map->elevations[0].read.heightFactor, 2.0);
    EXPECT_EQ(map->elevations[0].read.cellSize, 30.0);
    const Result<EarthMap> wrong = parseEarth(
        "<map>\n<elevation driver=\"gdal\" unit=\"smoot\" url=\"a.tif\"/></map>", "m.earth");
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().message.rfind("m.earth:2: <elevation> unit = \"smoot\"", 0), 0u)
        << wrong.error().message;
}
