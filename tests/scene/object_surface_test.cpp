// The surfaces of placed objects, drawn: white boxes on a plain under a uniform sky.
#include <osgTerrainLight/PlacedObject.h>
#include <osgTerrainLight/TerrainLighting.h>

#include "reference/PathTracer.h"
#include "scene/ObjectField.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/ScenePicture.h"
#include "terrain/TerrainModel.h"

#include <osg/Geode>
#include <osg/Material>
#include <osg/MatrixTransform>
#include <osg/Program>
#include <osg/ShapeDrawable>
#include <osg/Texture2D>

#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

using namespace osgTerrainLight;
using reference::LinearRgb;

namespace
{

constexpr double pi = 3.14159265358979323846;
constexpr double halfSide = 16.0; ///< of pictures [m]; the plain has 65 posts in 1 m
constexpr double radiance = 0.6;

/// A mean over 7 pixels of a quarter of a metre, in 8 bits: a step of 1 / 255 is 0.009 of linear
/// light where that is brightest.
constexpr double drawn = 0.01;
/// Asked of cones: 4 % of the open sky's light.
constexpr double cones = 0.04 * radiance;

double linearOf(double code)
{
    return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
}

/// Upright, about a place.
struct Box
{
    glm::dvec3 centre, half;

    bool stops(const glm::dvec3& from, const glm::dvec3& direction) const
    {
        double first = 0.0, last = 1.0e30;
        for (int axis = 0; axis < 3; ++axis)
        {
            const double a = (centre[axis] - half[axis] - from[axis]) / direction[axis];
            const double b = (centre[axis] + half[axis] - from[axis]) / direction[axis];
            first = std::max(first, std::min(a, b));
            last = std::min(last, std::max(a, b));
        }
        return last > first;
    }
    osg::ref_ptr<PlacedObject> object() const
    {
        const osg::ref_ptr<osg::Geode> geode = new osg::Geode;
        geode->addDrawable(new osg::ShapeDrawable(
            new osg::Box(osg::Vec3(float(centre.x), float(centre.y), float(centre.z)),
                         float(2.0 * half.x), float(2.0 * half.y), float(2.0 * half.z))));
        const osg::ref_ptr<PlacedObject> object = new PlacedObject;
        object->addChild(geode);
        return object;
    }
};

/// Irradiance / pi of a place by the sky above the horizontal that a box leaves, by rays: 200 by
/// 200, of the cosine's density.
double skyBy(const Box& box, const glm::dvec3& place, const glm::dvec3& normal)
{
    constexpr int strata = 200;
    const glm::dvec3 side = glm::normalize(glm::cross(normal, glm::dvec3(0.1, 0.2, 1.0)));
    const glm::dvec3 other = glm::cross(normal, side);
    int seen = 0;
    for (int i = 0; i < strata; ++i)
        for (int j = 0; j < strata; ++j)
        {
            const double r = std::sqrt((i + 0.5) / strata), turn = 2.0 * pi * (j + 0.5) / strata;
            const glm::dvec3 ray = side * (r * std::cos(turn)) + other * (r * std::sin(turn)) +
                                   normal * std::sqrt(1.0 - r * r);
            seen += ray.z > 0.0 && !box.stops(place, ray);
        }
    return radiance * seen / (strata * strata);
}

struct Plain
{
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    osg::ref_ptr<osg::MatrixTransform> place = new osg::MatrixTransform;
    std::unique_ptr<ScenePicture> picture;

