// Times as people write them, in maps and reader options: the keys take what readUtcTime() takes.
#include "io/EarthFile.h"
#include "io/LightParameters.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

using namespace osgTerrainLight;

// The right moment by ISO 8601, counted by hand from the text.
TEST(MapTime, AsPeopleWriteThem)
{
    for (const auto& [text, iso] : {std::pair{"2024-06-21 12:00", "2024-06-21T12:00:00Z"},
                                    {"2024-06-21T12:00+0200", "2024-06-21T10:00:00Z"},
                                    {"2024-06-21t12:00z", "2024-06-21T12:00:00Z"},
                                    {"2024-06-21T24:00", "2024-06-22T00:00:00Z"},
                                    {"2023-12-31 24:00 -0330", "2024-01-01T03:30:00Z"},
                                    {"1999-12-31t23:59:59,5z", "1999-12-31T23:59:59.500Z"},
                                    {" 2024-02-29\t06:15 +05:45 ", "2024-02-29T00:30:00Z"},
                                    {"2024-06-21 09:30 utc", "2024-06-21T09:30:00Z"}})
        for (const bool isChild : {false, true})
        {
            const std::string light =
                isChild ? std::string("<terrain_light><TIME>") + text + "</TIME></terrain_light>"
                        : std::string("<terrain_light time=\"") + text + "\"/>";
            const Result<EarthMap> map =
                parseEarth("<map><GDALElevation url='a.tif'/>\n" + light + "</map>", "m.earth");
            ASSERT_TRUE(map) << map.error().message;
            ASSERT_TRUE(map->light.time) << text;
            EXPECT_EQ(toString(*map->light.time), iso) << text;
        }
    LightParameters options;
    ASSERT_TRUE(setLightParameter(options, "time", "2024-06-21t24:00-02"));
    EXPECT_EQ(toString(*options.time), "2024-06-22T02:00:00Z");
}

TEST(MapTime, RefusalsNameLineAndReason)
{
    for (const auto& [text, reason] : {std::pair{"2024-06-21 24:30", "24:00 is the last moment"},
                                       {"21.06.2024 12:00", "does not begin with a date"},
                                       {"2024-06-21 12:00 MESZ", "not by name"},
                                       {"2024-06-21 9:00", "two digits, such as 09:30"}})
    {
        const Result<EarthMap> map =
            parseEarth("<map><GDALElevation url='a.tif'/>\n<terrain_light time=\"" +
                           std::string(text) + "\"/></map>",
                       "m.earth");
        ASSERT_FALSE(map) << text;
        EXPECT_EQ(map.error().message.rfind("m.earth:2: <terrain_light> time", 0), 0u)
            << map.error().message;
        EXPECT_NE(map.error().message.find(reason), std::string::npos) << map.error().message;
    }
}
