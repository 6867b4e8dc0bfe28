#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"

namespace osgTerrainLight
{

/// What the sky above the horizons gives to posts: the sky-view factor (R32F; < −1 where void), or,
/// of a sky with a table, rgb = irradiance / π (RGBA16F).
class SkyViewNode : public Node
{
public:
    SkyViewNode(const TileInputs& inputs, const TileSurface& surface, Resource* horizon,
                Resource* table);

    Status run(osg::State& state) override;

    Resource* view() const { return _view; }
    /// The sky may be of another kind now.
    void followFormat();

private:
    ~SkyViewNode() override = default;

    osg::ref_ptr<const TileInputs> _inputs;
    osg::ref_ptr<const TileSurface> _surface;
    Resource* _view;
    GpuPass* _pass;
};

} // namespace osgTerrainLight