    explicit Plain(const std::vector<osg::ref_ptr<PlacedObject>>& objects, bool sun = false,
                   const Rgb& albedo = {0.0f, 0.0f, 0.0f})
    {
        lighting->addChild(createTerrain(analytic::plane(65, 65, 1.0, 0.0)));
        SkyLight sky;
        sky.skyModel = SkyModel::Uniform;
        sky.skyRadiance = {float(radiance), float(radiance), float(radiance)};
        sky.sunEnabled = sun;
        sky.sunIrradiance = {1.2f, 1.2f, 1.2f};
        sky.sunAzimuth = 90.0;
        sky.sunElevation = 45.0;
        lighting->setSkyLight(sky);
        LightingSettings settings = lighting->getSettings();
        settings.albedo = albedo;
        lighting->setSettings(settings);
        for (const auto& object : objects)
            place->addChild(object);
        lighting->addChild(place);
        picture = std::make_unique<ScenePicture>(lighting, halfSide);
        picture->draw(4);
    }
    void bounce(int count)
    {
        LightingSettings settings = lighting->getSettings();
        settings.bounces = count;
        lighting->setSettings(settings);
        picture->draw(4);
    }
    /// From a place in the south, level to the north: what is 1 m before it, and beyond.
    void lookNorth(double north, double height)
    {
        picture->viewer().getCamera()->setViewMatrixAsLookAt(osg::Vec3d(0.0, north, height),
                                                             osg::Vec3d(0.0, north + 1.0, height),
                                                             osg::Vec3d(0.0, 0.0, 1.0));
        picture->draw(2);
    }
    /// Linear, at a place of the picture [m from its middle].
    double lightAt(double right, double up) const
    {
        return linearOf(picture->redAt(right / halfSide, up / halfSide) / 255.0);
    }
    double channelAt(double right, double up, std::size_t channel) const
    {
        const auto pixel = [](double at) {
            return std::size_t(std::lround((0.5 + 0.5 * at / halfSide) * (ScenePicture::size - 1)));
        };
        const std::size_t at = 4 * (pixel(up) * ScenePicture::size + pixel(right)) + channel;
        return linearOf(picture->pixels().at(at) / 255.0);
    }
};

const Box house = {{0.0, 0.0, 2.0}, {4.0, 4.0, 2.0}};
const Box facing = {{0.0, -9.0, 3.0}, {6.0, 1.0, 3.0}};

osg::ref_ptr<osg::Program> programOf(const std::string& fragment)
{
    const osg::ref_ptr<osg::Program> program = new osg::Program;
    program->addShader(new osg::Shader(osg::Shader::VERTEX, R"(#version 330 compatibility
varying vec3 place;
varying vec3 normal;
void main()
{
    place = (gl_ModelViewMatrix * gl_Vertex).xyz;
    normal = gl_NormalMatrix * gl_Normal;
    gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
})"));
    program->addShader(
        new osg::Shader(osg::Shader::FRAGMENT, "#version 330 compatibility\n" + fragment));
    return program;
}

} // namespace

TEST(ObjectSurface, AloneHasTheSkyOfAPlain)
{
    OTL_NEED_GL(context);
    Said said;
    Plain plain({house.object()});
    // Asked: 2 %.
    EXPECT_NEAR(plain.lightAt(0.0, 0.0), radiance, 0.02 * radiance);
    EXPECT_NEAR(plain.lightAt(2.5, -2.5), radiance, 0.02 * radiance);
    plain.lookNorth(-12.0, 2.0);
    // Half of the sky; the ground is black.
    for (const double up : {-1.0, 0.0, 1.0})
        EXPECT_NEAR(plain.lightAt(0.0, up), 0.5 * radiance, cones + drawn) << up;
    EXPECT_EQ(said.text(), "");
    EXPECT_EQ(takeGlErrors(), "");
}

// The wall before another, by rays.
TEST(ObjectSurface, AWallThatFacesAnotherIsDarker)
{
    OTL_NEED_GL(context);
    Plain plain({house.object(), facing.object()});
    plain.lookNorth(-7.0, 2.0);
    for (const double up : {-1.0, 0.0, 1.0})
        for (const double right : {-2.0, 0.0, 2.0})
        {
            const double expected = skyBy(facing, {right, -4.0, 2.0 + up}, {0.0, -1.0, 0.0});
            EXPECT_LT(expected, 0.4 * radiance);
            EXPECT_NEAR(plain.lightAt(right, up), expected, cones + drawn) << right << ' ' << up;
        }
}

// A roof 2 m within the box that a mast upon it makes of the object: the light above that box.
TEST(ObjectSurface, WithinItsFieldIsLitAsOutside)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<PlacedObject> object = house.object();
    object->addChild(Box{{3.75, 3.75, 5.0}, {0.25, 0.25, 1.0}}.object()->getChild(0));
    object->setField(PlacedObject::Field::Box);
    Plain plain({object});
    EXPECT_NEAR(plain.lightAt(0.0, 0.0), radiance, 0.02 * radiance);
    EXPECT_NEAR(plain.lightAt(-2.5, -2.5), radiance, 0.02 * radiance);
}

TEST(ObjectSurface, RedGroundShowsOnItsSides)
{
    OTL_NEED_GL(context);
    Plain plain({house.object()}, false, {1.0f, 0.0f, 0.0f});
    plain.lookNorth(-12.0, 2.0);
    // The lower half of what the wall sees sends what the ground gets; the plain ends 32 m away,
    // 2 m below: 4 % of the wall's light are black.
    EXPECT_NEAR(plain.channelAt(0.0, 0.0, 0), radiance, 0.04 * radiance + cones + drawn);
    EXPECT_NEAR(plain.channelAt(0.0, 0.0, 1), 0.5 * radiance, cones + drawn);
}

