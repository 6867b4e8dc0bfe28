#pragma once

#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/Result.h"

#include <osg/Referenced>
#include <osg/State>
#include <osg/Texture2D>
#include <osg/Texture2DArray>

#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

class GpuPass;

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

    /// Irradiance / π of the last bounce, then 1, post by post; 0 where void.
    virtual Result<std::vector<float>> readLight(osg::State& state) = 0;

    /// All textures [bytes].
    std::size_t bytes() const;

    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

protected:
    ~Bounces() override = default;
    virtual std::vector<osg::Texture2D*> textures() const = 0;
    virtual std::vector<GpuPass*> passes() const = 0;
};

} // namespace osgTerrainLight
