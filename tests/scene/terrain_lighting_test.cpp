#include <osgTerrainLight/LightingHandler.h>
#include <osgTerrainLight/TerrainLighting.h>

#include "gpu/Textures.h"
#include "scene/ShadingBinding.h"
#include "scene/TerrainTileReader.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/ScenePicture.h"
#include "support/ShaderFolder.h"
#include "support/TestFolder.h"
#include "terrain/TerrainModel.h"

#include <osg/MatrixTransform>
#include <osgDB/ReadFile>
#include <osgDB/WriteFile>
#include <osgTerrain/GeometryTechnique>
#include <osgTerrain/Layer>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

using namespace osgTerrainLight;

namespace
{
// A cone of 45 degrees in the middle of 65 x 65 posts, 10 m apart; 320 m to each edge.
constexpr double reach = 320.0;
DemTile coneTile()
{
    return analytic::cone(65, 65, 10.0, 32, 32, 250.0, 250.0);
}

osg::ref_ptr<TerrainLighting> litCone()
{
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    lighting->addChild(createTerrain(coneTile()));
    return lighting;
}

osg::ref_ptr<osgTerrain::TerrainTile> tileWith(osgTerrain::Locator* locator, int side)
{
    osg::ref_ptr<osg::HeightField> field = new osg::HeightField;
    field->allocate(static_cast<unsigned>(side), static_cast<unsigned>(side));
    osg::ref_ptr<osgTerrain::HeightFieldLayer> layer = new osgTerrain::HeightFieldLayer(field);
    layer->setLocator(locator);
    osg::ref_ptr<osgTerrain::TerrainTile> tile = new osgTerrain::TerrainTile;
    tile->setLocator(locator);
    tile->setElevationLayer(layer);
    return tile;
}

SkyLight whiteSky(float radiance)
{
    SkyLight sky;
    sky.sunEnabled = false;
    sky.skyRadiance = {radiance, radiance, radiance};
    return sky;
}
} // namespace

TEST(TerrainLighting, TheSlopeThatFacesTheSunIsBrightest)
{
    OTL_NEED_GL(context);
    Said said;
    osg::ref_ptr<TerrainLighting> lighting = litCone();
    ScenePicture picture(lighting, reach);
    // East and north of the middle: half-way down the cone, on each side.
    const struct
    {
        double azimuth, x, y;
    } sides[] = {
        {315, -0.3, 0.3}, {135, 0.3, -0.3}, {0, 0, 0.4}, {90, 0.4, 0}, {200, -0.14, -0.38}};
    for (const auto& side : sides)
    {
        SkyLight sky;
        sky.sunAzimuth = side.azimuth;
        lighting->setSkyLight(sky);
        picture.draw();
        EXPECT_GT(picture.redAt(side.x, side.y), picture.redAt(-side.x, -side.y) + 40.0)
            << "sun at " << side.azimuth;
    }
    EXPECT_EQ(said.text(), "");
    EXPECT_EQ(takeGlErrors(), "");
}

// Under a white sky green light in a valley is the sky's and what green the ground sends back: none
// from a red picture, some from a white one, and again after the picture has changed.
TEST(TerrainLighting, BouncesTakeTheColourLayerAndFollowIt)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    lighting->setSkyLight(whiteSky(0.25f));
    osg::ref_ptr<osg::Node> valley = createTerrain(
        analytic::makeTile(33, 33, 20.0,
                           [](int column, int) { return 15.0 * std::abs(column - 16); }),
        {{1, 1, {255, 0, 0, 255}}});
    auto* tile = dynamic_cast<osgTerrain::TerrainTile*>(valley->asGroup()->getChild(0));
    ASSERT_TRUE(tile);
    lighting->addChild(valley);
    ScenePicture picture(lighting, reach);
    const auto bottom = [&]
    {
        picture.draw(2);
        auto* shading = dynamic_cast<osg::Texture2D*>(tile->getStateSet()->getTextureAttribute(
            lighting->getTextureUnit(), osg::StateAttribute::TEXTURE));
        const std::vector<float> values = readFloats(picture.state(), *shading, 4);
        const std::size_t post = 4 * (16 * 33 + 16);
        return osg::Vec2f(values[post], values[post + 1]);
    };
    const osg::Vec2f direct = bottom();
    EXPECT_EQ(direct.x(), direct.y());
    LightingSettings settings = lighting->getSettings();
    settings.bounces = 2;
    lighting->setSettings(settings);
    const osg::Vec2f red = bottom();
    EXPECT_GT(red.x(), 1.05f * direct.x());
    EXPECT_EQ(red.y(), direct.y());
    osg::Image* image = tile->getColorLayer(0)->getImage();
    image->setColor(osg::Vec4(1.0f, 1.0f, 1.0f, 1.0f), 0u, 0u);
    image->dirty();
    const osg::Vec2f white = bottom();
    EXPECT_EQ(white.x(), white.y());
    EXPECT_EQ(white.x(), red.x());
    tile->setColorLayer(0, nullptr); // the settings' albedo, which is less
    const osg::Vec2f grey = bottom();
    EXPECT_LT(grey.y(), white.y());
    EXPECT_GT(grey.y(), direct.y());
    tile->getElevationLayer()->dirty(); // read again
    settings.bounces = 0;
    lighting->setSettings(settings);
    EXPECT_EQ(bottom(), direct);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(TerrainLighting, DefaultProgramMultipliesExposesAndEncodes)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    lighting->setSkyLight(whiteSky(0.25f));
    osg::ref_ptr<osg::Node> white = createTerrain(analytic::plane(33, 33, 20.0, 0.0));
    lighting->addChild(white);
    ScenePicture picture(lighting, reach);
    picture.draw();
    // Level ground under a uniform sky: shading is the sky's radiance. sRGB of 0.25 is 137; 1 in
    // 8 bits, and the half-float's 0.05 %.
    EXPECT_NEAR(picture.redAt(0, 0), 137.0, 1.5);
    LightingSettings settings = lighting->getSettings();
    settings.exposure = 1.0;
    lighting->setSettings(settings);
    picture.draw();
    EXPECT_NEAR(picture.redAt(0, 0), 188.0, 1.5); // sRGB of 0.5

    // A colour layer comes out as it is where shading times exposure is 1.
    settings.exposure = 2.0;
    lighting->setSettings(settings);
    lighting->setChild(
        0, createTerrain(analytic::plane(33, 33, 20.0, 0.0), {{1, 1, {100, 150, 200, 255}}}));
    picture.draw();
    EXPECT_NEAR(picture.redAt(0, 0), 100.0, 1.5);
    EXPECT_EQ(takeGlErrors(), "");
}

