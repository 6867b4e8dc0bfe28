// Models that a map places on its terrain: what is read of them, where they stand, and what their
// light is.
#include "io/EarthFile.h"
#include "io/InputFiles.h"
#include "support/GlContext.h"
#include "support/MapTransform.h"
#include "support/MemoryRaster.h"
#include "support/ScenePicture.h"
#include "support/TestFolder.h"
#include "terrain/TerrainModel.h"
#include <osgTerrainLight/PlacedObject.h>

#include <gtest/gtest.h>
#include <osg/ComputeBoundsVisitor>
#include <osg/LOD>
#include <osg/MatrixTransform>
#include <osg/NodeVisitor>
#include <osg/ProxyNode>
#include <osg/Transform>
#include <osgDB/DatabasePager>
#include <osgDB/WriteFile>

#include <OpenThreads/Thread>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

using namespace osgTerrainLight;

namespace
{
const std::string folder = OTL_SOURCE_DIR "/earth_files";
const std::string house = OTL_SOURCE_DIR "/earth_files/data/house.osgt";
constexpr double pi = 3.14159265358979323846;

Result<EarthMap> mapWith(const std::string& elements, const std::string& url = "a.tif")
{
    return parseEarth("<map>\n<elevation driver='gdal' url='" + url + "'/>\n" + elements + "</map>",
                      "m.earth");
}

TerrainModel modelOf(const std::string& elements, const std::string& url)
{
    const Result<EarthMap> map = mapWith(elements, url);
    EXPECT_TRUE(map) << (map ? "" : map.error().message);
    Result<TerrainModel> model =
        map ? loadMap(*map, folder, "m.earth") : Result<TerrainModel>(map.error());
    EXPECT_TRUE(model) << (model ? "" : model.error().message);
    return model ? *model : TerrainModel{};
}

std::string saidBy(const TerrainModel& model)
{
    std::string said;
    for (const auto& list : {model.warnings, model.notes})
        for (const std::string& sentence : list)
            said += sentence + "\n";
    return said;
}

/// An object, and where its frame lies in that of the terrain.
struct Placed
{
    osg::ref_ptr<PlacedObject> object;
    osg::Matrixd toScene;
};

std::vector<Placed> objectsIn(const TerrainModel& model)
{
    struct Finder : osg::NodeVisitor
    {
        Finder() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
        void apply(osg::Group& group) override
        {
            if (auto* object = dynamic_cast<PlacedObject*>(&group))
                found.push_back({object, osg::computeLocalToWorld(getNodePath())});
            traverse(group);
        }
        std::vector<Placed> found;
    };
    Finder finder;
    if (model.node)
        model.node->accept(finder);
    return finder.found;
}

void expectNear(const osg::Vec3d& found, const osg::Vec3d& wanted, double tolerance)
{
    EXPECT_NEAR(found.x(), wanted.x(), tolerance);
    EXPECT_NEAR(found.y(), wanted.y(), tolerance);
    EXPECT_NEAR(found.z(), wanted.z(), tolerance);
}

/// 61 × 41 posts of 10 m around 500000, 4000000 in UTM 33, where grid north is true: a plane, which
/// is bilinear between posts.
double planeAt(double x, double y)
{
    return 300.0 + 0.2 * (x - 500000.0) - 0.1 * (y - 4000000.0);
}
std::string plane()
{
    return rasterOfPlaces(61, 41, {499695, 10, 0, 4000205, 0, -10}, planeAt);
}

std::string houseAt(const std::string& place, const std::string& keys = "")
{
    return "<model name='h' url='" + house + "' " + keys + ">" + place + "</model>";
}
} // namespace

