// The sun by time and place in a scene: settings, reader options, keys and the clock on screen.
#include <osgTerrainLight/LightingHandler.h>
#include <osgTerrainLight/TerrainLighting.h>

#include "io/EarthFile.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/ScenePicture.h"
#include "terrain/TerrainModel.h"

#include <osg/ApplicationUsage>
#include <osgDB/Registry>
#include <osgGA/EventVisitor>
#include <osgViewer/Viewer>

#include <gtest/gtest.h>

#include <chrono>

using namespace osgTerrainLight;

namespace
{
const std::string dem = OTL_SOURCE_DIR "/samples/data/jacksboro_90m.tif";
// Of the raster's middle, as gdalinfo says.
const EarthPlace jacksboro{-84.2458333, 36.5895833, 0.0};

UtcTime at(const std::string& text)
{
    UtcTime time;
    EXPECT_EQ(readUtcTime(text, time), "");
    return time;
}

void expectSunOf(const TerrainLighting& lighting, UtcTime time, const EarthPlace& place)
{
    const SunPosition sun = sunPosition(time, place);
    EXPECT_NEAR(lighting.getSkyLight().sunAzimuth, sun.azimuth, 1e-5);
    EXPECT_NEAR(lighting.getSkyLight().sunElevation, sun.elevation, 1e-5);
    ASSERT_TRUE(lighting.getTime());
    EXPECT_EQ(*lighting.getTime(), time);
}

/// The events of a viewer's window, one by one.
class Window
{
public:
    explicit Window(TerrainLighting& lighting) : _lighting(lighting)
    {
        _visitor->setActionAdapter(&_actions);
    }
    void press(int key) { send(osgGA::GUIEventAdapter::KEYDOWN, key); }
    /// A frame that many seconds after the last event.
    void frame(double seconds)
    {
        _now += seconds;
        send(osgGA::GUIEventAdapter::FRAME, 0);
    }
    int redraws() const { return _actions.count; }

private:
    struct Actions : osgGA::GUIActionAdapter
    {
        int count = 0;
        void requestRedraw() override { ++count; }
        void requestContinuousUpdate(bool) override {}
        void requestWarpPointer(float, float) override {}
    };
    void send(osgGA::GUIEventAdapter::EventType type, int key)
    {
        osg::ref_ptr<osgGA::GUIEventAdapter> event = new osgGA::GUIEventAdapter;
        event->setEventType(type);
        event->setKey(key);
        event->setTime(_now);
        _visitor->reset();
        _visitor->addEvent(event);
        _lighting.accept(*_visitor);
    }

    TerrainLighting& _lighting;
    osg::ref_ptr<osgGA::EventVisitor> _visitor = new osgGA::EventVisitor;
    Actions _actions;
    double _now = 100.0;
};
} // namespace

TEST(Day, TheSunFollowsTimeAndPlaceUntilItIsMoved)
{
    osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    const UtcTime time = at("2024-06-21T15:00Z");
    {
        Said said;
        lighting->setTime(time);
        EXPECT_EQ(said.count("time not set: the terrain's place on Earth is not known"), 1);
        EXPECT_FALSE(lighting->getTime());
        lighting->setPlace({0.0, 95.0, 0.0});
        EXPECT_EQ(said.count("place not set: latitude = 95 degrees: needs -90 ... 90"), 1);
        EXPECT_FALSE(lighting->getPlace());
    }
    lighting->setPlace(jacksboro);
    lighting->setTime(time);
    expectSunOf(*lighting, time, jacksboro);
    lighting->setPlace({11.5, 48.1, 0.0}); // the same moment elsewhere
    expectSunOf(*lighting, time, {11.5, 48.1, 0.0});
    SkyLight sky = lighting->getSkyLight();
    sky.skyRadiance = {1.0f, 1.0f, 1.0f};
    lighting->setSkyLight(sky);
    EXPECT_TRUE(lighting->getTime()) << "only the sun's place is the time's";
    const osg::ref_ptr<TerrainLighting> copy = osg::clone(lighting.get());
    EXPECT_EQ(copy->getTime(), lighting->getTime());
    EXPECT_TRUE(copy->getPlace());
    sky.sunAzimuth += 1.0;
    lighting->setSkyLight(sky);
    EXPECT_FALSE(lighting->getTime());
    Said said;
    lighting->setTime(at("2100-12-31T00:00") + std::chrono::hours(24 * 365));
    EXPECT_EQ(said.count("time not set: \"2101-12-31T00:00:00Z\": needs a time"), 1);
}

