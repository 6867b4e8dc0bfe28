#include "io/EarthFile.h"
#include "support/GeoidGrid.h"
#include "support/TestFolder.h"
#include "terrain/TerrainModel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

using namespace osgTerrainLight;
namespace fs = std::filesystem;

namespace
{
std::vector<fs::path> mapsIn(const fs::path& folder)
{
    std::vector<fs::path> maps;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".earth")
            maps.push_back(entry.path());
    return maps;
}

/// Everything that reading a map says.
std::string saidOf(const fs::path& path)
{
    const Result<EarthMap> map = readEarthFile(path.string());
    if (!map)
        return map.error().message;
    std::string said;
    const Result<TerrainModel> model = loadMap(*map, path.parent_path().string(), path.string());
    if (!model)
        return model.error().message;
    for (const auto& list : {model->warnings, model->notes})
        for (const std::string& sentence : list)
            said += sentence + "\n";
    return said;
}

/// How many lines the file of expected messages beside a map has, each of which the map must give.
int linesSaid(const fs::path& path)
{
    std::ifstream file(fs::path(path).replace_extension(".expected"));
    const std::string said = saidOf(path);
    std::string line;
    int count = 0;
    for (; std::getline(file, line); ++count)
        EXPECT_NE(said.find(line), std::string::npos) << path << " says: " << said;
    return count;
}
} // namespace

TEST(EarthFiles, EveryMapLoadsWhole)
{
    const std::vector<fs::path> maps = mapsIn(OTL_SOURCE_DIR "/earth_files");
    ASSERT_FALSE(maps.empty());
    for (const fs::path& path : maps)
    {
        const Result<EarthMap> map = readEarthFile(path.string());
        ASSERT_TRUE(map) << map.error().message;
        const Result<TerrainModel> model =
            loadMap(*map, path.parent_path().string(), path.string());
        ASSERT_TRUE(model) << model.error().message;
        EXPECT_TRUE(model->warnings.empty()) << model->warnings.front();
        EXPECT_EQ(model->node->getNumChildren(), 1u + map->models.size()) << path;
    }
}

// Expected: each line of the file beside the map.
TEST(EarthFiles, EveryBrokenMapSaysWhatIsExpected)
{
    const std::vector<fs::path> maps = mapsIn(OTL_SOURCE_DIR "/earth_files/errors");
    ASSERT_FALSE(maps.empty());
    for (const fs::path& path : maps)
        EXPECT_GT(linesSaid(path), 0) << path << " has no message beside it";
}

// Expected: each line of the file beside a map that has one; of the others nothing is left out.
TEST(EarthFiles, EveryMapSaysWhatIsExpected)
{
    int withLines = 0;
    for (const fs::path& path : mapsIn(OTL_SOURCE_DIR "/earth_files"))
        if (linesSaid(path) > 0)
            ++withLines;
        else
            EXPECT_EQ(saidOf(path).find("skipped"), std::string::npos) << saidOf(path);
    EXPECT_GE(withLines, 6);
}

TEST(EarthFiles, SettingsAndLayersInEitherManner)
{
    const Result<EarthMap> map = parseEarth(R"(<map name="m">
  <image name="base" driver="gdal"><url>a.tif</url></image>
  <GDALImage name="over" url="b.tif"/>
  <image name="off" driver="gdal" url="c.tif" enabled="false"/>
  <image name="web" driver="tms" url="http://somewhere"/>
  <heightfield driver="gdal"><url> d.tif</url></heightfield>
  <GDALElevation><url>e.tif</url></GDALElevation>
  <options/>
  <terrain_light sun_azimuth="10" sky_radiance="1 2 3">
    <quality> best </quality>
    <light>sky</light>
  </terrain_light>
</map>)",
                                            "m.earth");
    ASSERT_TRUE(map) << map.error().message;
    ASSERT_EQ(map->images.size(), 2u);
    EXPECT_EQ(map->images[1].url, "b.tif");
    ASSERT_EQ(map->elevations.size(), 2u);
    EXPECT_EQ(map->elevations[0].url, "d.tif");
    EXPECT_EQ(map->light.sky.sunAzimuth, 10.0);
    EXPECT_EQ(map->light.sky.skyRadiance, (Rgb{1.0f, 2.0f, 3.0f}));
    EXPECT_EQ(map->light.settings.quality, HorizonQuality::Best);
    EXPECT_FALSE(map->light.sky.sunEnabled);
    ASSERT_EQ(map->warnings.size(), 1u);
    EXPECT_EQ(map->warnings[0],
              "m.earth: left out: <image driver=\"tms\" name=\"web\"> (line 5: its tiles are on a "
              "network; needs a folder)");
    ASSERT_EQ(map->notes.size(), 1u);
    EXPECT_EQ(map->notes[0],
              "m.earth: skipped: <image driver=\"gdal\" name=\"off\"> (line 4: enabled is false), "
              "<options> (line 8: of a kind that is not known here)");
}

