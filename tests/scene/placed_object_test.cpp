// Objects on a lit plain, drawn: what they do to the light of the ground, and what they cost.
#include <osgTerrainLight/PlacedObject.h>
#include <osgTerrainLight/TerrainLighting.h>

#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/ScenePicture.h"
#include "support/TestFolder.h"
#include "terrain/TerrainModel.h"

#include <osg/Geode>
#include <osg/Geometry>
#include <osg/MatrixTransform>
#include <osg/ShapeDrawable>

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <thread>

using namespace osgTerrainLight;

namespace
{

constexpr double pi = 3.14159265358979323846;
constexpr double halfSide = 32.0; ///< of the plain, 65 posts in 1 m, and of pictures [m]
constexpr double radiance = 0.6;

SkyLight uniformSky(bool sun = false)
{
    SkyLight sky;
    sky.skyModel = SkyModel::Uniform;
    sky.skyRadiance = {float(radiance), float(radiance), float(radiance)};
    sky.sunEnabled = sun;
    sky.sunIrradiance = {1.2f, 1.2f, 1.2f};
    sky.sunAzimuth = 90.0;
    sky.sunElevation = 45.0;
    return sky;
}

/// It is not drawn: what it does to the ground is looked at.
osg::ref_ptr<PlacedObject> boxObject(double length, double width, double height)
{
    osg::ref_ptr<osg::Geode> geode = new osg::Geode;
    geode->addDrawable(new osg::ShapeDrawable(new osg::Box(
        osg::Vec3(0.0f, 0.0f, float(0.5 * height)), float(length), float(width), float(height))));
    geode->setNodeMask(1u); // counts, …
    osg::ref_ptr<PlacedObject> object = new PlacedObject;
    object->addChild(geode);
    return object;
}

struct Plain
{
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 16);
    osg::ref_ptr<osg::MatrixTransform> place = new osg::MatrixTransform;
    std::unique_ptr<ScenePicture> picture;

    explicit Plain(PlacedObject* object, const SkyLight& sky = uniformSky())
    {
        lighting->addChild(createTerrain(analytic::plane(65, 65, 1.0, 0.0)));
        lighting->setSkyLight(sky);
        if (object)
            place->addChild(object);
        lighting->addChild(place);
        picture = std::make_unique<ScenePicture>(lighting, halfSide);
        // … but is not drawn.
        picture->viewer().getCamera()->setCullMask(~1u);
        picture->draw(4);
    }
    /// Irradiance / pi of a place [m from the middle], from the sRGB of the picture.
    double lightAt(double east, double north) const
    {
        const double code = picture->redAt(east / halfSide, north / halfSide) / 255.0;
        return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
    }
};

/// A mean over 7 pixels of half a metre, in 8 bits.
constexpr double drawn = 0.02;

} // namespace

// A wall 3 m high hides the sky in an angle of atan(3 / d) before it: light (1 + cos of that) / 2.
TEST(PlacedObject, AWallTakesSkyFromTheGround)
{
    OTL_NEED_GL(context);
    Said said;
    Plain plain(boxObject(30.0, 0.5, 3.0));
    EXPECT_EQ(plain.lighting->getObjectCount(), 1u);
    for (const double away : {2.5, 4.0, 6.0})
        for (const double side : {-1.0, 1.0})
        {
            const double expected =
                radiance * 0.5 * (1.0 + std::cos(std::atan(3.0 / (away - 0.25))));
            // 4 % of the open sky's light is what is asked of cones; the wall's ends show 2 % more.
            EXPECT_NEAR(plain.lightAt(0.0, side * away), expected, radiance * 0.06 + drawn)
                << away << " m";
        }
    EXPECT_LT(plain.lightAt(0.0, 2.5), plain.lightAt(0.0, 5.0) - 0.05);
    EXPECT_NEAR(plain.lightAt(28.0, 28.0), radiance, 0.01);
    EXPECT_EQ(said.text(), "");
    EXPECT_EQ(takeGlErrors(), "");
}

// Under a sun of 45 degrees in the east, a box of 4 m casts a shadow of 4 m to the west.
TEST(PlacedObject, CastsASunShadow)
{
    OTL_NEED_GL(context);
    Plain plain(boxObject(6.0, 10.0, 4.0), uniformSky(true));
    const double sun = 1.2 * std::sin(pi / 4.0) / pi;
    const double open = plain.lightAt(0.0, 28.0);
    EXPECT_NEAR(open, radiance + sun, 0.02);
    EXPECT_LT(plain.lightAt(-5.0, 0.0), radiance) << "in its shadow";
    EXPECT_GT(plain.lightAt(-9.5, 0.0), plain.lightAt(-5.0, 0.0) + 0.8 * sun) << "beyond it";
    EXPECT_GT(plain.lightAt(5.0, 0.0), plain.lightAt(-5.0, 0.0) + 0.8 * sun) << "before it";
}

// At 10 degrees the shadow of a tower 4 m high is 22.7 m long.
TEST(PlacedObject, CastsALongShadowInTheEvening)
{
    OTL_NEED_GL(context);
    SkyLight low = uniformSky(true);
    low.sunElevation = 10.0;
    low.sunAzimuth = 270.0;
    low.sunIrradiance = {8.0f, 8.0f, 8.0f};
    low.skyRadiance = {0.1f, 0.1f, 0.1f};
    Plain plain(boxObject(2.0, 6.0, 4.0), low);
    const double sun = 8.0 * std::sin(10.0 * pi / 180.0) / pi;
    const double open = plain.lightAt(0.0, 25.0);
    EXPECT_NEAR(open, 0.1 + sun, 0.02);
    for (const double away : {4.0, 10.0, 16.0, 20.0})
        EXPECT_LT(plain.lightAt(1.0 + away, 0.0), 0.12) << away << " m";
    EXPECT_GT(plain.lightAt(28.0, 0.0), 0.9 * open) << "beyond it";
}

