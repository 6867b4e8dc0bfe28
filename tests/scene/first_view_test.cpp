#include "viewer/FirstView.h"

#include "support/GlContext.h"
#include "support/ScenePicture.h"
#include "support/SharedData.h"

#include <osgDB/ReadFile>
#include <osgGA/KeySwitchMatrixManipulator>
#include <osgGA/TerrainManipulator>
#include <osgGA/TrackballManipulator>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

using namespace osgTerrainLight;

namespace
{
const std::string jacksboro = OTL_SOURCE_DIR "/samples/data/jacksboro_90m.tif";

osg::BoundingBoxd box(double width, double depth, double height)
{
    return {-0.5 * width, -0.5 * depth, 700.0, 0.5 * width, 0.5 * depth, 700.0 + height};
}

/// How much of a window a rectangle at half of the terrain's height covers: its corners in clip
/// coordinates, cut at the window's edges (Sutherland and Hodgman), and the area of what is left.
double coveredBy(const osg::BoundingBoxd& terrain, const ViewPlace& view, double fovy,
                 double aspect)
{
    const osg::Matrixd toClip =
        osg::Matrixd::lookAt(view.eye, view.centre, osg::Vec3d(0.0, 0.0, 1.0)) *
        osg::Matrixd::perspective(fovy, aspect, 1e-3 * terrain.radius(), 1e3 * terrain.radius());
    const double z = terrain.center().z();
    std::vector<osg::Vec4d> corners;
    for (const auto& [x, y] :
         {std::pair(terrain.xMin(), terrain.yMin()), std::pair(terrain.xMax(), terrain.yMin()),
          std::pair(terrain.xMax(), terrain.yMax()), std::pair(terrain.xMin(), terrain.yMax())})
        corners.push_back(osg::Vec4d(x, y, z, 1.0) * toClip);
    for (const osg::Vec4d& edge : {osg::Vec4d(1, 0, 0, 1), osg::Vec4d(-1, 0, 0, 1),
                                   osg::Vec4d(0, 1, 0, 1), osg::Vec4d(0, -1, 0, 1)})
    {
        std::vector<osg::Vec4d> left;
        for (std::size_t i = 0; i < corners.size(); ++i)
        {
            const osg::Vec4d& one = corners[i];
            const osg::Vec4d& next = corners[(i + 1) % corners.size()];
            const double a = one * edge, b = next * edge;
            if (a >= 0.0)
                left.push_back(one);
            if ((a >= 0.0) != (b >= 0.0))
                left.push_back(one + (next - one) * (a / (a - b)));
        }
        corners = std::move(left);
    }
    double area = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i)
    {
        const osg::Vec4d& one = corners[i];
        const osg::Vec4d& next = corners[(i + 1) % corners.size()];
        area += 0.5 * (one.x() * next.y() - next.x() * one.y()) / (one.w() * next.w());
    }
    return 0.25 * area; // the window is 2 x 2
}

/// A viewer of a lit file, as osgviewer has it, before its first frame.
class Shown
{
public:
    explicit Shown(const std::string& path, osgGA::CameraManipulator* manipulator)
        : _node((useOwnPlugins(), osgDB::readRefNodeFile(path + ".terrainlight"))),
          _picture(_node, 1.0)
    {
        osg::Camera& camera = *_picture.viewer().getCamera();
        camera.setProjectionMatrixAsPerspective(30.0, 1.0, 1.0, 1.0e6);
        camera.setComputeNearFarMode(osg::CullSettings::COMPUTE_NEAR_FAR_USING_BOUNDING_VOLUMES);
        _picture.viewer().setCameraManipulator(manipulator);
    }
    ScenePicture& picture() { return _picture; }
    osg::Vec3d direction()
    {
        osg::Vec3d eye, centre, up;
        _picture.viewer().getCamera()->getViewMatrixAsLookAt(eye, centre, up);
        return centre - eye;
    }
    /// The place from which the camera looks, and the place `range` metres before it.
    osg::Vec3d eye()
    {
        osg::Vec3d eye, centre, up;
        _picture.viewer().getCamera()->getViewMatrixAsLookAt(eye, centre, up);
        return eye;
    }
    osg::Vec3d at(double range)
    {
        osg::Vec3d unit = direction();
        unit.normalize();
        return eye() + unit * range;
    }
    osg::Vec3d up()
    {
        osg::Vec3d eye, centre, up;
        _picture.viewer().getCamera()->getViewMatrixAsLookAt(eye, centre, up);
        return up;
    }
    void press(int key)
    {
        _picture.viewer().getEventQueue()->keyPress(key);
        _picture.draw(1);
    }
    /// Of the window, that terrain has drawn last: the sky behind it leaves the depth as it was.
    double covered()
    {
        std::vector<float> depths(ScenePicture::size * ScenePicture::size);
        glReadPixels(0, 0, ScenePicture::size, ScenePicture::size, GL_DEPTH_COMPONENT, GL_FLOAT,
                     depths.data());
        return static_cast<double>(std::count_if(depths.begin(), depths.end(),
                                                 [](float depth) { return depth < 1.0f; })) /
               static_cast<double>(depths.size());
    }

private:
    osg::ref_ptr<osg::Node> _node;
    ScenePicture _picture;
};