// osgEarth lower-cases names (XmlUtils.cpp) and reads a flag as no where it is false, no or off in
// any case (StringUtils.h); whatever else stands there leaves the layer in.
TEST(EarthFiles, NamesInAnyCaseAndFlagsAsOsgEarthReadsThem)
{
    const std::pair<const char*, bool> layers[] = {
        {"<GDALElevation url='a.tif'/>", true},
        {"<gdalElevation URL='a.tif'/>", true},
        {"<GDALELEVATION><Url>a.tif</Url></GDALELEVATION>", true},
        {"<Elevation Driver='Gdal' url='a.tif'/>", true},
        {"<HeightField driver='gdal' url='a.tif'/>", true},
        {"<elevation><Driver> GDAL </Driver><url><![CDATA[a.tif]]></url></elevation>", true},
        {"<GDALElevation url='a.tif' open='yes'/>", true},
        {"<GDALElevation url='a.tif' visible='1'/>", true},
        {"<GDALElevation url='a.tif' enabled='perhaps'/>", true},
        {"<GDALElevation url='a.tif' open=''/>", true},
        {"<GDALElevation url='a.tif' Visible='False'/>", false},
        {"<GDALElevation url='a.tif' enabled='off'/>", false},
        {"<GDALElevation url='a.tif' open='NO'/>", false},
        {"<GDALElevation url='a.tif'><Enabled>\n false </Enabled></GDALElevation>", false},
        {"<GDALElevation url='a.tif' open='true' visible='no'/>", false},
        {"<GDALElevation url=' '/>", false},
        {"<GDALElevation><connection>x</connection></GDALElevation>", false},
    };
    for (const auto& [layer, counts] : layers)
    {
        const Result<EarthMap> map =
            parseEarth(std::string("<MAP><GDALImage url='b.tif'/>") + layer + "</MAP>", "m.earth");
        ASSERT_TRUE(map) << layer << ": " << map.error().message;
        EXPECT_EQ(map->elevations.size(), counts ? 1u : 0u) << layer;
        EXPECT_EQ(map->notes.size() + map->warnings.size(), counts ? 0u : 1u) << layer;
        for (const EarthLayer& elevation : map->elevations)
            EXPECT_EQ(elevation.url, "a.tif") << layer;
    }
}

// Keys that say something of a layer's values are not dropped without a word.
TEST(EarthFiles, KeysThatAreNotReadAreNamed)
{
    const std::pair<const char*, const char*> layers[] = {
        {"<GDALElevation name='d' url='a.tif' Max_Level='9' unit='ft'/>",
         "keys of <GDALElevation name=\"d\"> (line 2: not read here: Max_Level)"},
        {"<elevation driver='gdal'><url>a.tif</url><nodata_value>-1</nodata_value><offset>true"
         "</offset></elevation>",
         "keys of <elevation driver=\"gdal\"> (line 2: not read here: nodata_value, offset)"},
        {"<GDALElevation url='a.tif' opacity='7'/>",
         "keys of <GDALElevation> (line 2: not read here: opacity)"},
        {"<GDALImage url='a.tif' opacity='0.5' cell_size='3' min_level='1'><profile>x</profile>"
         "</GDALImage>",
         "keys of <GDALImage> (line 2: not read here: cell_size, min_level, profile)"}};
    for (const auto& [layer, named] : layers)
    {
        const Result<EarthMap> map =
            parseEarth(std::string("<map>\n") + layer + "</map>", "m.earth");
        ASSERT_TRUE(map) << map.error().message;
        ASSERT_EQ(map->notes.size(), 1u) << layer;
        EXPECT_EQ(map->notes[0], std::string("m.earth: skipped: ") + named);
        EXPECT_TRUE(map->warnings.empty());
    }
    // Of a layer that is not drawn they do not matter.
    const Result<EarthMap> off = parseEarth(
        "<map><GDALImage url='b.tif'/><GDALImage url='a.tif' opacity='0' open='no'/></map>", "m");
    ASSERT_TRUE(off && off->notes.size() == 1u);
    EXPECT_EQ(off->notes[0].find("opacity"), std::string::npos);
}

