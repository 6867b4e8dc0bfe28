#include <osgTerrainLight/Environment.h>
#include <osgTerrainLight/LightingHandler.h>
#include <osgTerrainLight/SunPosition.h>
#include <osgTerrainLight/TerrainLighting.h>

#include "io/ExrFile.h"
#include "scene/Scheduler.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/ScenePicture.h"
#include "support/SharedData.h"
#include "support/TestFolder.h"
#include "terrain/TerrainModel.h"

#include <osg/ApplicationUsage>
#include <osg/Geode>
#include <osg/MatrixTransform>
#include <osg/ShapeDrawable>
#include <osgDB/ReadFile>
#include <osgDB/Registry>
#include <osgDB/WriteFile>
#include <osgGA/EventQueue>
#include <osgGA/EventVisitor>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

using namespace osgTerrainLight;
namespace fs = std::filesystem;

namespace
{
const std::string dem = OTL_SOURCE_DIR "/samples/data/jacksboro_90m.tif";

osgDB::ReaderWriter::ReadResult read(const std::string& name, const std::string& options = "")
{
    useOwnPlugins();
    return osgDB::Registry::instance()->readNode(name, new osgDB::Options(options));
}

TerrainLighting* lightingOf(osgDB::ReaderWriter::ReadResult& result)
{
    return dynamic_cast<TerrainLighting*>(result.getNode());
}

/// A file in the test's folder.
std::string file(const std::string& name, const std::string& text)
{
    const fs::path path = testFolder() / name;
    std::ofstream(path, std::ios::binary) << text;
    return path.string();
}

class Actions : public osgGA::GUIActionAdapter
{
    void requestRedraw() override {}
    void requestContinuousUpdate(bool) override {}
    void requestWarpPointer(float, float) override {}
};
} // namespace

TEST(Plugin, ReadsADem)
{
    auto result = read(dem + ".terrainlight");
    TerrainLighting* lighting = lightingOf(result);
    ASSERT_TRUE(lighting) << result.message();
    EXPECT_EQ(lighting->getNumChildren(), 1u);
    EXPECT_TRUE(dynamic_cast<LightingHandler*>(lighting->getEventCallback()));
    // 402 x 343 cells of 0.075 km x 0.092 km, about 0.84 km in height.
    EXPECT_NEAR(lighting->getBound().radius(), 21800.0, 300.0);
}

TEST(Plugin, TakesOptions)
{
    auto result = read(dem + ".terrainlight",
                       "sun_azimuth=120 sun_elevation=12.5 azimuths=16 quality=draft exposure=-1 "
                       "light=sun sun_irradiance=1,2,3 sky_radiance=0.5 bounce_interval=4 "
                       "gloss=0.5 gloss_transfer=scalar");
    TerrainLighting* lighting = lightingOf(result);
    ASSERT_TRUE(lighting) << result.message();
    EXPECT_EQ(lighting->getSkyLight().sunAzimuth, 120.0);
    EXPECT_EQ(lighting->getSkyLight().sunElevation, 12.5);
    EXPECT_FALSE(lighting->getSkyLight().skyEnabled);
    EXPECT_EQ(lighting->getSkyLight().sunIrradiance, (Rgb{1.0f, 2.0f, 3.0f}));
    EXPECT_EQ(lighting->getSkyLight().skyRadiance, (Rgb{0.5f, 0.5f, 0.5f}));
    EXPECT_EQ(lighting->getSettings().azimuths, 16);
    EXPECT_EQ(lighting->getSettings().quality, HorizonQuality::Draft);
    EXPECT_EQ(lighting->getSettings().exposure, -1.0);
    EXPECT_EQ(lighting->getSettings().bounceInterval, 4);
    EXPECT_EQ(lighting->getSettings().gloss, 0.5);
    EXPECT_EQ(lighting->getSettings().glossTransfer, GlossTransfer::Scalar);
    auto lights = read(dem + ".terrainlight", "key_lights=300,30,20,50,6,4,2;80,60,-10,10 "
                                              "sky_harmonics=1,0,0.5,0");
    lighting = lightingOf(lights);
    ASSERT_TRUE(lighting) << lights.message();
    ASSERT_EQ(lighting->getSkyLight().keyLights.size(), 2u);
    EXPECT_EQ(lighting->getSkyLight().keyLights[0].radiance, (Rgb{6.0f, 4.0f, 2.0f}));
    EXPECT_EQ(lighting->getSkyLight().keyLights[1].lowest, -10.0);
    EXPECT_EQ(lighting->getSkyLight().keyLights[1].radiance, (Rgb{1.0f, 1.0f, 1.0f}));
    ASSERT_EQ(lighting->getSkyLight().skyHarmonics.size(), 4u);
    EXPECT_EQ(lighting->getSkyLight().skyHarmonics[2], (Rgb{0.5f, 0.5f, 0.5f}));
    auto off = read(dem + ".terrainlight", "light=off");
    EXPECT_FALSE(lightingOf(off)->getLightEnabled());
}

