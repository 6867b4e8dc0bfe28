#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"
#include "lighting/nodes/BounceRays.h"
#include "lighting/nodes/SentNode.h"
#include "lighting/sources/LightSource.h"

namespace osgTerrainLight
{

/// Passes that gather a bounce (bounce.comp): one for the first bounce, one for all others, so that
/// these share programs.
class Gather : public GpuWork
{
public:
    /// first: of light that the sources send, not of the bounce before. far: where bounces are
    /// sub-sampled, what blocks gather (farLayout()); else null.
    Gather(const TileInputs& inputs, const TileSurface& surface, BounceRays* rays,
           const LightSources& lights, Resource* horizon, Resource* far, bool first);

    static TextureLayout farLayout(const TileSurface& surface, const LightingSettings& settings);

    /// before: direct light, or the light of the bounce before.
    Status dispatch(osg::State& state, const SentNode& sent, Resource* before, Resource* light);

private:
    ~Gather() override = default;

    osg::ref_ptr<const TileSurface> _surface;
    LightSources _lights; ///< none where not the first
    bool _isFirst;
    int _stride;
    GpuPass* _near;
    GpuPass* _far = nullptr; ///< null: _near gathers all
};

/// Diffuse light of one bounce, at posts.
class BounceNode : public Node
{
public:
    /// before: as of Gather. light: RGBA16F, a texel per post: rgb = irradiance / π, a = 1; 0 where
    /// void; the node owns it.
    BounceNode(const TileSurface& surface, const PyramidNode& pyramid, Gather* gather,
               SentNode* sent, Resource* horizon, Resource* before, Resource* light);

    /// For the first bounce: what its receivers' own cells send is found anew from these.
    void followsLight(const TileInputs& inputs, const LightSources& lights);

    Status run(osg::State& state) override;

private:
    ~BounceNode() override = default;

    osg::ref_ptr<SentNode> _sent;
    Gather* _gather;
    osg::ref_ptr<Resource> _before, _light;
};

} // namespace osgTerrainLight
