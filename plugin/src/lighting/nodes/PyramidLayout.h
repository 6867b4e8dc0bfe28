#pragma once

#include "core/Result.h"
#include "gpu/GpuPass.h"

#include <osg/State>

#include <vector>

namespace osgTerrainLight
{

/// Where the levels of a pyramid stand in its texture. Level 0 is a texture of its own.
struct PyramidLayout
{
    struct Level
    {
        int x = 0, y = 0, width = 0, height = 0;
    };
    std::vector<Level> levels;
    int width = 1, height = 1; ///< of the texture of the levels above 0 [texels]

    TextureLayout texture(GLint format, int layers = 0) const
    {
        return {width, height, layers, format};
    }

    static PyramidLayout ofPosts(int columns, int rows);
    static PyramidLayout ofCells(int columns, int rows);
};

/// Fills the levels above 0. first: from level 0, which begins at texel (frame, frame) of `finest`;
/// next: from each other. Texture arrays: every layer.
Status reducePyramid(osg::State& state, const PyramidLayout& layout, GpuPass& first,
                     Resource* finest, int frame, GpuPass& next, Resource* pyramid);

/// Sets an array of levels.
void setLevels(GpuPass& pass, const char* uniform, const PyramidLayout& layout);

} // namespace osgTerrainLight
