#include "osgdb/Register.h"

#include <osgTerrainLight/TerrainLighting.h>

#include <osgTerrainLight/Environment.h>
#include <osgTerrainLight/LightingHandler.h>
#include <osgTerrainLight/SunPosition.h>

#include <osg/Notify>
#include <osgDB/InputStream>
#include <osgDB/ObjectWrapper>
#include <osgDB/OutputStream>

#include <string>

// SkyLight: radiance and irradiance, then angles [degrees].
static bool checkSkyLight(const osgTerrainLight::TerrainLighting&)
{
    return true;
}

static bool readSkyLight(osgDB::InputStream& is, osgTerrainLight::TerrainLighting& node)
{
    osgTerrainLight::SkyLight sky;
    is >> is.BEGIN_BRACKET;
    is >> is.PROPERTY("Sky") >> sky.skyEnabled;
    for (float& channel : sky.skyRadiance)
        is >> channel;
    is >> is.PROPERTY("Sun") >> sky.sunEnabled >> sky.sunAzimuth >> sky.sunElevation >>
        sky.sunAngularRadius;
    for (float& channel : sky.sunIrradiance)
        is >> channel;
    is >> is.END_BRACKET;
    node.setSkyLight(sky);
    return true;
}

static bool writeSkyLight(osgDB::OutputStream& os, const osgTerrainLight::TerrainLighting& node)
{
    const osgTerrainLight::SkyLight& sky = node.getSkyLight();
    os << os.BEGIN_BRACKET << std::endl;
    os << os.PROPERTY("Sky") << sky.skyEnabled;
    for (float channel : sky.skyRadiance)
        os << channel;
    os << std::endl;
    os << os.PROPERTY("Sun") << sky.sunEnabled << sky.sunAzimuth << sky.sunElevation
       << sky.sunAngularRadius;
    for (float channel : sky.sunIrradiance)
        os << channel;
    os << std::endl << os.END_BRACKET << std::endl;
    return true;
}

// What few scenes have is written where they have it: model, turbidity; file, heading, gain.
static bool checkSkyModel(const osgTerrainLight::TerrainLighting& node)
{
    const osgTerrainLight::SkyLight& sky = node.getSkyLight();
    return sky.skyModel != osgTerrainLight::SkyModel::Uniform || sky.environment;
}

static bool readSkyModel(osgDB::InputStream& is, osgTerrainLight::TerrainLighting& node)
{
    osgTerrainLight::SkyLight sky = node.getSkyLight();
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
    if (!file.empty() && !(sky.environment = osgTerrainLight::readEnvironment(file, problem)))
        OSG_WARN << "osgTerrainLight: left out the sky: " << problem << std::endl;
    node.setSkyLight(sky);
    return true;
}

static bool writeSkyModel(osgDB::OutputStream& os, const osgTerrainLight::TerrainLighting& node)
{
    const osgTerrainLight::SkyLight& sky = node.getSkyLight();
    if (sky.environment && sky.environment->name.empty())
        OSG_WARN << "osgTerrainLight: a sky that is of no file is not saved" << std::endl;
    os << os.BEGIN_BRACKET << std::endl;
    os << os.PROPERTY("Model");
    os.writeWrappedString(toString(sky.skyModel));
    os << sky.turbidity << std::endl;
    os << os.PROPERTY("Environment");
    os.writeWrappedString(sky.environment ? sky.environment->name : std::string());
    os << sky.environmentHeading << sky.environmentGain << std::endl;
    os << os.END_BRACKET << std::endl;
    return true;
}

static bool checkSkyHarmonics(const osgTerrainLight::TerrainLighting& node)
{
    return !node.getSkyLight().skyHarmonics.empty();
}

static bool readSkyHarmonics(osgDB::InputStream& is, osgTerrainLight::TerrainLighting& node)
{
    osgTerrainLight::SkyLight sky = node.getSkyLight();
    unsigned count = 0;
    is >> count >> is.BEGIN_BRACKET;
    if (count > 16) // more than any; setSkyLight says so
        count = 17;
    sky.skyHarmonics.assign(count, {});
    for (osgTerrainLight::Rgb& coefficient : sky.skyHarmonics)
        for (float& channel : coefficient)
            is >> channel;
    is >> is.END_BRACKET;
    node.setSkyLight(sky);
    return true;
}

