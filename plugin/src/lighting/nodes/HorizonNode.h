#pragma once

#include <osgTerrainLight/LightingSettings.h>

#include "core/AzimuthSet.h"
#include "gpu/WorkGraph.h"
#include "lighting/TileSurface.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace osgTerrainLight
{

struct GridDirection;

/// What a quality stands for. docs/ARCHITECTURE.md has the measurements that chose the numbers.
struct HorizonScheme
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
class HorizonNode : public Node
{
public:
    using Directions = std::function<std::vector<MapDirection>()>;

    /// Width of the frame that the heights must have, void or of terrain around the tile: the
    /// longest near field, and what a block of it and the sweep read beyond.
    static constexpr int frame = 64 + 20;

    /// directions: asked at each run for as many as there are, at most 256.
    HorizonNode(const std::string& name, const TileSurface& surface, const HorizonScheme& scheme,
                int directionCount, Directions directions);
    /// Directions from the next run on.
    void setDirectionCount(int count);

    Status run(osg::State& state) override;

    /// R16, a layer per direction.
    Resource* horizon() const { return _horizon; }

    /// R32UI, one texel: hull vertices that the sweeps dropped since creation (horizon_sweep.comp).
    Resource* dropped() const { return _dropped; }

    /// Hulls of the sweeps in flight at once, which the driver keeps per invocation.
    std::size_t workingBytes() const override;
    /// What a tile's horizons take beside heights and map [bytes]: that, and small textures.
    static std::size_t workingBytes(int width, int height, const HorizonScheme& scheme,
                                    int directionCount);

private:
    ~HorizonNode() override = default;
    static std::size_t hullBytes(int width, int height, const HorizonScheme& scheme);
    static int directionsPerDispatch(int width, int height, const HorizonScheme& scheme);
    static std::size_t hullBytes(int width, int height, const HorizonScheme& scheme,
                                 int directionCount);
    void aim();
    int linesOf(const GridDirection& grid) const;

    osg::ref_ptr<const TileSurface> _surface;
    HorizonScheme _scheme;
    Directions _wanted;
    std::vector<MapDirection> _aimed; ///< what follows is of these
    int _maxLines = 0;
    std::vector<osg::Vec4f> _directions;
    Resource *_horizon, *_dropped, *_stepLengths;
    std::vector<GpuPass*> _sweeps; ///< all lines; or even lines, odd lines
    GpuPass* _near;
};

} // namespace osgTerrainLight
