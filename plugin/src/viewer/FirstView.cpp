#include "viewer/FirstView.h"

#include <osg/Math>
#include <osg/Transform>
#include <osgGA/EventVisitor>
#include <osgGA/KeySwitchMatrixManipulator>
#include <osgGA/StandardManipulator>
#include <osgViewer/View>

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{
namespace
{
const double down = osg::DegreesToRadians(30.0);
constexpr double filled = 0.7; // of the window: half where a fourth of the terrain is void

/// How much of the window sees the rectangle of the terrain at half of its height, by rays.
double shareOf(const osg::BoundingBoxd& terrain, const osg::Vec3d& eye, double fovy, double aspect)
{
    constexpr int across = 80, up = 60;
    const double tangent = std::tan(0.5 * osg::DegreesToRadians(fovy));
    const double height = eye.z() - terrain.center().z();
    int seen = 0;
    for (int j = 0; j < up; ++j)
        for (int i = 0; i < across; ++i)
        {
            const double x = ((i + 0.5) / across * 2.0 - 1.0) * tangent * aspect;
            const double y = ((j + 0.5) / up * 2.0 - 1.0) * tangent;
            const double sinks = std::sin(down) - y * std::cos(down);
            if (sinks <= 0.0)
                continue;
            const double away = height / sinks;
            const double east = eye.x() + x * away;
            const double north = eye.y() + (std::cos(down) + y * std::sin(down)) * away;
            seen += east >= terrain.xMin() && east <= terrain.xMax() && north >= terrain.yMin() &&
                            north <= terrain.yMax()
                        ? 1
                        : 0;
        }
    return double(seen) / (across * up);
}

/// The one that moves the camera; null where it is of another kind.
osgGA::StandardManipulator* standardOf(osgGA::CameraManipulator* manipulator)
{
    if (const auto* keys = dynamic_cast<osgGA::KeySwitchMatrixManipulator*>(manipulator))
        return dynamic_cast<osgGA::StandardManipulator*>(
            const_cast<osgGA::CameraManipulator*>(keys->getCurrentMatrixManipulator()));
    return dynamic_cast<osgGA::StandardManipulator*>(manipulator);
}

void goHome(osgGA::CameraManipulator& manipulator, osgViewer::View& view)
{
    manipulator.home(*view.getEventQueue()->createEvent(), view);
}

/// Whether the manipulator looks as it does by itself, from any distance: that depends on a window,
/// which may have changed since.
bool isAtHome(osgGA::StandardManipulator& manipulator, osgViewer::View& view)
{
    const osg::Matrixd before = manipulator.getMatrix();
    goHome(manipulator, view);
    const osg::Matrixd home = manipulator.getMatrix();
    osg::Vec3d eye, centre, up;
    manipulator.getHomePosition(eye, centre, up);
    osg::Vec3d from = before.getTrans() - centre, by = eye - centre;
    from.normalize();
    by.normalize();
    double difference = (from - by).length();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            difference = std::max(difference, std::abs(before(row, column) - home(row, column)));
    if (difference < 1e-5)
        return true;
    manipulator.setByMatrix(before);
    return false;
}
} // namespace

ViewPlace viewFromSouth(const osg::BoundingBoxd& terrain, double fovy, double aspect)
{
    const osg::Vec3d centre = terrain.center();
    const osg::Vec3d back(0.0, -std::cos(down), std::sin(down));
    // Above the top, even where that is in front of the middle.
    double nearest =
        1.2 * (0.5 * (terrain.zMax() - terrain.zMin()) / std::sin(down)) + 1e-3 * terrain.radius();
    double farthest = std::max(nearest, 100.0 * terrain.radius());
    if (shareOf(terrain, centre + back * nearest, fovy, aspect) >= filled)
        for (int i = 0; i < 40; ++i)
        {
            const double between = std::sqrt(nearest * farthest);
            (shareOf(terrain, centre + back * between, fovy, aspect) >= filled ? nearest
                                                                               : farthest) =
                between;
        }
    return {centre + back * nearest, centre};
}

ViewPlace viewFrom(const Viewpoint& viewpoint)
{
    const double heading = osg::DegreesToRadians(viewpoint.heading);
    const double pitch = osg::DegreesToRadians(viewpoint.pitch);
    const osg::Vec3d level(std::sin(heading), std::cos(heading), 0.0);
    const osg::Vec3d above(0.0, 0.0, 1.0);
    const osg::Vec3d centre(viewpoint.x, viewpoint.y, viewpoint.z);
    const osg::Vec3d ahead = level * std::cos(pitch) + above * std::sin(pitch);
    return {centre - ahead * viewpoint.range, centre,
            above * std::cos(pitch) - level * std::sin(pitch)};
}

void lookFrom(osgViewer::View& view, const Viewpoint& viewpoint, const osg::Matrixd& toWorld)
{
    const ViewPlace place = viewFrom(viewpoint);
    const osg::Vec3d eye = place.eye * toWorld, centre = place.centre * toWorld;
    const osg::Vec3d up = osg::Matrixd::transform3x3(place.up, toWorld);
    osgGA::CameraManipulator* given = view.getCameraManipulator();
    if (osgGA::StandardManipulator* manipulator = standardOf(given))
        manipulator->setTransformation(eye, centre, up);
    else if (given)
        given->setByInverseMatrix(osg::Matrixd::lookAt(eye, centre, up));
    else
        view.getCamera()->setViewMatrixAsLookAt(eye, centre, up);
}

void FirstView::operator()(osg::Node* node, osg::NodeVisitor* visitor)
{
    if (osgGA::EventVisitor* events = visitor->asEventVisitor())
    {
        auto* view = dynamic_cast<osgViewer::View*>(events->getActionAdapter());
        const bool isNew =
            view && std::none_of(_seen.begin(), _seen.end(),
                                 [view](const auto& seen) { return seen.get() == view; });
        if (isNew)
        {
            _seen.emplace_back(view);
            place(*view, osg::computeLocalToWorld(visitor->getNodePath()));
        }
    }
    traverse(node, visitor);
}

void FirstView::place(osgViewer::View& view, const osg::Matrixd& toWorld) const
{
    osgGA::CameraManipulator* given = view.getCameraManipulator();
    osgGA::StandardManipulator* manipulator = standardOf(given);
    if (!manipulator || !manipulator->getAutoComputeHomePosition() || !isAtHome(*manipulator, view))
        return;
    double fovy = 30.0, aspect = 4.0 / 3.0, zNear = 0.0, zFar = 0.0;
    if (!view.getCamera()->getProjectionMatrixAsPerspective(fovy, aspect, zNear, zFar))
        return; // a plan
    const ViewPlace place = _home ? viewFrom(*_home) : viewFromSouth(_terrain, fovy, aspect);
    given->setHomePosition(place.eye * toWorld, place.centre * toWorld,
                           osg::Matrixd::transform3x3(place.up, toWorld));
    goHome(*manipulator, view);
}

} // namespace osgTerrainLight
