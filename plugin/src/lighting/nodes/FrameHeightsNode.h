#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"

namespace osgTerrainLight
{

/// Heights of a tile from posts that change: framed, and sunk as the planet's ground does.
class FrameHeightsNode : public Node
{
public:
    /// surface: made for heights that change.
    FrameHeightsNode(const TileInputs& inputs, const TileSurface& surface);

    Status run(osg::State& state) override;

private:
    ~FrameHeightsNode() override = default;

    osg::ref_ptr<const TileInputs> _inputs;
    int _width, _height;
    GpuPass* _pass;
    Resource* _posts; ///< those that are ours
};

} // namespace osgTerrainLight