// Expected: of several light elements, and of a key given twice, the later holds.
TEST(EarthFiles, TheLaterKeyOfLightHolds)
{
    const Result<EarthMap> map =
        parseEarth("<map><GDALImage url='b.tif'/><terrain_light sun_azimuth='1' azimuths='16'>"
                   "<sun_azimuth>2</sun_azimuth></terrain_light><terrain_light bounces='3'/></map>",
                   "m.earth");
    ASSERT_TRUE(map) << map.error().message;
    EXPECT_EQ(map->light.sky.sunAzimuth, 2.0);
    EXPECT_EQ(map->light.settings.azimuths, 16);
    EXPECT_EQ(map->light.settings.bounces, 3);
}

TEST(EarthFiles, WhereNothingIsLeftTheErrorNamesAllThatWas)
{
    const struct
    {
        const char* layers;
        std::vector<const char*> named;
    } maps[] = {
        {"<XYZImage name='osm'><url>http://t</url></XYZImage>\n<Rocky/>\n"
         "<GDALElevation name='hidden' visible='off' url='a.tif'/>",
         {"<XYZImage name=\"osm\"> (line 2: its tiles are on a network",
          "<Rocky> (line 3: of a kind",
          "<GDALElevation name=\"hidden\"> (line 4: visible is off)"}},
        {"<GDALElevation><connection>pg</connection></GDALElevation>\n<image driver='agglite'/>",
         {"<GDALElevation> (line 2: has no url)", "<image driver=\"agglite\"> (line 3"}},
        {"<CompositeElevation name='c'><layers/></CompositeElevation>",
         {"<CompositeElevation name=\"c\"> (line 2: has no layers)"}},
        {"<CompositeElevation><layers>\n<TMSElevation/>\n<GDALElevation/></layers>"
         "</CompositeElevation>",
         {"<TMSElevation> (line 3: has no url)", "<GDALElevation> (line 4: has no url)"}},
        {"", {"needs <elevation driver=\"gdal\"> or <image driver=\"gdal\"> with a url"}}};
    for (const auto& [layers, named] : maps)
    {
        const Result<EarthMap> map =
            parseEarth(std::string("<map>\n") + layers + "</map>", "m.earth");
        ASSERT_FALSE(map) << layers;
        EXPECT_EQ(map.error().message.rfind("m.earth:1: holds no layer that can be drawn", 0), 0u);
        for (const char* part : named)
            EXPECT_NE(map.error().message.find(part), std::string::npos) << map.error().message;
    }
}

// Expected: of layers with the same place the last one is seen; one that cannot be read is named.
TEST(EarthFiles, TheLastElevationThatCanBeReadIsSeen)
{
    const Result<EarthMap> map =
        parseEarth("<map>\n<GDALElevation name='under' url='jacksboro_90m.tif'/>\n"
                   "<GDALElevation name='over' url='jacksboro_90m.tif' z_factor='2'/>\n"
                   "<GDALElevation name='gone' url='no.tif'/></map>",
                   "m.earth");
    ASSERT_TRUE(map) << map.error().message;
    const Result<TerrainModel> model = loadMap(*map, OTL_SOURCE_DIR "/samples/data", "m.earth");
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->warnings.size(), 1u);
    EXPECT_EQ(model->warnings[0].rfind("m.earth:4: left out <GDALElevation name=\"gone\">: ", 0),
              0u);
    // The sample has heights of 236 m to 1076 m.
    const osg::BoundingSphere& bound = model->node->getBound();
    EXPECT_NEAR(bound.center().z(), 2.0 * 656.0, 2.0);
}

