#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/nodes/LegendreLight.h"

#include <vector>

namespace osgTerrainLight
{

/// Direct light as Nowrouzezahrai and Snyder 2009 compute it: visibility from the height pyramid
/// alone, in spherical harmonics of order 4, times the sky's; key lights, the sun among them, at
/// azimuths of their own. docs/ARCHITECTURE.md has what it leaves of the light.
class LegendreDirectNode : public Node
{
public:
    /// direct: RGBA16F, a texel per post, which the node owns: rgb = irradiance / π, ≥ 0; a =
    /// visible part of the sun, as harmonics have it (1 where the sun is off, 0 where it is below
    /// the horizontal). Void posts: 0.
    LegendreDirectNode(const TileInputs& inputs, const PyramidNode& pyramid,
                       const LegendreScheme& scheme, Resource* direct);

    Status run(osg::State& state) override;

private:
    ~LegendreDirectNode() override = default;
    GpuPass& choosePass(const SkyLight& sky);
    void setRays(GpuPass& pass, const SkyLight& sky) const;

    osg::ref_ptr<const TileInputs> _inputs;
    osg::ref_ptr<const TileSurface> _surface;
    LegendreScheme _scheme;
    GpuPass *_uniform, *_harmonics; ///< by the kind of sky
    Resource* _skyProduct;          ///< has no texture where the sky is uniform
    std::vector<Rgb> _productOf;    ///< the harmonics that it was made of
};

} // namespace osgTerrainLight