namespace
{
/// White, level and in the sun, as glossy as settings or layers say.
class GlossyPlain
{
public:
    GlossyPlain() : lighting(lightingWithBudget(0.0, 16))
    {
        SkyLight sky = whiteSky(0.1f);
        sky.sunEnabled = true;
        sky.sunAzimuth = 0.0;
        sky.sunElevation = 50.0;
        sky.sunIrradiance = {0.3f, 0.3f, 0.3f};
        lighting->setSkyLight(sky);
        lighting->addChild(createTerrain(analytic::plane(33, 33, 20.0, 0.0)));
    }

    void setGloss(double gloss)
    {
        LightingSettings settings = lighting->getSettings();
        settings.gloss = gloss;
        lighting->setSettings(settings);
    }

    /// Of red in the picture, from the south and so many degrees above it. Of a sky of L the lobe
    /// of exponent 8 sends L (1/2 + 3/4 · 9/10 z - 7/16 · 21/40 P3(z)) through order 4; of a sun
    /// whose mirror direction is at an angle a, 9/2π cos⁸ a.
    static double expected(double gloss, double elevation)
    {
        constexpr double pi = 3.14159265358979323846;
        const double z = std::sin(elevation * pi / 180.0);
        const double angle = (elevation - 50.0) * pi / 180.0;
        const double linear =
            0.1 + 0.3 * std::sin(50.0 * pi / 180.0) / pi +
            gloss * (0.1 * (0.5 + 0.675 * z - 7.0 / 16.0 * 0.525 * 0.5 * (5.0 * z * z - 3.0) * z) +
                     0.3 * 9.0 / (2.0 * pi) * std::pow(std::cos(angle), 8.0));
        return 255.0 * (1.055 * std::pow(linear, 1.0 / 2.4) - 0.055);
    }

    /// From the south; the sun's mirror direction is 50 degrees high there.
    static void look(ScenePicture& picture, double elevation)
    {
        const double e = osg::DegreesToRadians(elevation);
        picture.viewer().getCamera()->setViewMatrixAsLookAt(
            osg::Vec3d(0.0, -std::cos(e), std::sin(e)) * 5.0e5, osg::Vec3d(),
            osg::Vec3d(0.0, 1.0, 0.0));
    }

    const osg::ref_ptr<TerrainLighting> lighting;
};

/// A picture of gloss: 0 in the west, of exponent 8 in the east.
osg::ref_ptr<osg::Image> glossInTheEast(unsigned char gloss)
{
    const osg::ref_ptr<osg::Image> image = new osg::Image;
    image->allocateImage(2, 1, 1, GL_RGB, GL_UNSIGNED_BYTE);
    const std::vector<unsigned char> texels = {0, 0, 0, gloss, 32, 255};
    std::copy(texels.begin(), texels.end(), image->data());
    return image;
}
} // namespace

// Expected: closed form of a plain (GlossyPlain).
TEST(TerrainLighting, DefaultProgramAddsWhatGlossSendsToTheViewer)
{
    OTL_NEED_GL(context);
    Said said;
    GlossyPlain plain;
    ScenePicture picture(plain.lighting, reach);
    for (double gloss : {0.0, 0.6, 0.0})
    {
        plain.setGloss(gloss);
        for (double elevation : {90.0, 70.0, 50.0})
        {
            plain.look(picture, elevation);
            picture.draw(2);
            EXPECT_NEAR(picture.redAt(0, 0), plain.expected(gloss, elevation), 1.5)
                << gloss << " from " << elevation;
        }
    }
    EXPECT_EQ(said.text(), "");
    EXPECT_EQ(takeGlErrors(), "");

    const osg::ref_ptr<osg::Program> displaced = createDisplacedProgram(true, true);
    displaced->apply(picture.state());
    EXPECT_TRUE(displaced->getPCP(picture.state())->isLinked());

    // Set between update and drawing: computed before it is bound, drawn lit all the same.
    picture.viewer().advance();
    picture.viewer().updateTraversal();
    plain.setGloss(0.6);
    picture.viewer().renderingTraversals();
    picture.draw(2);
    EXPECT_NEAR(picture.redAt(0, 0), plain.expected(0.6, 50.0), 1.5);
    EXPECT_EQ(said.text(), "");
    EXPECT_EQ(takeGlErrors(), "");
}

