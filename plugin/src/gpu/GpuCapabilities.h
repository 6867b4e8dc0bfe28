#pragma once

#include "core/Result.h"

#include <osg/State>

#include <string>

namespace osgTerrainLight
{

/// What a graphics context offers.
struct GpuCapabilities
{
    std::string vendor, renderer, version;
    int major = 0, minor = 0;
    int maxTextureSize = 0;
    int maxArrayLayers = 0;

    /// Needs a current context. NotSupported, with one sentence that names the version found and
    /// the version needed, where it is older than OpenGL 4.3.
    static Result<GpuCapabilities> query(osg::State& state);

    /// True where the rasteriser is a program, not a chip (llvmpipe, softpipe).
    bool isSoftware() const;
};

} // namespace osgTerrainLight