// Under a sun of 45 degrees in the east a tower shades a roof 6 m below its top as far as 6 m.
TEST(ObjectSurface, HasTheSunsShadowOfAnother)
{
    OTL_NEED_GL(context);
    const Box low = {{-1.0, 0.0, 1.0}, {4.0, 4.0, 1.0}};
    const Box tower = {{6.0, 0.0, 4.0}, {2.0, 6.0, 4.0}};
    Plain plain({low.object(), tower.object()}, true);
    const double sun = 1.2 * std::sin(pi / 4.0) / pi;
    for (const double east : {-3.5, 0.0})
    {
        const double sky = skyBy(tower, {east, 0.0, 2.0}, {0.0, 0.0, 1.0});
        EXPECT_NEAR(plain.lightAt(east, 0.0), sky + (east < -2.0 ? sun : 0.0), cones + drawn)
            << east;
    }
    // The tower's own roof has all, its western wall no sun.
    EXPECT_NEAR(plain.lightAt(6.0, 0.0), radiance + sun, 0.02 + drawn);
}

TEST(ObjectSurface, ThatIsGoneLeavesNothing)
{
    OTL_NEED_GL(context);
    Plain plain({});
    const auto untouched = plain.picture->pixels();
    const std::size_t bytes = plain.lighting->getStatistics().bytes;
    const osg::ref_ptr<PlacedObject> object = house.object();
    plain.place->addChild(object);
    plain.picture->draw(4);
    EXPECT_NE(plain.picture->pixels(), untouched);
    EXPECT_FALSE(object->getStateSet());
    EXPECT_FALSE(object->getChild(0)->getStateSet());
    const unsigned probes = plain.lighting->getDispatchCounts()["probe"];
    EXPECT_GE(probes, 1u);
    plain.picture->draw(2);
    EXPECT_EQ(plain.lighting->getDispatchCounts()["probe"], probes) << "still: nothing runs";
    plain.place->removeChild(object);
    plain.picture->draw(4);
    EXPECT_EQ(plain.picture->pixels(), untouched);
    EXPECT_EQ(plain.lighting->getStatistics().bytes, bytes);
    // The object outlives its lighting, and is drawn elsewhere.
    plain.place->addChild(object);
    plain.picture->draw(4);
    plain.picture = nullptr;
    plain.lighting = nullptr;
    ScenePicture alone(object, halfSide);
    alone.draw(2);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(ObjectSurface, OfHostsKeepsItsShadersAndMayCallOurs)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<PlacedObject> own = house.object();
    own->getChild(0)->getOrCreateStateSet()->setAttribute(
        programOf("void main() { gl_FragColor = vec4(0.2, 0.4, 0.6, 1.0); }"));
    Plain plain({own});
    EXPECT_EQ(plain.picture->redAt(0.0, 0.0), 51.0);

    // Above the object, one that calls ours: as the default program, which has 8 bits of sRGB.
    own->getChild(0)->setStateSet(nullptr);
    plain.picture->draw(2);
    const double expected = plain.lightAt(0.0, 0.0);
    const osg::ref_ptr<osg::Program> calls = programOf(R"(varying vec3 place;
varying vec3 normal;
vec4 terrainObjectLight(vec3 place, vec3 normal);
void main() { gl_FragColor = terrainObjectLight(place, normal); })");
    calls->addShader(createObjectShader(osg::Shader::FRAGMENT));
    plain.place->getOrCreateStateSet()->setAttribute(calls);
    plain.picture->draw(2);
    EXPECT_NEAR(plain.picture->redAt(0.0, 0.0) / 255.0, expected, drawn);
    EXPECT_EQ(takeGlErrors(), "");
}