// Expected: the sentences of problems(), each once.
TEST(Plugin, SaysWhatHasNoEffect)
{
    Said said;
    auto lit = read(dem + ".terrainlight", "turbidity=5 sky_gain=2 bounces=1 albedo=0.9 gloss=0.5");
    ASSERT_TRUE(lightingOf(lit)) << lit.message();
    for (const char* sentence : {"turbidity has no effect with sky uniform",
                                 "sky-gain has no effect with sky uniform", "albedo + gloss = 1.4"})
        EXPECT_EQ(said.count(sentence), 1) << said.text();
}

TEST(Plugin, TakesSkies)
{
    ExrImage panorama;
    panorama.width = 16;
    panorama.height = 8;
    for (const char* name : {"R", "G", "B"})
        panorama.channels.push_back({name, std::vector<float>(128, 0.5f)});
    const std::string file = (testFolder() / "sky.exr").string();
    ASSERT_TRUE(writeExr(file, panorama).ok());

    auto clear = read(dem + ".terrainlight", "sky=clear turbidity=4 body_radius=6371000");
    TerrainLighting* lighting = lightingOf(clear);
    ASSERT_TRUE(lighting) << clear.message();
    EXPECT_EQ(lighting->getSkyLight().skyModel, SkyModel::Clear);
    EXPECT_EQ(lighting->getSkyLight().turbidity, 4.0);
    EXPECT_EQ(lighting->getSettings().bodyRadius, 6371000.0);
    // The later one holds, and none is hard light: nothing of a clear sky is left.
    auto none = read(dem + ".terrainlight", "sky_harmonics=1 sky=clear sky=none");
    EXPECT_FALSE(lightingOf(none)->getSkyLight().skyEnabled);
    EXPECT_EQ(lightingOf(none)->getSkyLight().skyModel, SkyModel::Uniform);
    EXPECT_TRUE(lightingOf(none)->getSkyLight().skyHarmonics.empty());

    // Of a map: from its own folder.
    const std::string map = (testFolder() / "map.earth").string();
    const auto write = [&](const std::string& keys)
    {
        std::ofstream(map) << "<map><elevation driver=\"gdal\"><url>" << fs::absolute(dem).string()
                           << "</url></elevation><terrain_light " << keys << "/></map>\n";
        return read(map + ".terrainlight");
    };
    auto lit = write("sky=\"sky.exr\" sky_heading=\"90\" sky_gain=\"2\"");
    lighting = lightingOf(lit);
    ASSERT_TRUE(lighting) << lit.message();
    ASSERT_TRUE(lighting->getSkyLight().environment);
    EXPECT_EQ(lighting->getSkyLight().environmentHeading, 90.0);
    EXPECT_EQ(lighting->getSkyLight().environmentGain, 2.0);
    EXPECT_FALSE(lighting->getSkyLight().sunEnabled);
    // A time has no sun to move, and says so.
    lighting->setTime(UtcTime());
    EXPECT_FALSE(lighting->getTime());
    auto timed = write("sky=\"sky.exr\" time=\"2024-06-20T12:00Z\"");
    ASSERT_TRUE(lightingOf(timed)) << timed.message(); // a warning, and the rest is drawn
    EXPECT_FALSE(lightingOf(timed)->getTime());
    EXPECT_TRUE(lightingOf(timed)->getSkyLight().environment);
    EXPECT_FALSE(lightingOf(timed)->getSkyLight().sunEnabled);
    // Through a file and back.
    const std::string saved = (testFolder() / "scene.osgt").string();
    ASSERT_TRUE(osgDB::writeNodeFile(*lighting, saved));
    osg::ref_ptr<osg::Node> node = osgDB::readRefNodeFile(saved);
    const auto* again = dynamic_cast<TerrainLighting*>(node.get());
    ASSERT_TRUE(again);
    ASSERT_TRUE(again->getSkyLight().environment);
    EXPECT_EQ(again->getSkyLight().environmentHeading, 90.0);
    EXPECT_EQ(again->getSkyLight().environmentGain, 2.0);
    ASSERT_TRUE(again->getPlace());
    EXPECT_NEAR(again->getPlace()->longitude, lighting->getPlace()->longitude, 1e-3);
    EXPECT_NEAR(again->getPlace()->latitude, lighting->getPlace()->latitude, 1e-3);
    // Place and time.
    auto noon = read(dem + ".terrainlight", "time=2024-06-20T12:00Z");
    ASSERT_TRUE(lightingOf(noon)) << noon.message();
    ASSERT_TRUE(osgDB::writeNodeFile(*lightingOf(noon), saved));
    node = osgDB::readRefNodeFile(saved);
    again = dynamic_cast<TerrainLighting*>(node.get());
    ASSERT_TRUE(again);
    ASSERT_TRUE(again->getTime());
    EXPECT_EQ(toString(*again->getTime()), toString(*lightingOf(noon)->getTime()));
    // One that is missing is left out, and the rest is drawn.
    auto missing = write("sky=\"nowhere.exr\"");
    lighting = lightingOf(missing);
    ASSERT_TRUE(lighting) << missing.message();
    EXPECT_FALSE(lighting->getSkyLight().environment);
    EXPECT_EQ(lighting->getNumChildren(), 1u);
}

