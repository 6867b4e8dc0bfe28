#pragma once

#include <osgTerrainLight/Export.h>

#include <osg/State>
#include <osgViewer/GraphicsWindow>

#include <memory>
#include <string>

namespace osgTerrainLight
{

/// An OpenGL context without a display. It comes from EGL: from the surfaceless platform (Mesa),
/// else from the first EGL device that gives one (NVIDIA). Its default framebuffer is a pixel
/// buffer of width × height. A viewer draws into it once its camera has window() as graphics
/// context.
class OSGTERRAINLIGHT_EXPORT HeadlessContext
{
public:
    /// Makes a context, which is then current on the calling thread. Returns null where there is
    /// none; problem then says why.
    static std::unique_ptr<HeadlessContext> create(int width, int height, std::string& problem);
    ~HeadlessContext();
    HeadlessContext(const HeadlessContext&) = delete;
    HeadlessContext& operator=(const HeadlessContext&) = delete;

    /// Makes the context current on the calling thread. Returns false where that fails.
    bool makeCurrent();

    /// The graphics context for a viewer's camera.
    osgViewer::GraphicsWindowEmbedded* window() const;

    /// The context's osg::State, which compute passes are dispatched with.
    osg::State& state() const;

    /// The platform that the context came from, for instance "EGL surfaceless".
    const std::string& platform() const;

private:
    struct Implementation;
    explicit HeadlessContext(std::unique_ptr<Implementation> implementation);
    std::unique_ptr<Implementation> _implementation;
};

} // namespace osgTerrainLight
