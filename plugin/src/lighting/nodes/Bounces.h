#pragma once

#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/Result.h"
#include "gpu/GpuPass.h"

#include <osg/Referenced>
#include <osg/State>
#include <osg/Texture2D>
#include <osg/Texture2DArray>

#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

struct AreaLights;

/// Adds the light of bounces, post by post: shaders/passes/add_light.comp.
class OSGTERRAINLIGHT_EXPORT LightSum : public osg::Referenced
{
public:
    LightSum(int width, int height);

    /// The kept sum, RGBA16F: irradiance / π of all bounces.
    osg::Texture2D* texture() const { return _sum; }

    /// The sum is this bounce, the first, or grows by it.
    Status add(osg::State& state, osg::Texture2D* light, bool first);
    /// Adds the sum to a shading texture.
    Status addTo(osg::State& state, osg::Texture2D* shading);

    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

private:
    ~LightSum() override = default;

    GpuPass::Groups _groups;
    osg::ref_ptr<osg::Texture2D> _sum;
    osg::ref_ptr<GpuPass> _add, _addToShading;
};

/// A way to compute diffuse bounces of light between the posts of a tile.
class OSGTERRAINLIGHT_EXPORT Bounces : public osg::Referenced
{
public:
    /// Builds the pyramid of heights, where it is its own.
    virtual Status dispatchHeights(osg::State&) { return Nothing{}; }

    /// Adds `bounces` ≥ 1 bounces to `shading` (RGBA16F, irradiance / π in, and out). horizon: of
    /// as many azimuths, or null where the method needs none. albedo: a texel per post, or one for
    /// all.
    virtual Status dispatch(osg::State& state, int bounces, const SkyLight& sky,
                            osg::Texture2DArray* horizon, osg::Texture2D* albedo,
                            osg::Texture2D* shading) = 0;

    /// Direct light beside the uniform sky and the sun, for a method that computes it anew where
    /// light bounces. From the next dispatch on.
    virtual void setAreaLights(const AreaLights&) {}

    /// Irradiance / π of the last bounce, then 1, post by post; 0 where void.
    virtual Result<std::vector<float>> readLight(osg::State& state) = 0;

    /// dispatch() leaves the sum of its bounces there, too. Null: nowhere.
    void keepSum(LightSum* sum) { _sum = sum; }

    /// All textures [bytes].
    std::size_t bytes() const;

    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

protected:
    ~Bounces() override = default;
    virtual std::vector<osg::Texture*> textures() const = 0;
    virtual std::vector<GpuPass*> passes() const = 0;

    /// For a way that has the light of each bounce, 0, 1, …: to be called after it.
    Status keep(osg::State& state, osg::Texture2D* light, int bounce);
    LightSum* sum() const { return _sum; }

private:
    osg::ref_ptr<LightSum> _sum;
};

} // namespace osgTerrainLight