// A layer of gloss instead of the settings', and after it has changed; a layer that the tile has
// not is none, one that cannot be is refused.
TEST(TerrainLighting, GlossLayerReplacesTheSettingsGloss)
{
    OTL_NEED_GL(context);
    Said said;
    GlossyPlain plain;
    TerrainLighting& lighting = *plain.lighting;
    ScenePicture picture(&lighting, reach);
    plain.look(picture, 50.0);
    plain.setGloss(0.6);
    picture.draw(2);
    plain.setGloss(0.0);
    const osg::ref_ptr<osgTerrain::ImageLayer> layer =
        new osgTerrain::ImageLayer(glossInTheEast(153)); // 0.6
    auto* tile =
        dynamic_cast<osgTerrain::TerrainTile*>(lighting.getChild(0)->asGroup()->getChild(0));
    ASSERT_TRUE(tile);
    tile->setColorLayer(1, layer);
    lighting.setGlossLayer(1);
    picture.draw(2);
    const double west = picture.redAt(-0.5, 0);
    EXPECT_GT(picture.redAt(0.5, 0), west + 20.0);
    layer->setImage(glossInTheEast(77)); // half of it
    picture.draw(2);
    EXPECT_GT(picture.redAt(0.5, 0), west + 10.0);
    lighting.setGlossLayer(2); // which it has not
    picture.draw(2);
    EXPECT_NEAR(picture.redAt(0.5, 0), west, 1.5);
    lighting.setGlossLayer(-1);
    EXPECT_EQ(said.text(), "");
    for (const int wrong : {-2, 0, 5})
        lighting.setGlossLayer(wrong);
    EXPECT_EQ(lighting.getGlossLayer(), -1);
    EXPECT_EQ(said.count("gloss layer not set: "), 3);
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: in what order ever they come, the second is refused.
TEST(TerrainLighting, ShadingAndGlossMayNotHaveTheSameTextureUnit)
{
    Said said;
    osg::ref_ptr<TerrainLighting> lighting = litCone();
    LightingSettings settings = lighting->getSettings();
    settings.gloss = 0.5;
    lighting->setTextureUnit(ShadingTexture::glossUnit);
    lighting->setSettings(settings);
    EXPECT_EQ(lighting->getSettings().gloss, 0.0);
    EXPECT_EQ(said.count("settings not set: gloss needs texture unit 5"), 1);
    lighting->setGlossLayer(1);
    EXPECT_EQ(lighting->getGlossLayer(), -1);
    EXPECT_EQ(said.count("gloss layer not set: gloss needs texture unit 5"), 1);
    lighting->setTextureUnit(4);
    lighting->setGlossLayer(1);
    EXPECT_EQ(lighting->getGlossLayer(), 1);
    lighting->setTextureUnit(ShadingTexture::glossUnit);
    EXPECT_EQ(lighting->getTextureUnit(), 4u);
    lighting->setGlossLayer(-1);
    lighting->setSettings(settings);
    EXPECT_EQ(lighting->getSettings().gloss, 0.5);
    lighting->setTextureUnit(ShadingTexture::glossUnit);
    EXPECT_EQ(lighting->getTextureUnit(), 4u);
    EXPECT_EQ(said.count("texture unit not set: gloss needs 5"), 2);
}

TEST(TerrainLighting, GlossWithAMethodThatHasNoneIsSaidOnce)
{
    Said said;
    osg::ref_ptr<TerrainLighting> lighting = litCone();
    LightingSettings settings = lighting->getSettings();
    settings.gloss = 0.5;
    lighting->setSettings(settings);
    EXPECT_EQ(said.text(), "");
    settings.bounceMethod = BounceMethod::Legendre;
    lighting->setSettings(settings);
    settings.azimuths = 8;
    lighting->setSettings(settings);
    EXPECT_EQ(said.count("gloss has no effect with bounce method legendre: needs slices"), 1);
}

// Expected: the sentences of problems(), each when it begins to hold.
TEST(TerrainLighting, WhatDoesNotDoAllThatItSeemsToIsSaidOnce)
{
    Said said;
    osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    LightingSettings settings;
    settings.bounces = 1;
    settings.albedo = {0.9f, 0.9f, 0.9f};
    settings.gloss = 0.5;
    lighting->setSettings(settings);
    settings.gloss = 0.6;
    lighting->setSettings(settings);
    EXPECT_EQ(said.count("albedo + gloss = 1.4: ground that sends more light"), 1) << said.text();
    EXPECT_EQ(said.count("albedo + gloss"), 1) << said.text();
    SkyLight sky;
    sky.turbidity = 5.0;
    sky.environmentGain = 2.0;
    for (int round = 0; round < 3; ++round)
    {
        sky.sunAzimuth += 10.0;
        lighting->setSkyLight(sky);
    }
    EXPECT_EQ(said.count("turbidity has no effect with sky uniform: needs sky clear"), 1);
    EXPECT_EQ(said.count("sky-gain has no effect with sky uniform: needs a sky from a file"), 1);
    EXPECT_EQ(lighting->getSkyLight().turbidity, 5.0) << "taken all the same";
    sky.skyModel = SkyModel::Clear;
    lighting->setSkyLight(sky);
    sky.skyModel = SkyModel::Uniform;
    lighting->setSkyLight(sky);
    EXPECT_EQ(said.count("turbidity has no effect"), 2) << "again after it had some";
}

// Expected: ground in the dark is black, with gloss too, in the default program and in a host's
// that reads gloss. The host's shows the shading besides, in blue, so that it is seen to be drawn.
TEST(TerrainLighting, GlossyGroundWithoutLightIsBlack)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    SkyLight dark;
    dark.skyEnabled = false;
    dark.sunElevation = -20.0;
    lighting->setSkyLight(dark);
    osg::ref_ptr<osg::Node> terrain = createTerrain(coneTile());
    lighting->addChild(terrain);
    ScenePicture picture(lighting, reach);
    LightingSettings settings = lighting->getSettings();
    settings.gloss = 0.5;
    lighting->setSettings(settings);
    picture.draw(2);
    EXPECT_EQ(picture.redAt(0.3, 0.2), 0.0);
    settings.bounceMethod = BounceMethod::Legendre;
    lighting->setSettings(settings);
    picture.draw(2);
    EXPECT_EQ(picture.redAt(0.3, 0.2), 0.0);

    const osg::ref_ptr<osg::Program> host = new osg::Program;
    for (const auto type : {osg::Shader::VERTEX, osg::Shader::FRAGMENT})
        host->addShader(createShadingShader(type, 330));
    host->addShader(createGlossShader(osg::Shader::FRAGMENT));
    host->addShader(new osg::Shader(osg::Shader::VERTEX, R"(#version 330 compatibility
vec2 terrainShadingCoordinate(vec4 source);
out vec2 place;
void main()
{
    gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
    place = terrainShadingCoordinate(gl_Vertex);
})"));
    host->addShader(new osg::Shader(osg::Shader::FRAGMENT, R"(#version 330 compatibility
vec4 terrainShading(vec2 coordinate);
vec3 terrainGloss(vec2 coordinate, vec3 toViewer);
in vec2 place;
void main()
{
    gl_FragColor = vec4(terrainGloss(place, vec3(0.0, 0.0, 1.0)).r, 0.0,
                        0.5 + 0.5 * terrainShading(place).r, 1.0);
})"));
    osg::ref_ptr<TerrainLighting> second = lightingWithBudget(0.0, 16);
    second->setSkyLight(dark);
    settings.bounceMethod = BounceMethod::Slices;
    second->setSettings(settings);
    osg::ref_ptr<osg::Node> theirs = createTerrain(coneTile());
    theirs->getOrCreateStateSet()->setAttribute(host);
    second->addChild(theirs);
    ScenePicture hostPicture(second, reach);
    hostPicture.draw(2);
    const auto blue = [&]
    { return int(hostPicture.pixels()[4 * (60 * ScenePicture::size + 70) + 2]); };
    EXPECT_EQ(hostPicture.redAt(0.3, 0.2), 0.0);
    EXPECT_NEAR(blue(), 128, 1);
    second->setSkyLight(whiteSky(0.5f));
    hostPicture.draw(2);
    EXPECT_GT(hostPicture.redAt(0.3, 0.2), 20.0);
    EXPECT_GT(blue(), 140);
    second->setSkyLight(dark);
    hostPicture.draw(2);
    EXPECT_EQ(hostPicture.redAt(0.3, 0.2), 0.0);
    EXPECT_NEAR(blue(), 128, 1);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(TerrainLighting, AStillSceneDispatchesNothingAndAChangeOnlyWhatItReaches)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<TerrainLighting> lighting = litCone();
    ScenePicture picture(lighting, reach);
    picture.draw(3);
    auto counts = lighting->getDispatchCounts();
    using Counts = std::map<std::string, unsigned>;
    EXPECT_EQ(counts, (Counts{{"horizon", 1},
                              {"table", 0},
                              {"sky", 1},
                              {"sun", 1},
                              {"shadow", 0},
                              {"key", 0},
                              {"shade", 1}}));
    picture.draw(20);
    EXPECT_EQ(lighting->getDispatchCounts(), counts);

    SkyLight sky = lighting->getSkyLight();
    sky.sunAzimuth = 100.0;
    lighting->setSkyLight(sky);
    picture.draw(3);
    counts["sun"] = counts["shade"] = 2;
    EXPECT_EQ(lighting->getDispatchCounts(), counts);
    sky.sunIrradiance = {1.0f, 1.0f, 1.0f}; // the sun's horizon does not depend on it
    lighting->setSkyLight(sky);
    picture.draw(3);
    counts["shade"] = 3;
    EXPECT_EQ(lighting->getDispatchCounts(), counts);
    LightingSettings settings = lighting->getSettings();
    settings.exposure = 1.5;
    lighting->setSettings(settings);
    lighting->setSkyLight(sky);
    picture.draw(3);
    EXPECT_EQ(lighting->getDispatchCount(), 1u + 1u + 2u + 3u);
}

// While the sun moves, tiles take turns with their bounces; once it stands, all catch up, and then
// a still scene dispatches nothing.
TEST(TerrainLighting, BouncesOfEveryNthFrameCatchUpWithLightThatStandsStill)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    for (int i = 0; i < 3; ++i)
        lighting->addChild(createTerrain(analytic::cone(33, 33, 10.0, 16, 16, 120.0, 120.0)));
    LightingSettings settings = lighting->getSettings();
    settings.bounces = 1;
    settings.bounceInterval = 3;
    lighting->setSettings(settings);
    ScenePicture picture(lighting, reach);
    picture.draw(3);
    ASSERT_EQ(lighting->getTileCount(), 3u);
    auto counts = lighting->getDispatchCounts();
    EXPECT_EQ(counts["bounce"], 3u);
    SkyLight sky = lighting->getSkyLight();
    for (unsigned frame = 1; frame <= 7; ++frame)
    {
        sky.sunAzimuth += 10.0;
        lighting->setSkyLight(sky);
        picture.draw();
        counts = lighting->getDispatchCounts();
        EXPECT_EQ(counts["bounce"], 3u + frame);
        EXPECT_EQ(counts["compose"], 3 * (1 + frame));
        EXPECT_EQ(counts["shade"], 3 * (1 + frame));
    }
    picture.draw();
    counts["bounce"] += 2; // the one whose turn it was is up to date
    counts["sent"] += 2;
    counts["compose"] += 2;
    EXPECT_EQ(lighting->getDispatchCounts(), counts);
    picture.draw(10);
    EXPECT_EQ(lighting->getDispatchCounts(), counts);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(TerrainLighting, EditedShadersAreTakenUpInAStillScene)
{
    OTL_NEED_GL(context);
    const auto sourceOf = [](const std::string& name)
    {
        std::ifstream file(OTL_SOURCE_DIR "/shaders/" + name);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    osg::ref_ptr<TerrainLighting> lighting = litCone();
    ScenePicture picture(lighting, reach);
    picture.draw(2);
    const std::vector<unsigned char> lit = picture.pixels();
    EXPECT_EQ(lighting->getDispatchCount(), 4u);
    for (const std::string name : {"passes/shade.comp", "host/default_terrain.frag"})
    {
        Said said;
        ShaderFile file(name, sourceOf(name) + "\njunk\n");
        picture.draw(2);
        EXPECT_FALSE(picture.pixels() == lit);
        EXPECT_NE(lighting->getFailure().find("shader " + name + " does not compile: "),
                  std::string::npos)
            << lighting->getFailure();
        EXPECT_EQ(said.count("; drawing"), 1) << said.text();
        file.write(sourceOf(name));
        picture.draw(2);
        EXPECT_TRUE(picture.pixels() == lit);
        EXPECT_EQ(lighting->getFailure(), "");
        const unsigned spent = lighting->getDispatchCount();
        picture.draw(3);
        EXPECT_EQ(lighting->getDispatchCount(), spent);
    }
    picture.draw(); // the file has gone: another edit
    EXPECT_TRUE(picture.pixels() == lit);
}

TEST(TerrainLighting, ATileAddedLaterIsLitDeepBelow)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    osg::ref_ptr<osg::Group> deep = new osg::Group;
    osg::ref_ptr<osg::Group> between = new osg::Group;
    between->addChild(deep);
    lighting->addChild(between);
    ScenePicture picture(lighting, reach);
    picture.draw(3);
    EXPECT_EQ(lighting->getTileCount(), 0u);
    osg::ref_ptr<osg::Node> terrain = createTerrain(coneTile());
    deep->addChild(terrain);
    picture.draw();
    EXPECT_EQ(lighting->getTileCount(), 1u);
    EXPECT_GT(picture.redAt(-0.3, 0.3), picture.redAt(0.3, -0.3) + 40.0);
    const unsigned spent = lighting->getDispatchCount();

    deep->removeChild(terrain);
    picture.draw(5);
    EXPECT_EQ(lighting->getTileCount(), 0u);
    EXPECT_EQ(lighting->getDispatchCount(), spent) << "counts of tiles that went are kept";
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(TerrainLighting, EditedHeightsAreLitAnew)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    lighting->setFadeSeconds(0.0); // TileFade tests fades
    osg::ref_ptr<osg::Node> terrain = createTerrain(analytic::plane(65, 65, 10.0, 0.0));
    lighting->addChild(terrain);
    ScenePicture picture(lighting, reach);
    picture.draw();
    const double level = picture.redAt(0.3, -0.3);
    auto* tile = dynamic_cast<osgTerrain::TerrainTile*>(terrain->asGroup()->getChild(0));
    ASSERT_TRUE(tile);
    auto* layer = dynamic_cast<osgTerrain::HeightFieldLayer*>(tile->getElevationLayer());
    const DemTile cone = coneTile();
    for (int row = 0; row < 65; ++row)
        for (int column = 0; column < 65; ++column)
            layer->getHeightField()->setHeight(static_cast<unsigned>(column),
                                               static_cast<unsigned>(row),
                                               cone.heightAt(column, row));
    layer->dirty();
    tile->setDirty(true);
    picture.draw(2);
    EXPECT_LT(picture.redAt(0.3, -0.3), level - 40.0);
    EXPECT_EQ(lighting->getTileCount(), 1u);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(TerrainLighting, SwitchedOffDrawsAsAPlainGroup)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<osg::Group> plain = new osg::Group;
    plain->addChild(createTerrain(coneTile()));
    std::vector<unsigned char> expected;
    {
        ScenePicture picture(plain, reach);
        picture.draw(2);
        expected = picture.pixels();
    }
    osg::ref_ptr<TerrainLighting> lighting = litCone();
    ScenePicture picture(lighting, reach);
    picture.draw(2);
    EXPECT_FALSE(picture.pixels() == expected);
    lighting->setLightEnabled(false);
    picture.draw(1);
    EXPECT_TRUE(picture.pixels() == expected);
    const unsigned spent = lighting->getDispatchCount();
    SkyLight sky;
    sky.sunAzimuth = 10.0;
    lighting->setSkyLight(sky);
    picture.draw(2);
    EXPECT_EQ(lighting->getDispatchCount(), spent);
    lighting->setLightEnabled(true);
    picture.draw();
    EXPECT_FALSE(picture.pixels() == expected);
    EXPECT_GT(lighting->getDispatchCount(), spent);
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: a budget that no piece keeps lets each frame run one, of a stage at most, and no tile
// is begun before the one before it is lit: horizon, sky, sun, shade.
TEST(TerrainLighting, TheBudgetSpreadsStepsOverFrames)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<TerrainLighting> lighting = litCone();
    lighting->addChild(createTerrain(coneTile()));
    lighting->addChild(createTerrain(coneTile()));
    lighting->setTimeBudget(1.0e-6);
    ScenePicture picture(lighting, reach);
    unsigned frames = 0;
    for (unsigned before = 0; before < 12 && frames < 2000; ++frames)
    {
        picture.draw();
        const unsigned now = lighting->getDispatchCount();
        EXPECT_LE(now, before + 1);
        EXPECT_EQ(lighting->getDispatchCounts()["shade"], now / 4);
        EXPECT_EQ(lighting->getStatistics().lit, now / 4);
        before = now;
    }
    EXPECT_GT(frames, 12u);
    picture.draw(3);
    EXPECT_EQ(lighting->getDispatchCount(), 12u);
}

// Expected: what was added, what is known to be refused, and the sizes of the tiles' textures: the
// horizons alone are 2 bytes per post and azimuth, of 33 x 33 and 16. Light takes time in the frame
// that it is computed in.
TEST(TerrainLighting, HasStatistics)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<TerrainLighting> lighting = litCone();
    ScenePicture picture(lighting, reach);
    picture.draw();
    EXPECT_GT(lighting->getStatistics().milliseconds, 0.0);
    picture.draw(2);
    const LightingStatistics still = lighting->getStatistics();
    EXPECT_EQ(still.tiles, 1u);
    EXPECT_EQ(still.lit, 1u);
    EXPECT_EQ(still.waiting, 0u);
    EXPECT_EQ(still.failed, 0u);
    EXPECT_EQ(still.milliseconds, 0.0);
    EXPECT_GT(still.bytes, coneTile().postCount() * 16u * 2u);
    osg::ref_ptr<osg::MatrixTransform> apart =
        new osg::MatrixTransform(osg::Matrix::translate(2000.0, 0.0, 0.0));
    apart->addChild(createTerrain(coneTile()));
    lighting->addChild(apart);
    lighting->setTimeBudget(1.0e-6);
    picture.draw(2);
    EXPECT_EQ(lighting->getStatistics().tiles, 2u);
    EXPECT_EQ(lighting->getStatistics().waiting, 1u);
}

TEST(TerrainLighting, RemovedTilesAreLeftAsTheyWere)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    osg::ref_ptr<osg::Node> bare = createTerrain(coneTile());
    osg::ref_ptr<osg::Node> dressed = createTerrain(coneTile());
    osg::Node* bareTile = bare->asGroup()->getChild(0);
    osg::Node* dressedTile = dressed->asGroup()->getChild(0);
    dressedTile->getOrCreateStateSet()->setMode(GL_CULL_FACE, osg::StateAttribute::ON);
    dressedTile->getStateSet()->setDataVariance(osg::Object::STATIC);
    const osg::ref_ptr<osg::StateSet> before =
        new osg::StateSet(*dressedTile->getStateSet(), osg::CopyOp::SHALLOW_COPY);
    lighting->addChild(bare);
    lighting->addChild(dressed);
    ScenePicture picture(lighting, reach);
    picture.draw(2); // one that may have been drawn already is bound in the second
    ASSERT_TRUE(bareTile->getStateSet());
    EXPECT_TRUE(bareTile->getStateSet()->getUniform(ShadingTexture::sampler));
    EXPECT_NE(dressedTile->getStateSet()->compare(*before, true), 0);
    lighting->removeChildren(0, 2);
    picture.draw(5);
    EXPECT_FALSE(bareTile->getStateSet());
    EXPECT_EQ(dressedTile->getStateSet()->compare(*before, true), 0);
    EXPECT_EQ(dressedTile->getStateSet()->getDataVariance(), before->getDataVariance());
}

