// Objects on a lit plain, drawn: what they do to the light of the ground, and what they cost.
#include <osgTerrainLight/PlacedObject.h>
#include <osgTerrainLight/TerrainLighting.h>

#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HeldObjects.h"
#include "support/SampledBodies.h"
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
#include <cstdio>
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

} // namespace

// By rays that meet the box itself, drawn by the cosine's density.
TEST(PlacedObject, AWallTakesSkyFromTheGround)
{
    OTL_NEED_GL(context);
    Said said;
    Plain plain(boxObject(30.0, 0.5, 3.0));
    EXPECT_EQ(plain.lighting->getObjectCount(), 1u);
    const auto stops = [](double away, const osg::Vec3d& ray)
    {
        // The wall's near face stands at -0.25; from the ground `away` from its middle.
        if (ray.y() >= 0.0)
            return false;
        for (const double face : {0.25, -0.25})
        {
            const double length = (face - away) / ray.y();
            if (length * ray.z() < 3.0 && std::abs(length * ray.x()) < 15.0)
                return true;
        }
        return false;
    };
    for (const double away : {2.5, 4.0, 6.0})
    {
        // The picture's light is the mean of a square of 7 pixels of half a metre.
        int seen = 0;
        constexpr int strata = 100, rows = 7;
        for (int row = 0; row < rows; ++row)
            for (int i = 0; i < strata; ++i)
                for (int j = 0; j < strata; ++j)
                {
                    const double r = std::sqrt((i + 0.5) / strata);
                    const double turn = 2.0 * pi * (j + 0.5) / strata;
                    seen +=
                        !stops(away + 0.5 * (row - rows / 2),
                               {r * std::cos(turn), r * std::sin(turn), std::sqrt(1.0 - r * r)});
                }
        const double expected = radiance * seen / (rows * strata * strata);
        for (const double side : {-1.0, 1.0})
        {
            const double found = plain.lightAt(0.0, side * away);
            std::printf("%.1f m: %.3f, by rays %.3f of open ground's light\n", away,
                        found / radiance, expected / radiance);
            // Asked of cones: 4 %. A code of 8 bits near 0.6 is 0.005.
            EXPECT_NEAR(found, expected, 0.04 * radiance + 0.005) << away << " m";
            EXPECT_LT(found, radiance - 0.5 * (radiance - expected)) << "it takes something";
        }
    }
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

namespace
{

int greatestDifference(const ScenePicture& a, const ScenePicture& b)
{
    int worst = 0;
    for (std::size_t i = 0; i < a.pixels().size(); ++i)
        worst = std::max(worst, std::abs(int(a.pixels()[i]) - int(b.pixels()[i])));
    return worst;
}

} // namespace

// A step of a whole brick of voxels, so that all but the place is the same; a step that keeps the
// size of what is computed; one that turns it. Frames are drawn with a budget that does a piece of
// work at a time, too.
TEST(PlacedObject, ThatMovesIsAsOneThatStoodThere)
{
    OTL_NEED_GL(context);
    const std::pair<osg::Matrix, int> moves[] = {
        {osg::Matrix::translate(2.0, 0.0, 0.0), 0},
        // Voxels stand otherwise to the box: an edge of its shadow is a fraction of a voxel
        // elsewhere.
        {osg::Matrix::translate(0.9, -1.3, 0.0), 40},
        {osg::Matrix::rotate(0.5, osg::Z_AXIS) * osg::Matrix::translate(4.0, -2.0, 0.0), 40}};
    for (const double budget : {0.0, 1.0e-3})
        for (const auto& [to, most] : moves)
        {
            Plain moved(boxObject(4.0, 6.0, 3.0), uniformSky(true));
            const auto before = moved.picture->pixels();
            moved.lighting->setTimeBudget(budget);
            moved.place->setMatrix(to);
            moved.picture->draw(budget > 0.0 ? 60 : 4);
            EXPECT_NE(moved.picture->pixels(), before);
            Plain other(nullptr, uniformSky(true));
            const osg::ref_ptr<osg::MatrixTransform> there = new osg::MatrixTransform(to);
            there->addChild(boxObject(4.0, 6.0, 3.0));
            other.lighting->addChild(there);
            other.picture->draw(4);
            EXPECT_LE(greatestDifference(*moved.picture, *other.picture), most);
        }
}

// While it is computed piece by piece, ground is drawn with the light that it had: never black.
TEST(PlacedObject, ThatComesUnderABudgetShowsNothingUnfinished)
{
    OTL_NEED_GL(context);
    Plain plain(nullptr, uniformSky(true));
    plain.lighting->setTimeBudget(1.0e-3);
    const double open = plain.lightAt(20.0, 20.0);
    plain.place->addChild(boxObject(4.0, 6.0, 3.0));
    for (int frame = 0; frame < 60; ++frame)
    {
        plain.picture->draw();
        // Far from the box and its shadow, but within what is computed for it.
        ASSERT_NEAR(plain.lightAt(0.0, 9.0), open, 0.05 * open) << "frame " << frame;
        plain.place->setMatrix(osg::Matrix::translate(0.02 * frame, 0.0, 0.0));
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

namespace
{

/// A blob whose vertices the application changes, as the samples' does.
struct DeformingBlob
{
    osg::ref_ptr<osg::Vec3Array> vertices = new osg::Vec3Array;
    osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
    osg::ref_ptr<PlacedObject> object = new PlacedObject;
    bodies::Blob form{0.3, 0.0, 3.0};

    explicit DeformingBlob(double phase)
    {
        const TriangleMesh mesh = form.mesh(24);
        vertices->resize(mesh.vertices.size());
        const osg::ref_ptr<osg::DrawElementsUInt> triangles =
            new osg::DrawElementsUInt(GL_TRIANGLES);
        for (const auto& triangle : mesh.triangles)
            triangles->insert(triangles->end(), triangle.begin(), triangle.end());
        geometry->setUseVertexBufferObjects(true);
        geometry->setVertexArray(vertices);
        geometry->addPrimitiveSet(triangles);
        osg::ref_ptr<osg::Geode> geode = new osg::Geode;
        geode->addDrawable(geometry);
        geode->setNodeMask(1u);
        object->setField(PlacedObject::Field::Star);
        object->addChild(geode);
        deform(phase);
    }
    void deform(double phase)
    {
        form.phase = phase;
        const TriangleMesh mesh = form.mesh(24);
        for (unsigned i = 0; i < vertices->size(); ++i)
            (*vertices)[i].set(mesh.vertices[i].x, mesh.vertices[i].y, mesh.vertices[i].z + 2.0f);
        vertices->dirty();
        geometry->dirtyBound();
    }
};

} // namespace

// A frame after its vertices have changed, the ground is lit as beside one that always had this
// form; while they stay nothing runs.
TEST(PlacedObject, ThatDeformsIsAsOneThatHadThisForm)
{
    OTL_NEED_GL(context);
    Said said;
    DeformingBlob blob(0.0);
    Plain plain(blob.object, uniformSky(true));
    EXPECT_EQ(plain.lighting->getObjectCount(), 1u);
    EXPECT_TRUE(blob.object->isFieldReady());
    for (const double phase : {0.7, 1.4, 2.1})
    {
        const auto before = plain.picture->pixels();
        const unsigned volumes = plain.lighting->getDispatchCounts()["objects"];
        blob.deform(phase);
        plain.picture->draw(2);
        EXPECT_EQ(plain.lighting->getDispatchCounts()["objects"], volumes + 1);
        EXPECT_NE(plain.picture->pixels(), before);
        plain.picture->draw(2);
        const unsigned dispatches = plain.lighting->getDispatchCount();
        plain.picture->draw(3);
        EXPECT_EQ(plain.lighting->getDispatchCount(), dispatches) << "still: nothing runs";

        DeformingBlob other(phase);
        Plain fresh(other.object, uniformSky(true));
        // Voxels may stand otherwise to it: an edge of its shadow is a fraction of one elsewhere.
        EXPECT_LE(greatestDifference(*plain.picture, *fresh.picture), 40);
    }
    EXPECT_EQ(said.text(), "");
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: after the second and third 30 frames what was held after the first. Volumes and the
// textures of the factor have sizes in whole bricks and texels, so they are compared at the same
// form.
TEST(PlacedObject, ThatDeformsInEveryFrameHoldsNoMore)
{
    OTL_NEED_GL(context);
    DeformingBlob blob(0.0);
    Plain plain(blob.object, uniformSky(true));
    Held first, last;
    for (int frame = 1; frame <= 90; ++frame)
    {
        blob.deform(2.0 * std::sin(2.0 * pi * frame / 30.0));
        plain.picture->draw();
        if (frame % 30 != 0)
            continue;
        plain.picture->draw(8); // what is released waits for frames that are still drawn
        last = heldBy(*plain.picture, *plain.lighting);
        if (frame == 30)
            first = last;
        std::printf("frame %3d: %u textures, %u buffers, %.2f MiB of light, %.1f MiB resident\n",
                    frame, last.textures, last.buffers,
                    static_cast<double>(last.graphics) / 1048576.0,
                    static_cast<double>(last.resident) / 1048576.0);
    }
    EXPECT_EQ(last.textures, first.textures);
    EXPECT_EQ(last.buffers, first.buffers);
    EXPECT_EQ(last.graphics, first.graphics);
    EXPECT_LE(static_cast<double>(last.resident), 1.02 * static_cast<double>(first.resident));
    EXPECT_EQ(takeGlErrors(), "");
}

// A plateau of an osg::HeightField, whose walls are a post wide, is found by itself, and lit around
// as the box that it nearly is; so is the box between two height fields.
TEST(PlacedObject, OfHeightFieldsIsAsItsSolid)
{
    OTL_NEED_GL(context);
    Plain solid(boxObject(6.0, 8.0, 4.0));
    const osg::ref_ptr<osg::HeightField> heights = new osg::HeightField;
    heights->allocate(33, 41);
    heights->setXInterval(0.2f);
    heights->setYInterval(0.2f);
    heights->setOrigin(osg::Vec3(-3.2f, -4.0f, 0.0f));
    for (unsigned row = 0; row < 41; ++row)
        for (unsigned column = 0; column < 33; ++column)
            heights->setHeight(column, row,
                               row == 0 || row == 40 || column == 0 || column == 32 ? 0.0f : 4.0f);
    osg::ref_ptr<osg::Geode> geode = new osg::Geode;
    geode->addDrawable(new osg::ShapeDrawable(heights));
    geode->setNodeMask(1u);
    const osg::ref_ptr<PlacedObject> plateau = new PlacedObject;
    plateau->addChild(geode);
    Plain drawn(plateau);
    EXPECT_TRUE(plateau->isFieldReady());
    const osg::ref_ptr<PlacedObject> two = boxObject(6.0, 8.0, 4.0);
    two->setField(PlacedObject::Field::TwoHeightFields);
    Plain between(two);
    for (const double away : {4.5, 6.0, 8.0})
    {
        // A wall may stand a post, 0.2 m, within its place, over which light before it changes by
        // 0.02 at most.
        EXPECT_NEAR(drawn.lightAt(away, 0.0), solid.lightAt(away, 0.0), 0.02) << away << " m";
        EXPECT_NEAR(between.lightAt(away, 0.0), solid.lightAt(away, 0.0), 0.01) << away << " m";
    }
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

// Two boxes whose volumes are two: where both take the sun, it is taken once. Expected: the light
// of the nearer one alone, since the other hides less than 1 % of the sky from 47 m away.
TEST(PlacedObject, TwoShadowsTakeTheSunOnce)
{
    OTL_NEED_GL(context);
    SkyLight sky = uniformSky(true);
    sky.sunElevation = 20.0;
    const osg::ref_ptr<PlacedObject> near = boxObject(4.0, 16.0, 6.0);
    Plain plain(near, sky);
    plain.place->setMatrix(osg::Matrix::translate(-12.0, 0.0, 0.0));
    plain.picture->draw(4);
    const double open = plain.lightAt(-22.0, 24.0), alone = plain.lightAt(-22.0, 0.0);
    EXPECT_LT(alone, 0.75 * open);
    const osg::ref_ptr<osg::MatrixTransform> far = new osg::MatrixTransform;
    far->setMatrix(osg::Matrix::translate(25.0, 0.0, 0.0));
    far->addChild(boxObject(4.0, 6.0, 20.0));
    plain.lighting->addChild(far);
    plain.picture->draw(4);
    EXPECT_LT(plain.lightAt(-1.0, 0.0), 0.8 * open) << "the shadow of the far one";
    EXPECT_NEAR(plain.lightAt(-22.0, 0.0), alone, 0.02 * open);
}

// Two lamps 40 m apart, whose volumes are two: far between them the light of both is that of one
// and of the other. Expected of each: the closed form of a sphere, radiance times (radius over
// distance) squared times the cosine; the lamp is 20 m away, many times its height.
TEST(PlacedObject, LampsShineFarAndAddUp)
{
    OTL_NEED_GL(context);
    SkyLight dusk = uniformSky();
    dusk.skyRadiance = {0.02f, 0.02f, 0.02f};
    const auto lamp = [](double east)
    {
        const osg::ref_ptr<osg::Geode> geode = new osg::Geode;
        geode->addDrawable(
            new osg::ShapeDrawable(new osg::Sphere(osg::Vec3(float(east), 0.0f, 3.0f), 0.4f)));
        geode->setNodeMask(1u); // is not drawn
        const osg::ref_ptr<PlacedObject> object = new PlacedObject;
        object->addChild(geode);
        return object;
    };
    const osg::ref_ptr<PlacedObject> west = lamp(-20.0), east = lamp(20.0);
    Plain plain(west, dusk);
    plain.lighting->addChild(east);
    plain.picture->draw(4);
    const double dark = plain.lightAt(0.0, 0.0);
    EXPECT_NEAR(dark, 0.02, 0.002);
    west->setEmission({2500.0f, 2500.0f, 2500.0f});
    plain.picture->draw(4);
    const double away = std::hypot(20.0, 3.0);
    const double one = 2500.0 * 0.16 * 3.0 / (away * away * away);
    // A step of 8 bits is 0.005 there.
    EXPECT_NEAR(plain.lightAt(0.0, 0.0) - dark, one, 0.01);
    east->setEmission({2500.0f, 2500.0f, 2500.0f});
    plain.picture->draw(4);
    EXPECT_NEAR(plain.lightAt(0.0, 0.0) - dark, 2.0 * one, 0.01);
}

// Expected: after the second thousand frames what was held after the first, and nothing more.
TEST(PlacedObject, TwoThousandFramesOfComingAndGoingLeaveNothing)
{
    OTL_NEED_GL(context);
    Plain plain(nullptr, uniformSky(true));
    std::vector<osg::ref_ptr<osg::MatrixTransform>> there;
    Held first, last, most;
    for (int frame = 1; frame <= 2000; ++frame)
    {
        if (frame % 100 < 80 && frame % 8 == 1)
        {
            const osg::ref_ptr<PlacedObject> object =
                boxObject(1.0 + frame % 5, 2.0, 1.0 + frame % 3);
            if (frame % 3 == 0)
                object->setField(PlacedObject::Field::Ellipsoid);
            there.emplace_back(new osg::MatrixTransform);
            there.back()->addChild(object);
            plain.lighting->addChild(there.back());
        }
        else if (!there.empty() && (frame % 100 >= 80 || frame % 16 == 5))
        {
            plain.lighting->removeChild(there.front());
            there.erase(there.begin());
        }
        for (std::size_t i = 0; i < there.size(); ++i)
            there[i]->setMatrix(
                osg::Matrix::rotate(0.05 * frame, osg::Z_AXIS) *
                osg::Matrix::translate(4.0 * double(i) - 16.0, 10.0 * std::sin(0.1 * frame), 0.0));
        plain.picture->draw();
        if (frame == 1070)
            most = heldBy(*plain.picture, *plain.lighting);
        if (frame % 100 != 99)
            continue;
        ASSERT_EQ(plain.lighting->getObjectCount(), 0u) << "in frame " << frame;
        plain.picture->draw(8); // what is released waits for frames that are still drawn
        last = heldBy(*plain.picture, *plain.lighting);
        if (frame == 999) // once, caches and allocators have what they need
            first = last;
        if (frame % 200 == 199)
            std::printf(
                "frame %4d: %u textures, %u buffers, %.2f MiB of light, %.1f MiB resident\n", frame,
                last.textures, last.buffers, static_cast<double>(last.graphics) / 1048576.0,
                static_cast<double>(last.resident) / 1048576.0);
    }
    EXPECT_GT(most.graphics, last.graphics) << "there were volumes";
    EXPECT_EQ(last.textures, first.textures);
    EXPECT_EQ(last.buffers, first.buffers);
    EXPECT_EQ(last.graphics, first.graphics);
    EXPECT_LE(static_cast<double>(last.resident), 1.02 * static_cast<double>(first.resident));
    EXPECT_EQ(takeGlErrors(), "");
}
