#include "lighting/nodes/ComposeNode.h"

#include "gpu/GlConstants.h"

#include <limits>

namespace osgTerrainLight
{

ComposeNode::ComposeNode(const TileSurface& surface, Resource* direct,
                         const std::vector<osg::ref_ptr<Resource>>& bounces, Resource* shading,
                         bool rings)
    : Node("compose"), _surface(&surface), _bounces(bounces), _pass(own(new GpuPass("compose")))
{
    const TextureLayout light = surface.perPost(GL_RGBA16F_ARB);
    reads(direct, light);
    for (const auto& bounce : bounces)
        reads(bounce, light);
    writes(own(shading));
    _pass->set("size", surface.width(), surface.height());
    _pass->set("least", rings ? 0.0f : std::numeric_limits<float>::lowest());
    _pass->reads("direct", direct);
    _pass->writes(0, shading, GpuPass::Access::ReadWrite);
}

Status ComposeNode::run(osg::State& state)
{
    bool first = true;
    for (const auto& bounce : _bounces)
    {
        _pass->reads("bounced", bounce);
        _pass->set("first", first);
        first = false;
        if (Status done = _pass->dispatch(state, _surface->groups()); !done)
            return done;
    }
    return Nothing{};
}

} // namespace osgTerrainLight
