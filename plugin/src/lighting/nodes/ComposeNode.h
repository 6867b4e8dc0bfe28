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
    /// All RGBA16F, a texel per post; 1 … 8 bounces. The node owns the shading. rings: bounces are
    /// in harmonics of order 4, which may fall below 0 where no radiance does; the sums are then
    /// kept at 0 or above.
    ComposeNode(const TileSurface& surface, Resource* direct,
                const std::vector<osg::ref_ptr<Resource>>& bounces, Resource* shading, bool rings);

    Status run(osg::State& state) override;

private:
    ~ComposeNode() override = default;

    osg::ref_ptr<const TileSurface> _surface;
    GpuPass* _pass;
};

} // namespace osgTerrainLight