// Expected: the layers of a composite stand in its place, in their order.
TEST(EarthFiles, LayersOfCompositesAreDrawnInTheirPlace)
{
    const Result<EarthMap> map = parseEarth(R"(<map>
  <GDALElevation url="a"/>
  <CompositeElevation cache="no"><layers>
    <GDALElevation url="b" unit="ft"/>
    <GDALElevation url="off" open="false"/>
    <compositeelevation><layers><gdalelevation url="c"/></layers></compositeelevation>
    <GDALImage name="wrong" url="x"/>
    <Rocky/>
  </layers></CompositeElevation>
  <heightfield driver="Composite"><elevation driver="gdal" url="d"/><heightfield driver="gdal"
    url="e"/></heightfield>
  <CompositeElevation enabled="false"><layers><GDALElevation url="y"/></layers></CompositeElevation>
  <GDALElevation url="f"/>
  <image driver="composite"><name>two</name><image driver="gdal" url="g"/>
    <image driver="gdal" url="h"/></image>
</map>)",
                                            "m.earth");
    ASSERT_TRUE(map) << map.error().message;
    std::string urls;
    for (const EarthLayer& layer : map->elevations)
        urls += layer.url;
    EXPECT_EQ(urls, "abcdef");
    EXPECT_EQ(map->elevations[1].read.heightUnit, "ft");
    ASSERT_EQ(map->images.size(), 2u);
    EXPECT_EQ(map->images[1].url, "h");
    ASSERT_EQ(map->warnings.size(), 1u);
    EXPECT_EQ(map->warnings[0],
              "m.earth: left out: <GDALImage name=\"wrong\"> (line 7: a part of a composite of "
              "elevations), <Rocky> (line 8: of a kind that is not known here)");
    ASSERT_EQ(map->notes.size(), 1u);
    EXPECT_EQ(map->notes[0],
              "m.earth: skipped: <GDALElevation> (line 5: open is false), keys of "
              "<CompositeElevation> (line 3: not read here: cache), <CompositeElevation> (line 12: "
              "enabled is false)");
}

TEST(EarthFiles, CompositesInCompositesEnd)
{
    std::string text = "<GDALImage url='a'/>";
    for (int i = 0; i < 3000; ++i)
        text = "<CompositeImage>" + text + "</CompositeImage>";
    const Result<EarthMap> map = parseEarth("<map>" + text + "</map>", "m.earth");
    ASSERT_FALSE(map);
    EXPECT_NE(map.error().message.find("too deep"), std::string::npos);
}

// Expected: as the map of this name has them; x and y of the second are those of the cone's axis.
TEST(EarthFiles, Viewpoints)
{
    const Result<EarthMap> map = readEarthFile(OTL_SOURCE_DIR "/earth_files/viewpoints.earth");
    ASSERT_TRUE(map) << map.error().message;
    ASSERT_EQ(map->viewpoints.size(), 2u);
    EXPECT_EQ(map->viewpoints[0].name, "along the fault");
    EXPECT_EQ(map->viewpoints[0].range, 12000.0);
    EXPECT_EQ(map->viewpoints[0].longitude, -84.2);
    EXPECT_NEAR(map->viewpoints[1].longitude, -84.249866892, 1.0e-8);
    EXPECT_NEAR(map->viewpoints[1].latitude, 36.599800403, 1.0e-8);
    EXPECT_EQ(map->viewpoints[1].range, 30000.0);
}

// Expected: the time of osgEarth's sky, wherever it stands, is that of <terrain_light> alone; half
// past seven in the evening is 19.5 hours.
TEST(EarthFiles, TheTimeOfTheSkyIsThatOfTheSun)
{
    UtcTime wanted;
    ASSERT_TRUE(readUtcTime("2024-06-20T19:30Z", wanted).empty());
    for (const char* sky : {"<sky driver='simple' hours='19.5' date_time='2024-06-20T03:00:00Z'/>",
                            "<Sky><Date_Time>2024-06-20T21:30+02:00</Date_Time></Sky>",
                            "<options><sky hours='19.5' date_time='2024-06-20'/></options>",
                            "<extensions><sky><hours>19.5</hours><date_time>2024-06-20</"
                            "date_time></sky></extensions>",
                            "<external><sky hours='19.5' date_time='2024-06-20'/></external>",
                            "<sky date_time='2024-06-20T19:30'/><terrain_light exposure='1'/>"})
    {
        const Result<EarthMap> map =
            parseEarth(std::string("<map><GDALImage url='b.tif'/>") + sky + "</map>", "m.earth");
        ASSERT_TRUE(map) << map.error().message;
        EXPECT_TRUE(map->warnings.empty() && map->notes.empty()) << sky;
        ASSERT_TRUE(map->light.time) << sky;
        EXPECT_EQ(toString(*map->light.time), toString(wanted)) << sky;
    }
}

