#include "io/LightParameters.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

using namespace osgTerrainLight;

TEST(LightParameters, EveryKeyIsReadAndCopied)
{
    for (const LightKey& key : lightKeys())
    {
        SCOPED_TRACE(key.name);
        EXPECT_EQ(findLightKey(key.name), &key);
        EXPECT_EQ(findLightKey(key.key()), &key);
        ASSERT_TRUE(key.read && key.copy);
        if (key.defaultText == "none" || key.name == "place" || key.defaultText.empty())
            continue; // no text stands for that
        LightParameters parameters;
        const Status set = setLightParameter(parameters, key.key(), key.defaultText);
        EXPECT_TRUE(set) << set.error().message;
        EXPECT_TRUE(parameters.settings == LightingSettings());
        EXPECT_TRUE(parameters.sky == SkyLight());
    }
}

TEST(LightParameters, OneKeyIsTakenFromAnotherLight)
{
    LightParameters from, to;
    from.settings.azimuths = 8;
    from.settings.bounces = 3;
    from.sky.sunElevation = 5.0;
    from.skyFile = "p.exr";
    findLightKey("bounces")->copy(to, from);
    EXPECT_EQ(to.settings.bounces, 3);
    EXPECT_EQ(to.settings.azimuths, LightingSettings().azimuths);
    to.time = UtcTime();
    findLightKey("sun_elevation")->copy(to, from);
    EXPECT_EQ(to.sky.sunElevation, 5.0);
    EXPECT_FALSE(to.time);
    findLightKey("sky")->copy(to, from);
    EXPECT_EQ(to.skyFile, "p.exr");
}

TEST(LightParameters, TheLaterOfContradictingKeysHolds)
{
    LightParameters light;
    ASSERT_TRUE(setLightParameter(light, "sky", "p.exr"));
    ASSERT_TRUE(setLightParameter(light, "sky_harmonics", "1"));
    EXPECT_EQ(light.skyFile, "");
    EXPECT_EQ(light.sky.skyHarmonics.size(), 1u);
    ASSERT_TRUE(setLightParameter(light, "sky", "clear"));
    EXPECT_TRUE(light.sky.skyHarmonics.empty());
    ASSERT_TRUE(setLightParameter(light, "time", "2024-06-21T10:30Z"));
    ASSERT_TRUE(setLightParameter(light, "sun_azimuth", "10"));
    EXPECT_FALSE(light.time);
}

TEST(LightParameters, RefusesByNameAndLeavesTheRest)
{
    LightParameters light;
    const Status unknown = setLightParameter(light, "sun-azimuth", "10");
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().code, ErrorCode::NotSupported);
    for (const char* key : {"gloss_viewer", "max_error", "sky_model"}) // no keys
        EXPECT_FALSE(setLightParameter(light, key, "1"));
    const Status bad = setLightParameter(light, "bounces", "2.5");
    ASSERT_FALSE(bad);
    EXPECT_EQ(bad.error().message, "bounces = \"2.5\": needs a whole number, 0 ... 8");
    EXPECT_TRUE(light.settings == LightingSettings());
}

TEST(LightParameters, EveryRowIsDocumented)
{
    const auto document = [](const char* name)
    {
        std::ifstream file(std::string(OTL_SOURCE_DIR "/docs/") + name);
        std::stringstream text;
        text << file.rdbuf();
        return text.str();
    };
    const std::string earth = document("EARTH_FILE.md"), tool = document("TOOL.md");
    ASSERT_FALSE(earth.empty() || tool.empty());
    for (const LightKey& key : lightKeys())
        EXPECT_NE(earth.find("`" + key.key() + "`"), std::string::npos) << key.key();
    const auto expectOption = [&](const SettingRow& row)
    {
        // The sun's place is one option, and key lights are given one by one.
        const std::string option = row.topic == Topic::KeyLights ? "key-light"
                                   : row.name == "sun-azimuth" || row.name == "sun-elevation"
                                       ? "sun"
                                       : row.name;
        if (row.isOption)
        {
            EXPECT_NE(tool.find("`--" + option), std::string::npos) << row.name;
        }
    };
    for (const Setting<LightingSettings>& setting : settingsOf<LightingSettings>())
        expectOption(setting);
    for (const Setting<SkyLight>& setting : settingsOf<SkyLight>())
        expectOption(setting);
    for (const SettingRow& row : budgetRows())
        expectOption(row);
}