static bool writeSkyHarmonics(osgDB::OutputStream& os, const osgTerrainLight::TerrainLighting& node)
{
    const auto& harmonics = node.getSkyLight().skyHarmonics;
    os << static_cast<unsigned>(harmonics.size()) << os.BEGIN_BRACKET << std::endl;
    for (const osgTerrainLight::Rgb& coefficient : harmonics)
    {
        for (float channel : coefficient)
            os << channel;
        os << std::endl;
    }
    os << os.END_BRACKET << std::endl;
    return true;
}

// Place, and time where the sun stands by it.
static bool checkPlace(const osgTerrainLight::TerrainLighting& node)
{
    return node.getPlace().has_value();
}

static bool readPlace(osgDB::InputStream& is, osgTerrainLight::TerrainLighting& node)
{
    osgTerrainLight::EarthPlace place;
    std::string time;
    is >> is.BEGIN_BRACKET >> place.longitude >> place.latitude >> place.convergence;
    is.readWrappedString(time);
    is >> is.END_BRACKET;
    node.setPlace(place);
    osgTerrainLight::UtcTime utc;
    if (time.empty())
        return true;
    const std::string problem = osgTerrainLight::readUtcTime(time, utc);
    if (problem.empty())
        node.setTime(utc);
    else
        OSG_WARN << "osgTerrainLight: time read from file: " << problem << std::endl;
    return true;
}

static bool writePlace(osgDB::OutputStream& os, const osgTerrainLight::TerrainLighting& node)
{
    const osgTerrainLight::EarthPlace& place = *node.getPlace();
    os << os.BEGIN_BRACKET << std::endl;
    os << place.longitude << place.latitude << place.convergence;
    os.writeWrappedString(node.getTime() ? osgTerrainLight::toString(*node.getTime())
                                         : std::string());
    os << std::endl << os.END_BRACKET << std::endl;
    return true;
}

// Azimuth, width, lowest, highest [degrees], radiance.
static bool checkKeyLights(const osgTerrainLight::TerrainLighting& node)
{
    return !node.getSkyLight().keyLights.empty();
}

static bool readKeyLights(osgDB::InputStream& is, osgTerrainLight::TerrainLighting& node)
{
    osgTerrainLight::SkyLight sky = node.getSkyLight();
    unsigned count = 0;
    is >> count >> is.BEGIN_BRACKET;
    if (count > 8) // more than any; setSkyLight says so
        count = 9;
    sky.keyLights.assign(count, {});
    for (osgTerrainLight::KeyLight& key : sky.keyLights)
    {
        is >> key.azimuth >> key.width >> key.lowest >> key.highest;
        for (float& channel : key.radiance)
            is >> channel;
    }
    is >> is.END_BRACKET;
    node.setSkyLight(sky);
    return true;
}

static bool writeKeyLights(osgDB::OutputStream& os, const osgTerrainLight::TerrainLighting& node)
{
    const auto& keys = node.getSkyLight().keyLights;
    os << static_cast<unsigned>(keys.size()) << os.BEGIN_BRACKET << std::endl;
    for (const osgTerrainLight::KeyLight& key : keys)
    {
        os << key.azimuth << key.width << key.lowest << key.highest;
        for (float channel : key.radiance)
            os << channel;
        os << std::endl;
    }
    os << os.END_BRACKET << std::endl;
    return true;
}

// Of older files: keys are now an event callback, which is saved as one. A user's serializer with
// no body has the binary form of the bool that it was.
static bool checkKeysEnabled(const osgTerrainLight::TerrainLighting&)
{
    return false;
}

static bool readKeysEnabled(osgDB::InputStream& is, osgTerrainLight::TerrainLighting& node)
{
    bool enabled = true;
    if (!is.isBinary())
        is >> enabled;
    if (enabled)
        node.addEventCallback(new osgTerrainLight::LightingHandler);
    return true;
}

static bool writeKeysEnabled(osgDB::OutputStream&, const osgTerrainLight::TerrainLighting&)
{
    return true;
}

static bool checkSettings(const osgTerrainLight::TerrainLighting&)
{
    return true;
}

