#include "scene/SkyDome.h"

#include "core/SkyRadiance.h"
#include "support/GlContext.h"
#include "support/ScenePicture.h"
#include <osgTerrainLight/Environment.h>

#include <osg/ComputeBoundsVisitor>
#include <osgDB/ReadFile>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;
using Direction = std::array<double, 3>;

Direction towards(double azimuth, double elevation)
{
    const double a = azimuth * pi / 180.0, e = elevation * pi / 180.0;
    return {std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), std::sin(e)};
}

/// IEC 61966-2-1, 0 … 255.
double srgb(double linear)
{
    const double v = std::clamp(linear, 0.0, 1.0);
    return 255.0 * (v > 0.0031308 ? 1.055 * std::pow(v, 1.0 / 2.4) - 0.055 : 12.92 * v);
}

/// A DEM as the plugin reads it, and pixels in directions from above its middle. The background is
/// blue, which no sky here is.
class Looking
{
public:
    Looking()
        : _node((useOwnPlugins(),
                 osgDB::readRefNodeFile(OTL_SOURCE_DIR "/samples/data/jacksboro_90m.tif"
                                                       ".terrainlight"))),
          _picture(_node, 1.0)
    {
        _picture.viewer().getCamera()->setProjectionMatrixAsPerspective(2.0, 1.0, 1.0, 1.0e6);
    }
    TerrainLighting& lighting() { return dynamic_cast<TerrainLighting&>(*_node); }
    osg::Node& node() { return *_node; }

    /// The pixel in the middle of the picture.
    std::array<double, 3> at(const Direction& d)
    {
        const osg::Vec3d eye(0.0, 0.0, 9000.0);
        _picture.viewer().getCamera()->setViewMatrixAsLookAt(
            eye, eye + osg::Vec3d(d[0], d[1], d[2]), osg::Vec3d(0.0, 0.01, 1.0));
        _picture.draw(2);
        constexpr std::size_t middle = 4 * (ScenePicture::size / 2) * (ScenePicture::size + 1);
        const std::vector<unsigned char>& pixels = _picture.pixels();
        return {double(pixels[middle]), double(pixels[middle + 1]), double(pixels[middle + 2])};
    }

private:
    osg::ref_ptr<osg::Node> _node;
    ScenePicture _picture;
};

void expectColour(const std::array<double, 3>& found, const std::array<double, 3>& radiance,
                  double within, const std::string& where)
{
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(found[c], srgb(radiance[c]), within) << where << ", channel " << c;
}

std::array<double, 3> valuesOf(const Rgb& colour, double factor = 1.0)
{
    return {factor * double(colour[0]), factor * double(colour[1]), factor * double(colour[2])};
}
} // namespace

// Expected: pixels are the model's radiance in double, exposed; within the step of 8 bits and its
// noise, and what a picture of 1.4 degrees a texel leaves.
TEST(SkyDome, ShowsTheSkyThatLightsTheTerrain)
{
    OTL_NEED_GL(context);
    Looking looking;
    LightingSettings settings = looking.lighting().getSettings();
    settings.exposure = 1.0;
    looking.lighting().setSettings(settings);
    for (const SkyModel model : {SkyModel::Uniform, SkyModel::Overcast, SkyModel::Clear})
    {
        SkyLight sky;
        sky.skyModel = model;
        sky.sunAzimuth = 120.0;
        sky.sunElevation = 30.0;
        looking.lighting().setSkyLight(sky);
        for (const double azimuth : {0.0, 77.0, 200.0, 300.0})
            for (const double elevation : {5.0, 45.0, 88.0})
            {
                const Direction d = towards(azimuth, elevation);
                auto radiance = modelRadiance(sky, d);
                for (double& channel : radiance)
                    channel *= 2.0;
                expectColour(looking.at(d), radiance, 3.0,
                             std::string(toString(model)) + " " + std::to_string(azimuth) + ", " +
                                 std::to_string(elevation));
            }
    }
}