TEST(TerrainLighting, LightsAHostsOwnTerrain)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<osg::Geometry> quad = osg::createTexturedQuadGeometry(
        osg::Vec3(-320, -320, 0), osg::Vec3(640, 0, 0), osg::Vec3(0, 640, 0));
    quad->setTexCoordArray(ShadingTexture::coordinateSet, quad->getTexCoordArray(0));
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    lighting->addChild(quad);
    osg::StateSet* stateSet = quad->getOrCreateStateSet();
    TileHandle tile = lighting->addTile(coneTile(), stateSet, {}, true);
    EXPECT_TRUE(tile);
    {
        Said said;
        EXPECT_FALSE(lighting->addTile(coneTile(), stateSet));
        EXPECT_EQ(said.count("tile not added"), 1);
    }
    ScenePicture picture(lighting, reach);
    picture.draw();
    EXPECT_GT(picture.redAt(-0.3, 0.3), picture.redAt(0.3, -0.3) + 40.0);

    // The same by position.
    EXPECT_TRUE(lighting->removeTile(tile));
    ShadingCoordinates byPosition;
    byPosition.source = ShadingCoordinates::Source::Vertex;
    byPosition.toTile = osg::Matrixd::translate(320.0, 320.0, 0.0) *
                        osg::Matrixd::scale(1.0 / 640.0, 1.0 / 640.0, 1.0);
    const std::vector<unsigned char> byTexCoord = picture.pixels();
    tile = lighting->addTile(coneTile(), stateSet, byPosition, true);
    EXPECT_TRUE(tile);
    picture.draw();
    std::size_t different = 0;
    for (std::size_t i = 0; i < byTexCoord.size(); ++i)
        different += std::abs(byTexCoord[i] - picture.pixels()[i]) > 1;
    EXPECT_EQ(different, 0u);
    EXPECT_TRUE(lighting->removeTile(tile));
    picture.draw(4);
    EXPECT_TRUE(stateSet->getUniformList().empty());
    EXPECT_TRUE(stateSet->getAttributeList().empty());
    EXPECT_TRUE(stateSet->getTextureAttributeList().empty());
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(TerrainLighting, VoidsHaveNoGeometryAndOpenTheHorizon)
{
    OTL_NEED_GL(context);
    DemTile tile = analytic::plane(65, 65, 10.0, 500.0);
    for (int row = 20; row < 45; ++row)
        for (int column = 20; column < 45; ++column)
            tile.setVoid(column, row);
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    lighting->setSkyLight(whiteSky(0.25f));
    osg::ref_ptr<osg::Node> terrain = createTerrain(tile);
    lighting->addChild(terrain);
    ScenePicture picture(lighting, reach);
    picture.draw(2);
    EXPECT_EQ(picture.redAt(0.0, 0.0), 0.0); // the background, which is blue
    EXPECT_NEAR(picture.redAt(-0.8, 0.8), 137.0, 1.5);
    EXPECT_LT(terrain->getBound().radius(), 500.0);
}