// Expected: hours alone are of today, and the rest of the day's time is theirs.
TEST(EarthFiles, HoursOfTheSkyAreOfToday)
{
    const auto today = []
    { return std::chrono::system_clock::now().time_since_epoch() / std::chrono::hours(24); };
    const auto before = today();
    const Result<EarthMap> map =
        parseEarth("<map><GDALImage url='b.tif'/><sky hours='6.25'/></map>", "m.earth");
    ASSERT_TRUE(map && map->light.time);
    const auto since = map->light.time->time_since_epoch();
    EXPECT_TRUE(since / std::chrono::hours(24) == before ||
                since / std::chrono::hours(24) == today());
    EXPECT_EQ(since % std::chrono::hours(24), std::chrono::minutes(375));
}

// Expected: a sun that <terrain_light> has, in whatever way and place, is not replaced, and that is
// said. A time that cannot be read is a warning; a sky without time is named.
TEST(EarthFiles, TheSkyOfOsgEarthComesAfterTheLight)
{
    for (const char* light : {"time='2020-01-01T00:00'", "sun_azimuth='10'", "Sun_Elevation='10'",
                              "sky='panorama.exr'"})
        for (const bool isFirst : {false, true})
        {
            const std::string sky = "<sky hours='1'/>";
            const Result<EarthMap> map =
                parseEarth("<map><GDALImage url='b.tif'/>" + (isFirst ? sky : "") +
                               "<terrain_light " + light + "/>" + (isFirst ? "" : sky) + "</map>",
                           "m.earth");
            ASSERT_TRUE(map) << map.error().message;
            EXPECT_TRUE(!map->light.time || toString(*map->light.time) == "2020-01-01T00:00:00Z");
            ASSERT_EQ(map->notes.size(), 1u) << light;
            EXPECT_EQ(map->notes[0],
                      "m.earth: skipped: <sky> (line 1: the sun is that of <terrain_light>)");
        }
    const std::pair<const char*, const char*> wrongs[] = {
        {"<sky hours='25'/>", "m.earth:2: left out <sky>: hours = \"25\": needs"},
        {"<sky hours='noon'/>", "hours = \"noon\": needs a number of hours of UTC, 0 ... 24"},
        {"<sky date_time='soon'/>", "date_time = \"soon\": needs a time"},
        {"<sky driver='gl'/>", "<sky driver=\"gl\"> (line 2: has neither hours nor date_time)"},
        {"<sky hours='1' visible='no'/>", "<sky> (line 2: visible is no)"},
        {"<sky hours='1' pbr='true'/>", "keys of <sky> (line 2: not read here: pbr)"},
        {"<options><sky hours='1'/><terrain/></options>",
         "<options> (line 2: only its sky, viewpoints, annotations and vertical datum are read)"}};
    for (const auto& [sky, named] : wrongs)
    {
        const Result<EarthMap> map =
            parseEarth(std::string("<map><GDALImage url='b.tif'/>\n") + sky + "</map>", "m.earth");
        ASSERT_TRUE(map) << map.error().message;
        ASSERT_EQ(map->warnings.size() + map->notes.size(), 1u) << sky;
        const std::string& said = (map->warnings.empty() ? map->notes : map->warnings)[0];
        EXPECT_NE(said.find(named), std::string::npos) << said;
    }
}

// Expected: the place of the sun by ERFA over the middle of the raster, as <terrain_light time="…">
// has it.
TEST(EarthFiles, TheSunStandsWhereTheSkySays)
{
    const fs::path folder = OTL_SOURCE_DIR "/earth_files";
    const Result<EarthMap> map = readEarthFile((folder / "sky.earth").string());
    ASSERT_TRUE(map) << map.error().message;
    const Result<TerrainModel> model = loadMap(*map, folder.string(), "sky.earth");
    ASSERT_TRUE(model) << model.error().message;
    UtcTime time;
    ASSERT_TRUE(readUtcTime("2024-06-20T19:30Z", time).empty());
    EarthPlace middle;
    middle.longitude = -84.41375 + 0.5 * 403 / 1200.0;
    middle.latitude = 36.732916667 - 0.5 * 344 / 1200.0;
    const SunPosition sun = sunPosition(time, middle);
    EXPECT_NEAR(model->node->getSkyLight().sunAzimuth, sun.azimuth, 1.0e-3);
    EXPECT_NEAR(model->node->getSkyLight().sunElevation, sun.elevation, 1.0e-3);
}

