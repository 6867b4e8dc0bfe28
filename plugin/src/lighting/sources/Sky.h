#pragma once

#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"
#include "lighting/nodes/HorizonNode.h"
#include "lighting/nodes/SkyTableNode.h"
#include "lighting/nodes/SkyViewNode.h"
#include "lighting/sources/LightSource.h"

namespace osgTerrainLight
{

/// The sky: horizons all around, and what posts receive above them.
class Sky : public LightSource
{
public:
    Sky(const TileInputs& inputs, const TileSurface& surface, SkyTableNode* table);

    WorkGraph::Nodes nodes() const override { return {_horizon, _table, _view}; }
    std::vector<Resource*> values() const override { return {_table->table()}; }
    /// skyTable (SKY_TABLE), skyRadiance and hasSky.
    void bind(GpuPass& pass, std::vector<std::string>& defines) const override;
    void follow(Invalidation stale) override;

    HorizonNode* horizon() const override { return _horizon; }
    bool isInHarmonics() const override { return false; }
    /// Sky-view factor, or light of a sky with a table.
    Resource* view() const { return _view->view(); }

private:
    ~Sky() override = default;

    osg::ref_ptr<const TileInputs> _inputs;
    osg::ref_ptr<HorizonNode> _horizon;
    osg::ref_ptr<SkyTableNode> _table;
    osg::ref_ptr<SkyViewNode> _view;
};

} // namespace osgTerrainLight