// Expected: the same model in every spelling; pi / 6 is 30 degrees and 2000 m are 2 km.
TEST(MapModels, InEverySpelling)
{
    for (const char* text :
         {"<model name='m' url='a/b.osgb' heading='30' scale='2' min_range='5' max_range='2000'>"
          "<location long='11.5' lat='48.25' hat='7'/></model>",
          "<Model Name='m' Heading='0.52359877559829882rad'><URL>a\\b.osgb</URL><Location "
          "lat='48.25'"
          " long='11.5' alt='7' mode='relative'/><scale>2</scale><min_range>5</min_range>"
          "<max_range>2km</max_range></Model>",
          "<ModelLayer name='m' url='a/b.osgb' orientation='30' scale='2 2 2' min_range='5m' "
          "max_range='2km'><position x='11.5' y='48.25' srs='wgs84' z='7' "
          "mode='relative_to_terrain'/></ModelLayer>",
          "<model driver='simple' name='m' url='a/b.osgb' mode='relative' min_range='5' "
          "max_range='2000'><location>11.5 48.25 7</location><orientation>30, 0, 0</orientation>"
          "<scale x='2' y='2' z='2'/></model>",
          "<model name='m' url='a/b.osgb' long='11.5' lat='48.25' hat='7m' scale='2' "
          "heading='30deg'"
          " min_range='5' max_range='2000'/>",
          "<annotations><model name='m' min_range='5' max_range='2000'><position><lon>11.5</lon>"
          "<lat>48.25</lat><hat>7</hat></position><style type='text/css'>model: \"a/b.osgb\"; "
          "model-scale: 2; model-heading: 30;</style></model></annotations>",
          "<external><Annotations><model name='m' min_range='5' max_range='2000'><position "
          "long='11.5' lat='48.25' hat='7'/><style>m { model: a/b.osgb; model-scale: 2;\n"
          "model-heading: 30 }</style></model></Annotations></external>"})
    {
        const Result<EarthMap> map = mapWith(text);
        ASSERT_TRUE(map) << map.error().message;
        ASSERT_EQ(map->models.size(), 1u)
            << text << (map->warnings.empty() ? "" : map->warnings[0]);
        EXPECT_TRUE(map->warnings.empty() && map->notes.empty())
            << text << (map->notes.empty() ? "" : map->notes[0]);
        const EarthModel& model = map->models[0];
        EXPECT_EQ(model.name, "m");
        EXPECT_EQ(model.url, "a/b.osgb") << text;
        EXPECT_EQ(model.line, 3);
        EXPECT_NEAR(model.place.x, 11.5, 1.0e-9) << text;
        EXPECT_NEAR(model.place.y, 48.25, 1.0e-9) << text;
        EXPECT_EQ(model.height, 7.0) << text;
        EXPECT_FALSE(model.isAbsolute) << text;
        EXPECT_NEAR(model.heading, 30.0, 1.0e-9) << text;
        EXPECT_EQ(model.scales, (std::array<double, 3>{2.0, 2.0, 2.0})) << text;
        EXPECT_EQ(model.minRange, 5.0) << text;
        EXPECT_EQ(model.maxRange, 2000.0) << text;
    }
}

// Expected: as GeoPoint of osgEarth takes its keys (hat is above the ground, alt and z are absolute
// unless mode says otherwise), but for a height of 0 without mode.
TEST(MapModels, HeightsAreRelativeOrAbsoluteAsInOsgEarth)
{
    const struct
    {
        const char* keys;
        double height;
        bool isAbsolute;
    } places[] = {{"", 0.0, false},
                  {"alt='0'", 0.0, false},
                  {"alt='0' mode='absolute'", 0.0, true},
                  {"mode='absolute'", 0.0, true},
                  {"alt='9'", 9.0, true},
                  {"z='9'", 9.0, true},
                  {"hat='9'", 9.0, false},
                  {"hat='9' mode='absolute'", 9.0, true},
                  {"alt='9' Mode='Relative'", 9.0, false},
                  {"alt='3ft' mode='relative_to_terrain'", 0.9144, false}};
    for (const auto& [keys, height, isAbsolute] : places)
    {
        const Result<EarthMap> map = mapWith(
            std::string("<model url='a.osgb'><position long='1' lat='2' ") + keys + "/></model>");
        ASSERT_TRUE(map && map->models.size() == 1u) << keys;
        EXPECT_NEAR(map->models[0].height, height, 1.0e-9) << keys;
        EXPECT_EQ(map->models[0].isAbsolute, isAbsolute) << keys;
    }
}

