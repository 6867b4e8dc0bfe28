#include "io/EarthFile.h"
#include "scene/TerrainModel.h"

#include <gtest/gtest.h>

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
    const TerrainModel model = loadMap(*map, path.parent_path().string(), path.string());
    for (const auto& list : {model.warnings, model.notes})
        for (const std::string& sentence : list)
            said += sentence + "\n";
    return said;
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
        const TerrainModel model = loadMap(*map, path.parent_path().string(), path.string());
        EXPECT_TRUE(model.warnings.empty()) << model.warnings.front();
        EXPECT_EQ(model.node->getNumChildren(), 1u) << path;
    }
}

TEST(EarthFiles, EveryBrokenMapSaysWhatIsExpected)
{
    const std::vector<fs::path> maps = mapsIn(OTL_SOURCE_DIR "/earth_files/errors");
    ASSERT_FALSE(maps.empty());
    for (const fs::path& path : maps)
    {
        std::ifstream file(fs::path(path).replace_extension(".expected"));
        std::string expected;
        ASSERT_TRUE(std::getline(file, expected)) << path << " has no message beside it";
        const std::string said = saidOf(path);
        EXPECT_NE(said.find(expected), std::string::npos) << path << " says: " << said;
    }
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
    ASSERT_EQ(map->notes.size(), 1u);
    EXPECT_EQ(map->notes[0], "m.earth: skipped, as this reader does not know it: "
                             "<image driver=\"tms\"> (line 5), <options> (line 8)");
}

TEST(EarthFiles, AnImageWithoutElevationIsLevel)
{
    const Result<EarthMap> map =
        parseEarth("<map><elevation name='gone' driver='gdal' url='no.tif'/>"
                   "<image driver='gdal' url='jacksboro_colour.tif'/></map>",
                   "m.earth");
    ASSERT_TRUE(map);
    const TerrainModel model = loadMap(*map, OTL_SOURCE_DIR "/samples/data", "m.earth");
    EXPECT_EQ(model.warnings.size(), 1u);
    EXPECT_EQ(model.node->getNumChildren(), 1u);
    // About 31 km x 32 km.
    EXPECT_NEAR(model.node->getBound().radius(), 21900.0, 500.0);
}

TEST(EarthFiles, AMapWithoutAnyReadableLayerIsAnEmptyScene)
{
    const Result<EarthMap> map =
        parseEarth("<map><elevation driver='gdal' url='no.tif'/></map>", "m.earth");
    ASSERT_TRUE(map);
    const TerrainModel model = loadMap(*map, "", "m.earth");
    EXPECT_EQ(model.warnings.size(), 2u);
    EXPECT_EQ(model.node->getNumChildren(), 0u);
}
