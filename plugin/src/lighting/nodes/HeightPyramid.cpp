#include "lighting/nodes/HeightPyramid.h"

#include "gpu/GlConstants.h"
#include "gpu/Textures.h"

namespace osgTerrainLight
{

HeightPyramid::HeightPyramid(const DemTile& tile, osg::Texture2D* heights, int frame)
    : _frame(frame), _layout(PyramidLayout::ofPosts(tile.width(), tile.height())),
      _heights(heights), _texture(createTarget(_layout.width, _layout.height, GL_RG32F)),
      _first(new GpuPass("pyramid", {"HEIGHTS", "FROM_POSTS"})),
      _next(new GpuPass("pyramid", {"HEIGHTS"}))
{
}

Status HeightPyramid::dispatch(osg::State& state)
{
    return reducePyramid(state, _layout, *_first, _heights, _frame, *_next, _texture);
}

std::size_t HeightPyramid::bytes() const
{
    return textureBytes(*_texture);
}

void HeightPyramid::releaseGLObjects(osg::State* state) const
{
    _first->releaseGLObjects(state);
    _next->releaseGLObjects(state);
    _texture->releaseGLObjects(state);
}

void HeightPyramid::resizeGLObjectBuffers(unsigned size)
{
    _first->resizeGLObjectBuffers(size);
    _next->resizeGLObjectBuffers(size);
    _texture->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
