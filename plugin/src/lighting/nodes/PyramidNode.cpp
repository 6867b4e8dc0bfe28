#include "lighting/nodes/PyramidNode.h"

#include "gpu/GlConstants.h"

namespace osgTerrainLight
{

PyramidNode::PyramidNode(const TileSurface& surface)
    : Node("pyramid"), _surface(&surface),
      _layout(PyramidLayout::ofPosts(surface.width(), surface.height())),
      _pyramid(writes(own(new Resource("pyramid", _layout.texture(GL_RG32F))))),
      _first(own(new GpuPass("pyramid", {"HEIGHTS", "FROM_POSTS"}))),
      _next(own(new GpuPass("pyramid", {"HEIGHTS"})))
{
    reads(surface.heights());
}

Status PyramidNode::run(osg::State& state)
{
    return reducePyramid(state, _layout, *_first, _surface->heights(), _surface->frame(), *_next,
                         _pyramid);
}

} // namespace osgTerrainLight
