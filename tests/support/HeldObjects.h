#pragma once

#include "support/ScenePicture.h"
#include <osgTerrainLight/TerrainLighting.h>

#include <osg/BufferObject>
#include <osg/ContextData>
#include <osg/Texture>

#include <cstddef>
#include <fstream>

namespace osgTerrainLight
{

/// What a program holds.
struct Held
{
    unsigned textures = 0, buffers = 0; ///< OpenGL objects
    std::size_t graphics = 0;           ///< LightingStatistics::bytes
    std::size_t resident = 0;           ///< of the process [bytes]
};

inline Held heldBy(ScenePicture& picture, const TerrainLighting& lighting)
{
    const unsigned context = picture.state().getContextID();
    Held held;
    auto& textures = *osg::get<osg::TextureObjectManager>(context);
    held.textures =
        textures.getNumberActiveTextureObjects() + textures.getNumberOrphanedTextureObjects();
    auto& buffers = *osg::get<osg::GLBufferObjectManager>(context);
    held.buffers =
        buffers.getNumberActiveGLBufferObjects() + buffers.getNumberOrphanedGLBufferObjects();
    held.graphics = lighting.getStatistics().bytes;
    std::ifstream pages("/proc/self/statm"); // of 4 KiB: the whole, then those that are resident
    std::size_t whole = 0;
    pages >> whole >> held.resident;
    held.resident *= 4096;
    return held;
}

} // namespace osgTerrainLight
