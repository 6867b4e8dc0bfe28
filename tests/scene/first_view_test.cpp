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
    /// Of the window, that is not background.
    double covered() const
    {
        int count = 0;
        const std::vector<unsigned char>& pixels = _picture.pixels();
        for (std::size_t i = 0; i < pixels.size(); i += 4)
            count += pixels[i] == 0 && pixels[i + 1] == 0 && pixels[i + 2] == 255 ? 0 : 1;
        return count / double(ScenePicture::size * ScenePicture::size);
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

// Expected: terrain, which no pixel of the background's blue is, in at least half of the window.
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
