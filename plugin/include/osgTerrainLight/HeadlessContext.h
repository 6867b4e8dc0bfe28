#pragma once

#include <osgTerrainLight/Export.h>

#include <osg/State>
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
    /// Makes the context current on the calling thread. Null where none can be had; problem then
    /// says why.
    static std::unique_ptr<HeadlessContext> create(int width, int height, std::string& problem);
    ~HeadlessContext();
    HeadlessContext(const HeadlessContext&) = delete;
    HeadlessContext& operator=(const HeadlessContext&) = delete;

    bool makeCurrent();

    osgViewer::GraphicsWindowEmbedded* window() const;

    /// OSG's view of the context: what compute passes are dispatched with.
    osg::State& state() const;

    /// Which way led to it, for instance "EGL surfaceless".
    const std::string& platform() const;

private:
    struct Implementation;
    explicit HeadlessContext(std::unique_ptr<Implementation> implementation);
    std::unique_ptr<Implementation> _implementation;
};

} // namespace osgTerrainLight