// Expected: a model with a wrong value, without a place or without a file is left out with its
// line, the key, the value and what is needed. The rest of the map is read.
TEST(MapModels, WrongValuesLeaveTheModelOut)
{
    const std::string at = "<position long='1' lat='2'/>";
    const std::pair<std::string, const char*> wrongs[] = {
        {"<model name='m' url='a.osgb'/>", "has no place; needs long and lat, or x and y"},
        {"<model name='m'>" + at + "</model>", "has no url"},
        {"<model name='m' url='http://h/a.osgb'>" + at + "</model>",
         "its model is on a network; needs a file"},
        {"<model name='m' url='a.osgb'><position long='1' lat='91'/></model>",
         "lat = \"91\": needs degrees, -90 ... 90"},
        {"<model name='m' url='a.osgb'><position srs='nowhere' x='1' y='2'/></model>",
         "srs = \"nowhere\": needs a CRS that PROJ knows"},
        {"<model name='m' url='a.osgb'><location>1 north</location></model>",
         "location = \"1 north\": needs long and lat, or two or three numbers"},
        {"<model name='m' url='a.osgb'><location>1</location></model>", "location = \"1\": needs"},
        {"<model name='m' url='a.osgb'><position long='1' lat='2' alt='high'/></model>",
         "alt = \"high\": needs a height in metres"},
        {"<model name='m' url='a.osgb'><position long='1' lat='2' mode='up'/></model>",
         "mode = \"up\": needs relative, relative_to_terrain or absolute"},
        {"<model name='m' url='a.osgb' heading='east'>" + at + "</model>",
         "heading = \"east\": needs degrees, -720 ... 720"},
        {"<model name='m' url='a.osgb' orientation='1 2 3 4'>" + at + "</model>",
         "orientation = \"1 2 3 4\": needs heading, pitch and roll"},
        {"<model name='m' url='a.osgb' scale='0'>" + at + "</model>",
         "scale = \"0\": needs a number, 1e-6 ... 1e6"},
        {"<model name='m' url='a.osgb' scale='1 2'>" + at + "</model>", "scale = \"1 2\": needs"},
        {"<model name='m' url='a.osgb'><scale x='-1'/>" + at + "</model>",
         "scale x = \"-1\": needs"},
        {"<model name='m' url='a.osgb' min_range='9' max_range='3'>" + at + "</model>",
         "max_range = \"3\": needs more than min_range"},
        {"<model name='m'>" + at + "<style>model: a.osgb; model-scale: big</style></model>",
         "model-scale = \"big\": needs a number"},
        {"<annotations><label name='m'>" + at + "</label></annotations>",
         "of a kind that is not known here"},
        {"<model name='m' driver='feature_geom' url='a.shp'/>",
         "of a kind that is not known here"}};
    for (const auto& [text, wanted] : wrongs)
    {
        const Result<EarthMap> map = mapWith(text);
        ASSERT_TRUE(map) << map.error().message;
        EXPECT_TRUE(map->models.empty()) << text;
        EXPECT_EQ(map->elevations.size(), 1u);
        ASSERT_EQ(map->warnings.size(), 1u) << text;
        const std::string& said = map->warnings[0];
        EXPECT_EQ(said.rfind("m.earth: left out: <", 0), 0u) << said;
        EXPECT_NE(said.find("name=\"m\"> (line 3: "), std::string::npos) << said;
        EXPECT_NE(said.find(wanted), std::string::npos) << said;
    }
}

// Expected: of annotations the models are read and all others named; a model is read where only
// some of its keys are, and the others are named; those that are switched off are named as such.
TEST(MapModels, WhatIsNotReadIsNamed)
{
    const Result<EarthMap> map = mapWith(
        "<annotations name='a'>\n<label text='x'/>\n<model name='m' url='a.osgb' lighting='no'>"
        "<position long='1' lat='2' vdatum='egm96'/><local_offset x='1'/><icon>i.png</icon>"
        "<style>model-scale: auto; text-fill: #ff0000; icon: \"x.png\";</style></model>\n"
        "<Feature name='f'/></annotations>\n<model name='off' url='b.osgb' visible='no'/>\n"
        "<Annotations open='no'><model url='c.osgb'/></Annotations>");
    ASSERT_TRUE(map) << map.error().message;
    ASSERT_EQ(map->models.size(), 1u);
    ASSERT_EQ(map->warnings.size(), 1u);
    EXPECT_EQ(map->warnings[0], "m.earth: left out: <label> (line 4: of a kind that is not known "
                                "here), <Feature name=\"f\"> (line 6: of a kind that is not known "
                                "here)");
    ASSERT_EQ(map->notes.size(), 1u);
    EXPECT_EQ(
        map->notes[0],
        "m.earth: skipped: keys of <model name=\"m\"> (line 5: not read here: style "
        "model-scale: auto, style text-fill: #ff0000, style icon: \"x.png\", location vdatum, "
        "lighting, local_offset, icon), <model name=\"off\"> (line 7: visible is no), "
        "<Annotations> (line 8: open is no)");
}

