// A host's object with a light probe, drawn: on a plain, and in a valley with a red side.
#include <osgTerrainLight/LightProbe.h>
#include <osgTerrainLight/TerrainLighting.h>

#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/ScenePicture.h"
#include "terrain/TerrainModel.h"

#include <osg/Geode>
#include <osg/MatrixTransform>
#include <osg/ShapeDrawable>
#include <osgTerrain/TerrainTile>

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;

namespace
{
constexpr double spacing = 10.0;
constexpr int posts = 65;

/// A white sphere about a probe; its shader writes linear light over 2.
osg::ref_ptr<osg::Node> sphere(LightProbe& probe, double height)
{
    const osg::ref_ptr<osg::Program> program = new osg::Program;
    program->addShader(createProbeShader(osg::Shader::FRAGMENT));
    program->addShader(new osg::Shader(osg::Shader::VERTEX, R"(#version 120
varying vec3 normal;
void main()
{
    normal = gl_Normal; // the scene's axes are the tile's
    gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
})"));
    program->addShader(new osg::Shader(osg::Shader::FRAGMENT, R"(#version 120
varying vec3 normal;
vec3 terrainProbeDiffuse(vec3 normal);
void main()
{
    gl_FragColor = vec4(0.5 * terrainProbeDiffuse(normalize(normal)), 1.0);
})"));
    const osg::ref_ptr<osg::ShapeDrawable> drawable =
        new osg::ShapeDrawable(new osg::Sphere(osg::Vec3(0.0f, 0.0f, float(height)), 60.0f));
    const osg::ref_ptr<osg::Geode> geode = new osg::Geode;
    geode->addDrawable(drawable);
    geode->setStateSet(probe.getStateSet());
    probe.getStateSet()->setAttribute(program);
    return geode;
}

struct Scene
{
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    osg::ref_ptr<LightProbe> probe = new LightProbe;
    osgTerrain::TerrainTile* tile = nullptr;

    Scene(const DemTile& dem, double height)
    {
        const osg::ref_ptr<osg::Node> terrain = createTerrain(dem);
        lighting->addChild(terrain);
        tile = dynamic_cast<osgTerrain::TerrainTile*>(terrain->asGroup()->getChild(0));
        lighting->addChild(sphere(*probe, height));
        const double middle = (posts - 1) / 2 * dem.northSpacing;
        probe->setPlace(middle, middle);
        probe->setHeight(height);
        SkyLight sky;
        sky.skyRadiance = {1.0f, 1.0f, 1.0f};
        sky.sunEnabled = false;
        lighting->setSkyLight(sky);
        EXPECT_TRUE(lighting->addProbe(probe, lighting->getTileHandle(tile)));
    }
};
} // namespace

// Expected: closed forms of a sphere seen from above. On a plain of albedo 0.5 the light is (1 + z)
// / 2 + 0.5 (1 − z) / 2; with a sun at the zenith of irradiance π / 2 on its back, z / 2 more.
TEST(LightProbe, LightsAnObjectOfTheHost)
{
    OTL_NEED_GL(context);
    Said said;
    Scene scene(analytic::plane(posts, posts, 10.0 * spacing, 0.0), 100.0);
    ASSERT_TRUE(scene.tile);
    LightingSettings settings = scene.lighting->getSettings();
    settings.albedo = {0.5f, 0.5f, 0.5f};
    scene.lighting->setSettings(settings);
    ScenePicture picture(scene.lighting, 100.0);
    picture.draw(3);
    // At a place x of the picture the sphere's normal has an east part of x / 0.6.
    const auto expected = [](double x, double sun)
    {
        const double z = std::sqrt(1.0 - x * x / 0.36);
        return 127.5 * ((1.0 + z) / 2.0 + 0.25 * (1.0 - z) + sun * z);
    };
    // 8 bits, and what is dark at the tile's end: 100 m above it at 3200 m.
    for (const double x : {0.0, 0.3, -0.4})
        EXPECT_NEAR(picture.redAt(x, 0.0), expected(x, 0.0), 2.0) << x;

    SkyLight sky = scene.lighting->getSkyLight();
    sky.sunEnabled = true;
    sky.sunElevation = 90.0;
    sky.sunIrradiance = {1.5708f, 1.5708f, 1.5708f};
    scene.lighting->setSkyLight(sky);
    picture.draw(2);
    // What of the sun the ground sends does not reach the top.
    EXPECT_NEAR(picture.redAt(0.0, 0.0), expected(0.0, 0.5), 2.0);

    // The same from other texture units.
    const std::vector<unsigned char> before = picture.pixels();
    scene.probe->setTextureUnits(11, 12);
    picture.draw();
    EXPECT_EQ(picture.pixels(), before);
    const osg::StateSet& stateSet = *scene.probe->getStateSet();
    const auto texture = osg::StateAttribute::TEXTURE;
    EXPECT_EQ(stateSet.getTextureAttribute(11, texture), scene.probe->getDiffuseMap());
    EXPECT_EQ(stateSet.getTextureAttribute(12, texture), scene.probe->getGlossyMap());
    EXPECT_FALSE(stateSet.getTextureAttribute(LightProbe::diffuseUnit, texture));

    // Computed once per change, and not after it has been removed.
    const unsigned runs = scene.lighting->getDispatchCounts()["probe"];
    EXPECT_GE(runs, 2u);
    picture.draw(2);
    EXPECT_EQ(scene.lighting->getDispatchCounts()["probe"], runs);
    scene.probe->setHeight(120.0);
    picture.draw(2);
    EXPECT_EQ(scene.lighting->getDispatchCounts()["probe"], runs + 1);
    scene.lighting->removeProbe(scene.probe);
    sky.sunElevation = 80.0;
    scene.lighting->setSkyLight(sky);
    picture.draw(2);
    EXPECT_EQ(scene.lighting->getDispatchCounts()["probe"], runs + 1);
    EXPECT_EQ(said.text(), "");
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: darker than on a plain, where the valley's sides hide half of the sky, and red where it
// faces the red side.
TEST(LightProbe, AValleyIsDarkerAndItsRedSideIsSeen)
{
    OTL_NEED_GL(context);
    Said said;
    Scene plain(analytic::plane(posts, posts, spacing, 0.0), 100.0);
    Scene valley(analytic::valley(posts, posts, spacing, posts / 2, 2.0), 100.0);
    osg::ref_ptr<osg::Image> colours = new osg::Image;
    colours->allocateImage(2, 1, 1, GL_RGB, GL_UNSIGNED_BYTE);
    const unsigned char texels[] = {60, 60, 60, 255, 60, 60};
    std::copy(std::begin(texels), std::end(texels), colours->data());
    valley.tile->setColorLayer(0, new osgTerrain::ImageLayer(colours));
    ScenePicture onPlain(plain.lighting, 100.0);
    onPlain.draw(3);
    ScenePicture inValley(valley.lighting, 100.0);
    inValley.draw(3);
    const auto at = [](const ScenePicture& picture, double x, int channel)
    {
        const int column = static_cast<int>((0.5 + 0.5 * x) * ScenePicture::size);
        return int(picture.pixels()[static_cast<std::size_t>(
            4 * (ScenePicture::size / 2 * ScenePicture::size + column) + channel)]);
    };
    for (const double x : {-0.45, 0.45})
        EXPECT_LT(at(inValley, x, 1), at(onPlain, x, 1) - 15) << x;
    EXPECT_GT(at(inValley, 0.45, 0), at(inValley, 0.45, 1) + 10);
    EXPECT_LT(at(inValley, -0.45, 0), at(inValley, -0.45, 1) + 5);
    EXPECT_EQ(said.text(), "");
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(LightProbe, BadValuesAreRefused)
{
    Said said;
    const osg::ref_ptr<LightProbe> probe = new LightProbe;
    probe->setPlace(std::nan(""), 0.0);
    probe->setHeight(-1.0);
    probe->setExponent(0.5);
    probe->setTextureUnits(5, 5);
    EXPECT_EQ(said.count("texture units of probe not set: "), 1);
    EXPECT_EQ(probe->getRevision(), 0u);
    EXPECT_EQ(said.count("place of probe not set: "), 1);
    EXPECT_EQ(said.count("height of probe not set: "), 1);
    EXPECT_EQ(said.count("exponent of probe not set: "), 1);
    const osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    const TileHandle tile = TileHandle::at(3, 4, 5); // it may come later
    EXPECT_FALSE(lighting->addProbe(nullptr, tile));
    EXPECT_FALSE(lighting->addProbe(probe, TileHandle()));
    EXPECT_TRUE(lighting->addProbe(probe, tile));
    EXPECT_FALSE(lighting->addProbe(probe, tile));
    EXPECT_EQ(said.count("probe not added: "), 3);
}