static bool readSettings(osgDB::InputStream& is, osgTerrainLight::TerrainLighting& node)
{
    osgTerrainLight::LightingSettings settings;
    std::string quality;
    is >> is.BEGIN_BRACKET;
    is >> is.PROPERTY("Azimuths") >> settings.azimuths;
    is >> is.PROPERTY("Quality") >> quality;
    is >> is.PROPERTY("Exposure") >> settings.exposure;
    std::string method;
    is >> is.PROPERTY("Bounces") >> settings.bounces;
    is >> is.PROPERTY("BounceMethod") >> method;
    if (!osgTerrainLight::fromString(method, settings.bounceMethod))
        OSG_WARN << "osgTerrainLight: bounce method " << method << " read from file: needs slices, "
                 << "legendre or legendre-bspline" << std::endl;
    is >> is.PROPERTY("Subsampling") >> settings.subsampling;
    is >> is.PROPERTY("BounceInterval") >> settings.bounceInterval;
    is >> is.PROPERTY("BodyRadius") >> settings.bodyRadius;
    is >> is.PROPERTY("Albedo");
    for (float& channel : settings.albedo)
        is >> channel;
    bool scalar = false;
    is >> is.PROPERTY("Gloss") >> settings.gloss >> settings.glossExponent;
    is >> is.PROPERTY("GlossScalar") >> scalar;
    for (double& part : settings.glossViewer)
        is >> part;
    if (scalar)
        settings.glossTransfer = osgTerrainLight::GlossTransfer::Scalar;
    is >> is.END_BRACKET;
    if (!osgTerrainLight::fromString(quality, settings.quality))
        OSG_WARN << "osgTerrainLight: quality " << quality << " read from file: needs draft, "
                 << "normal or best" << std::endl;
    node.setSettings(settings);
    return true;
}

static bool writeSettings(osgDB::OutputStream& os, const osgTerrainLight::TerrainLighting& node)
{
    const osgTerrainLight::LightingSettings& settings = node.getSettings();
    os << os.BEGIN_BRACKET << std::endl;
    os << os.PROPERTY("Azimuths") << settings.azimuths << std::endl;
    os << os.PROPERTY("Quality") << std::string(toString(settings.quality)) << std::endl;
    os << os.PROPERTY("Exposure") << settings.exposure << std::endl;
    os << os.PROPERTY("Bounces") << settings.bounces << std::endl;
    os << os.PROPERTY("BounceMethod") << std::string(toString(settings.bounceMethod)) << std::endl;
    os << os.PROPERTY("Subsampling") << settings.subsampling << std::endl;
    os << os.PROPERTY("BounceInterval") << settings.bounceInterval << std::endl;
    os << os.PROPERTY("BodyRadius") << settings.bodyRadius << std::endl;
    os << os.PROPERTY("Albedo");
    for (const float channel : settings.albedo)
        os << channel;
    os << std::endl;
    os << os.PROPERTY("Gloss") << settings.gloss << settings.glossExponent << std::endl;
    os << os.PROPERTY("GlossScalar")
       << (settings.glossTransfer == osgTerrainLight::GlossTransfer::Scalar);
    for (const double part : settings.glossViewer)
        os << part;
    os << std::endl;
    os << os.END_BRACKET << std::endl;
    return true;
}

static osg::Object* createLighting()
{
    return new osgTerrainLight::TerrainLighting;
}

static void addLightingProperties(osgDB::ObjectWrapper* wrapper)
{
    typedef osgTerrainLight::TerrainLighting MyClass; // by this name OSG's macros know it
    ADD_USER_SERIALIZER(SkyLight);
    ADD_USER_SERIALIZER(Settings);
    ADD_USER_SERIALIZER(SkyHarmonics);
    ADD_USER_SERIALIZER(KeyLights);
    ADD_USER_SERIALIZER(SkyModel);
    ADD_USER_SERIALIZER(Place);
    ADD_BOOL_SERIALIZER(LightEnabled, true);
    ADD_DOUBLE_SERIALIZER(TimeBudget, 50.0);
    ADD_UINT_SERIALIZER(TextureUnit, osgTerrainLight::ShadingTexture::defaultUnit);
    ADD_BOOL_SERIALIZER(DefaultProgramEnabled, true);
    ADD_USER_SERIALIZER(KeysEnabled);
    ADD_INT_SERIALIZER(GlossLayer, -1);
}

static osg::Object* createHandler()
{
    return new osgTerrainLight::LightingHandler;
}

static void addHandlerProperties(osgDB::ObjectWrapper*) {}

namespace osgTerrainLight
{

void registerSerializers()
{
    // REGISTER_OBJECT_WRAPPER would do it when the library is loaded, in applications that only
    // link it too.
    static const osgDB::RegisterWrapperProxy lighting(
        createLighting, "osgTerrainLight::TerrainLighting",
        "osg::Object osg::Node osg::Group osgTerrainLight::TerrainLighting", addLightingProperties);
    static const osgDB::RegisterWrapperProxy handler(
        createHandler, "osgTerrainLight::LightingHandler",
        "osg::Object osg::Callback osg::NodeCallback osgTerrainLight::LightingHandler",
        addHandlerProperties);
}

} // namespace osgTerrainLight