// Drawn as the same boxes that are no placed objects.
TEST(ObjectSurface, IsAsItIsWithoutLightOrDefaultProgram)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<PlacedObject> object = house.object();
    Plain plain({object});
    const double lit = plain.picture->redAt(0.0, 0.0);
    const osg::ref_ptr<osg::Node> drawing = object->getChild(0);
    plain.place->removeChild(object);
    plain.place->addChild(drawing);
    plain.picture->draw(3);
    const double fixed = plain.picture->redAt(0.0, 0.0);
    EXPECT_NE(fixed, lit);
    plain.place->removeChild(drawing);
    plain.place->addChild(object);
    plain.picture->draw(3);
    EXPECT_EQ(plain.picture->redAt(0.0, 0.0), lit);

    plain.lighting->setDefaultProgramEnabled(false);
    plain.picture->draw(2);
    EXPECT_EQ(plain.picture->redAt(0.0, 0.0), fixed);
    plain.lighting->setDefaultProgramEnabled(true);
    plain.lighting->setLightEnabled(false);
    plain.picture->draw(2);
    EXPECT_EQ(plain.picture->redAt(0.0, 0.0), fixed);
    plain.lighting->setLightEnabled(true);
    plain.picture->draw(2);
    EXPECT_EQ(plain.picture->redAt(0.0, 0.0), lit);
    // Beyond the plain no tile holds it.
    plain.place->setMatrix(osg::Matrix::translate(40.0, 0.0, 0.0));
    plain.picture->viewer().getCamera()->setViewMatrixAsLookAt(
        osg::Vec3d(40.0, 0.0, 5.0e5), osg::Vec3d(40.0, 0.0, 0.0), osg::Vec3d(0.0, 1.0, 0.0));
    plain.picture->draw(2);
    EXPECT_EQ(plain.picture->redAt(0.0, 0.0), fixed);
}

TEST(ObjectSurface, HasTheColourOfItsMaterialVerticesAndPicture)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<PlacedObject> object = house.object();
    Plain plain({object});
    const double white = plain.lightAt(0.0, 0.0);
    const osg::ref_ptr<osg::Material> material = new osg::Material;
    material->setDiffuse(osg::Material::FRONT_AND_BACK, osg::Vec4(0.5f, 0.2f, 0.2f, 1.0f));
    osg::StateSet* stateSet = object->getChild(0)->getOrCreateStateSet();
    stateSet->setAttribute(material);
    object->dirtyField();
    plain.picture->draw(2);
    EXPECT_NEAR(plain.lightAt(0.0, 0.0), linearOf(0.5) * white, drawn) << "colour mode OFF";
    material->setColorMode(osg::Material::AMBIENT_AND_DIFFUSE);
    object->dirtyField();
    plain.picture->draw(2);
    EXPECT_NEAR(plain.lightAt(0.0, 0.0), white, drawn) << "vertices are white";

    auto* box = static_cast<osg::ShapeDrawable*>(object->getChild(0)->asGroup()->getChild(0));
    box->setColor(osg::Vec4(0.7f, 0.1f, 0.1f, 1.0f));
    plain.picture->draw(2);
    EXPECT_NEAR(plain.lightAt(0.0, 0.0), linearOf(0.7) * white, drawn);

    const osg::ref_ptr<osg::Image> picture = new osg::Image;
    picture->allocateImage(1, 1, 1, GL_RGB, GL_UNSIGNED_BYTE);
    std::fill_n(picture->data(), 3, static_cast<unsigned char>(204));
    const osg::ref_ptr<osg::Texture2D> texture = new osg::Texture2D(picture);
    texture->setWrap(osg::Texture::WRAP_S, osg::Texture::REPEAT);
    texture->setWrap(osg::Texture::WRAP_T, osg::Texture::REPEAT);
    stateSet->setTextureAttributeAndModes(0, texture);
    plain.picture->draw(2);
    EXPECT_NEAR(plain.lightAt(0.0, 0.0), linearOf(0.7) * linearOf(0.8) * white, drawn);
}

// A fifth of 8 m: steps of 0.5 m are as many moves of the probe as there are 1.6 m, and one more
// where the object comes to rest.
TEST(ObjectSurface, ThatMovesHasANewProbeNowAndThen)
{
    OTL_NEED_GL(context);
    Plain plain({house.object()});
    const auto runs = [&] { return plain.lighting->getDispatchCounts()["probe"]; };
    const unsigned before = runs();
    const auto moveTo = [&](double east)
    {
        plain.place->setMatrix(osg::Matrix::translate(east, 0.0, 0.0));
        plain.picture->draw();
    };
    for (const double east : {0.5, 1.0, 1.5})
        moveTo(east);
    EXPECT_EQ(runs(), before);
    moveTo(2.0);
    EXPECT_EQ(runs(), before + 1);
    moveTo(2.5);
    EXPECT_EQ(runs(), before + 1);
    plain.picture->draw();
    EXPECT_EQ(runs(), before + 2) << "at rest";
    plain.picture->draw(2);
    EXPECT_EQ(runs(), before + 2);
    EXPECT_NEAR(plain.lightAt(2.5, 0.0), radiance, 0.02 * radiance + drawn);
}

