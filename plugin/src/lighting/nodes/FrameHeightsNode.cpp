#include "lighting/nodes/FrameHeightsNode.h"

#include "gpu/GlConstants.h"

#include <osg/GLExtensions>

namespace osgTerrainLight
{

FrameHeightsNode::FrameHeightsNode(const TileInputs& inputs, const TileSurface& surface)
    : Node("heights"), _inputs(&inputs), _width(surface.width() + 2 * surface.frame()),
      _height(surface.height() + 2 * surface.frame()), _pass(own(new GpuPass("frame_heights"))),
      _posts(own(new Resource("posts")))
{
    reads(inputs.postsValue);
    writes(surface.heights());
    surface.heights()->keepWhole(); // a host may write the posts meanwhile
    _pass->reads("eastSpacings", surface.eastSpacings());
    _pass->set("size", surface.width(), surface.height());
    _pass->set("frame", surface.frame());
    _pass->set("northSpacing", static_cast<float>(surface.tile().northSpacing));
    _pass->set("curvature",
               static_cast<float>(surface.bodyRadius() > 0.0 ? 1.0 / surface.bodyRadius() : 0.0));
    _pass->writes(0, surface.heights());
}

Status FrameHeightsNode::run(osg::State& state)
{
    if (_inputs->ownsPosts)
        _posts->set(_inputs->posts);
    _pass->reads("posts", _inputs->posts);
    // A pass of the host may have written the posts: OSG issues no barrier after it.
    state.get<osg::GLExtensions>()->glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    return _pass->dispatch(state,
                           {GpuPass::groupsFor(_width, 8), GpuPass::groupsFor(_height, 8), 1});
}

} // namespace osgTerrainLight
