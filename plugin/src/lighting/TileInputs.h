#pragma once

#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/Raster.h"
#include "gpu/Resource.h"
#include "lighting/TileObjects.h"
#include "lighting/nodes/ProbePlace.h"

#include <osg/Referenced>
#include <osg/Texture2D>

#include <array>
#include <memory>
#include <vector>

namespace osgTerrainLight
{

/// The three sky-view factors in use (docs/CONVENTIONS.md).
enum class SkyViewDefinition
{
    Surface,    ///< cosine to the surface normal: what lights the terrain
    Horizontal, ///< cosine to the zenith
    SolidAngle  ///< fraction of the upper hemisphere's solid angle
};

inline bool isBlackAlbedo(const Rgb& albedo)
{
    return albedo[0] <= 0.0f && albedo[1] <= 0.0f && albedo[2] <= 0.0f;
}

/// What the ground of the coarser levels around a tile sends, radiance: by bounce that it is sent
/// to, from the first, and by level, of FarLevel::posts each.
using FarLight = std::vector<std::vector<Raster<Rgb>>>;

/// All that the setters of a tile set.
struct TileValues
{
    LightingSettings settings;
    SkyLight sky;
    SkyViewDefinition definition = SkyViewDefinition::Surface;
    std::shared_ptr<const Raster<Rgb>> albedo; ///< null: the settings'
    bool albedoIsBlack = false;                ///< all posts'
    /// Gloss and exponent; null: the settings'.
    std::shared_ptr<const Raster<std::array<float, 2>>> gloss;
    bool hasGloss = false; ///< some post's is not 0
    std::vector<ProbePlace> probes;
    TileObjects objects;                      ///< on the tile, or near enough to change its light
    std::shared_ptr<const FarLight> farLight; ///< null: none
    osg::ref_ptr<osg::Texture2D> posts; ///< where heights come from; null: the tile's, for good
    bool ownsPosts = false;             ///< posts are not the host's texture

    bool bySlices() const { return settings.bounceMethod == BounceMethod::Slices; }
    bool hasSky() const { return sky.skyEnabled; }
    bool hasSkyTable() const;
    /// A sun that is on and not wholly below the horizontal.
    bool hasSun() const;
    /// A key light that is above the horizontal and not black.
    bool hasKeyLights() const;
    bool hasLight() const { return hasSky() || hasSun() || hasKeyLights(); }
    /// Whether ground sends light by gloss.
    bool isGlossy() const;
    /// Whether host shaders are told where the sun's shadow ends between posts.
    bool hasEdges() const { return settings.shadowEdges && bySlices() && hasSun(); }
    /// Bounces of a tile of this size that there is something for.
    int bounces(int width, int height) const;
    /// Whether bounces are not computed in every update. Gloss is computed with them, in each.
    bool isPaced() const { return settings.bounceInterval > 1 && !isGlossy(); }

    /// The light with the sun's irradiance at the ground.
    SkyLight lightAtGround() const;
    /// The same with every sky but the uniform one in harmonics, for what knows no other.
    SkyLight lightInHarmonics() const;
};

/// What the skyRadiance of shaders/lights/sky.glsl is: what the sky's share of light is multiplied
/// by.
Rgb skyGain(const SkyLight& sky);

/// What a tile is lit with, for its nodes, and resources that say when it has changed.
struct TileInputs : public osg::Referenced, public TileValues
{
    TileInputs();

    osg::ref_ptr<Resource> settingsValue; ///< settings that nodes were not made anew for
    osg::ref_ptr<Resource> light;         ///< any of sky, sun and key lights
    osg::ref_ptr<Resource> skyValue;      ///< what the sky sends
    osg::ref_ptr<Resource> sunPlace;
    osg::ref_ptr<Resource> keyPlaces;
    osg::ref_ptr<Resource> bouncesDue; ///< where paced: bounces are to follow the light
    osg::ref_ptr<Resource> probePlaces;
    osg::ref_ptr<Resource> objectsValue; ///< their places; what they are is in their volumes
    osg::ref_ptr<Resource> postsValue;
    osg::ref_ptr<Resource> albedoTexture;   ///< RGBA16F, a texel per post, or one for all
    osg::ref_ptr<Resource> materialTexture; ///< likewise, x gloss, y exponent

protected:
    ~TileInputs() override = default;

private:
    osg::ref_ptr<osg::Texture> createAlbedo() const;
    osg::ref_ptr<osg::Texture> createMaterial() const;
};

} // namespace osgTerrainLight
