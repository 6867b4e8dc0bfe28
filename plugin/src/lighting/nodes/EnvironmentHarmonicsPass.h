#pragma once

#include "core/Result.h"
#include "gpu/WorkGraph.h"

#include <osg/Texture2D>
#include <osg/TextureCubeMap>

namespace osgTerrainLight
{

/// An environment in spherical harmonics (King 2005, section 10.3.1): one pass over its texels, and
/// one that adds what its groups found. Sums are in a fixed order: the same bits in every run.
class EnvironmentHarmonicsPass : public GpuWork
{
public:
    /// order: 2 … 6, for 4 … 36 coefficients.
    explicit EnvironmentHarmonicsPass(int order);

    int order() const { return _order; }

    /// Of a picture laid out as Environment::radiance, of one radiance per texel. heading: degrees
    /// that it is turned clockwise; gain: what it is multiplied by.
    Status dispatch(osg::State& state, osg::Texture2D* picture, double heading = 0.0,
                    double gain = 1.0);
    /// The same of one that a pass has written.
    Status dispatch(osg::State& state, Resource* picture);
    /// Of a cube map as a host draws one: what texture(map, d) gives towards d, x east, y north, z
    /// up; level 0 alone is read. Its size is that of its images, or of setTextureSize(), and 4 …
    /// 8192; another is an error, Invalid.
    Status dispatch(osg::State& state, osg::TextureCubeMap* map, double gain = 1.0);

    /// RGBA32F, order² × 1: rgb = coefficient (l, m) at l (l + 1) + m (docs/CONVENTIONS.md), a = 1.
    Resource* harmonics() const { return _harmonics; }

private:
    ~EnvironmentHarmonicsPass() override = default;
    Status project(osg::State& state, GpuPass& pass, int groups, double gain);

    int _order;
    Resource* _partials; ///< what groups found, a row each
    Resource* _harmonics;
    GpuPass *_picture, *_cube, *_sum;
};

/// A cube map of an environment convolved with a kernel (King 2005, section 10.3.2).
class IrradianceMapPass : public GpuWork
{
public:
    /// Reads RGBA32F harmonics of an order, as EnvironmentHarmonicsPass has them.
    IrradianceMapPass(Resource* harmonics, int order);

    /// RGBA16F, without content: for light in all directions.
    static osg::ref_ptr<osg::TextureCubeMap> createMap(int size);

    /// What alpha holds: the visible fraction of a sun's disc, as in ShadingTexture.
    struct Sun
    {
        /// R32F, three texels: the horizon's elevation [rad] towards the disc's left, centre and
        /// right; null: alpha is `fraction`.
        Resource* horizon = nullptr;
        double elevation = 0.0; ///< [degrees]
        double radius = 0.2666; ///< [degrees]
        double fraction = 1.0;
    };

    /// Irradiance / π of a surface of each normal. At the orders 3 … 6 it is that of the order, at
    /// 2 coarser.
    Status dispatchDiffuse(osg::State& state, osg::TextureCubeMap* map, const Sun& sun);
    /// Radiance through the lobe (s + 1) / 2π cosˢ about each direction: what a mirror direction
    /// looks up. exponent: s, 1 or more.
    Status dispatchGlossy(osg::State& state, osg::TextureCubeMap* map, double exponent,
                          const Sun& sun);

private:
    ~IrradianceMapPass() override = default;
    Status dispatch(osg::State& state, osg::TextureCubeMap* map, osg::Uniform* bands,
                    const Sun& sun);

    int _order;
    GpuPass* _pass;
};

} // namespace osgTerrainLight
