#pragma once

#include "lighting/methods/Method.h"
#include "lighting/nodes/BounceNode.h"
#include "lighting/nodes/BounceRays.h"
#include "lighting/nodes/GlossNode.h"
#include "lighting/nodes/PyramidNode.h"
#include "lighting/nodes/SentNode.h"
#include "lighting/sources/Sky.h"

namespace osgTerrainLight
{

/// The default: exact integrals over slices of azimuth, from horizons of every post.
class Slices : public Method
{
public:
    /// Void posts that the surface needs on every side: a sweep reads far beyond the last.
    static constexpr int frame = HorizonNode::frame;

    Slices(const TileInputs& inputs, const TileSurface& surface, SkyTableNode* table);

    WorkGraph::Nodes sources() const override;
    std::vector<HorizonNode*> horizons() const override;
    Resource* skyView() const override { return _sky->view(); }
    Resource* skyHorizon() const override { return horizon(); }
    bool readsSkyTable() const override { return true; }
    bool mayUndershoot() const override { return _gloss.valid(); }
    void declareDirect(WorkGraph::Nodes& nodes, Resource* direct, int bounces,
                       Resource* lightOfGloss) override;
    void declareEdges(WorkGraph::Nodes& nodes, Resource* edges) override;
    osg::ref_ptr<Resource> declareBounce(WorkGraph::Nodes& nodes) override;
    void follow(Invalidation stale) override;

private:
    ~Slices() override = default;
    Resource* horizon() const { return _sky->horizon()->horizon(); }
    void declareGloss(WorkGraph::Nodes& nodes);
    osg::ref_ptr<Resource> declareGlossBounce(WorkGraph::Nodes& nodes, Resource* diffuse);

    osg::ref_ptr<const TileInputs> _inputs;
    osg::ref_ptr<const TileSurface> _surface;
    osg::ref_ptr<Sky> _sky;
    LightSources _lights; ///< all of them

    // Of the last declareDirect().
    int _bounces = 0, _bounce = 0; ///< all, and those that are declared
    osg::ref_ptr<BounceSweep> _first, _next;
    osg::ref_ptr<PyramidNode> _pyramid; ///< null where nothing is glossy, like _rays
    osg::ref_ptr<BounceRays> _rays;
    osg::ref_ptr<Resource> _light; ///< direct, then of the last bounce
    osg::ref_ptr<Resource> _lightOfGloss;
    osg::ref_ptr<GlossWork> _gloss; ///< null where nothing is glossy
    osg::ref_ptr<Resource> _glossSoFar, _exit;
    osg::ref_ptr<SentNode> _sent;
};

} // namespace osgTerrainLight