TEST(TerrainLighting, RefusesValuesOutsideTheirRange)
{
    osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    Said said;
    SkyLight sky;
    sky.sunElevation = 100.0;
    lighting->setSkyLight(sky);
    EXPECT_EQ(lighting->getSkyLight().sunElevation, SkyLight().sunElevation);
    sky = SkyLight();
    sky.skyHarmonics.resize(3);
    lighting->setSkyLight(sky);
    EXPECT_TRUE(lighting->getSkyLight().skyHarmonics.empty());
    sky.skyHarmonics.clear();
    sky.keyLights.resize(9);
    lighting->setSkyLight(sky);
    sky.keyLights.resize(1);
    sky.keyLights[0].lowest = sky.keyLights[0].highest;
    lighting->setSkyLight(sky);
    EXPECT_TRUE(lighting->getSkyLight().keyLights.empty());
    LightingSettings settings;
    settings.azimuths = 30;
    lighting->setSettings(settings);
    EXPECT_EQ(lighting->getSettings().azimuths, LightingSettings().azimuths);
    lighting->setTimeBudget(std::nan(""));
    EXPECT_EQ(lighting->getTimeBudget(), 50.0);
    for (const double seconds : {-0.1, 3601.0, std::nan("")})
        lighting->setFadeSeconds(seconds);
    EXPECT_EQ(lighting->getFadeSeconds(), 0.5);
    EXPECT_EQ(said.count("not set"), 9) << said.text();
}

