#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileSurface.h"
#include "lighting/nodes/PyramidLayout.h"

namespace osgTerrainLight
{

/// Heights of a tile, coarser and coarser: what a scan reads far away (Nowrouzezahrai and Snyder
/// 2009, section 5.2).
class PyramidNode : public Node
{
public:
    explicit PyramidNode(const TileSurface& surface);

    Status run(osg::State& state) override;

    const TileSurface& surface() const { return *_surface; }
    const PyramidLayout& layout() const { return _layout; }
    /// RG32F: height [m] times weight, weight; the levels above the posts, as layout() has them.
    Resource* pyramid() const { return _pyramid; }

private:
    ~PyramidNode() override = default;

    osg::ref_ptr<const TileSurface> _surface;
    PyramidLayout _layout;
    Resource* _pyramid;
    GpuPass *_first, *_next;
};

} // namespace osgTerrainLight
