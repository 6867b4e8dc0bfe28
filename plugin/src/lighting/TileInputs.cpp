#include "lighting/TileInputs.h"

#include "core/KeySlices.h"
#include "core/SkyRadiance.h"
#include "gpu/Textures.h"

namespace osgTerrainLight
{

bool TileValues::hasSkyTable() const
{
    return hasSky() && skyHasTable(sky);
}

bool TileValues::hasSun() const
{
    return sky.sunEnabled && sky.sunElevation + sky.sunAngularRadius > 0.0;
}

bool TileValues::hasKeyLights() const
{
    return !keySlices(sky, settings.azimuths).empty();
}

bool TileValues::isGlossy() const
{
    return bySlices() && (gloss ? hasGloss : settings.gloss > 0.0) && hasLight();
}

int TileValues::bounces(int width, int height) const
{
    const bool isBlack = albedo ? albedoIsBlack : isBlackAlbedo(settings.albedo);
    // Less than two posts a side have no cell between them to send light.
    return hasLight() && width > 1 && height > 1 && (isGlossy() || !isBlack) ? settings.bounces : 0;
}

SkyLight TileValues::lightAtGround() const
{
    SkyLight found = sky;
    found.sunIrradiance = sunAtGround(sky);
    return found;
}

SkyLight TileValues::lightInHarmonics() const
{
    SkyLight found = lightAtGround();
    if (skyHasTable(sky))
        found.skyHarmonics = harmonicsOf(sky);
    return found;
}

Rgb skyGain(const SkyLight& sky)
{
    return !sky.skyEnabled ? Rgb{} : skyHasTable(sky) ? Rgb{1.0f, 1.0f, 1.0f} : sky.skyRadiance;
}

TileInputs::TileInputs()
    : settingsValue(new Resource("settings")), light(new Resource("light")),
      skyValue(new Resource("sky")), sunPlace(new Resource("place of the sun")),
      keyPlaces(new Resource("places of key lights")), bouncesDue(new Resource("bounces due")),
      probePlaces(new Resource("places of probes")),
      objectsValue(new Resource("places of objects")), postsValue(new Resource("posts")),
      albedoTexture(new Resource("albedo", [this] { return createAlbedo(); })),
      materialTexture(new Resource("material", [this] { return createMaterial(); }))
{
}

osg::ref_ptr<osg::Texture> TileInputs::createAlbedo() const
{
    return createColourTexture(albedo ? *albedo : Raster<Rgb>(1, 1, settings.albedo));
}

osg::ref_ptr<osg::Texture> TileInputs::createMaterial() const
{
    if (!gloss)
        return createColourTexture(Raster<Rgb>(1, 1,
                                               {static_cast<float>(settings.gloss),
                                                static_cast<float>(settings.glossExponent), 0.0f}));
    Raster<Rgb> material(gloss->width(), gloss->height());
    for (std::size_t i = 0; i < material.size(); ++i)
        material.values()[i] = {gloss->values()[i][0], gloss->values()[i][1], 0.0f};
    return createColourTexture(material);
}

} // namespace osgTerrainLight
