#pragma once

#include <osgTerrainLight/HeadlessContext.h>
#include <osgTerrainLight/TerrainLighting.h>

#include <osg/Node>
#include <osg/Notify>
#include <osgViewer/Viewer>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Draws a scene from straight above, north up, without a display.
class ScenePicture
{
public:
    static constexpr int size = 128;

    /// halfSide: from the middle of the picture, at the origin, to its edges [m].
    /// The picture has a context of its own. Precondition: one can be had (OTL_NEED_GL).
    ScenePicture(osg::Node* scene, double halfSide);
    ~ScenePicture();

    osg::State& state() { return _context->state(); }

    osgViewer::Viewer& viewer() { return *_viewer; }

    /// Draws `count` frames and keeps the last.
    void draw(int count = 1);

    /// Mean of the red channel, 0 … 255, in a square of 7 pixels about a place: x east and y north
    /// of the middle, −1 … 1.
    double redAt(double x, double y) const;
    const std::vector<unsigned char>& pixels() const { return _pixels; } ///< RGBA, row 0 south

private:
    std::unique_ptr<HeadlessContext> _context;
    osg::ref_ptr<osgViewer::Viewer> _viewer;
    std::vector<unsigned char> _pixels;
};

/// With so many azimuths, and so much time per update [ms]; 0 is no limit.
osg::ref_ptr<TerrainLighting> lightingWithBudget(double milliseconds, int azimuths);

/// Keeps what OSG says while it lives.
class Said
{
public:
    Said();
    ~Said();
    std::string text() const;
    int count(const std::string& part) const;

private:
    class Handler;
    osg::ref_ptr<Handler> _handler;
    osg::ref_ptr<osg::NotifyHandler> _before;
};

/// Gives osgDB the reader and the serializers that this program holds. The modules must not be
/// loaded besides: they bring a second copy of the library. tests/scene/viewer_test.cpp has those.
void useOwnPlugins();

} // namespace osgTerrainLight
