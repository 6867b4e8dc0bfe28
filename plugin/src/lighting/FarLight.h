#pragma once

#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/Raster.h"
#include "core/Result.h"
#include "core/TileSource.h"
#include "lighting/TileInputs.h"
#include "lighting/TileWindows.h"

#include <osg/State>

#include <functional>
#include <map>
#include <memory>
#include <vector>

namespace osgTerrainLight
{

/// Radiance that the ground of a terrain's coarser levels sends, diffusely: where it is kept.
class RadianceStore
{
public:
    virtual ~RadianceStore() = default;

    /// Whether it is there already, from an earlier run with the same lighting.
    virtual bool has(int level) const = 0;
    /// posts: all of the level that will be written, once before the others.
    virtual Status begin(int level, int bounces, const PostRect& posts) = 0;
    /// All is written.
    virtual Status end(int level) = 0;
    /// bounce: that it is sent to, from 0. Posts beyond those of begin() send nothing.
    virtual Status write(int level, int bounce, const PostRect& posts,
                         const Raster<Rgb>& radiance) = 0;
    virtual Result<Raster<Rgb>> read(int level, int bounce, const PostRect& posts) = 0;
};

/// In memory.
class MemoryRadiance : public RadianceStore
{
public:
    bool has(int level) const override { return _levels.count(level) > 0; }
    Status end(int) override { return Nothing{}; }
    Status begin(int level, int bounces, const PostRect& posts) override;
    Status write(int level, int bounce, const PostRect& posts,
                 const Raster<Rgb>& radiance) override;
    Result<Raster<Rgb>> read(int level, int bounce, const PostRect& posts) override;

private:
    struct Level
    {
        PostRect posts;
        std::vector<Raster<Rgb>> bounces;
    };
    std::map<int, Level> _levels;
};

/// How a terrain's coarser levels are lit before its tiles, so that these receive light from beyond
/// themselves (docs/methods/tiles.md).
struct FarLighting
{
    LightingSettings settings; ///< of the tiles
    SkyLight sky;
    int side = 1024; ///< of tiles, posts
    /// Of posts of a level; null: the settings'.
    std::function<Result<Raster<Rgb>>(int level, const PostRect& posts)> albedo;
    /// Called with 0 … 1.
    std::function<void(double)> progress;
};

/// Posts of its own level around a tile that are lit with it and then left out, so that a bounce
/// finds its neighbours' light: what is beyond them sends the coarser levels' light.
constexpr int bounceMargin = 64;

/// Lights the levels of `source`, coarsest first, as far as the tiles of (0, 0) … (width − 1,
/// height − 1) see them. Nothing to do where there are no bounces. Needs a current context.
Status lightLevels(osg::State& state, TileSource& source, const FarLighting& lighting,
                   RadianceStore& store);

/// What TileLight::setFarLight() takes, for a tile of a level.
Result<std::shared_ptr<const FarLight>> readFarLight(RadianceStore& store, int level, int bounces,
                                                     const TileWindows& windows);

} // namespace osgTerrainLight
