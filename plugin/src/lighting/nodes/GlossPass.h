#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/Result.h"
#include "gpu/GpuPass.h"
#include "lighting/nodes/AreaLights.h"
#include "lighting/nodes/Pyramid.h"

#include <osg/Referenced>
#include <osg/State>
#include <osg/Texture2D>
#include <osg/Texture2DArray>

#include <array>
#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

/// Light that a glossy tile sends, as spherical harmonics of order 4 of the direction that it
/// leaves in: the vector pyramid of Nowrouzezahrai and Snyder 2009 (section 5.3), but of exit
/// radiance, which filters linearly where normals differ. BouncePass runs it between its bounces.
class OSGTERRAINLIGHT_EXPORT GlossPass : public osg::Referenced
{
public:
    /// Of the texture that the viewer reads: 12 of harmonics (gloss.comp), one of the surface.
    static constexpr int layers = 13;

    /// heights, eastSpacings: as of BouncePass. material: x gloss, y exponent, a texel per post, or
    /// one for all. light: RGBA16F, layers, a texel per post. bounces: whether and how often gloss
    /// is to light other terrain.
    GlossPass(const DemTile& tile, osg::Texture2D* heights, osg::Texture2D* eastSpacings,
              osg::Texture2D* material, osg::Texture2DArray* light, int azimuths, int bounces,
              GlossTransfer transfer, const std::array<double, 3>& viewer);

    /// Of sky, sun and key lights (all that is read of `lights`). horizon: of as many azimuths;
    /// null where there is no sky. shading: of which the sun's visible fraction is read.
    Status dispatchDirect(osg::State& state, const SkyLight& sky, const AreaLights& lights,
                          osg::Texture2DArray* horizon, osg::Texture2D* shading);

    /// What BouncePass gives its own uniforms and textures: those of its rays.
    GpuPass* gatherPass() const { return _gather; }
    /// Before radiance of cells is filtered: filters what posts sent by gloss (Vector), or adds it
    /// to the cells' (Scalar). posts: of the pyramid of heights.
    Status dispatchSent(osg::State& state, int bounce, const PyramidLayout& posts,
                        osg::Texture2D* radiance);
    /// After a bounce of diffuse light: the same of glossy light, added to `light` of the
    /// constructor, and, where Vector, to shading and `bounced`, irradiance / π of this bounce.
    Status dispatchBounce(osg::State& state, int bounce, osg::Texture2DArray* horizon,
                          osg::Texture2D* shading, osg::Texture2D* bounced);

    /// Textures of its own, without `light` [bytes]. 0 without bounces but for one texel.
    std::size_t bytes() const;
    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

private:
    ~GlossPass() override = default;
    std::vector<osg::Texture*> textures() const;
    std::vector<GpuPass*> passes() const;

    int _width, _height;
    GlossTransfer _transfer;
    osg::ref_ptr<osg::Texture2DArray> _light;
    /// What posts send, in turn: bounce b reads the b-th, modulo 2, and writes the other. A single
    /// texel where no bounce reads it: what is stored beyond it has no effect.
    std::array<osg::ref_ptr<osg::Texture2DArray>, 2> _exit;
    osg::ref_ptr<osg::Texture2DArray> _pyramid; ///< null unless Vector and bounces
    osg::ref_ptr<GpuPass> _direct, _gather, _shade, _reduce;
};

} // namespace osgTerrainLight
