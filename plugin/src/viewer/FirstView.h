#pragma once

#include <osg/BoundingBox>
#include <osg/Matrixd>
#include <osg/NodeCallback>
#include <osg/Vec3d>
#include <osg/observer_ptr>

#include <vector>

namespace osgViewer
{
class View;
}

namespace osgTerrainLight
{

/// A place to look from, and what is in the middle of the picture. Up is +z.
struct ViewPlace
{
    osg::Vec3d eye, centre;
};

/// Looks at terrain from the south, 30 degrees down, from where it fills 7/10 of a window, or from
/// just above its top where it would have to be nearer. terrain: its extent, x east, y north, z up.
/// fovy: vertical field of view [degrees]. aspect: width over height.
ViewPlace viewFromSouth(const osg::BoundingBoxd& terrain, double fovy, double aspect);

/// Event callback of terrain: gives every viewer that shows it the view of viewFromSouth() as its
/// home, and takes it there, in its first frame. A viewer's own default looks at terrain edge-on.
/// Leaves alone viewers whose camera, or home, somebody has placed, and those without a manipulator
/// that knows a home (osgGA::StandardManipulator).
class FirstView : public osg::NodeCallback
{
public:
    /// terrain: in coordinates of the node.
    explicit FirstView(const osg::BoundingBoxd& terrain) : _terrain(terrain) {}
    // Files name it as the stock callback, which does nothing.

    void operator()(osg::Node* node, osg::NodeVisitor* visitor) override;

private:
    ~FirstView() override = default;

    void place(osgViewer::View& view, const osg::Matrixd& toWorld) const;

    osg::BoundingBoxd _terrain;
    std::vector<osg::observer_ptr<osgViewer::View>> _seen;
};

} // namespace osgTerrainLight