TEST(Day, KeysRunIt)
{
    osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    lighting->addEventCallback(new LightingHandler);
    lighting->setPlace(jacksboro);
    const UtcTime start = at("2024-06-21T15:00Z");
    lighting->setTime(start);
    Window window(*lighting);
    using namespace std::chrono;
    window.press('j');
    expectSunOf(*lighting, start + hours(1), jacksboro);
    window.press('J');
    window.press('y');
    expectSunOf(*lighting, start + hours(24), jacksboro);
    window.press('Y');
    expectSunOf(*lighting, start, jacksboro);

    window.frame(0.5);
    expectSunOf(*lighting, start, jacksboro); // stands still
    window.press('d');
    const int before = window.redraws();
    window.frame(0.5); // ten minutes a second
    expectSunOf(*lighting, start + minutes(5), jacksboro);
    EXPECT_GT(window.redraws(), before) << "the next frame must come by itself";
    window.press('n');
    window.frame(0.5);
    expectSunOf(*lighting, start + minutes(15), jacksboro);
    window.press('N');
    window.press('N');
    window.frame(0.5);
    expectSunOf(*lighting, start + seconds(15 * 60 + 150), jacksboro);
    window.frame(30.0); // a hung window counts for a second
    expectSunOf(*lighting, start + seconds(15 * 60 + 450), jacksboro);
    window.press('d');
    window.frame(0.5);
    expectSunOf(*lighting, start + seconds(15 * 60 + 450), jacksboro);

    // The sun moved by hand stops the day.
    window.press('d');
    window.press('r');
    EXPECT_FALSE(lighting->getTime());
    const double azimuth = lighting->getSkyLight().sunAzimuth;
    window.frame(0.5);
    EXPECT_EQ(lighting->getSkyLight().sunAzimuth, azimuth);
    // And the next press starts it with the time that it is.
    window.press('d');
    ASSERT_TRUE(lighting->getTime());
    EXPECT_LT(std::abs(duration_cast<seconds>(*lighting->getTime() - system_clock::now()).count()),
              60);

    const auto& listed = osg::ApplicationUsage::instance()->getKeyboardMouseBindings();
    for (const char* key : {"d", "n", "N", "j", "J", "y", "Y"})
        EXPECT_TRUE(listed.count(key)) << key;
}

TEST(Day, KeysWithoutAPlaceSayWhatIsNeeded)
{
    osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    lighting->addEventCallback(new LightingHandler);
    const double azimuth = lighting->getSkyLight().sunAzimuth;
    Window window(*lighting);
    Said said;
    window.press('d');
    EXPECT_EQ(said.count("needs setPlace() (reader option place=LONGITUDE,LATITUDE)"), 1);
    window.frame(0.5);
    EXPECT_EQ(lighting->getSkyLight().sunAzimuth, azimuth);
}

TEST(Day, PluginTakesTimeAndPlace)
{
    useOwnPlugins();
    const auto read = [](const std::string& name, const std::string& options)
    { return osgDB::Registry::instance()->readNode(name, new osgDB::Options(options)); };
    const auto lightingOf = [](osgDB::ReaderWriter::ReadResult& result)
    { return dynamic_cast<TerrainLighting*>(result.getNode()); };
    const UtcTime time = at("2024-06-21T15:00Z");

    auto result = read(dem + ".terrainlight", "time=2024-06-21T17:00+02:00");
    ASSERT_TRUE(lightingOf(result)) << result.message();
    expectSunOf(*lightingOf(result), time, jacksboro);

    result = read(dem + ".terrainlight", "place=11.5,48.1 time=2024-06-21T15:00Z");
    ASSERT_TRUE(lightingOf(result)) << result.message();
    expectSunOf(*lightingOf(result), time, {11.5, 48.1, 0.0});

    result = read(dem + ".terrainlight", "time=2024-06-21T15:00Z sun_azimuth=120");
    ASSERT_TRUE(lightingOf(result)) << result.message();
    EXPECT_EQ(lightingOf(result)->getSkyLight().sunAzimuth, 120.0) << "the later one holds";
    EXPECT_FALSE(lightingOf(result)->getTime());
    ASSERT_TRUE(lightingOf(result)->getPlace()) << "for the keys";
    EXPECT_NEAR(lightingOf(result)->getPlace()->latitude, jacksboro.latitude, 1e-6);

    const std::pair<const char*, const char*> bad[] = {
        {"time=noon", "time = \"noon\": needs a time YYYY-MM-DDThh:mm"},
        {"place=1", "place = \"1\": needs longitude,latitude"},
        {"place=1,91", "latitude = 91 degrees: needs -90 ... 90"}};
    for (const auto& [option, message] : bad)
    {
        result = read(dem + ".terrainlight", option);
        EXPECT_FALSE(result.validNode()) << option;
        EXPECT_NE(result.message().find(message), std::string::npos)
            << option << ": " << result.message();
    }
}