// Expected: the disc is white within its radius and not there beyond it.
TEST(SkyDome, ShowsTheSun)
{
    OTL_NEED_GL(context);
    Looking looking;
    SkyLight sky;
    sky.sunAzimuth = 210.0;
    sky.sunElevation = 20.0;
    sky.sunAngularRadius = 1.0;
    looking.lighting().setSkyLight(sky);
    const std::array<double, 3> white = {1.0, 1.0, 1.0};
    for (const double away : {-0.9, 0.0, 0.9})
        expectColour(looking.at(towards(210.0, 20.0 + away)), white, 1.0, std::to_string(away));
    for (const double away : {-1.1, 1.1})
        expectColour(looking.at(towards(210.0, 20.0 + away)), valuesOf(sky.skyRadiance), 2.0,
                     std::to_string(away));
    sky.sunEnabled = false;
    looking.lighting().setSkyLight(sky);
    expectColour(looking.at(towards(210.0, 20.0)), valuesOf(sky.skyRadiance), 2.0, "without");
}

// Expected: a quarter of a panorama each for east, north, west and south; a heading of 90 degrees
// turns what was north to the east.
TEST(SkyDome, ShowsAPanorama)
{
    OTL_NEED_GL(context);
    Looking looking;
    const std::array<Rgb, 4> quarters = {
        {{0.1f, 0.2f, 0.3f}, {0.4f, 0.1f, 0.2f}, {0.2f, 0.5f, 0.1f}, {0.3f, 0.3f, 0.05f}}};
    std::vector<Rgb> texels;
    for (int row = 0; row < 32; ++row)
        for (int column = 0; column < 64; ++column)
            texels.push_back(quarters[static_cast<std::size_t>((column + 8) % 64 / 16)]);
    std::string problem;
    const auto environment = createEnvironment(64, 32, texels, problem);
    ASSERT_TRUE(environment) << problem;
    for (const int turns : {0, 1, 2})
    {
        SkyLight sky;
        sky.setEnvironment(environment, 90.0 * turns, 1.5);
        looking.lighting().setSkyLight(sky);
        for (const int quarter : {0, 1, 2, 3})
        {
            // Azimuths are clockwise from north, quarters counter-clockwise from east.
            const double azimuth = 90.0 - 90.0 * quarter + 90.0 * turns;
            expectColour(looking.at(towards(azimuth, 30.0)),
                         valuesOf(quarters[static_cast<std::size_t>(quarter)], 1.5), 2.0,
                         std::to_string(quarter));
        }
    }
}

// Expected: level ground of the lighting's albedo, whose irradiance is pi times the radiance of a
// uniform sky, and the sun's times the sine of its elevation.
TEST(SkyDome, ShowsGroundBelowTheHorizontal)
{
    OTL_NEED_GL(context);
    SkyLight sky;
    sky.sunElevation = 30.0;
    const Rgb albedo = {0.5f, 0.4f, 0.3f};
    const Raster<Rgb> picture = skyPicture(sky, 64, albedo, sky.sunIrradiance);
    for (std::size_t c = 0; c < 3; ++c)
    {
        const double expected = double(albedo[c]) * (double(sky.skyRadiance[c]) +
                                                     0.5 * double(sky.sunIrradiance[c]) / pi);
        EXPECT_NEAR(picture.at(5, 3)[c], expected, 1e-3);
        EXPECT_NEAR(picture.at(100, 20)[c], expected, 1e-3); // 33 degrees below
        EXPECT_FLOAT_EQ(picture.at(5, 40)[c], sky.skyRadiance[c]);
        EXPECT_NEAR(picture.at(5, 31)[c], sky.skyRadiance[c], 0.06); // haze
    }
}

// Expected: the dome has no extent, is no child, and is drawn only with light: the background's
// blue is seen where the light, or the sky, is off.
TEST(SkyDome, IsNoPartOfTheScene)
{
    OTL_NEED_GL(context);
    Looking looking;
    EXPECT_EQ(looking.lighting().getNumChildren(), 1u);
    const Direction up = towards(0.0, 60.0);
    looking.at(up);
    osg::ComputeBoundsVisitor bounds;
    looking.node().accept(bounds);
    EXPECT_LT(bounds.getBoundingBox().radius(), 1e5);
    const std::array<double, 3> background = {0.0, 0.0, 255.0};
    EXPECT_NE(looking.at(up), background);
    SkyLight sky;
    sky.skyEnabled = false;
    looking.lighting().setSkyLight(sky);
    EXPECT_EQ(looking.at(up), background);
    looking.lighting().setSkyLight(SkyLight());
    EXPECT_NE(looking.at(up), background);
    looking.lighting().setLightEnabled(false);
    EXPECT_EQ(looking.at(up), background);
}
