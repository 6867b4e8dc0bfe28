#pragma once

#include <osgTerrainLight/SkyLight.h>

#include "core/Result.h"

#include <osg/Referenced>
#include <osg/State>
#include <osg/Texture2D>
#include <osg/Texture2DArray>

#include <cstddef>

namespace osgTerrainLight
{

/// A way to compute diffuse bounces of light between the posts of a tile.
class Bounces : public osg::Referenced
{
public:
    /// Builds the pyramid of heights.
    virtual Status dispatchHeights(osg::State& state) = 0;

    /// Adds `bounces` ≥ 1 bounces to `shading` (RGBA16F, irradiance / π in, and out). horizon: of
    /// as many azimuths, or null where the method needs none. albedo: a texel per post, or one for
    /// all.
    virtual Status dispatch(osg::State& state, int bounces, const SkyLight& sky,
                            osg::Texture2DArray* horizon, osg::Texture2D* albedo,
                            osg::Texture2D* shading) = 0;

    /// RGBA16F: irradiance / π of the last bounce.
    virtual osg::Texture2D* light() const = 0;

    /// All textures [bytes].
    virtual std::size_t bytes() const = 0;

    virtual void releaseGLObjects(osg::State* state) const = 0;
    virtual void resizeGLObjectBuffers(unsigned size) = 0;

protected:
    ~Bounces() override = default;
};

} // namespace osgTerrainLight