TEST(PlacedObject, ThatMovesIsAsOneThatStoodThere)
{
    OTL_NEED_GL(context);
    Plain moved(boxObject(4.0, 6.0, 3.0), uniformSky(true));
    const auto before = moved.picture->pixels();
    const osg::Matrix to =
        osg::Matrix::rotate(0.5, osg::Z_AXIS) * osg::Matrix::translate(3.0, -2.0, 0.0);
    moved.place->setMatrix(to);
    moved.picture->draw(3);
    EXPECT_NE(moved.picture->pixels(), before);
    const osg::ref_ptr<PlacedObject> still = boxObject(4.0, 6.0, 3.0);
    {
        const osg::ref_ptr<osg::MatrixTransform> there = new osg::MatrixTransform(to);
        Plain other(nullptr, uniformSky(true));
        there->addChild(still);
        other.lighting->addChild(there);
        other.picture->draw(3);
        // Volumes may begin at other bricks: half a step of 8 bits moves a half float's last place.
        const auto& a = moved.picture->pixels();
        const auto& b = other.picture->pixels();
        int worst = 0;
        for (std::size_t i = 0; i < a.size(); ++i)
            worst = std::max(worst, std::abs(int(a[i]) - int(b[i])));
        EXPECT_LE(worst, 3);
    }
}

// What is drawn without an object is what is drawn where there never was one, to the last bit, and
// nothing is computed or kept for it.
TEST(PlacedObject, ThatIsGoneLeavesNothing)
{
    OTL_NEED_GL(context);
    Plain none(nullptr);
    const auto untouched = none.picture->pixels();
    const std::size_t bytes = none.lighting->getStatistics().bytes;
    EXPECT_EQ(none.lighting->getDispatchCounts()["objects"], 0u);
    EXPECT_EQ(none.lighting->getDispatchCounts()["object factor"], 0u);

    const osg::ref_ptr<PlacedObject> object = boxObject(4.0, 6.0, 3.0);
    none.place->addChild(object);
    none.picture->draw(4);
    EXPECT_NE(none.picture->pixels(), untouched);
    EXPECT_GT(none.lighting->getStatistics().bytes, bytes);
    const unsigned dispatches = none.lighting->getDispatchCount();
    none.picture->draw(3);
    EXPECT_EQ(none.lighting->getDispatchCount(), dispatches) << "still: nothing runs";

    none.place->removeChild(object);
    none.picture->draw(4);
    EXPECT_EQ(none.picture->pixels(), untouched);
    EXPECT_EQ(none.lighting->getStatistics().bytes, bytes);
    EXPECT_EQ(none.lighting->getObjectCount(), 0u);
}

TEST(PlacedObject, MayStandElsewhereInTheScene)
{
    OTL_NEED_GL(context);
    Plain plain(nullptr);
    const auto untouched = plain.picture->pixels();
    const osg::ref_ptr<PlacedObject> object = boxObject(4.0, 6.0, 3.0);
    EXPECT_TRUE(plain.lighting->addObject(object));
    {
        Said said;
        EXPECT_FALSE(plain.lighting->addObject(object));
        EXPECT_FALSE(plain.lighting->addObject(nullptr));
        EXPECT_EQ(said.count("object not added"), 2);
    }
    plain.picture->draw(4);
    EXPECT_NE(plain.picture->pixels(), untouched);
    EXPECT_EQ(plain.lighting->getObjectCount(), 1u);
    EXPECT_TRUE(plain.lighting->removeObject(object));
    EXPECT_FALSE(plain.lighting->removeObject(object));
    plain.picture->draw(4);
    EXPECT_EQ(plain.picture->pixels(), untouched);
    plain.place->addChild(object);
    Said said;
    EXPECT_FALSE(plain.lighting->addObject(object)) << "it stands below";
    EXPECT_EQ(said.count("object not added"), 1);
}

// The same box, as a shape of OSG and as twelve triangles.
TEST(PlacedObject, OfTrianglesIsAsItsSolid)
{
    OTL_NEED_GL(context);
    setenv("XDG_CACHE_HOME", testFolder().c_str(), 1); // not the user's
    Plain solid(boxObject(6.0, 8.0, 4.0));
    const osg::ref_ptr<PlacedObject> mesh = boxObject(6.0, 8.0, 4.0);
    mesh->setField(PlacedObject::Field::Mesh);
    Plain sampled(mesh);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!mesh->isFieldReady() && std::chrono::steady_clock::now() < deadline)
    {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        sampled.picture->draw();
    }
    ASSERT_TRUE(mesh->isFieldReady());
    sampled.picture->draw(4);
    // 48 cells over 8 m: 0.17 m, less than the volume's 0.25 m. A light of a few percent changes
    // over a voxel beside the wall.
    for (const double away : {4.5, 6.0, 8.0})
        EXPECT_NEAR(sampled.lightAt(away, 0.0), solid.lightAt(away, 0.0), 0.02) << away << " m";
}

TEST(PlacedObject, WithoutAFieldChangesNothing)
{
    OTL_NEED_GL(context);
    Plain none(nullptr);
    const osg::ref_ptr<PlacedObject> object = boxObject(4.0, 6.0, 3.0);
    object->setField(PlacedObject::Field::None);
    Plain plain(object);
    EXPECT_EQ(plain.picture->pixels(), none.picture->pixels());
    EXPECT_EQ(plain.lighting->getObjectCount(), 0u);
    object->setField(PlacedObject::Field::Ellipsoid);
    plain.picture->draw(4);
    EXPECT_NE(plain.picture->pixels(), none.picture->pixels());
}