// Expected: metres of the map from its middle, the plane's height there, and the same place by its
// longitude and latitude.
TEST(MapModels, StandOnTheGroundOfAMapInMetres)
{
    double longitude = 500123.0, latitude = 3999941.0;
    ASSERT_TRUE(transformation("EPSG:32633", "EPSG:4326")->Transform(1, &longitude, &latitude));
    char degrees[200];
    std::snprintf(degrees, sizeof degrees, "long='%.12f' lat='%.12f'", longitude, latitude);
    for (const std::string& place :
         {std::string("<location>500123 3999941</location>"),
          std::string("<position x='500123' y='3999941'/>"),
          std::string("<position srs='EPSG:32633' x='500123' y='3999941'/>"),
          "<position " + std::string(degrees) + "/>"})
    {
        const TerrainModel model = modelOf(houseAt(place), plane());
        EXPECT_EQ(saidBy(model), "") << place;
        const std::vector<Placed> objects = objectsIn(model);
        ASSERT_EQ(objects.size(), 1u) << place;
        EXPECT_EQ(objects[0].object->getName(), "h");
        expectNear(objects[0].toScene.getTrans(), {123.0, -59.0, planeAt(500123.0, 3999941.0)},
                   0.002);
    }
    for (const auto& [height, z] :
         {std::pair<const char*, double>{"hat='2.5'", planeAt(500123.0, 3999941.0) + 2.5},
          {"alt='450'", 450.0},
          {"alt='-3' mode='relative'", planeAt(500123.0, 3999941.0) - 3.0}})
    {
        const std::vector<Placed> objects = objectsIn(modelOf(
            houseAt(std::string("<position x='500123' y='3999941' ") + height + "/>"), plane()));
        ASSERT_EQ(objects.size(), 1u) << height;
        EXPECT_NEAR(objects[0].toScene.getTrans().z(), z, 0.002) << height;
    }
}

// Expected: on a post of the DEM its own height, halfway between two the mean, at the metres that
// terrain in degrees is drawn with: steps of longitude as long as in its middle.
TEST(MapModels, StandOnTheGroundOfAMapInDegrees)
{
    const auto heightAt = [](double x, double y)
    { return 1000.0 * (x - 10.0) + 500.0 * (y - 47.0); };
    const std::string url =
        rasterOfPlaces(41, 61, {9.9795, 0.001, 0, 47.0305, 0, -0.001}, heightAt, "EPSG:4326");
    const TerrainModel model =
        modelOf(houseAt("<location long='10.012' lat='46.988'/>") +
                    houseAt("<location>10.0125 46.988</location>", "heading='360'"),
                url);
    EXPECT_EQ(saidBy(model), "");
    const std::vector<Placed> objects = objectsIn(model);
    ASSERT_EQ(objects.size(), 2u);
    // Radii of curvature of WGS 84 at 47 degrees (Snyder 1987, eq. 4-18 and 4-20).
    const double sine = std::sin(47.0 * pi / 180.0), cosine = std::cos(47.0 * pi / 180.0);
    const double e2 = 0.00669437999014, a = 6378137.0, w = 1.0 - e2 * sine * sine;
    const double metresEast = a / std::sqrt(w) * cosine * pi / 180.0;
    const double metresNorth = a * (1.0 - e2) / std::pow(w, 1.5) * pi / 180.0;
    expectNear(objects[0].toScene.getTrans(), {0.012 * metresEast, -0.012 * metresNorth, 6.0},
               0.05);
    expectNear(objects[1].toScene.getTrans(), {0.0125 * metresEast, -0.012 * metresNorth, 6.5},
               0.05);
    // North of a map in degrees is true: the door looks north.
    expectNear(osg::Matrixd::transform3x3(osg::Vec3d(0.0, 1.0, 0.0), objects[1].toScene),
               {0.0, 1.0, 0.0}, 1.0e-9);
}

