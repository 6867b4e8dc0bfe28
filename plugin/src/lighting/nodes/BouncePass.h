#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/Result.h"
#include "gpu/GpuPass.h"
#include "lighting/nodes/Bounces.h"
#include "lighting/nodes/GlossPass.h"
#include "lighting/nodes/Pyramid.h"

#include <osg/Texture2D>
#include <osg/Texture2DArray>

#include <array>
#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

/// How a bounce samples the terrain that a post sees. docs/ARCHITECTURE.md has the measurements.
struct OSGTERRAINLIGHT_EXPORT BounceScheme
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
OSGTERRAINLIGHT_EXPORT std::vector<BounceSample> bounceSamples(const BounceScheme& scheme,
                                                               int reach, int levelCount);

/// Diffuse bounces of light between the posts of a tile.
class OSGTERRAINLIGHT_EXPORT BouncePass : public Bounces
{
public:
    /// heights: createHeightTexture(tile, HorizonPass::frame). eastSpacings: one texel per row.
    /// stride: what is farther than so many posts is looked at from every stride-th post in both
    /// directions, 1, 2 or 4. gloss: null
    /// where nothing is glossy; else its dispatchDirect() comes before dispatch().
    BouncePass(const DemTile& tile, osg::Texture2D* heights, osg::Texture2D* eastSpacings,
               const BounceScheme& scheme, int azimuths, int stride = 1,
               GlossPass* gloss = nullptr);

    Status dispatchHeights(osg::State& state) override;
    /// horizon: of as many azimuths, never null.
    Status dispatch(osg::State& state, int bounces, const SkyLight& sky,
                    osg::Texture2DArray* horizon, osg::Texture2D* albedo,
                    osg::Texture2D* shading) override;
    Result<std::vector<float>> readLight(osg::State& state) override;
    void setAreaLights(const AreaLights& lights) override;

    /// RG32F: height [m] times weight, weight; above the posts, as layout() has its levels.
    osg::Texture2D* heightPyramid() const { return _heightPyramid; }
    const PyramidLayout& layout() const { return _posts; }

private:
    ~BouncePass() override = default;
    std::vector<osg::Texture*> textures() const override;
    std::vector<GpuPass*> passes() const override;

    int _width, _height, _stride;
    PyramidLayout _posts, _cells;
    osg::ref_ptr<osg::Texture2D> _heights;
    osg::ref_ptr<osg::Texture2D> _stepLengths;
    osg::ref_ptr<osg::Texture2D> _heightPyramid;
    osg::ref_ptr<osg::Texture2D> _radiancePyramid;
    osg::ref_ptr<osg::Texture2D> _radiance; ///< of cells
    osg::ref_ptr<osg::Texture2D> _light;
    osg::ref_ptr<GpuPass> _directRadiance, _bouncedRadiance; ///< of cells
    osg::ref_ptr<GpuPass> _firstBounce, _nextBounce;
    // Where the stride is not 1:
    osg::ref_ptr<GpuPass> _firstFar, _nextFar;
    osg::ref_ptr<osg::Texture2DArray> _farRadiance; ///< of blocks, a layer per azimuth
    osg::ref_ptr<GpuPass> _firstHeights, _nextHeights, _firstRadiance, _nextRadiance;
    osg::ref_ptr<GlossPass> _gloss;
};

} // namespace osgTerrainLight