TEST(TerrainLighting, GoesThroughAFileAndBack)
{
    useOwnPlugins();
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    SkyLight sky;
    sky.sunAzimuth = 123.25;
    sky.sunElevation = 12.5;
    sky.skyEnabled = false;
    sky.sunIrradiance = {1.0f, 2.0f, 3.0f};
    sky.skyHarmonics = {{1.0f, 2.0f, 3.0f}, {-0.5f, 0.0f, 0.25f}, {0.1f, 0.2f, 0.3f}, {}};
    sky.skyModel = SkyModel::Clear;
    sky.turbidity = 4.5;
    sky.keyLights.resize(2);
    sky.keyLights[1].azimuth = -33.5;
    sky.keyLights[1].radiance = {0.5f, 4.0f, 0.0f};
    lighting->setSkyLight(sky);
    LightingSettings settings;
    settings.azimuths = 64;
    settings.quality = HorizonQuality::Best;
    settings.exposure = -1.5;
    settings.bounceInterval = 7;
    settings.bodyRadius = 1737400.0;
    settings.gloss = 0.25;
    settings.glossExponent = 12.0;
    settings.glossTransfer = GlossTransfer::Scalar;
    settings.glossViewer = {0.0, 1.0, 2.0};
    lighting->setSettings(settings);
    lighting->setLightEnabled(false);
    lighting->setFadeSeconds(0.25);
    lighting->setTextureUnit(4);
    lighting->setGlossLayer(3);
    lighting->addEventCallback(new LightingHandler);
    lighting->addChild(createTerrain(coneTile()));
    for (const char* extension : {"osgt", "osgb", "osgx"})
    {
        const std::string path = (testFolder() / "again.").string() + extension;
        ASSERT_TRUE(osgDB::writeNodeFile(*lighting, path));
        osg::ref_ptr<osg::Node> node = osgDB::readRefNodeFile(path);
        auto* read = dynamic_cast<TerrainLighting*>(node.get());
        ASSERT_TRUE(read) << extension;
        EXPECT_EQ(read->getSkyLight().sunAzimuth, 123.25);
        EXPECT_EQ(read->getSkyLight().sunElevation, 12.5);
        EXPECT_FALSE(read->getSkyLight().skyEnabled);
        EXPECT_TRUE(read->getSkyLight().sunEnabled);
        EXPECT_EQ(read->getSkyLight().sunIrradiance, sky.sunIrradiance);
        EXPECT_EQ(read->getSkyLight().skyHarmonics, sky.skyHarmonics);
        ASSERT_EQ(read->getSkyLight().keyLights.size(), 2u);
        EXPECT_EQ(read->getSkyLight().keyLights[0].highest, 50.0);
        EXPECT_EQ(read->getSkyLight().keyLights[1].azimuth, -33.5);
        EXPECT_EQ(read->getSkyLight().keyLights[1].radiance, sky.keyLights[1].radiance);
        EXPECT_EQ(read->getSettings().azimuths, 64);
        EXPECT_EQ(read->getSettings().bounceInterval, 7);
        EXPECT_EQ(read->getSettings().bodyRadius, 1737400.0);
        EXPECT_EQ(read->getSkyLight().skyModel, SkyModel::Clear);
        EXPECT_EQ(read->getSkyLight().turbidity, 4.5);
        EXPECT_EQ(read->getSettings().quality, HorizonQuality::Best);
        EXPECT_EQ(read->getSettings().exposure, -1.5);
        EXPECT_FALSE(read->getLightEnabled());
        EXPECT_EQ(read->getTimeBudget(), 0.0);
        EXPECT_EQ(read->getFadeSeconds(), 0.25);
        EXPECT_EQ(read->getTextureUnit(), 4u);
        EXPECT_EQ(read->getGlossLayer(), 3);
        EXPECT_EQ(read->getSettings().gloss, 0.25);
        EXPECT_EQ(read->getSettings().glossExponent, 12.0);
        EXPECT_EQ(read->getSettings().glossTransfer, GlossTransfer::Scalar);
        EXPECT_EQ(read->getSettings().glossViewer, settings.glossViewer);
        EXPECT_TRUE(dynamic_cast<LightingHandler*>(read->getEventCallback()));
        EXPECT_EQ(read->getNumChildren(), 1u);
    }
}