namespace
{

void paint(PlacedObject& object, const osg::Vec4& colour)
{
    auto* geode = object.getChild(0)->asGroup();
    static_cast<osg::ShapeDrawable*>(geode->getChild(0))->setColor(colour);
    object.dirtyField();
}

void addTriangles(reference::SceneDescription& scene, const Box& box, const LinearRgb& albedo)
{
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0})
            for (const double half : {-1.0, 1.0})
            {
                reference::Triangle triangle;
                triangle.albedo = albedo;
                const double corners[3][2] = {{half, half}, {-half, half}, {half, -half}};
                for (std::size_t i = 0; i < 3; ++i)
                {
                    glm::dvec3 own;
                    own[axis] = side;
                    own[(axis + 1) % 3] = corners[i][0];
                    own[(axis + 2) % 3] = corners[i][1];
                    const glm::dvec3 place = box.centre + box.half * own;
                    triangle.corners[i] = {place.x + 32.0, place.y + 32.0, place.z};
                }
                scene.triangles.push_back(triangle);
            }
}

} // namespace

// A white wall before a red one, on black and on grey ground. Expected: by the path tracer with as
// many bounces, to 0.3 %.
TEST(ObjectSurface, HasTheLightThatAnotherSends)
{
    OTL_NEED_GL(context);
    for (const float ground : {0.0f, 0.5f})
    {
        const osg::ref_ptr<PlacedObject> red = facing.object();
        paint(*red, {1.0f, 0.2f, 0.2f, 1.0f});
        Plain plain({house.object(), red}, false, {ground, ground, ground});
        plain.lookNorth(-7.0, 2.0);
        EXPECT_EQ(plain.lighting->getDispatchCounts().count("object radiosity"), 0u);

        reference::SceneDescription scene;
        scene.tile = analytic::plane(65, 65, 1.0, 0.0);
        scene.albedo = {ground, ground, ground};
        addTriangles(scene, house, {1.0, 1.0, 1.0});
        addTriangles(scene, facing, {1.0, linearOf(0.2), linearOf(0.2)});
        const auto tracer = reference::PathTracer::build(scene);
        ASSERT_TRUE(tracer) << tracer.error().message;
        reference::Illumination illumination;
        illumination.light.sunEnabled = false;
        illumination.light.skyRadiance = {float(radiance), float(radiance), float(radiance)};
        for (const int bounces : {1, 3})
        {
            plain.bounce(bounces);
            EXPECT_GT(plain.lighting->getDispatchCounts().at("object radiosity"), 0u);
            reference::PathTracerOptions options;
            options.samples = 16384;
            options.bounces = bounces;
            std::vector<reference::Receiver> receivers;
            for (const double up : {-1.0, 0.0, 1.0})
                for (const double right : {-2.0, 0.0, 2.0})
                {
                    receivers.emplace_back();
                    receivers.back().place = {{right + 32.0, 32.0 - 4.0 - 1.0e-4, 2.0 + up},
                                              {0.0, -1.0, 0.0}};
                }
            const auto truth = tracer->trace(illumination, receivers, options);
            ASSERT_TRUE(truth) << truth.error().message;
            double squares = 0.0;
            std::size_t i = 0;
            for (const double up : {-1.0, 0.0, 1.0})
                for (const double right : {-2.0, 0.0, 2.0})
                {
                    for (std::size_t channel = 0; channel < 2; ++channel)
                        squares += std::pow(plain.channelAt(right, up, channel) -
                                                (*truth)[i].total.mean[channel],
                                            2);
                    ++i;
                }
            const double rms = std::sqrt(squares / 18.0) / radiance;
            const auto& middle = (*truth)[4];
            std::printf(
                "ground %.1f, %d bounces: RMS %.1f %% of the open sky's light; in the middle "
                "%.3f %.3f, path tracer %.3f %.3f, sky alone %.3f\n",
                double(ground), bounces, 100.0 * rms, plain.channelAt(0.0, 0.0, 0),
                plain.channelAt(0.0, 0.0, 1), middle.total.mean[0], middle.total.mean[1],
                middle.sky.mean[0]);
            EXPECT_LE(rms, 0.04);
        }
        plain.bounce(0);
        EXPECT_NEAR(plain.channelAt(0.0, 0.0, 0), plain.channelAt(0.0, 0.0, 1),
                    ground > 0.0f ? 0.2 : 1.0e-6);
        EXPECT_EQ(takeGlErrors(), "");
    }
}