TEST(Plugin, RefusesOptionsByName)
{
    const std::pair<const char*, const char*> bad[] = {
        {"sun_elevation=95", "sun_elevation = \"95\": needs a number, -90 ... 90 degrees"},
        {"sun_elevation=", "sun_elevation = \"\": needs a number"},
        {"sun_elevation=1x", "needs a number"},
        {"sun_azimuth=1,2", "needs a number"},
        {"azimuths=30", "a multiple of 4"},
        {"azimuths=nan", "azimuths = \"nan\""},
        {"quality=super", "needs draft, normal or best"},
        {"light=on", "needs off, sky, sun or both"},
        {"sun_irradiance=1,2", "one number or three"},
        {"sun_irradiance=1,2,-3", "0 ... 1e+06"},
        {"colour=red", "colour = \"red\": no such setting; needs one of azimuths"},
        {"cell_size=0", "cell_size = \"0\": needs a number of metres more than 0"},
        {"key_lights=1,2,3", "key light = \"1,2,3\": needs azimuth,width,lowest,highest"},
        {"key_lights=0,30,50,20", "needs lowest < highest"},
        {"key_lights=0,361,20,50", "width = 361 degrees: needs 0.1 ... 360"},
        {"sky_harmonics=1,2", "needs 1, 4, 9 or 16 coefficients"},
        {"fast", "reader option fast: needs NAME=VALUE"}};
    for (const auto& [option, message] : bad)
    {
        auto result = read(dem + ".terrainlight", option);
        EXPECT_FALSE(result.validNode()) << option;
        EXPECT_NE(result.message().find(message), std::string::npos)
            << option << ": " << result.message();
        EXPECT_NE(result.message().find("jacksboro_90m.tif"), std::string::npos);
    }
}

TEST(Plugin, TellsNotHandledFromNotFoundFromFailed)
{
    using Result = osgDB::ReaderWriter::ReadResult;
    useOwnPlugins();
    osgDB::ReaderWriter* reader =
        osgDB::Registry::instance()->getReaderWriterForExtension("terrainlight");
    ASSERT_TRUE(reader);
    EXPECT_EQ(reader->readNode("x.tif", nullptr).status(), Result::FILE_NOT_HANDLED);
    EXPECT_EQ(reader->readNode("no_such.tif.terrainlight", nullptr).status(),
              Result::FILE_NOT_FOUND);
    EXPECT_EQ(reader->readNode("no_such.earth", nullptr).status(), Result::FILE_NOT_FOUND);
    auto failed = reader->readNode(file("text.tif", "no raster") + ".terrainlight", nullptr);
    EXPECT_EQ(failed.status(), Result::ERROR_IN_READING_FILE);
    EXPECT_NE(failed.message().find("text.tif"), std::string::npos);
}