// Expected: that of an image in a composite is the product of both.
TEST(EarthFiles, OpacityOfImages)
{
    const Result<EarthMap> map = parseEarth(
        "<map><GDALImage url='a'/><GDALImage url='b'><opacity> 0.25 </opacity></GDALImage>"
        "<CompositeImage opacity='0.5'><layers><GDALImage url='c' opacity='0.5'/><GDALImage "
        "url='d'/></layers></CompositeImage></map>",
        "m.earth");
    ASSERT_TRUE(map) << map.error().message;
    EXPECT_TRUE(map->notes.empty());
    ASSERT_EQ(map->images.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(map->images[i].opacity, (std::array{1.0, 0.25, 0.25, 0.5}[i]));
    for (const char* wrong : {"-0.1", "1.01", "half", "nan", "0.5x"})
    {
        const Result<EarthMap> refused = parseEarth(
            std::string("<map>\n<GDALImage url='a' opacity='") + wrong + "'/></map>", "m.earth");
        ASSERT_FALSE(refused) << wrong;
        EXPECT_EQ(refused.error().message, std::string("m.earth:2: <GDALImage> opacity = \"") +
                                               wrong + "\": needs a number, 0 ... 1");
    }
}

// Expected: nothing to say where heights have no datum, or one layer has one; a notice where all
// have the same; else a notice for each layer that is converted, and a warning for each that is
// not. The map's own datum comes before that of the first layer. With a grid of −20 m, heights of
// the sample, 236 m to 1076 m, are drawn that much lower, or higher.
TEST(EarthFiles, HeightsAreBroughtToOneVerticalDatum)
{
    writeGeoidGrid(testFolder() / "geoid.gtx", -85.0, 36.0, 1.0, 2, 2,
                   [](double, double) { return -20.0; });
    const std::string grid = (testFolder() / "geoid.gtx").string();
    const auto layer = [](const std::string& keys)
    { return "<GDALElevation url='jacksboro_90m.tif' " + keys + "/>"; };
    const struct
    {
        std::string layers;
        std::size_t warnings;
        int datums;    ///< notices that name one
        double lowest; ///< of the terrain
    } maps[] = {
        {layer("") + layer(""), 0, 0, 236.0},
        {layer("vdatum='EGM96'") + layer("vdatum='egm96'"), 0, 1, 236.0},
        {layer("vdatum='EPSG:5773'") + layer("vdatum='egm96'"), 0, 1, 236.0},
        {layer("vdatum='egm96'") + layer("") + layer("vdatum='no-such'"), 2, 0, 236.0},
        {layer("vdatum='ellipsoid'") + layer("vdatum='" + grid + "'"), 0, 1, 216.0},
        {layer("vdatum='" + grid + "'") + layer("vdatum='ellipsoid'"), 0, 1, 256.0},
        {"<profile vdatum='ellipsoid'/>" + layer("vdatum='" + grid + "'"), 0, 1, 216.0},
        {"<options><profile><vdatum>WGS84</vdatum></profile></options>" +
             layer("vdatum='" + grid + "'"),
         0, 1, 216.0},
        {"<profile vdatum='egm96'/>" + layer(""), 1, 0, 236.0},
        {layer("vdatum='" + grid + "' z_factor='-1'") + layer("vdatum='no.gtx'"), 1, 0, 236.0}};
    for (const auto& [layers, warnings, datums, lowest] : maps)
    {
        const Result<EarthMap> map = parseEarth("<map>\n" + layers + "</map>", "m.earth");
        ASSERT_TRUE(map) << map.error().message;
        const Result<TerrainModel> model = loadMap(*map, OTL_SOURCE_DIR "/samples/data", "m.earth");
        ASSERT_TRUE(model) << model.error().message;
        EXPECT_EQ(model->warnings.size(), warnings) << layers;
        for (const std::string& warning : model->warnings)
            EXPECT_NE(warning.find("they are not converted: "), std::string::npos) << warning;
        EXPECT_EQ(std::count_if(model->notes.begin(), model->notes.end(),
                                [](const std::string& note)
                                { return note.find("vertical datum") != std::string::npos; }),
                  datums)
            << layers;
        EXPECT_NEAR(model->terrain.zMin(), lowest, 1.0e-3) << layers;
    }
}

// Expected: the datum of a layer's profile is its own; names are in lower case, paths as written.
TEST(EarthFiles, NamesOfVerticalDatums)
{
    const std::pair<const char*, const char*> layers[] = {
        {"<GDALElevation url='a'><profile srs='wgs84' vdatum='EGM2008'/></GDALElevation>",
         "egm2008"},
        {"<GDALElevation url='a' vdatum='egm84'><profile vdatum='egm96'/></GDALElevation>",
         "egm84"},
        {"<GDALElevation url='a'><VDatum>Grids\\Local.gtx</VDatum></GDALElevation>",
         "Grids/Local.gtx"},
        {"<GDALElevation url='a'/>", ""}};
    for (const auto& [layer, datum] : layers)
    {
        const Result<EarthMap> map = parseEarth(std::string("<map>") + layer + "</map>", "m");
        ASSERT_TRUE(map && map->elevations.size() == 1u) << layer;
        EXPECT_EQ(map->elevations[0].verticalDatum, datum);
    }
}

// Expected: slashes that every system knows; what is left out is named by the path that was tried.
TEST(EarthFiles, PathsThatWereWrittenOnWindows)
{
    const Result<EarthMap> map = parseEarth(
        "<map>\n<GDALElevation url='..\\data\\dem.tif'/><GDALElevation url='D:\\a b\\c.tif'/>"
        "<terrain_light sky='skies\\noon.exr'/></map>",
        "m.earth");
    ASSERT_TRUE(map) << map.error().message;
    EXPECT_EQ(map->elevations[0].url, "../data/dem.tif");
    EXPECT_EQ(map->elevations[1].url, "D:/a b/c.tif");
    EXPECT_EQ(map->light.skyFile, "skies/noon.exr");
    const Result<TerrainModel> model = loadMap(*map, "/no/such/folder", "m.earth");
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->warnings.size(), 4u); // of the sky, the layers, and the map
    EXPECT_EQ(model->warnings[1].rfind("m.earth:2: left out <GDALElevation>: ", 0), 0u);
    EXPECT_EQ(model->warnings[1].find("drive"), std::string::npos);
    EXPECT_NE(model->warnings[1].find("/no/such/folder/../data/dem.tif"), std::string::npos);
    EXPECT_NE(model->warnings[2].find(": D:/a b/c.tif: no such file"), std::string::npos);
    EXPECT_NE(model->warnings[2].find("; the path names a drive of Windows"), std::string::npos);
}

