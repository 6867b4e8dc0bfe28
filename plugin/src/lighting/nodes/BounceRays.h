#pragma once

#include <osgTerrainLight/LightingSettings.h>

#include "gpu/WorkGraph.h"
#include "lighting/nodes/PyramidLayout.h"
#include "lighting/nodes/PyramidNode.h"

#include <vector>

namespace osgTerrainLight
{

/// How light of gloss, and light by Legendre, samples the terrain that a post sees.
struct BounceScheme
{
    /// Samples per doubling of the distance, 1 … 16: the level step k of Nowrouzezahrai and Snyder
    /// 2009. Where they would be less than a post apart, there is one per post.
    double samplesPerOctave = 8.0;
    /// How many octaves finer than the distance a level is read, 0 … 8: their level offset o.
    double offset = 5.0;

    static BounceScheme of(HorizonQuality quality);
};

/// One sample of a ray: a height, and the radiance between it and the sample before.
struct BounceSample
{
    double distance; ///< steps along the axis that the ray crosses faster
    int level;
    double between;
    int radianceLevel;
};

/// Samples up to `reach` steps away, nearest first. Those of level 0 are at whole steps, and come
/// first. Fewer per octave than the scheme asks for where that is more than a pass can hold (128).
std::vector<BounceSample> bounceSamples(const BounceScheme& scheme, int reach, int levelCount);

/// Rays from posts over a tile's heights, far ones over their pyramid: what every pass that looks
/// for the terrain a post sees is given.
class BounceRays : public GpuWork
{
public:
    /// stepLengths: as createStepLengths() makes it.
    BounceRays(const PyramidNode& pyramid, const BounceScheme& scheme, int azimuths,
               Resource* stepLengths);

    /// Sets the surface's own, heightPyramid, stepLengths, the block Rays, and the levels of both
    /// pyramids.
    void bind(GpuPass& pass) const;

    /// Of the pyramid of what cells send.
    const PyramidLayout& cells() const { return _cells; }

private:
    ~BounceRays() override = default;

    osg::ref_ptr<const PyramidNode> _pyramid;
    PyramidLayout _cells;
    int _azimuths;
    std::vector<BounceSample> _samples;
    Resource* _stepLengths;
};

} // namespace osgTerrainLight
