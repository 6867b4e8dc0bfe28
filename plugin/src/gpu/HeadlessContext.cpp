#include "gpu/HeadlessContext.h"

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

struct HeadlessContext::Handles
{
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
    EGLSurface surface = EGL_NO_SURFACE;

    ~Handles()
    {
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

Result<std::unique_ptr<HeadlessContext>> HeadlessContext::create(int width, int height)
{
    auto platformDisplay = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
        eglGetProcAddress("eglGetPlatformDisplayEXT"));
    auto queryDevices =
        reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);

    std::unique_ptr<HeadlessContext> result(new HeadlessContext);
    const auto attempt = [&](EGLDisplay display, const std::string& name)
    {
        result->_handles = std::make_unique<Handles>();
        result->_platform = name;
        return result->_handles->open(display, width, height);
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
        return Error{ErrorCode::NotSupported,
                     std::string("no OpenGL context without a display: neither EGL's surfaceless "
                                 "platform nor an EGL device gave one (last EGL error ") +
                         code + ")"};
    }

    result->_window = new osgViewer::GraphicsWindowEmbedded(0, 0, width, height);
    result->_window->getState()->initializeExtensionProcs();
    return result;
}

HeadlessContext::~HeadlessContext()
{
    if (_window && makeCurrent())
        _window->close(); // deletes its GL objects while the context lives
    _window = nullptr;
}

bool HeadlessContext::makeCurrent()
{
    return eglMakeCurrent(_handles->display, _handles->surface, _handles->surface,
                          _handles->context);
}

} // namespace osgTerrainLight