// Expected: the height of its own posts, though what is drawn first has one of every 16.
TEST(MapModels, StandOnTheGroundOfPagedTerrain)
{
    const auto heightAt = [](double x, double y)
    { return 400.0 + 30.0 * std::sin(x / 35.0) * std::cos(y / 50.0); };
    const std::string url = rasterOfPlaces(2301, 61, {499995, 10, 0, 4000605, 0, -10}, heightAt);
    const TerrainModel model = modelOf(houseAt("<location>513370 4000210</location>") +
                                           houseAt("<location>513375 4000210</location>"),
                                       url);
    EXPECT_EQ(saidBy(model).find("left out"), std::string::npos) << saidBy(model);
    const std::vector<Placed> objects = objectsIn(model);
    ASSERT_EQ(objects.size(), 2u);
    const double onPost = heightAt(513370.0, 4000210.0);
    EXPECT_NEAR(objects[0].toScene.getTrans().z(), onPost, 0.001);
    EXPECT_NEAR(objects[1].toScene.getTrans().z(), 0.5 * (onPost + heightAt(513380.0, 4000210.0)),
                0.001);
    EXPECT_NEAR(objects[0].toScene.getTrans().x(), (513370.0 - 511500.0), 0.05);
    EXPECT_NEAR(objects[0].toScene.getTrans().y(), (4000210.0 - 4000300.0), 0.05);
}

// Expected: y of the model points where the heading says, clockwise; pitch raises it, roll lowers
// its x; three angles in one text are those of the three keys; scales are along its own axes.
TEST(MapModels, TurnAsTheirAnglesSay)
{
    const auto turned = [](const std::string& keys)
    {
        const std::vector<Placed> objects =
            objectsIn(modelOf(houseAt("<location>500000 4000000</location>", keys), plane()));
        EXPECT_EQ(objects.size(), 1u) << keys;
        return objects.empty() ? osg::Matrixd() : objects[0].toScene;
    };
    const auto axis = [](const osg::Matrixd& matrix, int i)
    { return osg::Matrixd::transform3x3(osg::Vec3d(i == 0, i == 1, i == 2), matrix); };
    const double half = std::sqrt(0.5), root = 0.5 * std::sqrt(3.0);
    expectNear(axis(turned("heading='90'"), 1), {1.0, 0.0, 0.0}, 1.0e-6);
    expectNear(axis(turned("heading='90'"), 0), {0.0, -1.0, 0.0}, 1.0e-6);
    expectNear(axis(turned("orientation='30'"), 1), {0.5, root, 0.0}, 1.0e-6);
    expectNear(axis(turned("pitch='45'"), 1), {0.0, half, half}, 1.0e-6);
    expectNear(axis(turned("roll='45'"), 0), {half, 0.0, -half}, 1.0e-6);
    const osg::Matrixd whole = turned("orientation='90 45 0'");
    expectNear(axis(whole, 1), {half, 0.0, half}, 1.0e-6);
    const osg::Matrixd keys = turned("heading='70' pitch='20' roll='10'");
    const osg::Matrixd text = turned("orientation='70 20 10'");
    for (int i = 0; i < 3; ++i)
        expectNear(axis(keys, i), axis(text, i), 1.0e-12);
}

// Expected: grid north of UTM, three degrees east of its central meridian, lies atan(tan 3 sin 60)
// east of true north, so that a model that looks north looks to the left of the map's y axis.
TEST(MapModels, HeadingsCountFromTrueNorth)
{
    double x = 18.0, y = 60.0;
    ASSERT_TRUE(transformation("EPSG:4326", "EPSG:32633")->Transform(1, &x, &y));
    const std::string url = rasterOfPlaces(21, 21, {x - 105.0, 10, 0, y + 105.0, 0, -10},
                                           [](double, double) { return 5.0; });
    const std::vector<Placed> objects =
        objectsIn(modelOf(houseAt("<location long='18' lat='60'/>"), url));
    ASSERT_EQ(objects.size(), 1u);
    const double convergence = std::atan(std::tan(3.0 * pi / 180.0) * std::sin(60.0 * pi / 180.0));
    expectNear(osg::Matrixd::transform3x3(osg::Vec3d(0.0, 1.0, 0.0), objects[0].toScene),
               {-std::sin(convergence), std::cos(convergence), 0.0}, 1.0e-4);
}

