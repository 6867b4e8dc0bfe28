#pragma once

#include <osgTerrainLight/LightingSettings.h>

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"
#include "lighting/nodes/BounceRays.h"
#include "lighting/sources/LightSource.h"

namespace osgTerrainLight
{

class SentNode;

/// Light that a glossy tile sends, as spherical harmonics of order 4 of the direction that it
/// leaves in: the vector pyramid of Nowrouzezahrai and Snyder 2009 (section 5.3), but of exit
/// radiance, which filters linearly where normals differ. What all nodes of gloss share.
class GlossWork : public GpuWork
{
public:
    /// Of what the viewer reads: 12 of harmonics (gloss.comp), one of the surface.
    static constexpr int layers = 13;

    /// rays: null without bounces.
    GlossWork(const TileInputs& inputs, const TileSurface& surface, BounceRays* rays,
              Resource* horizon);

    bool isVector() const { return _transfer == GlossTransfer::Vector; }

    /// Light that posts send, for the viewer: RGBA16F.
    Resource* createLight() const;
    /// What posts send in one bounce, for other terrain: 12 layers. One texel where no terrain is
    /// to read it: what is stored beyond it has no effect.
    Resource* createExit(bool isRead) const;

    /// The pass that adds to what cells send what their corners' gloss sends to the viewer.
    GpuPass* createShadePass() const;

    /// One bounce: from what posts sent (exit) and cells sent, to what posts send then. diffuse and
    /// bounced: irradiance / π of this bounce without and with the light of gloss; unless
    /// isVector() not used.
    struct Bounce
    {
        const SentNode* sent;
        Resource *exitBefore, *exit, *lightBefore, *light, *diffuse, *bounced;
    };
    Status dispatch(osg::State& state, const Bounce& bounce);

private:
    friend class GlossNode;
    ~GlossWork() override = default;

    osg::ref_ptr<const TileInputs> _inputs;
    osg::ref_ptr<const TileSurface> _surface;
    const GlossTransfer _transfer;
    PyramidLayout _posts;
    GpuPass *_direct, *_gather, *_reduce;
    Resource* _exitPyramid = nullptr; ///< null unless Vector and bounces
};

/// What glossy posts send of the light of the sources.
class GlossNode : public Node
{
public:
    /// lights: those whose horizons the pass reads. direct: of which the sun's visible fraction is
    /// read. light, exit: as GlossWork creates them; the node owns both.
    GlossNode(const TileInputs& inputs, GlossWork* work, const LightSources& lights,
              Resource* horizon, Resource* direct, Resource* light, Resource* exit);

    Status run(osg::State& state) override;

private:
    ~GlossNode() override = default;

    osg::ref_ptr<const TileInputs> _inputs;
    GlossWork* _work;
    LightSources _lights;
    osg::ref_ptr<Resource> _light, _exit;
};

/// What glossy posts send of the terrain that they see, and what they light by it, in one bounce.
class GlossBounceNode : public Node
{
public:
    /// Owns exit, light and, where isVector(), bounced.
    GlossBounceNode(const TileSurface& surface, const PyramidNode& pyramid, GlossWork* work,
                    SentNode* sent, Resource* horizon, const GlossWork::Bounce& bounce);

    Status run(osg::State& state) override;

private:
    ~GlossBounceNode() override = default;

    GlossWork* _work;
    osg::ref_ptr<SentNode> _sent;
    GlossWork::Bounce _bounce;
    std::vector<osg::ref_ptr<Resource>> _held;
};

} // namespace osgTerrainLight
