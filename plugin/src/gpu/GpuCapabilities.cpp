#include "gpu/GpuCapabilities.h"

#include "gpu/GlConstants.h"

#include <osg/GLExtensions>

#include <cstdio>

namespace osgTerrainLight
{

namespace
{
std::string text(GLenum name)
{
    const GLubyte* value = glGetString(name);
    return value ? reinterpret_cast<const char*>(value) : "";
}
} // namespace

Result<GpuCapabilities> GpuCapabilities::query(osg::State& state)
{
    GpuCapabilities found;
    found.vendor = text(GL_VENDOR);
    found.renderer = text(GL_RENDERER);
    found.version = text(GL_VERSION);
    std::sscanf(found.version.c_str(), "%d.%d", &found.major, &found.minor);
    const auto* extensions = state.get<osg::GLExtensions>();
    const bool recent = found.major > 4 || (found.major == 4 && found.minor >= 3);
    if (!recent || !extensions->glDispatchCompute || !extensions->glBindImageTexture)
        return Error{
            ErrorCode::NotSupported,
            "terrain lighting needs OpenGL 4.3 (compute shaders); this context is OpenGL '" +
                found.version + "' on '" + found.renderer + "'"};
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &found.maxTextureSize);
    glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &found.maxArrayLayers);
    return found;
}

bool GpuCapabilities::isSoftware() const
{
    return renderer.find("llvmpipe") != std::string::npos ||
           renderer.find("softpipe") != std::string::npos;
}

} // namespace osgTerrainLight
