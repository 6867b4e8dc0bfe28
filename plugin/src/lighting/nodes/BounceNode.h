#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"
#include "lighting/nodes/BounceSweep.h"
#include "lighting/nodes/SentNode.h"
#include "lighting/sources/LightSource.h"

namespace osgTerrainLight
{

/// Diffuse light of one bounce, at posts.
class BounceNode : public Node
{
public:
    /// before: as of BounceSweep. light: RGBA16F, a texel per post: rgb = irradiance / π, a = 1; 0
    /// where void; the node owns it.
    BounceNode(const TileSurface& surface, BounceSweep* sweep, SentNode* sent, Resource* horizon,
               Resource* before, Resource* light);

    /// What comes from beyond the tile (TileSurface::createFarLight()).
    void addFarLight(Resource* light) { _far = own(light); }

    /// For the first bounce: what its receivers' own cells send is found anew from these.
    void followsLight(const TileInputs& inputs, const LightSources& lights);

    Status run(osg::State& state) override;

private:
    ~BounceNode() override = default;

    osg::ref_ptr<SentNode> _sent;
    BounceSweep* _sweep;
    osg::ref_ptr<Resource> _before, _light;
    Resource* _far = nullptr;
};

} // namespace osgTerrainLight
