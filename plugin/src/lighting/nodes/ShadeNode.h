#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"
#include "lighting/sources/LightSource.h"

namespace osgTerrainLight
{

/// Direct light of posts: rgb = irradiance / π, a = visible fraction of the sun.
class ShadeNode : public Node
{
public:
    /// skyView: of SkyViewNode. direct: RGBA16F, a texel per post, which the node owns.
    ShadeNode(const TileInputs& inputs, const TileSurface& surface, Resource* skyView,
              const LightSources& lights, Resource* direct);

    Status run(osg::State& state) override;

private:
    ~ShadeNode() override = default;

    osg::ref_ptr<const TileSurface> _surface;
    LightSources _lights;
    GpuPass* _pass;
};

} // namespace osgTerrainLight