// Expected: what TerrainLighting's copy constructor says.
TEST(TerrainLighting, CopiesHaveWhatTheHeaderSays)
{
    osg::ref_ptr<TerrainLighting> lighting = litCone();
    SkyLight sky;
    sky.sunElevation = 12.0;
    lighting->setSkyLight(sky);
    lighting->setPlace({11.5, 48.1, 0.0});
    lighting->setTime(UtcTime());
    lighting->setLightEnabled(false);
    lighting->setTimeBudget(7.0);
    lighting->setFadeSeconds(1.5);
    lighting->setTextureUnit(9);
    lighting->setGlossUnit(10);
    lighting->setGlossLayer(2);
    lighting->setDefaultProgramEnabled(false);
    lighting->addEventCallback(new LightingHandler);
    const osg::ref_ptr<osg::StateSet> stateSet = new osg::StateSet;
    EXPECT_TRUE(lighting->addTile(coneTile(), stateSet));
    const osg::ref_ptr<TerrainLighting> copy =
        osg::clone(lighting.get(), osg::CopyOp::DEEP_COPY_NODES);
    EXPECT_EQ(copy->getSettings().azimuths, 16);
    EXPECT_EQ(copy->getSkyLight().sunElevation, lighting->getSkyLight().sunElevation);
    ASSERT_TRUE(copy->getPlace());
    EXPECT_EQ(copy->getPlace()->latitude, 48.1);
    EXPECT_EQ(copy->getTime(), lighting->getTime());
    EXPECT_FALSE(copy->getLightEnabled());
    EXPECT_EQ(copy->getTimeBudget(), 7.0);
    EXPECT_EQ(copy->getFadeSeconds(), 1.5);
    EXPECT_EQ(copy->getTextureUnit(), 9u);
    EXPECT_EQ(copy->getGlossUnit(), 10u);
    EXPECT_EQ(copy->getGlossLayer(), 2);
    EXPECT_FALSE(copy->getDefaultProgramEnabled());
    EXPECT_EQ(copy->getNumChildren(), 1u);
    EXPECT_EQ(copy->getTileCount(), 0u);
    EXPECT_TRUE(copy->getTileHandles().empty());
    EXPECT_FALSE(copy->getEventCallback()) << "OSG copies none";
    EXPECT_EQ(copy->getNumChildrenRequiringUpdateTraversal(),
              lighting->getNumChildrenRequiringUpdateTraversal());
}

TEST(TerrainTileReader, MeasuresGeographicAndGeocentricTilesInMetres)
{
    const double degrees = osg::PI / 180.0;
    for (const auto type : {osgTerrain::Locator::GEOGRAPHIC, osgTerrain::Locator::GEOCENTRIC})
    {
        osg::ref_ptr<osgTerrain::Locator> locator = new osgTerrain::Locator;
        locator->setCoordinateSystemType(type);
        locator->setTransformAsExtents(10.0 * degrees, 60.0 * degrees, 10.1 * degrees,
                                       60.1 * degrees);
        const Result<TerrainHeights> heights = readTerrainTile(*tileWith(locator, 101), {});
        ASSERT_TRUE(heights) << heights.error().message;
        const DemTile* dem = &heights->dem;
        // WGS 84: a thousandth of a degree at 60.05 degrees north is 111.414 m north, and at 60 and
        // 60.1 degrees 55.800 m and 55.631 m east.
        EXPECT_NEAR(dem->northSpacing, 111.414, 0.01);
        ASSERT_EQ(dem->eastSpacings.size(), 101u);
        EXPECT_NEAR(dem->eastSpacings.front(), 55.800, 0.01);
        EXPECT_NEAR(dem->eastSpacings.back(), 55.631, 0.01);
    }
}

TEST(TerrainTileReader, GeocentricTilesGetTileCoordinates)
{
    const double degrees = osg::PI / 180.0;
    osg::ref_ptr<osgTerrain::Locator> locator = new osgTerrain::Locator;
    locator->setCoordinateSystemType(osgTerrain::Locator::GEOCENTRIC);
    locator->setTransformAsExtents(10.0 * degrees, 60.0 * degrees, 11.0 * degrees, 61.0 * degrees);
    osg::ref_ptr<osgTerrain::TerrainTile> tile = tileWith(locator, 11);
    osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
    osg::ref_ptr<osg::Vec3Array> vertices = new osg::Vec3Array;
    osg::Vec3d centre;
    locator->convertLocalToModel(osg::Vec3d(0.5, 0.5, 0.0), centre);
    for (const osg::Vec3d& place :
         {osg::Vec3d(0, 0, 0), osg::Vec3d(1, 1, 900), osg::Vec3d(0.25, 1, 0)})
    {
        osg::Vec3d model;
        locator->convertLocalToModel(place, model);
        vertices->push_back(model - centre);
    }
    geometry->setVertexArray(vertices);
    const std::vector<TilePart> parts = {{geometry, osg::Matrixd::translate(centre)}};
    EXPECT_FALSE(affineCoordinates(*tile, parts).has_value());
    addTileCoordinates(*tile, parts);
    const auto* found = dynamic_cast<const osg::Vec2Array*>(
        geometry->getTexCoordArray(ShadingTexture::coordinateSet));
    ASSERT_TRUE(found);
    // Vertices are floats of up to 1e5 m: 4 mm, 1e-7 of the tile.
    EXPECT_NEAR((*found)[0].x(), 0.0, 1e-6);
    EXPECT_NEAR((*found)[1].x(), 1.0, 1e-6);
    EXPECT_NEAR((*found)[1].y(), 1.0, 1e-6);
    EXPECT_NEAR((*found)[2].x(), 0.25, 1e-6);
    EXPECT_NEAR((*found)[2].y(), 1.0, 1e-6);
}

