#pragma once

#include "lighting/methods/Method.h"
#include "lighting/nodes/LegendreBounceNode.h"
#include "lighting/nodes/PyramidNode.h"

namespace osgTerrainLight
{

/// The yardstick: all light as Nowrouzezahrai and Snyder 2009 compute it, from a pyramid of heights
/// alone. Nothing is glossy.
class Legendre : public Method
{
public:
    /// Void posts that the surface needs on every side: a normal reads one beyond.
    static constexpr int frame = 1;

    Legendre(const TileInputs& inputs, const TileSurface& surface, SkyTableNode* table);

    /// The table, for probes.
    WorkGraph::Nodes sources() const override { return {_table}; }
    bool readsSkyTable() const override { return false; }
    bool mayUndershoot() const override { return true; }
    void declareDirect(WorkGraph::Nodes& nodes, Resource* direct, int bounces,
                       Resource* lightOfGloss) override;
    osg::ref_ptr<Resource> declareBounce(WorkGraph::Nodes& nodes) override;

private:
    ~Legendre() override = default;

    osg::ref_ptr<const TileInputs> _inputs;
    osg::ref_ptr<const TileSurface> _surface;
    osg::ref_ptr<SkyTableNode> _table;

    // Of the last declareDirect().
    int _bounces = 0, _bounce = 0; ///< all, and those that are declared
    osg::ref_ptr<PyramidNode> _pyramid;
    osg::ref_ptr<LegendreGather> _gather;
    osg::ref_ptr<Resource> _sends; ///< what the next bounce sends on: direct light, then blocks'
};

} // namespace osgTerrainLight