// Expected: the house is 8 m wide, 12 m long and 10 m high, times its scales; its ranges are metres
// whatever its scale is.
TEST(MapModels, ScalesAndRanges)
{
    const std::vector<Placed> objects = objectsIn(
        modelOf(houseAt("<location>500000 4000000</location>", "scale='2 3 0.5' max_range='900'"),
                plane()));
    ASSERT_EQ(objects.size(), 1u);
    osg::ComputeBoundsVisitor bounds;
    objects[0].object->getChild(0)->accept(bounds);
    const osg::BoundingBox& box = bounds.getBoundingBox();
    EXPECT_NEAR(box.xMax() - box.xMin(), 16.0f, 1.0e-3f);
    EXPECT_NEAR(box.yMax() - box.yMin(), 36.15f, 1.0e-3f); // the door stands out by 5 cm
    EXPECT_NEAR(box.zMax() - box.zMin(), 5.0f, 1.0e-3f);
    const auto* range = dynamic_cast<const osg::LOD*>(objects[0].object->getChild(0));
    ASSERT_TRUE(range);
    EXPECT_EQ(range->getMaxRange(0), 900.0f);
    EXPECT_EQ(range->getMinRange(0), 0.0f);
    const std::string note = "takes no light from the ground, since its min_range is more than 0";
    for (const auto& [keys, isNoted] : {std::pair("max_range='9'", false), {"min_range='9'", true}})
    {
        const TerrainModel model =
            modelOf(houseAt("<location>500000 4000000</location>", keys), plane());
        EXPECT_EQ(saidBy(model).find(note) != std::string::npos, isNoted) << saidBy(model);
    }
}

// Expected: the reason, with the map's line and the model's file; the terrain and the other models
// are drawn.
TEST(MapModels, ModelsThatCannotBePlacedAreLeftOut)
{
    const std::string broken = (testFolder() / "broken.osgt").string();
    std::ofstream(broken) << "#Ascii Scene\n#Version 161\nosg::Geode { UniqueID";
    const std::string unknown = (testFolder() / "house.nosuchformat").string();
    std::ofstream(unknown) << "x";
    const std::string nameless = (testFolder() / "house").string();
    std::ofstream(nameless) << "x";
    const std::string empty = (testFolder() / "empty.osgt").string();
    const osg::ref_ptr<osg::Group> nothing = new osg::Group;
    ASSERT_TRUE(osgDB::writeNodeFile(*nothing, empty));
    const std::string here = "<location>500000 4000000</location>";
    const auto with = [](const std::string& url, const std::string& place)
    { return "<model name='m' url='" + url + "'>" + place + "</model>"; };
    const std::pair<std::string, std::string> wrongs[] = {
        {with("none.osgb", here), folder + "/none.osgb: no such file"},
        {with("C:\\models\\a.osgb", here), "the path names a drive of Windows"},
        {with(broken, here), broken + ": is no model that OpenSceneGraph reads"},
        {with(empty, here), empty + ": draws nothing that has a finite size"},
        {with(unknown, here), unknown + ": needs the plugin osgdb_nosuchformat of OpenSceneGraph, "
                                        "which is not installed"},
        {with(nameless, here), nameless + ": has no extension that names its format"},
        {with("jacksboro.earth", here), "jacksboro.earth: is a map; needs a model"},
        {with("jacksboro.earth.terrainlight", here), "is a map; needs a model"},
        {with(house, "<location>600000 4000000</location>"), "x 600000, y 4000000 lies 99.7"},
        {with(house, "<location long='40' lat='36'/>"), "longitude 40, latitude 36 lies"},
        {with(house, "<location long='40' lat='36'/>"), "outside the terrain; needs a place on it"},
        {with(house, "<location x='500000' y='4000000' z='20'/>"),
         "<model name=\"m\"> is hidden, 2"}};
    for (const auto& [text, wanted] : wrongs)
    {
        const TerrainModel model = modelOf(text + houseAt(here), plane());
        const std::string said = saidBy(model);
        EXPECT_NE(said.find(wanted), std::string::npos) << text << " says: " << said;
        EXPECT_NE(said.find("m.earth:3: "), std::string::npos) << said;
        EXPECT_NE(said.find("<model name=\"m\">"), std::string::npos) << said;
        const bool isHidden = wanted.find("hidden") != std::string::npos;
        EXPECT_EQ(objectsIn(model).size(), isHidden ? 2u : 1u) << text;
        EXPECT_TRUE(model.terrain.valid());
    }
}

