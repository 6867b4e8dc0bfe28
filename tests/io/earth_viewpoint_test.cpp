// Viewpoints of a map, as osgEarth spells them.
#include "io/EarthFile.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

using namespace osgTerrainLight;

namespace
{
Result<EarthMap> mapWith(const std::string& viewpoints)
{
    return parseEarth("<map><GDALImage url='a.tif'/>\n<viewpoints>" + viewpoints +
                          "</viewpoints></map>",
                      "m.earth");
}

void expectEqual(const EarthViewpoint& found, const EarthViewpoint& wanted)
{
    EXPECT_EQ(found.name, wanted.name);
    EXPECT_NEAR(found.longitude, wanted.longitude, 1.0e-7);
    EXPECT_NEAR(found.latitude, wanted.latitude, 1.0e-7);
    ASSERT_EQ(found.height.has_value(), wanted.height.has_value());
    EXPECT_NEAR(found.height.value_or(0.0), wanted.height.value_or(0.0), 1.0e-6);
    EXPECT_NEAR(found.heading, wanted.heading, 1.0e-9);
    EXPECT_NEAR(found.pitch, wanted.pitch, 1.0e-9);
    EXPECT_NEAR(found.range, wanted.range, 1.0e-6);
}
} // namespace

// Expected: the same viewpoint in every spelling; 2000 m are 6561.68 ft, and 45 degrees are pi / 4.
TEST(EarthViewpoints, InEverySpelling)
{
    const EarthViewpoint wanted{"v", 11.5, 48.25, 500.0, 45.0, -30.0, 2000.0};
    for (const char* text :
         {"<viewpoint name='v' heading='45' pitch='-30' range='2000' long='11.5' lat='48.25' "
          "height='500'/>",
          "<viewpoint name='v' heading='45deg' pitch='-30 deg' range='2km' lon='11.5' lat='48.25' "
          "alt='500m'/>",
          "<Viewpoint><Name>v</Name><Heading> +45 </Heading><pitch>-30.0</pitch><range>2.0 km"
          "</range><x>11.5</x><y>48.25</y><z>0.5km</z></Viewpoint>",
          "<viewpoint name='v' heading='0.78539816339744831rad' pitch='-30\u00b0' "
          "range='6561.679790026246 ft' longitude='11.5' latitude='48.25' height='50000cm'/>",
          "<viewpoint name='v' heading='45' pitch='-30' range='2000' srs='wgs84' x='11.5' "
          "y='48.25' z='500'/>"})
    {
        const Result<EarthMap> map = mapWith(text);
        ASSERT_TRUE(map) << map.error().message;
        ASSERT_EQ(map->viewpoints.size(), 1u) << text << map->warnings.front();
        EXPECT_TRUE(map->warnings.empty() && map->notes.empty()) << text;
        expectEqual(map->viewpoints[0], wanted);
    }
}

// Expected: the central meridian of UTM 33 lies at 500000 m and 15 degrees, the equator at 0 m.
TEST(EarthViewpoints, OnAnyMap)
{
    const Result<EarthMap> map =
        mapWith("<viewpoint srs='EPSG:32633' x='500000' y='0'/><viewpoint lat='1' long='2'/>");
    ASSERT_TRUE(map && map->viewpoints.size() == 2u);
    expectEqual(map->viewpoints[0], {"", 15.0, 0.0, {}, 0.0, -90.0, 0.0});
    expectEqual(map->viewpoints[1], {"", 2.0, 1.0, {}, 0.0, -90.0, 0.0});
}

