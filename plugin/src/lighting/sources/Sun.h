#pragma once

#include "core/AzimuthSet.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"
#include "lighting/nodes/HorizonNode.h"
#include "lighting/nodes/ShadowEdgeNode.h"
#include "lighting/sources/LightSource.h"

#include <array>

namespace osgTerrainLight
{

/// Towards the left, the centre and the right of the sun's disc.
std::array<MapDirection, 3> sunDirections(const SkyLight& sky);

/// The sun: a disc, whose visible part three horizons tell.
class Sun : public LightSource
{
public:
    Sun(const TileInputs& inputs, const TileSurface& surface);

    WorkGraph::Nodes nodes() const override { return {_horizon, _edge}; }
    std::vector<Resource*> values() const override { return {_horizon->horizon(), _edge->edge()}; }
    /// sunHorizon, sunEdge, sunIrradiance, sunDirection, sunElevation and sunRadius (SUN), or
    /// sunOff.
    void bind(GpuPass& pass, std::vector<std::string>& defines) const override;
    bool variesInCells() const override { return true; } // shadows have edges

    HorizonNode* horizon() const override { return _horizon; }
    bool isInHarmonics() const override { return false; }

private:
    ~Sun() override = default;

    osg::ref_ptr<const TileInputs> _inputs;
    osg::ref_ptr<HorizonNode> _horizon;
    osg::ref_ptr<ShadowEdgeNode> _edge; ///< where light bounces
};

} // namespace osgTerrainLight
