#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"
#include "lighting/sources/LightSource.h"

namespace osgTerrainLight
{

/// What host shaders need to find the sun's shadow between posts: screen_edges.comp.
class ScreenEdgesNode : public Node
{
public:
    /// edges: written, RGBA16F, a texel per post (ShadingTexture::edgeSampler).
    ScreenEdgesNode(const TileInputs& inputs, const TileSurface& surface,
                    const LightSources& lights, Resource* edges);

    Status run(osg::State& state) override;

private:
    ~ScreenEdgesNode() override = default;

    osg::ref_ptr<const TileSurface> _surface;
    const LightSources _sun;
    GpuPass* _pass;
};

} // namespace osgTerrainLight