TEST(TerrainTileReader, MapsPostsOfAProjectedTileFarFromTheOrigin)
{
    osg::ref_ptr<osgTerrain::Locator> locator = new osgTerrain::Locator;
    locator->setCoordinateSystemType(osgTerrain::Locator::PROJECTED);
    locator->setTransformAsExtents(500000.0, 4.0e6, 501000.0, 4.0005e6);
    osg::ref_ptr<osgTerrain::TerrainTile> tile = tileWith(locator, 21);
    const std::vector<TilePart> parts = {
        {new osg::Geometry, osg::Matrixd::translate(500500.0, 4.00025e6, 0.0)}};
    const auto coordinates = affineCoordinates(*tile, parts);
    ASSERT_TRUE(coordinates.has_value());
    const osg::Vec3d found = osg::Vec3d(-500.0, 250.0, 77.0) * coordinates->toTile;
    EXPECT_NEAR(found.x(), 0.0, 1e-9);
    EXPECT_NEAR(found.y(), 1.0, 1e-9);
}

TEST(TerrainLighting, ATurnedTileIsNamedAndDrawnUnlit)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<osg::MatrixTransform> turned =
        new osg::MatrixTransform(osg::Matrix::rotate(0.3, osg::Vec3(0, 0, 1)));
    osg::ref_ptr<osgTerrain::Locator> locator = new osgTerrain::Locator;
    locator->setCoordinateSystemType(osgTerrain::Locator::PROJECTED);
    locator->setTransformAsExtents(-320.0, -320.0, 320.0, 320.0);
    osg::ref_ptr<osgTerrain::TerrainTile> tile = tileWith(locator, 11);
    tile->setName("turned");
    turned->addChild(tile);
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    lighting->addChild(turned);
    Said said;
    ScenePicture picture(lighting, reach);
    picture.draw(5);
    EXPECT_EQ(said.count("terrain tile \"turned\" is drawn unlit"), 1) << said.text();
    const TileState state = lighting->getTileState(lighting->getTileHandle(tile));
    EXPECT_EQ(state.stage, TileState::Stage::Failed);
    EXPECT_NE(state.reason.find("its locator or a transform above turns it"), std::string::npos);
    EXPECT_GT(picture.redAt(0, 0), 0.0);
}

TEST(TerrainLighting, ReleasedAndResizedLikeAnyNode)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<TerrainLighting> lighting = litCone();
    std::vector<unsigned char> first;
    // Each picture has a context of its own, and releases the scene's objects in it at its end.
    for (unsigned round = 1; round <= 3; ++round)
    {
        lighting->resizeGLObjectBuffers(4 * round);
        ScenePicture picture(lighting, reach);
        picture.draw();
        EXPECT_EQ(lighting->getDispatchCounts().at("shade"), round);
        EXPECT_EQ(takeGlErrors(), "");
        if (round == 1)
            first = picture.pixels();
        EXPECT_TRUE(picture.pixels() == first);
    }
    lighting->releaseGLObjects();
    ScenePicture one(lighting, reach);
    ScenePicture other(lighting, reach);
    one.draw();
    EXPECT_TRUE(one.pixels() == first);
    other.draw();
    EXPECT_TRUE(other.pixels() == first);
    EXPECT_EQ(lighting->getDispatchCounts().at("shade"), 5u);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(TerrainLighting, AContextThatSleptThroughASwitchIsLitAsTheOthers)
{
    OTL_NEED_GL(context);
    osg::ref_ptr<TerrainLighting> lighting = litCone();
    ScenePicture awake(lighting, reach);
    ScenePicture asleep(lighting, reach);
    awake.draw();
    asleep.draw();
    const SkyLight both;
    SkyLight skyOnly = both;
    skyOnly.sunEnabled = false;
    lighting->setSkyLight(skyOnly);
    awake.draw();
    lighting->setSkyLight(both);
    awake.draw();
    asleep.draw();
    EXPECT_TRUE(asleep.pixels() == awake.pixels());
}

TEST(TerrainLighting, LightsAGeocentricTileByItsOwnNorth)
{
    OTL_NEED_GL(context);
    // The cone again, at 45 degrees north, 120 degrees east, seen from above with north up.
    const double latitude = osg::PI / 4.0, longitude = 2.0 * osg::PI / 3.0;
    const osg::EllipsoidModel earth;
    const double halfNorth = reach / 6.3674e6, halfEast = reach / (6.3888e6 * std::cos(latitude));
    osg::ref_ptr<osgTerrain::Locator> locator = new osgTerrain::Locator;
    locator->setCoordinateSystemType(osgTerrain::Locator::GEOCENTRIC);
    locator->setTransformAsExtents(longitude - halfEast, latitude - halfNorth, longitude + halfEast,
                                   latitude + halfNorth);
    osg::ref_ptr<osgTerrain::TerrainTile> tile = tileWith(locator, 65);
    auto* layer = dynamic_cast<osgTerrain::HeightFieldLayer*>(tile->getElevationLayer());
    const DemTile cone = coneTile();
    for (int row = 0; row < 65; ++row)
        for (int column = 0; column < 65; ++column)
            layer->getHeightField()->setHeight(static_cast<unsigned>(column),
                                               static_cast<unsigned>(row),
                                               cone.heightAt(column, row));
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    lighting->addChild(tile);
    osg::Matrixd place;
    earth.computeLocalToWorldTransformFromLatLongHeight(latitude, longitude, 0.0, place);
    osg::ref_ptr<osg::MatrixTransform> scene =
        new osg::MatrixTransform(osg::Matrixd::inverse(place));
    scene->addChild(lighting);
    std::vector<unsigned char> geocentric;
    {
        ScenePicture picture(scene, reach);
        picture.draw(2);
        geocentric = picture.pixels();
    }
    ScenePicture picture(litCone(), reach);
    picture.draw();
    std::size_t different = 0;
    for (std::size_t i = 0; i < geocentric.size(); ++i)
        different += std::abs(geocentric[i] - picture.pixels()[i]) > 8 ? 1u : 0u;
    // Other triangles along the outline of shadows, and the picture's edge.
    EXPECT_LT(different, geocentric.size() / 50);
    EXPECT_EQ(takeGlErrors(), "");
}
