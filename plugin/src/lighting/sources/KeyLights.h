#pragma once

#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"
#include "lighting/nodes/HorizonNode.h"
#include "lighting/sources/LightSource.h"

#include <array>
#include <vector>

namespace osgTerrainLight
{

/// Area lights: slices of azimuth, each with a horizon of its own.
class KeyLights : public LightSource
{
public:
    KeyLights(const TileInputs& inputs, const TileSurface& surface);

    WorkGraph::Nodes nodes() const override { return {_horizon}; }
    std::vector<Resource*> values() const override { return {_horizon->horizon()}; }
    /// keyHorizon, keyPlaces, keyRadiances and keyCount (KEY_LIGHTS).
    void bind(GpuPass& pass, std::vector<std::string>& defines) const override;
    void follow(Invalidation stale) override;

    HorizonNode* horizon() const override { return _horizon; }

private:
    ~KeyLights() override = default;

    osg::ref_ptr<const TileInputs> _inputs;
    osg::ref_ptr<HorizonNode> _horizon;
    std::vector<std::array<double, 3>> _places; ///< of slices: first azimuth, width, count
};

} // namespace osgTerrainLight
