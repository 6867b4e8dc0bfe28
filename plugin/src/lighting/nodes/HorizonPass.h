#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/LightingSettings.h>

#include "core/AzimuthSet.h"
#include "core/Result.h"
#include "gpu/GpuPass.h"

#include <osg/Texture2D>
#include <osg/Texture2DArray>

#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

/// What a quality stands for. docs/ARCHITECTURE.md has the measurements that chose the numbers.
struct OSGTERRAINLIGHT_EXPORT HorizonScheme
{
    int reach = 8;        ///< steps of the near field, 1 … 64
    int linesPerPost = 1; ///< lines of the sweep per post, 1 … 8
    int linesAsked = 1;   ///< by each post: 1, the nearest, or 2

    /// For the sky's horizons.
    static HorizonScheme of(HorizonQuality quality);
    /// For the sun's, which has one azimuth, and a shadow's edge to put in its place: finer.
    static HorizonScheme ofSun(HorizonQuality quality);
};

/// Horizons of a tile for a list of directions: a linear-time sweep for what is far (Timonen and
/// Westerholm 2010), an exact scan for what is near. Output: one layer of elevation codes
/// (HorizonMap.h) per direction.
class OSGTERRAINLIGHT_EXPORT HorizonPass : public osg::Referenced
{
public:
    /// Width of the void frame that the height texture must have: the longest near field, and what
    /// a block of it and the sweep read beyond.
    static constexpr int frame = 64 + 20;

    /// heights: createHeightTexture(tile, frame). At most 256 directions.
    HorizonPass(const DemTile& tile, osg::Texture2D* heights, const HorizonScheme& scheme,
                int directionCount);

    /// The directions to look in, as many as there are layers.
    void setDirections(const std::vector<MapDirection>& directions);

    Status dispatch(osg::State& state);

    osg::Texture2DArray* horizon() const { return _horizon; }

    /// R32UI, one texel: hull vertices that the sweeps dropped since creation (horizon_sweep.comp).
    osg::Texture2D* dropped() const { return _dropped; }

    /// What a tile's horizons take beside heights and map [bytes]: small textures, and the hulls of
    /// the sweeps in flight at once, which the driver keeps per invocation.
    static std::size_t workingBytes(int width, int height, const HorizonScheme& scheme,
                                    int directionCount);

    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

private:
    ~HorizonPass() override = default;
    static std::size_t hullBytes(int width, int height, const HorizonScheme& scheme);
    static int directionsPerDispatch(int width, int height, const HorizonScheme& scheme);

    int _width, _height;
    double _northSpacing;
    std::vector<double> _eastSpacings;
    double _nominalEastSpacing;
    HorizonScheme _scheme;
    int _maxLines = 0;
    std::vector<osg::Vec4f> _directions;
    osg::ref_ptr<osg::Texture2D> _stepLengths;
    osg::ref_ptr<osg::Texture2DArray> _horizon;
    osg::ref_ptr<osg::Texture2D> _dropped;
    std::vector<osg::ref_ptr<GpuPass>> _sweeps; ///< all lines; or even lines, odd lines
    osg::ref_ptr<GpuPass> _near;
};

} // namespace osgTerrainLight
