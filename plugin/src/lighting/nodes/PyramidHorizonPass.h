#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>

#include "core/Result.h"
#include "gpu/GpuPass.h"
#include "lighting/nodes/BouncePass.h"
#include "lighting/nodes/HeightPyramid.h"

#include <osg/Texture2D>
#include <osg/Texture2DArray>

#include <cstddef>

namespace osgTerrainLight
{

/// Horizons of a tile in equally spaced azimuths from a pyramid of heights (Nowrouzezahrai and
/// Snyder 2009, section 5.2): the other producer of what HorizonPass makes, for comparison. Cheap
/// and blurred; docs/ARCHITECTURE.md has by how much.
class OSGTERRAINLIGHT_EXPORT PyramidHorizonPass : public osg::Referenced
{
public:
    enum class Join
    {
        BSpline, ///< the paper's: maximum of a cubic B-spline, at knots and midpoints
        None     ///< the highest sample
    };

    /// heights: createHeightTexture(tile, HorizonPass::frame). scheme: samples at
    /// 2^(i/samplesPerOctave) steps, 1 … 64 per octave, from level log2(distance) − offset.
    PyramidHorizonPass(const DemTile& tile, osg::Texture2D* heights, const BounceScheme& scheme,
                       int azimuths, Join join = Join::BSpline);

    /// Builds the pyramid, then the map.
    Status dispatch(osg::State& state);

    /// Elevation codes (HorizonMap.h), a layer per azimuth of AzimuthSet.
    osg::Texture2DArray* horizon() const { return _horizon; }

    /// All textures [bytes].
    std::size_t bytes() const;

    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

private:
    ~PyramidHorizonPass() override = default;

    int _width, _height, _azimuths;
    osg::ref_ptr<HeightPyramid> _pyramid;
    osg::ref_ptr<osg::Texture2D> _eastSpacings;
    osg::ref_ptr<osg::Texture2DArray> _horizon;
    osg::ref_ptr<GpuPass> _scan;
};

} // namespace osgTerrainLight
