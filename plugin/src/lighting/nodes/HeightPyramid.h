#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>

#include "core/Result.h"
#include "gpu/GpuPass.h"
#include "lighting/nodes/Pyramid.h"

#include <osg/Referenced>
#include <osg/State>
#include <osg/Texture2D>

#include <cstddef>

namespace osgTerrainLight
{

/// Heights of a tile, coarser and coarser: what a scan reads instead of a horizon map
/// (Nowrouzezahrai and Snyder 2009, section 5.2).
class OSGTERRAINLIGHT_EXPORT HeightPyramid : public osg::Referenced
{
public:
    /// heights: createHeightTexture(tile, frame).
    HeightPyramid(const DemTile& tile, osg::Texture2D* heights, int frame);

    Status dispatch(osg::State& state);

    osg::Texture2D* heights() const { return _heights; }
    int frame() const { return _frame; }
    const PyramidLayout& layout() const { return _layout; }
    /// RG32F: height [m] times weight, weight; the levels above the posts, as layout() has them.
    osg::Texture2D* texture() const { return _texture; }

    /// Of the levels above the posts.
    std::size_t bytes() const;
    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

private:
    ~HeightPyramid() override = default;

    int _frame;
    PyramidLayout _layout;
    osg::ref_ptr<osg::Texture2D> _heights, _texture;
    osg::ref_ptr<GpuPass> _first, _next;
};

} // namespace osgTerrainLight
