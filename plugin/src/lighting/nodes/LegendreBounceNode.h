#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/nodes/LegendreLight.h"

namespace osgTerrainLight
{

/// RGBA16F, a texel per block of stride x stride posts.
TextureLayout blockLayout(const TileSurface& surface, int stride);

/// What posts send out in one bounce, one of each block: post_radiance.comp.
class LegendreSentNode : public Node
{
public:
    /// light: irradiance / π that is sent on, a texel per post, or where byBlock per block. paced:
    /// the node follows it where bounces are due only.
    LegendreSentNode(const TileInputs& inputs, const TileSurface& surface, int stride,
                     Resource* light, bool byBlock, bool paced);

    Status run(osg::State& state) override;

    /// RGBA16F, a texel per block: radiance, 1; 0 where all is void.
    Resource* radiance() const { return _radiance; }
    /// Coarser and coarser: radiance times weight, weight.
    Resource* pyramid() const { return _pyramid; }
    const PyramidLayout& blocks() const { return _blocks; }

private:
    ~LegendreSentNode() override = default;

    osg::ref_ptr<const TileSurface> _surface;
    int _stride;
    PyramidLayout _blocks;
    Resource *_radiance, *_pyramid;
    GpuPass *_pass, *_reduce;
};

/// Passes of the bounces as Nowrouzezahrai and Snyder 2009 compute them: slices in normalised
/// Legendre polynomials, joined to spherical harmonics of order 4, and no horizon map. The
/// yardstick for BounceNode; docs/ARCHITECTURE.md has what it leaves of the light.
class LegendreGather : public GpuWork
{
public:
    LegendreGather(const PyramidNode& pyramid, const LegendreScheme& scheme);

    /// light: signed, a texel per post. blocks: the same where it was gathered, or null where no
    /// bounce follows.
    Status dispatch(osg::State& state, const LegendreSentNode& sent, Resource* light,
                    Resource* blocks);

    const LegendreScheme& scheme() const { return _scheme; }

private:
    ~LegendreGather() override = default;

    osg::ref_ptr<const TileSurface> _surface;
    LegendreScheme _scheme;
    GpuPass *_last, *_other; ///< a bounce: the last one, and those that another follows
};

/// One such bounce.
class LegendreBounceNode : public Node
{
public:
    /// light, blocks: as of LegendreGather; the node owns both. light: rgb = irradiance / π, which
    /// may be below 0; a = 1; 0 where void.
    LegendreBounceNode(const PyramidNode& pyramid, LegendreGather* gather, LegendreSentNode* sent,
                       Resource* light, Resource* blocks);

    Status run(osg::State& state) override;

private:
    ~LegendreBounceNode() override = default;

    LegendreGather* _gather;
    osg::ref_ptr<LegendreSentNode> _sent;
    Resource *_light, *_blocks;
};

} // namespace osgTerrainLight