TEST(Plugin, WrapsAScene)
{
    useOwnPlugins();
    osg::ref_ptr<osg::Group> scene = new osg::Group;
    scene->setName("the scene");
    const std::string path = (testFolder() / "scene.osgt").string();
    ASSERT_TRUE(osgDB::writeNodeFile(*scene, path));
    auto result = read(path + ".terrainlight", "sun_azimuth=10 noRotation");
    TerrainLighting* lighting = lightingOf(result);
    ASSERT_TRUE(lighting) << result.message();
    EXPECT_EQ(lighting->getSkyLight().sunAzimuth, 10.0);
    ASSERT_EQ(lighting->getNumChildren(), 1u);
    EXPECT_EQ(lighting->getChild(0)->getName(), "the scene");
}

// Expected: one warning where the file holds several tiles that do not touch, none where it holds
// one, or tiles that share edges, as databases of VirtualPlanetBuilder do: these light one another.
TEST(Plugin, SaysThatTilesOfASceneAreLitAlone)
{
    OTL_NEED_GL(context);
    useOwnPlugins();
    for (const auto& [count, apart] : {std::pair{1, 50.0}, {2, 50.0}, {4, 50.0}, {4, 40.0}})
    {
        osg::ref_ptr<osg::Group> scene = new osg::Group;
        for (int i = 0; i < count; ++i)
        {
            osg::ref_ptr<osg::MatrixTransform> place =
                new osg::MatrixTransform(osg::Matrix::translate(apart * i, 0.0, 0.0));
            place->addChild(createTerrain(analytic::plane(5, 5, 10.0, 0.0)));
            scene->addChild(place);
        }
        const std::string path = (testFolder() / "tiles.osgb").string();
        ASSERT_TRUE(osgDB::writeNodeFile(*scene, path));
        Said said;
        auto result = read(path + ".terrainlight");
        TerrainLighting* lighting = lightingOf(result);
        ASSERT_TRUE(lighting) << result.message();
        ScenePicture picture(lighting, 100.0);
        picture.draw(6 + Scheduler::updatesToTellAlone);
        EXPECT_EQ(lighting->getTileCount(), static_cast<unsigned>(count));
        EXPECT_EQ(said.count("Each of them is lit alone"), count > 1 && apart > 40.0 ? 1 : 0)
            << said.text();
    }
}

TEST(Plugin, FindsFilesOnTheDataPathAndMapsOfStreams)
{
    useOwnPlugins();
    osg::ref_ptr<osgDB::Options> options = new osgDB::Options;
    options->getDatabasePathList().push_back(OTL_SOURCE_DIR "/samples/data");
    EXPECT_TRUE(osgDB::readRefNodeFile("jacksboro_90m.tif.terrainlight", options));
    EXPECT_EQ(options->getDatabasePathList().size(), 1u);

    osgDB::ReaderWriter* reader = osgDB::Registry::instance()->getReaderWriterForExtension("earth");
    ASSERT_TRUE(reader);
    std::istringstream good("<map><elevation driver='gdal' url='jacksboro_90m.tif'/></map>");
    EXPECT_TRUE(reader->readNode(good, options).validNode());
    std::istringstream bad("<map>\n<terrain_light x='1'/></map>");
    EXPECT_NE(reader->readNode(bad, options).message().find("map:2: <terrain_light> x"),
              std::string::npos);
}

