#include "io/LightParameters.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <regex>
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

namespace
{
/// Rows of a document's tables, by the name of their first cell without quotes.
std::map<std::string, std::vector<std::string>> tableRows(const char* document)
{
    std::ifstream file(std::string(OTL_SOURCE_DIR "/docs/") + document);
    std::map<std::string, std::vector<std::string>> rows;
    for (std::string line; std::getline(file, line);)
    {
        if (line.rfind("| `", 0) != 0)
            continue;
        std::vector<std::string> cells;
        line = std::regex_replace(line, std::regex(R"(\\\|)"), "/"); // a quoted bar is no border
        std::istringstream parts(line.substr(1));
        for (std::string cell; std::getline(parts, cell, '|');)
            cells.push_back(std::regex_replace(cell, std::regex("^ +| +$|`"), ""));
        std::string name = cells.front().substr(0, cells.front().find_first_of(" ,"));
        rows.emplace(name, cells); // the first one of that name: the others refer to it
    }
    return rows;
}

/// As documents write it.
std::string typeset(std::string text)
{
    text = std::regex_replace(text, std::regex(R"(\.\.\.)"), "…");
    text = std::regex_replace(text, std::regex(R"(e\+0?)"), "e");
    text = std::regex_replace(text, std::regex("^(a number, |a whole number, |a )"), "");
    return std::regex_replace(text, std::regex(R"((^|[ ,])-(?=[0-9]))"), "$1−");
}

std::string typesetDefault(const std::string& text)
{
    std::smatch same;
    if (std::regex_match(text, same, std::regex(R"(([^,]+),\1,\1)")))
        return typeset(same[1]); // one number stands for three
    return text.empty() ? "none" : typeset(text);
}

/// The range or the names alone, without what kind of number it is.
std::string rangeOf(const SettingRow& row)
{
    return std::regex_replace(typeset(row.needs()),
                              std::regex("^(one number or three|multiple of 4|power of 2), "), "");
}

struct Documented
{
    const SettingRow* row;
    std::string defaultText;
};

std::vector<Documented> allRows()
{
    std::vector<Documented> rows;
    for (const Setting<LightingSettings>& setting : settingsOf<LightingSettings>())
        rows.push_back({&setting, setting.defaultText()});
    for (const Setting<SkyLight>& setting : settingsOf<SkyLight>())
        rows.push_back({&setting, setting.defaultText()});
    for (const SettingRow& row : budgetRows())
        rows.push_back({&row, ""});
    return rows;
}
} // namespace

// Values and default of the table in EARTH_FILE.md are those of the table of settings, to the
// letter.
TEST(LightParameters, EveryKeyIsDocumented)
{
    const auto rows = tableRows("EARTH_FILE.md");
    for (const LightKey& key : lightKeys())
        EXPECT_EQ(rows.count(key.key()), 1u) << key.key();
    for (const auto& [row, defaultText] : allRows())
    {
        if (!row->isKey)
            continue;
        SCOPED_TRACE(row->name);
        ASSERT_EQ(rows.count(row->key()), 1u);
        const std::vector<std::string>& cells = rows.at(row->key());
        ASSERT_GE(cells.size(), 4u);
        EXPECT_EQ(cells[1], typeset(row->needs()));
        EXPECT_EQ(cells[2], typesetDefault(defaultText));
    }
}

// Every option of the tool stands in TOOL.md with its default and its range.
TEST(LightParameters, EveryOptionIsDocumented)
{
    const auto rows = tableRows("TOOL.md");
    for (const auto& [row, defaultText] : allRows())
    {
        // The sun's place is one option, and key lights are given one by one.
        if (!row->isOption || row->topic == Topic::KeyLights || row->name == "sun-azimuth" ||
            row->name == "sun-elevation")
            continue;
        SCOPED_TRACE(row->name);
        ASSERT_EQ(rows.count("--" + row->name), 1u);
        const std::vector<std::string>& cells = rows.at("--" + row->name);
        ASSERT_GE(cells.size(), 3u);
        EXPECT_EQ(cells[1], row->topic == Topic::Budget ? "" : typesetDefault(defaultText));
        EXPECT_NE(cells[2].find(rangeOf(*row)), std::string::npos)
            << cells[2] << "\nneeds " << rangeOf(*row);
    }
}