// Expected: the others are read.
TEST(EarthViewpoints, BadValuesAreNamed)
{
    const std::pair<const char*, const char*> wrongs[] = {
        {"lat='91' long='0'", "lat = \"91\": needs degrees, -90 ... 90"},
        {"lat='x' long='0'", "lat = \"x\": needs"},
        {"lat='0' lon='361'", "lon = \"361\": needs"},
        {"lat='0'", "has no place; needs long and lat, or x and y"},
        {"", "has no place"},
        {"srs='EPSG:32633' x='1'", "has no place"},
        {"srs='EPSG:32633' x='1' y='1km'", "y = \"1km\": needs a number"},
        {"srs='no-such' x='1' y='1'", "srs = \"no-such\": needs a CRS"},
        {"lat='0' long='0' range='0'", "range = \"0\": needs a length more than 0"},
        {"lat='0' long='0' range='5 parsecs'", "range = \"5 parsecs\": needs"},
        {"lat='0' long='0' range='nan'", "range = \"nan\": needs"},
        {"lat='0' long='0' pitch='-91'", "pitch = \"-91\": needs"},
        {"lat='0' long='0' heading='north'", "heading = \"north\": needs"},
        {"lat='0' long='0' height='1e999'", "height = \"1e999\": needs"}};
    for (const auto& [keys, named] : wrongs)
    {
        const Result<EarthMap> map =
            mapWith(std::string("<viewpoint name='v' ") + keys + "/><viewpoint lat='1' long='2'/>");
        ASSERT_TRUE(map) << map.error().message;
        EXPECT_EQ(map->viewpoints.size(), 1u) << keys;
        ASSERT_EQ(map->warnings.size(), 1u) << keys;
        EXPECT_EQ(map->warnings[0].rfind("m.earth:2: left out <viewpoint name=\"v\">: ", 0), 0u);
        EXPECT_NE(map->warnings[0].find(named), std::string::npos) << map->warnings[0];
    }
}

TEST(EarthViewpoints, KeysThatAreNotReadAreNamed)
{
    const Result<EarthMap> map =
        mapWith("<time>0.5</time><viewpoint lat='1' long='2' vdatum='egm96'/>");
    ASSERT_TRUE(map && map->viewpoints.size() == 1u);
    ASSERT_EQ(map->notes.size(), 1u);
    EXPECT_EQ(map->notes[0], "m.earth: skipped: keys of <viewpoint> (line 2: not read here: "
                             "vdatum), keys of <viewpoints> (line 2: not read here: time)");
}

// Expected: the home is first, by the key, by its name, or by its place; the others follow in their
// order.
TEST(EarthViewpoints, TheHomeIsTheFirst)
{
    const std::pair<const char*, const char*> maps[] = {
        {"<viewpoints><viewpoint name='a' PLACE/><viewpoint name='b' PLACE/><viewpoint name='c' "
         "PLACE/></viewpoints>",
         "abc"},
        {"<viewpoints home='B'><viewpoint name='a' PLACE/><viewpoint name='b' PLACE/><viewpoint "
         "name='c' PLACE/></viewpoints>",
         "bca"},
        {"<viewpoints><viewpoint name='a' PLACE/><viewpoint name='b' PLACE/><home>c</home>"
         "<viewpoint name='c' PLACE/></viewpoints>",
         "cab"},
        {"<viewpoints><viewpoint name='a' PLACE/><viewpoint name='Home' PLACE/></viewpoints>",
         "Homea"}};
    for (const auto& [viewpoints, order] : maps)
    {
        std::string text = viewpoints;
        for (std::size_t at = text.find("PLACE"); at != std::string::npos; at = text.find("PLACE"))
            text.replace(at, 5, "lat='1' long='2'");
        const Result<EarthMap> map =
            parseEarth("<map><GDALImage url='a.tif'/>" + text + "</map>", "m.earth");
        ASSERT_TRUE(map) << map.error().message;
        EXPECT_TRUE(map->warnings.empty() && map->notes.empty()) << text;
        std::string names;
        for (const EarthViewpoint& viewpoint : map->viewpoints)
            names += viewpoint.name;
        EXPECT_EQ(names, order);
    }
    const Result<EarthMap> none =
        parseEarth("<map><GDALImage url='a.tif'/>\n<viewpoints home='x'><viewpoint name='a' "
                   "lat='1' long='2'/></viewpoints></map>",
                   "m.earth");
    ASSERT_TRUE(none && none->viewpoints.size() == 1u && none->warnings.size() == 1u);
    EXPECT_EQ(none->warnings[0],
              "m.earth:2: <viewpoints> home = \"x\": needs the name of a <viewpoint>");
}