TEST(Plugin, NamesFileAndReasonOfBadRasters)
{
    OTL_SKIP_WITHOUT_SHARED_DATA();
    const fs::path awkward = sharedData("awkward");
    const std::pair<const char*, const char*> bad[] = {
        {"text_named.tif", "no raster"},     {"empty.tif", "is empty"},
        {"truncated_everest.tif", ""},       {"rasterio_all-nodata.tif", "not a DEM"},
        {"rasterio_rotated.tif", "rotated"}, {"fuji_1x1.tif", "1 x 1 posts; needs at least 2 x 2"},
        {"fuji_600x1.tif", "needs at least"}};
    for (const auto& [name, reason] : bad)
    {
        auto result = read((awkward / name).string() + ".terrainlight");
        EXPECT_FALSE(result.validNode()) << name;
        EXPECT_NE(result.message().find(name), std::string::npos) << result.message();
        EXPECT_NE(result.message().find(reason), std::string::npos) << result.message();
    }
    std::size_t read_ = 0;
    for (const auto& entry : fs::directory_iterator(awkward)) // whatever else: no crash
        if (entry.path().extension() == ".tif" || entry.path().extension() == ".vrt" ||
            entry.path().extension() == ".asc")
            read_ += read(entry.path().string() + ".terrainlight").validNode() ? 1u : 0u;
    EXPECT_GT(read_, 5u);
    EXPECT_TRUE(read((awkward / "fuji_2x2.tif").string() + ".terrainlight").validNode());
}

TEST(Plugin, NamesARasterWithoutAnyHeight)
{
    const std::string path = file("void.asc", "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\n"
                                              "cellsize 10\nNODATA_value -9999\n"
                                              "-9999 -9999 -9999\n-9999 -9999 -9999\n");
    auto result = read(path + ".terrainlight");
    EXPECT_FALSE(result.validNode());
    EXPECT_NE(result.message().find("void.asc: holds no valid height"), std::string::npos)
        << result.message();
}

TEST(Plugin, PagesALargeRaster)
{
    std::ostringstream text;
    text << "ncols 3000\nnrows 30\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n";
    for (int row = 0; row < 30; ++row)
        for (int column = 0; column < 3000; ++column)
            text << (row < 2 ? -9999 : 100 + column % 2) << (column == 2999 ? '\n' : ' ');
    const std::string path = file("large.asc", text.str());
    Said said;
    auto result = read(path + ".terrainlight");
    TerrainLighting* lighting = lightingOf(result);
    ASSERT_TRUE(lighting) << result.message();
    EXPECT_EQ(said.count("averaged"), 0) << said.text();
    EXPECT_NEAR(lighting->getBound().radius(), 15000.0, 100.0);
    EXPECT_NEAR(lighting->getBound().center().z(), 100.5, 1.0) << "a void has a height";
}

TEST(Plugin, KeysChangeTheLightAndAreListed)
{
    osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    lighting->addEventCallback(new LightingHandler);
    osg::ref_ptr<osgGA::EventVisitor> visitor = new osgGA::EventVisitor;
    Actions actions;
    visitor->setActionAdapter(&actions);
    const auto press = [&](int key)
    {
        osg::ref_ptr<osgGA::GUIEventAdapter> event = new osgGA::GUIEventAdapter;
        event->setEventType(osgGA::GUIEventAdapter::KEYDOWN);
        event->setKey(key);
        visitor->reset();
        visitor->addEvent(event);
        lighting->accept(*visitor);
    };
    const SkyLight before = lighting->getSkyLight();
    press('r');
    EXPECT_EQ(lighting->getSkyLight().sunAzimuth, before.sunAzimuth + 5.0);
    press('R');
    press('u');
    EXPECT_EQ(lighting->getSkyLight().sunAzimuth, before.sunAzimuth);
    EXPECT_EQ(lighting->getSkyLight().sunElevation, before.sunElevation + 2.0);
    for (int i = 0; i < 200; ++i)
        press('U');
    EXPECT_EQ(lighting->getSkyLight().sunElevation, -90.0);
    press('x');
    EXPECT_EQ(lighting->getSettings().exposure, 0.5);
    press('X');
    press('X');
    EXPECT_EQ(lighting->getSettings().exposure, -0.5);
    press('k');
    EXPECT_TRUE(lighting->getSkyLight().skyEnabled && !lighting->getSkyLight().sunEnabled);
    press('k');
    EXPECT_TRUE(!lighting->getSkyLight().skyEnabled && lighting->getSkyLight().sunEnabled);
    press('k');
    EXPECT_TRUE(lighting->getSkyLight().skyEnabled && lighting->getSkyLight().sunEnabled);
    press('i');
    EXPECT_FALSE(lighting->getLightEnabled());

    const auto& listed = osg::ApplicationUsage::instance()->getKeyboardMouseBindings();
    for (const char* key : {"r", "R", "u", "U", "x", "X", "i", "k"})
        EXPECT_TRUE(listed.count(key)) << key;
}
