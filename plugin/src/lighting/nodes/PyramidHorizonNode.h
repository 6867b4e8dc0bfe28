#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/nodes/BounceRays.h"
#include "lighting/nodes/PyramidNode.h"

namespace osgTerrainLight
{

/// Horizons of a tile in equally spaced azimuths from a pyramid of heights (Nowrouzezahrai and
/// Snyder 2009, section 5.2): the other producer of what HorizonNode makes, for comparison. Cheap
/// and blurred; docs/ARCHITECTURE.md has by how much.
class PyramidHorizonNode : public Node
{
public:
    enum class Join
    {
        BSpline, ///< the paper's: maximum of a cubic B-spline, at knots and midpoints
        None     ///< the highest sample
    };

    /// scheme: samples at 2^(i/samplesPerOctave) steps, 1 … 64 per octave, from level
    /// log2(distance) − offset.
    PyramidHorizonNode(const PyramidNode& pyramid, const BounceScheme& scheme, int azimuths,
                       Join join = Join::BSpline);

    Status run(osg::State& state) override;

    /// R16: elevation codes (HorizonMap.h), a layer per azimuth of AzimuthSet.
    Resource* horizon() const { return _horizon; }

private:
    ~PyramidHorizonNode() override = default;

    osg::ref_ptr<const TileSurface> _surface;
    int _azimuths;
    Resource* _horizon;
    GpuPass* _scan;
};

} // namespace osgTerrainLight
