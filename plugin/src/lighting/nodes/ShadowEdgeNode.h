#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"

namespace osgTerrainLight
{

/// Where the sun's shadow ends between posts: shadow_lines.comp, then shadow_edge.comp.
class ShadowEdgeNode : public Node
{
public:
    ShadowEdgeNode(const TileInputs& inputs, const TileSurface& surface);

    Status run(osg::State& state) override;

    /// RG16F, a texel per post: height over the shadow [m], negative in it, and softness of its
    /// edge [m] (shaders/lib/shadow.glsl); 0 where void.
    Resource* edge() const { return _edge; }

private:
    ~ShadowEdgeNode() override = default;

    osg::ref_ptr<const TileInputs> _inputs;
    osg::ref_ptr<const TileSurface> _surface;
    Resource *_edge, *_shadows;
    GpuPass *_lines, *_posts;
};

} // namespace osgTerrainLight