TEST(EarthFiles, LightInAnyCase)
{
    const Result<EarthMap> map = parseEarth(
        "<map><GDALImage url='b.tif'/><Terrain_Light SUN_AZIMUTH='10'><Key_Light Azimuth='90' "
        "width='10' LOWEST='0' highest='20'/><Quality>best</Quality></Terrain_Light></map>",
        "m.earth");
    ASSERT_TRUE(map) << map.error().message;
    EXPECT_EQ(map->light.sky.sunAzimuth, 10.0);
    EXPECT_EQ(map->light.settings.quality, HorizonQuality::Best);
    ASSERT_EQ(map->light.sky.keyLights.size(), 1u);
    EXPECT_EQ(map->light.sky.keyLights[0].azimuth, 90.0);
}

TEST(EarthFiles, AnImageWithoutElevationIsLevel)
{
    const Result<EarthMap> map =
        parseEarth("<map><elevation name='gone' driver='gdal' url='no.tif'/>"
                   "<image driver='gdal' url='jacksboro_colour.tif'/></map>",
                   "m.earth");
    ASSERT_TRUE(map);
    const Result<TerrainModel> model = loadMap(*map, OTL_SOURCE_DIR "/samples/data", "m.earth");
    ASSERT_TRUE(model) << model.error().message;
    EXPECT_EQ(model->warnings.size(), 1u);
    EXPECT_EQ(model->node->getNumChildren(), 1u);
    // About 31 km x 32 km.
    EXPECT_NEAR(model->node->getBound().radius(), 21900.0, 500.0);
}

