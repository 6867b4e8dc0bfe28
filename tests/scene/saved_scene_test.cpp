// Scenes in files: those that were written before properties had names (data/former), and files
// with other properties than this version has.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/ScenePicture.h"
#include "support/TestFolder.h"
#include "terrain/TerrainModel.h"

#include <osgTerrainLight/LightingHandler.h>
#include <osgTerrainLight/PlacedObject.h>
#include <osgTerrainLight/TerrainLighting.h>

#include <osgDB/ReadFile>
#include <osgDB/WriteFile>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

using namespace osgTerrainLight;
namespace fs = std::filesystem;

namespace
{
const char* const extensions[] = {"osgt", "osgb", "osgx"};

osg::ref_ptr<TerrainLighting> readScene(const std::string& path)
{
    useOwnPlugins();
    osg::ref_ptr<osg::Node> node = osgDB::readRefNodeFile(path);
    return dynamic_cast<TerrainLighting*>(node.get());
}

std::string former(const std::string& name)
{
    return OTL_SOURCE_DIR "/tests/scene/data/former/" + name;
}

std::string textOf(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

void replace(std::string& text, const std::string& from, const std::string& to)
{
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
}

/// What lit.* was made with: written in its .osgt, which the other two were converted from.
void expectLit(const TerrainLighting& node)
{
    LightingSettings settings;
    settings.azimuths = 16;
    settings.quality = HorizonQuality::Best;
    settings.exposure = 0.5;
    settings.bounces = 2;
    settings.subsampling = 2;
    settings.bounceInterval = 3;
    settings.bodyRadius = 1737400.0;
    settings.albedo = {0.2f, 0.3f, 0.4f};
    settings.gloss = 0.25;
    settings.glossExponent = 16.0;
    settings.glossTransfer = GlossTransfer::Scalar;
    settings.glossViewer = {0.5, 0.25, 1.0};
    EXPECT_TRUE(node.getSettings() == settings);
    SkyLight sky;
    sky.skyRadiance = {0.1f, 0.2f, 0.3f};
    sky.sunAzimuth = 250.125;
    sky.sunElevation = 20.0;
    sky.sunAngularRadius = 0.5;
    sky.sunIrradiance = {2.0f, 1.9f, 1.7f};
    sky.skyHarmonics = {
        {0.9f, 0.8f, 0.7f}, {0.1f, 0.2f, 0.3f}, {0.05f, 0.06f, 0.07f}, {0.0f, 0.1f, 0.0f}};
    sky.keyLights = {{300.0, 30.0, 15.0, 40.0, {6.0f, 4.0f, 2.0f}}, {80.0, 60.0, 40.0, 80.0, {}}};
    sky.keyLights[1].radiance = {1.0f, 1.0f, 1.0f};
    EXPECT_TRUE(node.getSkyLight() == sky);
    ASSERT_TRUE(node.getPlace());
    EXPECT_EQ(node.getPlace()->longitude, -84.2);
    EXPECT_EQ(node.getPlace()->latitude, 36.6);
    EXPECT_EQ(node.getPlace()->convergence, 1.25);
    EXPECT_FALSE(node.getTime());
    EXPECT_EQ(node.getTimeBudget(), 20.0);
    EXPECT_EQ(node.getGlossLayer(), 2);
    EXPECT_EQ(node.getTextureUnit(), ShadingTexture::defaultUnit);
    EXPECT_FALSE(node.getEventCallback());
}
} // namespace

TEST(SavedScene, OfAFormerVersionHasItsSettings)
{
    for (const char* extension : extensions)
    {
        SCOPED_TRACE(extension);
        const osg::ref_ptr<TerrainLighting> lit =
            readScene(former(std::string("lit.") + extension));
        ASSERT_TRUE(lit);
        expectLit(*lit);
        EXPECT_EQ(lit->getNumChildren(), 1u);

        const osg::ref_ptr<TerrainLighting> day =
            readScene(former(std::string("day.") + extension));
        ASSERT_TRUE(day);
        EXPECT_EQ(day->getSkyLight().skyModel, SkyModel::Clear);
        EXPECT_EQ(day->getSkyLight().turbidity, 4.5);
        EXPECT_EQ(day->getSettings().bounceMethod, BounceMethod::LegendreBSpline);
        EXPECT_EQ(day->getSettings().bounces, 1);
        ASSERT_TRUE(day->getTime());
        EXPECT_EQ(toString(*day->getTime()), "2024-06-21T12:30:15Z");
        EXPECT_TRUE(dynamic_cast<LightingHandler*>(day->getEventCallback()));
    }
}

TEST(SavedScene, KeepsEveryDigit)
{
    const fs::path folder = testFolder();
    osg::ref_ptr<TerrainLighting> node = readScene(former("lit.osgt"));
    ASSERT_TRUE(node);
    SkyLight sky = node->getSkyLight();
    sky.sunAzimuth = 1000.0 / 7.0;
    sky.sunIrradiance = {1.0f / 3.0f, 2.0f / 3.0f, 1e-7f};
    node->setSkyLight(sky);
    for (const char* extension : extensions)
    {
        SCOPED_TRACE(extension);
        const std::string path = (folder / (std::string("again.") + extension)).string();
        ASSERT_TRUE(osgDB::writeNodeFile(*node, path));
        const osg::ref_ptr<TerrainLighting> again = readScene(path);
        ASSERT_TRUE(again);
        EXPECT_TRUE(again->getSkyLight() == node->getSkyLight());
        EXPECT_TRUE(again->getSettings() == node->getSettings());
        EXPECT_EQ(again->getPlace()->longitude, -84.2);
        EXPECT_EQ(again->getTimeBudget(), 20.0);
    }
}

TEST(SavedScene, WithOtherPropertiesIsStillRead)
{
    const fs::path folder = testFolder();
    osg::ref_ptr<TerrainLighting> node = readScene(former("lit.osgt"));
    ASSERT_TRUE(node);
    for (const char* extension : extensions)
    {
        SCOPED_TRACE(extension);
        const fs::path path = folder / (std::string("other.") + extension);
        ASSERT_TRUE(osgDB::writeNodeFile(*node, path.string()));
        std::string text = textOf(path);
        // Of the same length, so that a binary file stays one: a name that is not known.
        replace(text, "azimuths", "azimuthz");
        std::ofstream(path, std::ios::binary) << text;
        Said said;
        const osg::ref_ptr<TerrainLighting> read = readScene(path.string());
        ASSERT_TRUE(read);
        LightingSettings settings = node->getSettings();
        settings.azimuths = LightingSettings().azimuths;
        EXPECT_TRUE(read->getSettings() == settings) << "all but the azimuths";
        EXPECT_TRUE(read->getSkyLight() == node->getSkyLight());
        EXPECT_EQ(read->getGlossLayer(), 2);
        EXPECT_EQ(read->getNumChildren(), 1u);
        EXPECT_EQ(said.count("skipped azimuthz"), 1) << said.text();
    }
}

TEST(SavedScene, SaysWhatIsNotLegalAndKeepsTheDefault)
{
    const fs::path path = testFolder() / "scene.osgt";
    osg::ref_ptr<TerrainLighting> node = readScene(former("lit.osgt"));
    ASSERT_TRUE(node);
    ASSERT_TRUE(osgDB::writeNodeFile(*node, path.string()));
    std::string text = textOf(path);
    replace(text, "\"sun-elevation\" \"20\"", "\"sun-elevation\" \"95\"");
    std::ofstream(path, std::ios::binary) << text;
    Said said;
    const osg::ref_ptr<TerrainLighting> read = readScene(path.string());
    ASSERT_TRUE(read);
    EXPECT_EQ(read->getSkyLight().sunElevation, SkyLight().sunElevation);
    EXPECT_EQ(read->getSkyLight().sunAzimuth, 250.125);
    EXPECT_EQ(said.count("sun-elevation = \"95\": needs a number, -90 ... 90 degrees"), 1)
        << said.text();
}

// Expected: the picture of the same scene, saved before anything was bound to its tiles.
TEST(SavedScene, SavedAfterItWasDrawnIsLitAgain)
{
    OTL_NEED_GL(context);
    const fs::path folder = testFolder();
    constexpr double halfSide = 170.0;
    osg::ref_ptr<TerrainLighting> scene = new TerrainLighting;
    scene->setTimeBudget(0.0);
    scene->addChild(createTerrain(analytic::cone(33, 33, 10.0, 16, 16, 120.0, 120.0)));
    const auto save = [&](const char* when)
    {
        for (const char* extension : extensions)
            EXPECT_TRUE(osgDB::writeNodeFile(*scene, (folder / when).string() + "." + extension));
    };
    useOwnPlugins();
    save("before");
    {
        ScenePicture picture(scene, halfSide);
        picture.draw(3);
        save("after");
        EXPECT_GT(picture.redAt(-0.3, 0.3), picture.redAt(0.3, -0.3) + 40.0);
    }
    for (const char* extension : extensions)
    {
        SCOPED_TRACE(extension);
        std::vector<unsigned char> expected;
        for (const char* when : {"before", "after"})
        {
            Said said;
            const osg::ref_ptr<TerrainLighting> read =
                readScene((folder / when).string() + "." + extension);
            ASSERT_TRUE(read);
            ScenePicture picture(read, halfSide);
            picture.draw(4);
            EXPECT_GT(picture.redAt(-0.3, 0.3), picture.redAt(0.3, -0.3) + 40.0) << when;
            EXPECT_TRUE(expected.empty() || picture.pixels() == expected) << when;
            expected = picture.pixels();
            EXPECT_EQ(said.text(), "") << when;
        }
    }
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: every property of the node comes back, that of gloss too.
TEST(SavedScene, KeepsTextureUnits)
{
    useOwnPlugins();
    const fs::path path = testFolder() / "scene.osgt";
    const osg::ref_ptr<TerrainLighting> node = new TerrainLighting;
    node->setTextureUnit(ShadingTexture::glossUnit);
    node->setGlossUnit(9);
    ASSERT_TRUE(osgDB::writeNodeFile(*node, path.string()));
    Said said;
    const osg::ref_ptr<TerrainLighting> read = readScene(path.string());
    ASSERT_TRUE(read);
    EXPECT_EQ(read->getTextureUnit(), ShadingTexture::glossUnit);
    EXPECT_EQ(read->getGlossUnit(), 9u);
    EXPECT_EQ(said.text(), "");
}

TEST(SavedScene, SaysWhichUnitOrLayerIsNotLegal)
{
    useOwnPlugins();
    const fs::path path = testFolder() / "scene.osgt";
    const osg::ref_ptr<TerrainLighting> node = new TerrainLighting;
    ASSERT_TRUE(osgDB::writeNodeFile(*node, path.string()));
    const std::string legal = textOf(path);
    const struct
    {
        const char *is, *becomes, *said;
    } wrong[] = {{"\"texture-unit\" \"7\"", "\"texture-unit\" \"-1\"",
                  "texture-unit = \"-1\": needs a whole number, 0 ... 31"},
                 {"\"texture-unit\" \"7\"", "\"texture-unit\" \"40\"",
                  "texture-unit = \"40\": needs a whole number, 0 ... 31"},
                 {"\"gloss-unit\" \"5\"", "\"gloss-unit\" \"5.5\"",
                  "gloss-unit = \"5.5\": needs a whole number, 0 ... 31"},
                 {"\"gloss-layer\" \"-1\"", "\"gloss-layer\" \"2.7\"",
                  "gloss-layer = \"2.7\": needs a whole number, -1 ... 4"},
                 {"\"time-budget\" \"50\"", "\"time-budget\" \"-1\"",
                  "time-budget = \"-1\": needs a number, 0 ... 1e+09 ms"}};
    for (const auto& each : wrong)
    {
        SCOPED_TRACE(each.becomes);
        std::string text = legal;
        replace(text, each.is, each.becomes);
        std::ofstream(path, std::ios::binary) << text;
        Said said;
        const osg::ref_ptr<TerrainLighting> read = readScene(path.string());
        ASSERT_TRUE(read);
        EXPECT_EQ(said.count(each.said), 1) << said.text();
        EXPECT_EQ(read->getTextureUnit(), ShadingTexture::defaultUnit);
        EXPECT_EQ(read->getGlossUnit(), ShadingTexture::glossUnit);
        EXPECT_EQ(read->getGlossLayer(), -1);
        EXPECT_EQ(read->getTimeBudget(), 50.0);
    }
}

TEST(SavedScene, KeepsPlacedObjects)
{
    useOwnPlugins();
    const fs::path folder = testFolder();
    for (const char* extension : extensions)
    {
        SCOPED_TRACE(extension);
        osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
        using Field = PlacedObject::Field;
        const Field fields[] = {Field::Automatic, Field::Box,         Field::Ellipsoid,
                                Field::Cylinder,  Field::Mesh,        Field::None,
                                Field::Star,      Field::HeightField, Field::TwoHeightFields};
        for (const Field field : fields)
        {
            osg::ref_ptr<PlacedObject> object = new PlacedObject;
            object->setField(field);
            if (field == Field::Box)
            {
                object->setAlbedo(osg::Vec3f(0.25f, 0.5f, 0.75f));
                object->setEmission(osg::Vec3f(2.0f, 1.0f, 0.5f));
            }
            lighting->addChild(object);
        }
        const std::string path = (folder / (std::string("objects.") + extension)).string();
        ASSERT_TRUE(osgDB::writeNodeFile(*lighting, path));
        const osg::ref_ptr<TerrainLighting> read = readScene(path);
        ASSERT_TRUE(read.valid());
        ASSERT_EQ(read->getNumChildren(), std::size(fields));
        for (unsigned i = 0; i < std::size(fields); ++i)
        {
            const auto* object = dynamic_cast<PlacedObject*>(read->getChild(i));
            ASSERT_TRUE(object);
            EXPECT_EQ(object->getField(), fields[i]);
            EXPECT_EQ(object->getAlbedo().has_value(), fields[i] == Field::Box);
            EXPECT_EQ(object->getEmission(),
                      fields[i] == Field::Box ? osg::Vec3f(2.0f, 1.0f, 0.5f) : osg::Vec3f());
            EXPECT_EQ(object->getAlbedo().value_or(osg::Vec3f(0.25f, 0.5f, 0.75f)),
                      osg::Vec3f(0.25f, 0.5f, 0.75f));
            EXPECT_EQ(object->getNumChildrenRequiringUpdateTraversal(), 1u);
        }
    }
}
