// Times as people write them, through the tool's options: the same moment, the same file.
#include "ToolRun.h"

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{
using Times = ToolTest;
using GlTimes = GlToolTest;

const std::string small =
    jacksboro + " o.tif -q --quality draft -srcwin 100 100 16 16 --place -84.2,36.4";

// The right moment by ISO 8601, counted by hand from the text.
TEST_F(GlTimes, OfTheSun)
{
    for (const auto& [text, iso] : {std::pair{"2024-06-21 12:00", "2024-06-21T12:00:00Z"},
                                    {"2024-06-21T12:00+0200", "2024-06-21T10:00:00Z"},
                                    {"2024-06-21t18:00z", "2024-06-21T18:00:00Z"},
                                    {"2024-02-28 24:00 -1100", "2024-02-29T11:00:00Z"},
                                    {"2024-12-31t24:00-17", "2025-01-01T17:00:00Z"},
                                    {"  2024-06-21  17:30:15 gmt", "2024-06-21T17:30:15Z"}})
    {
        const ToolRun result = run("shadow " + small + " --time '" + text + "'");
        ASSERT_EQ(result.status, 0) << text << ": " << result.err;
        EXPECT_EQ(ReadRaster(path("o.tif")).metadata("TERRAINLIGHT_TIME"), iso) << text;
    }
}

TEST_F(GlTimes, OfAPeriod)
{
    const ToolRun result = run("sunhours " + small +
                               " --from '2024-06-21 00:00 -05' --to 2024-06-21t24:00-0500 "
                               "--step 120");
    ASSERT_EQ(result.status, 0) << result.err;
    const ReadRaster written(path("o.tif"));
    EXPECT_EQ(written.metadata("TERRAINLIGHT_FROM"), "2024-06-21T05:00:00Z");
    EXPECT_EQ(written.metadata("TERRAINLIGHT_TO"), "2024-06-22T05:00:00Z");
}

TEST_F(Times, RefusalsNameOptionTextAndReason)
{
    for (const auto& [options, reason] :
         {std::pair{"--time '21.06.2024 12:00'", "does not begin with a date"},
          {"--time '2024-06-21 12:00 CEST'", "not by name"},
          {"--time '2024-06-21 24:00:01'", "24:00 is the last moment of a day"},
          {"--time '2024-06-21 7:00'", "two digits, such as 09:30"},
          {"--time 2024-06-21T12:00+2", "hours of two digits"}})
    {
        const ToolRun result = run("shadow " + small + " " + options);
        EXPECT_EQ(result.status, 2) << options;
        EXPECT_TRUE(result.complains("--time")) << result.err;
        EXPECT_TRUE(result.complains(reason)) << result.err;
        EXPECT_TRUE(left().empty());
    }
}
} // namespace
