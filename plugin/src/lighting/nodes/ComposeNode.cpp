#include "lighting/nodes/ComposeNode.h"

#include "gpu/GlConstants.h"

#include <limits>
#include <string>

namespace osgTerrainLight
{

ComposeNode::ComposeNode(const TileSurface& surface, Resource* direct,
                         const std::vector<osg::ref_ptr<Resource>>& bounces, Resource* shading,
                         bool rings)
    : Node("compose"), _surface(&surface), _pass(own(new GpuPass("compose")))
{
    const TextureLayout light = surface.perPost(GL_RGBA16F_ARB);
    reads(direct, light);
    writes(own(shading));
    _pass->set("size", surface.width(), surface.height());
    _pass->set("least", rings ? 0.0f : std::numeric_limits<float>::lowest());
    _pass->reads("direct", direct);
    _pass->writes(0, shading);
    int count = 0;
    for (const auto& bounce : bounces)
    {
        reads(bounce, light);
        _pass->reads("bounce" + std::to_string(count++), bounce);
    }
    _pass->set("bounces", count);
}

Status ComposeNode::run(osg::State& state)
{
    return _pass->dispatch(state, _surface->groups());
}

} // namespace osgTerrainLight