// Expected: where the terrain is void no model stands on it, and one with an absolute height stands
// where that says.
TEST(MapModels, OnAVoid)
{
    const std::string url =
        rasterOfPlaces(41, 41, {499795, 10, 0, 4000205, 0, -10},
                       [](double x, double) { return x < 499990.0 ? std::nan("") : 100.0; });
    const TerrainModel model =
        modelOf(houseAt("<location>499900 4000000</location>") +
                    houseAt("<position x='499900' y='4000000' z='150' mode='absolute'/>"),
                url);
    EXPECT_NE(saidBy(model).find("the terrain has no height at x 499900, y 4000000; needs a place "
                                 "that has one, or a height with mode=\"absolute\""),
              std::string::npos)
        << saidBy(model);
    const std::vector<Placed> objects = objectsIn(model);
    ASSERT_EQ(objects.size(), 1u);
    EXPECT_EQ(objects[0].toScene.getTrans().z(), 150.0);
}

// Expected: a scene that reads the map that it is a model of ends, and says why.
TEST(MapModels, AMapWithinItsOwnModelEnds)
{
    useOwnPlugins();
    const std::string map = (testFolder() / "m.earth").string();
    std::ofstream(map) << "<map><elevation driver='gdal' url='" + plane() +
                              "'/><model url='loop.osgt'><location>500000 4000000</location>"
                              "</model></map>";
    const osg::ref_ptr<osg::ProxyNode> proxy = new osg::ProxyNode;
    proxy->setFileName(0, map + ".terrainlight");
    ASSERT_TRUE(osgDB::writeNodeFile(*proxy, (testFolder() / "loop.osgt").string()));
    const Said said;
    const Result<EarthMap> read = readEarthFile(map);
    ASSERT_TRUE(read) << read.error().message;
    const Result<TerrainModel> model = loadMap(*read, testFolder().string(), map);
    ASSERT_TRUE(model) << model.error().message;
    EXPECT_TRUE(model->terrain.valid());
    EXPECT_EQ(said.count("belongs to a map within a model"), 1) << said.text();
}

// Expected: the first view is that of the terrain, however high or large a model is; the model's
// file is one of those that the map is made of.
TEST(MapModels, ChangeNeitherTheViewNorTheListOfFiles)
{
    const TerrainModel with =
        modelOf(houseAt("<position x='500000' y='4000000' z='90000'/>", "scale='500'"), plane());
    const TerrainModel without = modelOf("", plane());
    ASSERT_EQ(objectsIn(with).size(), 1u);
    EXPECT_EQ(with.terrain._min, without.terrain._min);
    EXPECT_EQ(with.terrain._max, without.terrain._max);
    const std::vector<std::string> files = filesOf(folder + "/models.earth");
    EXPECT_TRUE(std::any_of(files.begin(), files.end(),
                            [](const std::string& file)
                            { return file.find("house.osgt") != std::string::npos; }));
}

namespace
{
/// What is drawn of a map: a square about a place, in the frame of the terrain [m].
struct Square
{
    osg::Vec3d middle;
    double halfSide = 1500.0;
};

/// A map with the house in the middle of the picture, and the same map without it.
class HousePicture
{
public:
    HousePicture(const std::string& url, const std::string& place, const std::string& keys,
                 const Square& square = {})
        : _square(square), _with(picture(houseAt(place, keys), url, square)),
          _without(picture("", url, square))
    {
    }

    /// Red, in 255: the mean of 9 pixels, at a place from the middle [m].
    double with(double x, double y) const { return at(_with, x, y, 0); }
    double without(double x, double y) const { return at(_without, x, y, 0); }
    double green(double x, double y) const { return at(_with, x, y, 1); }

private:
    using Pixels = std::vector<unsigned char>;

    static Pixels picture(const std::string& elements, const std::string& url, const Square& square)
    {
        const TerrainModel model =
            modelOf(elements + "<terrain_light sun_azimuth='270' sun_elevation='35' azimuths='8' "
                               "albedo='0.5'/>",
                    url);
        if (!model.node)
            return Pixels(4 * ScenePicture::size * ScenePicture::size);
        model.node->setTimeBudget(0.0);
        model.node->setFadeSeconds(0.0);
        const osg::ref_ptr<osg::MatrixTransform> moved =
            new osg::MatrixTransform(osg::Matrixd::translate(-square.middle));
        moved->addChild(model.node);
        ScenePicture drawn(moved, square.halfSide);
        drawn.draw(4);
        const osgDB::DatabasePager& pager = *drawn.viewer().getDatabasePager();
        const auto isLoading = [&pager]
        { return pager.requiresUpdateSceneGraph() || pager.getRequestsInProgress(); };
        for (int wait = 0; wait < 400 && isLoading(); ++wait)
        {
            OpenThreads::Thread::microSleep(25000);
            drawn.draw(2);
        }
        drawn.draw(4);
        return drawn.pixels();
    }