void expectFromSouth(const osg::Vec3d& direction)
{
    osg::Vec3d unit = direction;
    unit.normalize();
    EXPECT_NEAR(unit.x(), 0.0, 1e-5);
    EXPECT_NEAR(unit.y(), std::sqrt(0.75), 1e-5);
    EXPECT_NEAR(unit.z(), -0.5, 1e-5);
}
} // namespace

// Expected: the area of the projected rectangle, by clipping, is 7/10 of the window, for terrain of
// any shape and windows of any.
TEST(FirstView, TerrainFillsTheWindow)
{
    for (const osg::BoundingBoxd& terrain :
         {box(1e4, 1e4, 100.0), box(4e4, 1e4, 100.0), box(1e4, 5e4, 100.0), box(1.0, 2.0, 0.0)})
        for (const double aspect : {0.6, 1.0, 4.0 / 3.0, 2.4})
            for (const double fovy : {20.0, 30.0, 60.0})
            {
                const ViewPlace view = viewFromSouth(terrain, fovy, aspect);
                EXPECT_NEAR(coveredBy(terrain, view, fovy, aspect), 0.7, 0.02)
                    << terrain.xMax() << " x " << terrain.yMax() << ", " << aspect << ", " << fovy;
                EXPECT_EQ(view.centre, terrain.center());
                expectFromSouth(view.centre - view.eye);
            }
}

// Expected: nobody stands in a mountain, however high and narrow it is.
TEST(FirstView, StandsAboveTheTop)
{
    for (const osg::BoundingBoxd& terrain : {box(1e4, 10.0, 9e3), box(100.0, 100.0, 5e4)})
        EXPECT_GT(viewFromSouth(terrain, 30.0, 1.0).eye.z(), terrain.zMax());
}

// Expected: terrain, which alone writes depths, in at least half of the window.
TEST(FirstView, DemsOfAllKindsFillHalfOfTheWindow)
{
    OTL_NEED_GL(context);
    std::vector<std::string> paths = {jacksboro};
    for (const char* name :
         {"dem/halfdome_1s.tif", "dem/mt_fuji_90m.tif", "dem/mt_rainier_90m.tif",
          "awkward/everest_voids_256.tif", "awkward/fuji_cog_512.tif",
          "awkward/fuji_moved_antimeridian.tif", "awkward/olinda_dem_utm25s.tif",
          "awkward/rainier_feet_scale_offset.tif", "awkward/topobathy_lon0_360_nonsquare.tif"})
        if (std::filesystem::exists(sharedData(name)))
            paths.push_back(sharedData(name));
    for (const std::string& path : paths)
    {
        Shown shown(path, new osgGA::TrackballManipulator);
        shown.picture().draw(3);
        expectFromSouth(shown.direction());
        EXPECT_GE(shown.covered(), 0.5) << path;
        std::printf("%s: %.0f %%\n", std::filesystem::path(path).filename().c_str(),
                    100.0 * shown.covered());
    }
    if (paths.size() < 10)
        GTEST_SKIP() << "skipped for nine DEMs: they are in the shared data, and "
                     << sharedData("dem") << " is absent";
}