// Areas of the parts count, and their colours are sRGB: of vertices, or of a material where its
// mode says so, times the picture's.
TEST(ObjectSurface, SendsTheMeanOfItsColours)
{
    const auto albedoOf = [](PlacedObject& object)
    {
        ObjectField field;
        const auto shape = field.shape(object);
        return shape ? shape->albedo : glm::dvec3(-1.0);
    };
    const osg::ref_ptr<PlacedObject> object = house.object();
    EXPECT_EQ(albedoOf(*object), glm::dvec3(1.0)) << "nothing has a colour";
    // 8 x 8 x 4 m have 256 square metres; 4 x 4 x 1 m have 48.
    paint(*object, {0.5f, 0.0f, 1.0f, 1.0f});
    const osg::ref_ptr<PlacedObject> second = Box{{0.0, 0.0, 9.0}, {2.0, 2.0, 0.5}}.object();
    paint(*second, {0.0f, 1.0f, 1.0f, 1.0f});
    object->addChild(second->getChild(0));
    glm::dvec3 found = albedoOf(*object);
    EXPECT_NEAR(found.x, linearOf(0.5) * 256.0 / 304.0, 1.0e-4);
    EXPECT_NEAR(found.y, 48.0 / 304.0, 1.0e-4);
    EXPECT_NEAR(found.z, 1.0, 1.0e-6);

    const osg::ref_ptr<osg::Material> material = new osg::Material;
    material->setDiffuse(osg::Material::FRONT_AND_BACK, osg::Vec4(0.2f, 0.4f, 0.6f, 1.0f));
    osg::StateSet* stateSet = object->getChild(1)->getOrCreateStateSet();
    stateSet->setAttribute(material);
    const osg::ref_ptr<osg::Image> picture = new osg::Image;
    picture->allocateImage(1, 1, 1, GL_RGB, GL_UNSIGNED_BYTE);
    std::fill_n(picture->data(), 3, static_cast<unsigned char>(204));
    stateSet->setTextureAttributeAndModes(0, new osg::Texture2D(picture));
    found = albedoOf(*object);
    EXPECT_NEAR(found.y, 48.0 / 304.0 * linearOf(0.4) * linearOf(0.8), 1.0e-4);

    ObjectField field;
    field.albedo = osg::Vec3f(0.25f, 0.5f, 0.75f);
    EXPECT_EQ(field.shape(*object)->albedo, glm::dvec3(0.25, 0.5, 0.75));
    Said said;
    object->setAlbedo(osg::Vec3f(0.5f, 1.5f, 0.0f));
    EXPECT_FALSE(object->getAlbedo());
    EXPECT_EQ(said.count("needs 0 ... 1"), 1);
}

// A lamp under a roof at dusk: it shows what it emits, and lights a wall beside it by the closed
// form of a sphere; where it does not emit any more nothing is left of it.
TEST(ObjectSurface, HasTheLightOfALamp)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<PlacedObject> lamp = new PlacedObject;
    const osg::ref_ptr<osg::Geode> geode = new osg::Geode;
    geode->addDrawable(new osg::ShapeDrawable(new osg::Sphere(osg::Vec3(0.0f, -6.0f, 2.0f), 0.4f)));
    lamp->addChild(geode);
    Plain plain({house.object(), lamp});
    plain.lookNorth(-9.0, 2.0);
    const auto before = plain.lightAt(3.0, 0.0);
    lamp->setEmission({0.9f, 0.6f, 0.3f});
    plain.picture->draw(4);
    // 2 m before the wall, seen at its own height: 3 m beside its foot the cosine is 2 / sqrt(13).
    const double expected = 0.16 / 13.0 * 2.0 / std::sqrt(13.0);
    EXPECT_NEAR(plain.lightAt(3.0, 0.0) - before, 0.9 * expected, 0.1 * expected + drawn);
    EXPECT_GT(plain.channelAt(0.0, 0.0, 0), 0.9) << "its own surface";
    lamp->setEmission({});
    plain.picture->draw(4);
    EXPECT_NEAR(plain.lightAt(3.0, 0.0), before, 1.0e-6);
    Said said;
    lamp->setEmission({-1.0f, 0.0f, 0.0f});
    EXPECT_EQ(lamp->getEmission(), osg::Vec3f());
    EXPECT_EQ(said.count("needs 0 or more"), 1);
    EXPECT_EQ(takeGlErrors(), "");
}
