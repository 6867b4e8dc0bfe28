#include <osgTerrainLight/HeadlessContext.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <cstdio>
#include <cstring>
#include <vector>

#ifndef EGL_PLATFORM_SURFACELESS_MESA
#define EGL_PLATFORM_SURFACELESS_MESA 0x31DD
#endif

namespace osgTerrainLight
{

struct HeadlessContext::Implementation
{
    osg::ref_ptr<osgViewer::GraphicsWindowEmbedded> window;
    std::string platform;
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
    EGLSurface surface = EGL_NO_SURFACE;

    ~Implementation()
    {
        window = nullptr;
        if (display == EGL_NO_DISPLAY)
            return;
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (surface != EGL_NO_SURFACE)
            eglDestroySurface(display, surface);
        if (context != EGL_NO_CONTEXT)
            eglDestroyContext(display, context);
        // The display is shared by all contexts of the process, so it is not terminated.
    }

    bool open(EGLDisplay candidate, int width, int height)
    {
        if (candidate == EGL_NO_DISPLAY || !eglInitialize(candidate, nullptr, nullptr))
            return false;
        display = candidate;
        if (!eglBindAPI(EGL_OPENGL_API))
            return false;
        const EGLint wanted[] = {EGL_SURFACE_TYPE,
                                 EGL_PBUFFER_BIT,
                                 EGL_RENDERABLE_TYPE,
                                 EGL_OPENGL_BIT,
                                 EGL_RED_SIZE,
                                 8,
                                 EGL_GREEN_SIZE,
                                 8,
                                 EGL_BLUE_SIZE,
                                 8,
                                 EGL_ALPHA_SIZE,
                                 8,
                                 EGL_DEPTH_SIZE,
                                 24,
                                 EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        if (!eglChooseConfig(display, wanted, &config, 1, &count) || count == 0)
            return false;
        context = eglCreateContext(display, config, EGL_NO_CONTEXT, nullptr);
        const EGLint size[] = {EGL_WIDTH, width, EGL_HEIGHT, height, EGL_NONE};
        surface = eglCreatePbufferSurface(display, config, size);
        return context != EGL_NO_CONTEXT && surface != EGL_NO_SURFACE &&
               eglMakeCurrent(display, surface, surface, context);
    }
};

std::unique_ptr<HeadlessContext> HeadlessContext::create(int width, int height,
                                                         std::string& problem)
{
    auto platformDisplay = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
        eglGetProcAddress("eglGetPlatformDisplayEXT"));
    auto queryDevices =
        reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);

    std::unique_ptr<Implementation> made;
    const auto attempt = [&](EGLDisplay display, const std::string& name)
    {
        made = std::make_unique<Implementation>();
        made->platform = name;
        return made->open(display, width, height);
    };

    bool open = false;
    if (platformDisplay && extensions && std::strstr(extensions, "EGL_MESA_platform_surfaceless"))
        open = attempt(platformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr),
                       "EGL surfaceless");
    if (!open && platformDisplay && queryDevices)
    {
        std::vector<EGLDeviceEXT> devices(16);
        EGLint count = 0;
        if (queryDevices(static_cast<EGLint>(devices.size()), devices.data(), &count))
            for (EGLint i = 0; i < count && !open; ++i)
                open = attempt(platformDisplay(EGL_PLATFORM_DEVICE_EXT,
                                               devices[static_cast<std::size_t>(i)], nullptr),
                               "EGL device " + std::to_string(i));
    }
    if (!open)
    {
        char code[16];
        std::snprintf(code, sizeof(code), "0x%04x", static_cast<unsigned>(eglGetError()));
        problem = std::string("no OpenGL context without a display: neither EGL's surfaceless "
                              "platform nor an EGL device gave one (last EGL error ") +
                  code + ")";
        return nullptr;
    }
    made->window = new osgViewer::GraphicsWindowEmbedded(0, 0, width, height);
    made->window->getState()->initializeExtensionProcs();
    return std::unique_ptr<HeadlessContext>(new HeadlessContext(std::move(made)));
}

HeadlessContext::HeadlessContext(std::unique_ptr<Implementation> implementation)
    : _implementation(std::move(implementation))
{
}

HeadlessContext::~HeadlessContext()
{
    if (makeCurrent())
        _implementation->window->close(); // deletes its GL objects while the context lives
}

bool HeadlessContext::makeCurrent()
{
    return eglMakeCurrent(_implementation->display, _implementation->surface,
                          _implementation->surface, _implementation->context);
}

osgViewer::GraphicsWindowEmbedded* HeadlessContext::window() const
{
    return _implementation->window;
}

osg::State& HeadlessContext::state() const
{
    return *_implementation->window->getState();
}

const std::string& HeadlessContext::platform() const
{
    return _implementation->platform;
}

} // namespace osgTerrainLight
