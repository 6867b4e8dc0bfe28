#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/SkyLight.h>

#include "gpu/GpuPass.h"
#include "lighting/nodes/BouncePass.h"
#include "lighting/nodes/Bounces.h"
#include "lighting/nodes/HeightPyramid.h"
#include "lighting/nodes/LegendreLight.h"

#include <vector>

namespace osgTerrainLight
{

/// Diffuse bounces as Nowrouzezahrai and Snyder 2009 compute them: slices in normalised Legendre
/// polynomials, joined to spherical harmonics of order 4, and no horizon map. The yardstick for
/// BouncePass; docs/ARCHITECTURE.md has what it leaves of the light.
class OSGTERRAINLIGHT_EXPORT LegendreBouncePass : public Bounces
{
public:
    /// eastSpacings: createSpacingTexture(tile). bounces ≥ 1: the most that a dispatch adds.
    LegendreBouncePass(const DemTile& tile, const HeightPyramid& pyramid,
                       osg::Texture2D* eastSpacings, const LegendreScheme& scheme, int bounces);

    /// sky and horizon are not read: what posts send out is their shading.
    Status dispatch(osg::State& state, int bounces, const SkyLight& sky,
                    osg::Texture2DArray* horizon, osg::Texture2D* albedo,
                    osg::Texture2D* shading) override;
    Result<std::vector<float>> readLight(osg::State& state) override;

private:
    ~LegendreBouncePass() override = default;
    std::vector<osg::Texture*> textures() const override;
    std::vector<GpuPass*> passes() const override;

    /// Where a bounce is added: a shading, which stays a radiance, or signed light; fresh: its
    /// first.
    static void aim(GpuPass& pass, osg::Texture2D* target, bool signedLight, bool fresh);

    int _width, _height, _blocksAcross, _blocksUp;
    PyramidLayout _blocks;
    GpuPass::Groups _groups;
    osg::ref_ptr<osg::Texture2D> _radiance; ///< of blocks
    osg::ref_ptr<osg::Texture2D> _radiancePyramid;
    osg::ref_ptr<osg::Texture2D> _light; ///< of blocks; null where one bounce is all
    osg::ref_ptr<GpuPass> _postRadiance, _reduceRadiance;
    osg::ref_ptr<GpuPass> _last, _other; ///< a bounce: the last one, and those that another follows
};

} // namespace osgTerrainLight