TEST(EarthFiles, AMapWithoutAnyReadableLayerIsAnEmptyScene)
{
    const Result<EarthMap> map =
        parseEarth("<map><elevation driver='gdal' url='no.tif'/></map>", "m.earth");
    ASSERT_TRUE(map);
    const Result<TerrainModel> model = loadMap(*map, "", "m.earth");
    ASSERT_TRUE(model) << model.error().message;
    EXPECT_EQ(model->warnings.size(), 2u);
    EXPECT_EQ(model->node->getNumChildren(), 0u);
}

// Expected: what osgEarth may draw and this reader does not is a warning, which every program
// shows; a notice is for what draws nothing, or was switched off by whoever wrote the map.
TEST(EarthFiles, WhateverMayDrawAndIsNotKnownIsAWarning)
{
    const std::pair<const char*, bool> elements[] = {
        {"<model driver='simple'><url>a.osgb</url></model>", true},
        {"<FeatureModel name='roads'/>", true},
        {"<mask driver='gdal' url='a.shp'/>", true},
        {"<ThreeDTiles/>", true},
        {"<XYZImage/>", true},
        {"<Options/>", false},
        {"<libraries>a;b</libraries>", false},
        {"<profile>global-geodetic</profile>", false},
        {"<viewpoints><time>1</time></viewpoints>", false},
        {"<extensions/>", false},
        {"<name>m</name>", false},
        {"<model visible='false'/>", false}};
    for (const auto& [element, isWarning] : elements)
    {
        const Result<EarthMap> map = parseEarth(
            std::string("<map>\n<GDALImage url='b.tif'/>\n") + element + "</map>", "m.earth");
        ASSERT_TRUE(map) << map.error().message;
        EXPECT_EQ(map->warnings.size(), isWarning ? 1u : 0u) << element;
        EXPECT_EQ(map->notes.size(), isWarning ? 0u : 1u) << element;
        for (const auto& list : {map->warnings, map->notes})
            for (const std::string& sentence : list)
                EXPECT_NE(sentence.find(" (line 3: "), std::string::npos) << sentence;
    }
}

// A key may stand as an attribute and as a child: whichever is not empty counts.
TEST(EarthFiles, AnEmptyKeyDoesNotHideTheOther)
{
    for (const char* layer :
         {"<elevation driver='gdal' url=''><url>a.tif</url></elevation>",
          "<elevation driver='gdal' url='a.tif'><url/></elevation>",
          "<elevation driver='gdal' URL=' ' url='a.tif'/>",
          "<elevation driver=''><driver>gdal</driver><url> </url><url>a.tif</url></elevation>"})
    {
        const Result<EarthMap> map = parseEarth(std::string("<map>") + layer + "</map>", "m.earth");
        ASSERT_TRUE(map) << layer << ": " << map.error().message;
        ASSERT_EQ(map->elevations.size(), 1u) << layer;
        EXPECT_EQ(map->elevations[0].url, "a.tif") << layer;
    }
}

// Expected: where a file is there and cannot be drawn, the reason is the error, with all else that
// was left out; the sample's heights are no picture.
TEST(EarthFiles, WhereNoFileCanBeDrawnTheErrorSaysWhy)
{
    const Result<EarthMap> map =
        parseEarth("<map>\n<elevation driver='gdal' url='no.tif'/>\n"
                   "<GDALImage url='jacksboro_90m.tif'/>\n<FeatureModel/></map>",
                   "m.earth");
    ASSERT_TRUE(map) << map.error().message;
    const Result<TerrainModel> model = loadMap(*map, OTL_SOURCE_DIR "/samples/data", "m.earth");
    ASSERT_FALSE(model);
    const std::string& said = model.error().message;
    EXPECT_EQ(said.rfind("m.earth: no layer could be read, left out: ", 0), 0u) << said;
    for (const char* part :
         {"<elevation driver=\"gdal\"> (line 2: ", "no.tif: no such file",
          "<GDALImage> (line 3: ", "needs 8 bits per channel", "<FeatureModel> (line 4: of a kind"})
        EXPECT_NE(said.find(part), std::string::npos) << said;
}
