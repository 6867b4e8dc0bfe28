#pragma once

#include <osgTerrainLight/Export.h>

#include "core/Result.h"

#include <osg/State>
#include <osg/ref_ptr>
#include <osgViewer/GraphicsWindow>

#include <memory>
#include <string>

namespace osgTerrainLight
{

/// An OpenGL context without a display: EGL on the surfaceless platform (Mesa), else on the first
/// EGL device that gives one (NVIDIA). It owns a pixel buffer of width × height as default
/// framebuffer, so a viewer draws into it once its camera has window() as graphics context.
class OSGTERRAINLIGHT_EXPORT HeadlessContext
{
public:
    /// Makes the context current on the calling thread.
    static Result<std::unique_ptr<HeadlessContext>> create(int width = 16, int height = 16);
    ~HeadlessContext();
    HeadlessContext(const HeadlessContext&) = delete;
    HeadlessContext& operator=(const HeadlessContext&) = delete;

    bool makeCurrent();

    osgViewer::GraphicsWindowEmbedded* window() { return _window.get(); }

    /// OSG's view of the context: what passes are dispatched with.
    osg::State& state() { return *_window->getState(); }

    /// Which way led to it, for instance "EGL surfaceless".
    const std::string& platform() const { return _platform; }

private:
    HeadlessContext() = default;

    struct Handles;
    std::unique_ptr<Handles> _handles;
    osg::ref_ptr<osgViewer::GraphicsWindowEmbedded> _window;
    std::string _platform;
};

} // namespace osgTerrainLight
