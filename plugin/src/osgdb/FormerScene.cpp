#include "osgdb/FormerScene.h"

#include <osgTerrainLight/Environment.h>
#include <osgTerrainLight/LightingHandler.h>

#include <osg/Notify>

#include <algorithm>
#include <string>

namespace osgTerrainLight
{

namespace
{
/// Whether a block is in the file: a text has its name, a binary file a mark.
bool has(osgDB::InputStream& is, const char* name)
{
    if (!is.isBinary())
        return is.matchString(name);
    bool present = false;
    is >> present;
    return present;
}

void readLight(osgDB::InputStream& is, SkyLight& sky)
{
    is >> is.BEGIN_BRACKET;
    is >> is.PROPERTY("Sky") >> sky.skyEnabled;
    for (float& channel : sky.skyRadiance)
        is >> channel;
    is >> is.PROPERTY("Sun") >> sky.sunEnabled >> sky.sunAzimuth >> sky.sunElevation >>
        sky.sunAngularRadius;
    for (float& channel : sky.sunIrradiance)
        is >> channel;
    is >> is.END_BRACKET;
}

void readSettings(osgDB::InputStream& is, LightingSettings& settings)
{
    std::string quality, method;
    bool scalar = false;
    is >> is.BEGIN_BRACKET;
    is >> is.PROPERTY("Azimuths") >> settings.azimuths;
    is >> is.PROPERTY("Quality") >> quality;
    is >> is.PROPERTY("Exposure") >> settings.exposure;
    is >> is.PROPERTY("Bounces") >> settings.bounces;
    is >> is.PROPERTY("BounceMethod") >> method;
    is >> is.PROPERTY("Subsampling") >> settings.subsampling;
    is >> is.PROPERTY("BounceInterval") >> settings.bounceInterval;
    is >> is.PROPERTY("BodyRadius") >> settings.bodyRadius;
    is >> is.PROPERTY("Albedo");
    for (float& channel : settings.albedo)
        is >> channel;
    is >> is.PROPERTY("Gloss") >> settings.gloss >> settings.glossExponent;
    is >> is.PROPERTY("GlossScalar") >> scalar;
    for (double& part : settings.glossViewer)
        is >> part;
    is >> is.END_BRACKET;
    settings.glossTransfer = scalar ? GlossTransfer::Scalar : GlossTransfer::Vector;
    if (!fromString(quality, settings.quality) || !fromString(method, settings.bounceMethod))
        OSG_WARN << "osgTerrainLight: quality " << quality << ", bounce method " << method
                 << " read from file: needs known ones" << std::endl;
}

/// More than any are cut to one too many, which setSkyLight() refuses.
unsigned readCount(osgDB::InputStream& is, unsigned most)
{
    unsigned count = 0;
    is >> count >> is.BEGIN_BRACKET;
    return std::min(count, most + 1);
}

void readHarmonics(osgDB::InputStream& is, SkyLight& sky)
{
    sky.skyHarmonics.assign(readCount(is, 16), {});
    for (Rgb& coefficient : sky.skyHarmonics)
        for (float& channel : coefficient)
            is >> channel;
    is >> is.END_BRACKET;
}

void readKeyLights(osgDB::InputStream& is, SkyLight& sky)
{
    sky.keyLights.assign(readCount(is, 8), {});
    for (KeyLight& key : sky.keyLights)
    {
        is >> key.azimuth >> key.width >> key.lowest >> key.highest;
        for (float& channel : key.radiance)
            is >> channel;
    }
    is >> is.END_BRACKET;
}

void readSkyModel(osgDB::InputStream& is, SkyLight& sky)
{
    std::string model, file, problem;
    is >> is.BEGIN_BRACKET;
    is >> is.PROPERTY("Model");
    is.readWrappedString(model);
    is >> sky.turbidity;
    is >> is.PROPERTY("Environment");
    is.readWrappedString(file);
    is >> sky.environmentHeading >> sky.environmentGain;
    is >> is.END_BRACKET;
    if (!fromString(model, sky.skyModel))
        OSG_WARN << "osgTerrainLight: no sky model is called " << model << std::endl;
    // The sun is read already: the one that was saved, found there or not.
    if (!file.empty() && !(sky.environment = readEnvironment(file, problem)))
        OSG_WARN << "osgTerrainLight: left out the sky: " << problem << std::endl;
}

void readPlace(osgDB::InputStream& is, TerrainLighting& node)
{
    EarthPlace place;
    std::string time;
    is >> is.BEGIN_BRACKET >> place.longitude >> place.latitude >> place.convergence;
    is.readWrappedString(time);
    is >> is.END_BRACKET;
    node.setPlace(place);
    UtcTime utc;
    if (time.empty())
        return;
    const std::string problem = readUtcTime(time, utc);
    if (problem.empty())
        node.setTime(utc);
    else
        OSG_WARN << "osgTerrainLight: time read from file: " << problem << std::endl;
}

/// A text has what is not the default, a binary file all.
template <class Value>
Value readPlain(osgDB::InputStream& is, const char* name, Value value)
{
    if (is.isBinary() || is.matchString(name))
        is >> value;
    return value;
}
} // namespace

void readFormerScene(osgDB::InputStream& is, TerrainLighting& node)
{
    SkyLight sky;
    LightingSettings settings;
    if (is.isBinary() || is.matchString("SkyLight"))
        readLight(is, sky);
    if (has(is, "Settings"))
        readSettings(is, settings);
    if (has(is, "SkyHarmonics"))
        readHarmonics(is, sky);
    if (has(is, "KeyLights"))
        readKeyLights(is, sky);
    if (has(is, "SkyModel"))
        readSkyModel(is, sky);
    node.setSkyLight(sky);
    node.setSettings(settings);
    if (has(is, "Place"))
        readPlace(is, node);
    node.setLightEnabled(readPlain(is, "LightEnabled", true));
    node.setTimeBudget(readPlain(is, "TimeBudget", 50.0));
    node.setTextureUnit(readPlain(is, "TextureUnit", ShadingTexture::defaultUnit));
    node.setDefaultProgramEnabled(readPlain(is, "DefaultProgramEnabled", true));
    if (readPlain(is, "KeysEnabled", false)) // now a callback, which is saved by itself
        node.addEventCallback(new LightingHandler);
    node.setGlossLayer(readPlain(is, "GlossLayer", -1));
}

} // namespace osgTerrainLight
