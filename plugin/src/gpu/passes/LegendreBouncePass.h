#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/LightingSettings.h>

#include "core/WedgeMatrices.h"
#include "gpu/GpuPass.h"
#include "gpu/passes/BouncePass.h"
#include "gpu/passes/Bounces.h"

#include <vector>

namespace osgTerrainLight
{

/// The scheme for a quality: Draft has the paper's own numbers.
OSGTERRAINLIGHT_EXPORT BounceScheme legendreScheme(HorizonQuality quality);

/// Diffuse bounces as Nowrouzezahrai and Snyder 2009 compute them: slices in normalised Legendre
/// polynomials, joined to spherical harmonics of order 4, and no horizon map. The yardstick for
/// BouncePass; docs/ARCHITECTURE.md has what it leaves of the light.
class OSGTERRAINLIGHT_EXPORT LegendreBouncePass : public Bounces
{
public:
    /// heights: createHeightTexture(tile, HorizonPass::frame). eastSpacings: one texel per row.
    /// scheme: samples at 2^(i/samplesPerOctave) steps, i = 0, 1, …, 1 … 64 per octave.
    LegendreBouncePass(const DemTile& tile, osg::Texture2D* heights, osg::Texture2D* eastSpacings,
                       const BounceScheme& scheme, int azimuths, AzimuthBlend blend);

    Status dispatchHeights(osg::State& state) override;
    /// sky and horizon are not read: what posts send out is their shading.
    Status dispatch(osg::State& state, int bounces, const SkyLight& sky,
                    osg::Texture2DArray* horizon, osg::Texture2D* albedo,
                    osg::Texture2D* shading) override;
    osg::Texture2D* light() const override { return _light; }

private:
    ~LegendreBouncePass() override = default;
    std::vector<osg::Texture2D*> textures() const override;
    std::vector<GpuPass*> passes() const override;

    int _width, _height;
    PyramidLayout _posts;
    osg::ref_ptr<osg::Texture2D> _heights;
    osg::ref_ptr<osg::Texture2D> _stepLengths;
    osg::ref_ptr<osg::Texture2D> _heightPyramid;
    osg::ref_ptr<osg::Texture2D> _radiancePyramid;
    osg::ref_ptr<osg::Texture2D> _radiance; ///< of posts
    osg::ref_ptr<osg::Texture2D> _light;
    osg::ref_ptr<GpuPass> _postRadiance, _bounce;
    osg::ref_ptr<GpuPass> _firstHeights, _nextHeights, _reduceRadiance;
};

} // namespace osgTerrainLight
