#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileSurface.h"

#include <vector>

namespace osgTerrainLight
{

/// The shading where there are bounces: direct light and the light of each bounce, added in this
/// order, each sum rounded to half floats (compose.comp).
class ComposeNode : public Node
{
public:
    /// All RGBA16F, a texel per post. The node owns the shading.
    ComposeNode(const TileSurface& surface, Resource* direct,
                const std::vector<osg::ref_ptr<Resource>>& bounces, Resource* shading);

    Status run(osg::State& state) override;

private:
    ~ComposeNode() override = default;

    osg::ref_ptr<const TileSurface> _surface;
    std::vector<osg::ref_ptr<Resource>> _bounces;
    GpuPass* _pass;
};

} // namespace osgTerrainLight