    double at(const Pixels& pixels, double x, double y, std::size_t channel) const
    {
        const auto pixel = [this](double place, int step) {
            return static_cast<int>((0.5 + 0.5 * place / _square.halfSide) * ScenePicture::size) +
                   step;
        };
        double sum = 0.0;
        for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i)
                sum += pixels[static_cast<std::size_t>(
                                  4 * (pixel(y, j) * ScenePicture::size + pixel(x, i))) +
                              channel];
        return sum / 9.0;
    }

    const Square _square;
    const Pixels _with, _without;
};

/// Expected, with lengths times `scale`: the roof is red in the middle. The house is 8 m wide and
/// its ridge is 7 m high, so its shadow ends 10 m east of the ridge; there is no sun in it, and sky
/// is a fourth of the light of level ground. West of the house and far from it the ground is as
/// without it.
void expectLightOfObject(const HousePicture& picture, double scale, const char* what)
{
    EXPECT_GT(picture.with(2.0 * scale, 0.0), 1.5 * picture.green(2.0 * scale, 0.0)) << what;
    const double open = picture.without(6.75 * scale, 0.0);
    EXPECT_GT(open, 60.0) << what;
    EXPECT_LT(picture.with(6.75 * scale, 0.0), 0.75 * open) << what;
    for (const double x : {-25.0, 32.0})
        EXPECT_NEAR(picture.with(x * scale, 0.0), picture.without(x * scale, 0.0), 3.0)
            << what << x;
}
} // namespace

TEST(MapModels, PictureOnAMapInMetres)
{
    OTL_NEED_GL(context);
    const std::string url = rasterOfPlaces(101, 101, {498485, 30, 0, 4001515, 0, -30},
                                           [](double, double) { return 100.0; });
    expectLightOfObject(HousePicture(url, "<location>500000 4000000</location>", "scale='40'"),
                        40.0, "metres");
}

TEST(MapModels, PictureOnAMapInDegrees)
{
    OTL_NEED_GL(context);
    const std::string url = rasterOfPlaces(
        101, 101, {9.97975, 0.0004, 0, 47.0151500, 0, -0.0003},
        [](double, double) { return 100.0; }, "EPSG:4326");
    expectLightOfObject(HousePicture(url, "<location long='9.99995' lat='47'/>", "scale='40'"),
                        40.0, "degrees");
}

TEST(MapModels, PictureOnPagedTerrain)
{
    OTL_NEED_GL(context);
    const std::string url = rasterOfPlaces(2101, 401, {489495, 10, 0, 4002005, 0, -10},
                                           [](double, double) { return 100.0; });
    expectLightOfObject(HousePicture(url, "<location>500000 4000000</location>", "scale='40'"),
                        40.0, "paged");
}

// Expected: the same far from the middle row of a map in degrees, where columns are drawn farther
// apart than they are. The ground rises to the east by a sixth, so that light that looks for it
// beside its place finds it above or below the house: rows are drawn 1 % too long there.
TEST(MapModels, PictureInTheCornerOfAMapInDegrees)
{
    OTL_NEED_GL(context);
    const auto isAt = [](int columns, const char* what)
    {
        const double perDegree = 55800.0; // about, in metres
        const auto heightAt = [&](double x, double) { return (x - 10.0) * perDegree / 6.0; };
        const double step = 1.0 / (columns - 1), half = 0.5 * step;
        const std::string url = rasterOfPlaces(
            columns, 401, {10.0 - half, step, 0, 60.4 + 0.001, 0, -0.002}, heightAt, "EPSG:4326");
        const std::string place = "<location long='10.95' lat='60.35'/>";
        const TerrainModel model = modelOf(houseAt(place), url);
        const std::vector<Placed> objects = objectsIn(model);
        ASSERT_EQ(objects.size(), 1u) << what;
        Square square;
        square.middle = objects[0].toScene.getTrans();
        square.halfSide = 600.0;
        expectLightOfObject(HousePicture(url, place, "scale='15'", square), 15.0, what);
    };
    isAt(801, "one tile");
    isAt(2401, "paged");
}