TEST(Day, TerrainWithoutAPlaceNeedsOne)
{
    LightParameters light;
    light.time = at("2024-06-21T15:00Z");
    osg::ref_ptr<TerrainLighting> node = new TerrainLighting;
    const Status refused = setTimeAndPlace(*node, light, analytic::plane(3, 3, 10.0, 0.0));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message,
              "time = 2024-06-21T15:00:00Z: the raster has no CRS that tells its place: needs "
              "place, LONGITUDE,LATITUDE");
    light.place = jacksboro;
    EXPECT_TRUE(setTimeAndPlace(*node, light, std::nullopt));
    expectSunOf(*node, *light.time, jacksboro);

    const Result<EarthMap> map = readEarthFile(OTL_SOURCE_DIR "/earth_files/solstice.earth");
    ASSERT_TRUE(map) << map.error().message;
    const Result<TerrainModel> model =
        loadMap(*map, OTL_SOURCE_DIR "/earth_files", "solstice.earth");
    ASSERT_TRUE(model) << model.error().message;
    expectSunOf(*model->node, at("2024-06-20T23:30Z"), jacksboro);
}

TEST(Day, TheClockIsOnScreenWhileThereIsATime)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    lighting->setPlace(jacksboro);
    ScenePicture picture(lighting, 100.0); // nothing but blue
    const auto whiteTexels = [&](int fromRow, int toRow)
    {
        int count = 0;
        for (int i = fromRow * ScenePicture::size; i < toRow * ScenePicture::size; ++i)
            count += picture.pixels()[static_cast<std::size_t>(4 * i)] > 200;
        return count;
    };
    lighting->addEventCallback(new LightingHandler);
    picture.draw(2);
    EXPECT_EQ(whiteTexels(0, ScenePicture::size), 0) << "no time, no clock";
    lighting->setTime(at("2024-06-21T15:00Z"));
    picture.draw(2);
    // Two lines of 20 pixels, in the lower half. The picture has room for ten letters a line, each
    // with some strokes two pixels wide; measured 49.
    EXPECT_GT(whiteTexels(0, ScenePicture::size / 2), 20);
    EXPECT_EQ(whiteTexels(ScenePicture::size / 2, ScenePicture::size), 0);
    const std::vector<unsigned char> before = picture.pixels();
    picture.draw(2);
    EXPECT_EQ(picture.pixels(), before);
    lighting->setTime(at("2035-08-19T15:38Z")); // the date is what so small a picture shows
    picture.draw(2);
    EXPECT_NE(picture.pixels(), before);
    lighting->removeEventCallback(lighting->getEventCallback());
    picture.draw(2);
    EXPECT_EQ(whiteTexels(0, ScenePicture::size), 0);
}

// Expected: added to a viewer a handler changes the lighting that it was given, and nothing once
// that is gone.
TEST(Day, AViewersHandlerChangesTheLightingThatItWasGiven)
{
    osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    lighting->setPlace(jacksboro);
    const UtcTime start = at("2024-06-21T15:00Z");
    lighting->setTime(start);
    osgViewer::Viewer viewer;
    const osg::ref_ptr<LightingHandler> handler = new LightingHandler(lighting);
    const auto press = [&]
    {
        const osg::ref_ptr<osgGA::GUIEventAdapter> event = new osgGA::GUIEventAdapter;
        event->setEventType(osgGA::GUIEventAdapter::KEYDOWN);
        event->setKey('j');
        // As Viewer::eventTraversal() does.
        return handler->handle(*event, viewer, nullptr, nullptr);
    };
    EXPECT_TRUE(press());
    expectSunOf(*lighting, start + std::chrono::hours(1), jacksboro);
    lighting = nullptr;
    EXPECT_FALSE(press());
}
