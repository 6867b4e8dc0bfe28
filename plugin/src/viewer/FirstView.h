#pragma once

#include <osgTerrainLight/Viewpoint.h>

#include <osg/BoundingBox>
#include <osg/Matrixd>
#include <osg/NodeCallback>
#include <osg/Vec3d>
#include <osg/observer_ptr>

#include <optional>
#include <utility>
#include <vector>

namespace osgViewer
{
class View;
}

namespace osgTerrainLight
{

/// A place to look from, and what is in the middle of the picture.
struct ViewPlace
{
    osg::Vec3d eye, centre;
    osg::Vec3d up = {0.0, 0.0, 1.0};
};

/// Of a viewpoint, with the horizon level; up is defined for a view straight down, too.
ViewPlace viewFrom(const Viewpoint& viewpoint);

/// Moves the camera of a view there. toWorld: from the frame of the viewpoint.
void lookFrom(osgViewer::View& view, const Viewpoint& viewpoint, const osg::Matrixd& toWorld);

/// Looks at terrain from the south, 30 degrees down, from where it fills 7/10 of a window, or from
/// just above its top where it would have to be nearer. terrain: its extent, x east, y north, z up.
/// fovy: vertical field of view [degrees]. aspect: width over height.
ViewPlace viewFromSouth(const osg::BoundingBoxd& terrain, double fovy, double aspect);

/// Event callback of terrain: gives every viewer that shows it a home, and takes it there, in its
/// first frame: the home of a map, or else the view of viewFromSouth(). A viewer's own default
/// looks at terrain edge-on. Leaves alone viewers whose camera, or home, somebody has placed, and
/// those without a manipulator that knows a home (osgGA::StandardManipulator).
class FirstView : public osg::NodeCallback
{
public:
    /// terrain, home: in coordinates of the node.
    explicit FirstView(const osg::BoundingBoxd& terrain, std::optional<Viewpoint> home = {})
        : _terrain(terrain), _home(std::move(home))
    {
    }
    // Files name it as the stock callback, which does nothing.

    void operator()(osg::Node* node, osg::NodeVisitor* visitor) override;

private:
    ~FirstView() override = default;

    void place(osgViewer::View& view, const osg::Matrixd& toWorld) const;

    osg::BoundingBoxd _terrain;
    std::optional<Viewpoint> _home;
    std::vector<osg::observer_ptr<osgViewer::View>> _seen;
};

} // namespace osgTerrainLight
