#pragma once

#include "gpu/GpuCapabilities.h"
#include <osgTerrainLight/HeadlessContext.h>

#include <gtest/gtest.h>

#include <string>

namespace osgTerrainLight
{

/// The one context that the GL tests of a program share, current on the calling thread; null, with
/// the reason in `reason`, where none of OpenGL 4.3 can be had. It is made at the first call and
/// closed after the last test.
HeadlessContext* sharedGlContext(std::string& reason);

/// OpenGL errors raised since the last call, by name; empty where there were none.
std::string takeGlErrors();

} // namespace osgTerrainLight

/// First line of a test that needs OpenGL: declares `HeadlessContext* context`, or skips the test.
#define OTL_NEED_GL(context)                                                                       \
    std::string context##Reason;                                                                   \
    osgTerrainLight::HeadlessContext* const context =                                              \
        osgTerrainLight::sharedGlContext(context##Reason);                                         \
    if (!context)                                                                                  \
    GTEST_SKIP() << "skipped: no OpenGL 4.3 here (install Mesa's libgl1-mesa-dri): "               \
                 << context##Reason