// Expected: a viewer whose manipulators change by keys, as osgviewer's, is placed too, and its home
// is the view.
TEST(FirstView, ManipulatorsThatChangeByKeys)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<osgGA::KeySwitchMatrixManipulator> keys =
        new osgGA::KeySwitchMatrixManipulator;
    keys->addMatrixManipulator('1', "Trackball", new osgGA::TrackballManipulator);
    keys->addMatrixManipulator('5', "Terrain", new osgGA::TerrainManipulator);
    Shown shown(jacksboro, keys);
    shown.picture().draw(2);
    expectFromSouth(shown.direction());
    keys->getCurrentMatrixManipulator()->setByMatrix(osg::Matrixd::translate(1.0, 2.0, 3.0));
    shown.picture().draw(1);
    EXPECT_LT(shown.direction().y(), 0.1);
    keys->getCurrentMatrixManipulator()->home(0.0);
    shown.picture().draw(1);
    expectFromSouth(shown.direction());
    keys->selectMatrixManipulator(1);
    keys->getCurrentMatrixManipulator()->home(0.0);
    shown.picture().draw(1);
    expectFromSouth(shown.direction());
}

// Expected: who has placed the camera, or its home, keeps it.
TEST(FirstView, LeavesAloneWhatSomebodyHasPlaced)
{
    OTL_NEED_GL(context);
    const osg::Vec3d eye(5e4, 0.0, 2e4), centre(0.0, 0.0, 500.0), up(0.0, 0.0, 1.0);
    const auto expectOurs = [&](Shown& shown)
    {
        shown.picture().draw(2);
        osg::Vec3d direction = shown.direction(), expected = centre - eye;
        direction.normalize();
        expected.normalize();
        EXPECT_LT((direction - expected).length(), 1e-5);
    };
    {
        const osg::ref_ptr<osgGA::TrackballManipulator> homed = new osgGA::TrackballManipulator;
        homed->setHomePosition(eye, centre, up);
        Shown shown(jacksboro, homed);
        expectOurs(shown);
    }
    {
        const osg::ref_ptr<osgGA::TrackballManipulator> moved = new osgGA::TrackballManipulator;
        Shown shown(jacksboro, moved);
        moved->setTransformation(eye, centre, up);
        expectOurs(shown);
    }
    {
        Shown shown(jacksboro, nullptr);
        shown.picture().viewer().getCamera()->setViewMatrixAsLookAt(eye, centre, up);
        expectOurs(shown);
    }
}

namespace
{
const std::string viewpoints = OTL_SOURCE_DIR "/earth_files/viewpoints.earth";

/// Where the first viewpoint of that map looks: metres from the middle of the raster, of 403 x 344
/// cells of 1/1200 degree from 84.41375 west and 36.732916667 north, by the lengths of degrees on
/// WGS 84 at its middle latitude, 36.58958.
osg::Vec3d alongTheFault()
{
    constexpr double east = 89487.8, north = 110970.0; // metres per degree
    return {(-84.2 + 84.41375 - 0.5 * 403 / 1200) * east,
            (36.6 - 36.732916667 + 0.5 * 344 / 1200) * north, 400.0};
}

void expectAlongTheFault(Shown& shown)
{
    const double heading = osg::DegreesToRadians(225.0), pitch = osg::DegreesToRadians(-20.0);
    osg::Vec3d direction = shown.direction();
    direction.normalize();
    EXPECT_NEAR(direction.x(), std::sin(heading) * std::cos(pitch), 1e-5);
    EXPECT_NEAR(direction.y(), std::cos(heading) * std::cos(pitch), 1e-5);
    EXPECT_NEAR(direction.z(), std::sin(pitch), 1e-5);
    EXPECT_LT((shown.at(12000.0) - alongTheFault()).length(), 5.0);
}
} // namespace

// Expected: straight down the top of the picture is the heading; else the horizon is level.
TEST(FirstView, OfAViewpoint)
{
    Viewpoint viewpoint;
    viewpoint.x = 10.0;
    viewpoint.heading = 90.0;
    viewpoint.range = 100.0;
    ViewPlace place = viewFrom(viewpoint);
    EXPECT_LT((place.eye - osg::Vec3d(10.0, 0.0, 100.0)).length(), 1e-9);
    EXPECT_LT((place.up - osg::Vec3d(1.0, 0.0, 0.0)).length(), 1e-9);
    viewpoint.pitch = 0.0;
    place = viewFrom(viewpoint);
    EXPECT_LT((place.eye - osg::Vec3d(-90.0, 0.0, 0.0)).length(), 1e-9);
    EXPECT_LT((place.up - osg::Vec3d(0.0, 0.0, 1.0)).length(), 1e-9);
    EXPECT_EQ(place.centre, osg::Vec3d(10.0, 0.0, 0.0));
}

// Expected: heading, pitch, range and place of the first viewpoint in the map's text; the viewer's
// home is there, too.
TEST(FirstView, OfAMapIsItsFirstViewpoint)
{
    OTL_NEED_GL(context);
    for (const bool hasTrackball : {true, false})
    {
        osg::ref_ptr<osgGA::StandardManipulator> manipulator;
        if (hasTrackball)
            manipulator = new osgGA::TrackballManipulator;
        else
            manipulator = new osgGA::TerrainManipulator;
        Shown shown(viewpoints, manipulator);
        shown.picture().draw(2);
        expectAlongTheFault(shown);
        manipulator->setTransformation(osg::Vec3d(0.0, 0.0, 1e5), osg::Vec3d(),
                                       osg::Vec3d(0.0, 1.0, 0.0));
        manipulator->home(0.0);
        shown.picture().draw(1);
        expectAlongTheFault(shown);
    }
}

// Expected: a camera that somebody has placed stays, until a key asks for a viewpoint.
TEST(FirstView, OfAMapLeavesAloneWhatSomebodyHasPlaced)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<osgGA::TrackballManipulator> manipulator = new osgGA::TrackballManipulator;
    const osg::Vec3d eye(5e4, 0.0, 2e4);
    manipulator->setHomePosition(eye, osg::Vec3d(), osg::Vec3d(0.0, 0.0, 1.0));
    Shown shown(viewpoints, manipulator);
    shown.picture().draw(2);
    EXPECT_LT((shown.eye() - eye).length(), 1e-3);
    shown.press('G'); // the second of two, from the first
    shown.press('G');
    expectAlongTheFault(shown);
}

// Expected: the second viewpoint looks straight down, from 30 km above the terrain, on the axis of
// the cone of earth_files/data, 746000, 4054000 in UTM 16 north: longitude -84.249866892, latitude
// 36.599800403 by PROJ; then the first again, backwards too. North is up.
TEST(FirstView, KeysLeadThroughTheViewpoints)
{
    OTL_NEED_GL(context);
    for (const bool hasManipulator : {true, false})
    {
        Shown shown(viewpoints, hasManipulator ? new osgGA::TrackballManipulator : nullptr);
        shown.picture().draw(2);
        for (const auto& [on, back] : {std::pair('g', 'G'), std::pair('G', 'g')})
        {
            shown.press(on);
            osg::Vec3d direction = shown.direction();
            direction.normalize();
            EXPECT_LT((direction - osg::Vec3d(0.0, 0.0, -1.0)).length(), 1e-5);
            EXPECT_LT((shown.up() - osg::Vec3d(0.0, 1.0, 0.0)).length(), 1e-5);
            const osg::Vec3d place =
                alongTheFault() + osg::Vec3d(-0.049866892 * 89487.8, -0.000199597 * 110970.0, 0.0);
            EXPECT_NEAR(shown.eye().x(), place.x(), 5.0);
            EXPECT_NEAR(shown.eye().y(), place.y(), 5.0);
            EXPECT_GT(shown.eye().z(), 30000.0 + 236.0); // the lowest and highest of the sample
            EXPECT_LT(shown.eye().z(), 30000.0 + 1076.0);
            shown.press(back);
            expectAlongTheFault(shown);
        }
    }
    const auto& listed = osg::ApplicationUsage::instance()->getKeyboardMouseBindings();
    for (const char* key : {"g", "G"})
        EXPECT_TRUE(listed.count(key)) << key;
}

// Expected: keys without viewpoints are left to others.
TEST(FirstView, KeysWithoutViewpointsDoNothing)
{
    OTL_NEED_GL(context);
    Shown shown(jacksboro, new osgGA::TrackballManipulator);
    shown.picture().draw(2);
    const osg::Vec3d before = shown.eye();
    shown.press('g');
    EXPECT_EQ(shown.eye(), before);
}
