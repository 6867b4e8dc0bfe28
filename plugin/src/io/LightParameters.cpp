#include "io/LightParameters.h"

namespace osgTerrainLight
{

namespace
{
/// A later key takes the place of what contradicts it.
void follow(LightParameters& parameters, const std::string& name)
{
    if (name == "sun-azimuth" || name == "sun-elevation")
        parameters.time.reset();
    if (name == "sky-harmonics" && !parameters.sky.skyHarmonics.empty())
    {
        parameters.sky.skyModel = SkyModel::Uniform;
        parameters.skyFile.clear();
    }
}

/// The key of a row of the table.
template <class Owner>
LightKey keyOf(const Setting<Owner>& setting, Owner LightParameters::*part)
{
    LightKey key;
    static_cast<SettingRow&>(key) = setting;
    key.defaultText = setting.defaultText();
    key.read = [&setting, part](LightParameters& parameters, const std::string& text) -> Status
    {
        const Result<SettingValue> value = setting.read(text, setting.key());
        if (!value)
            return value.error();
        setting.set(parameters.*part, *value);
        follow(parameters, setting.name);
        return Nothing{};
    };
    key.copy = [&setting, part](LightParameters& to, const LightParameters& from)
    {
        setting.set(to.*part, setting.get(from.*part));
        follow(to, setting.name);
    };
    return key;
}

/// What a scene has besides settings and light.
LightKey sceneKey(const char* name, const char* needs, const char* defaultText, const char* meaning)
{
    LightKey key;
    key.name = name;
    key.form.kind = ValueForm::Kind::Name;
    key.form.names = {needs};
    key.topic = Topic::Sun;
    key.defaultText = defaultText;
    key.meaning = meaning;
    key.isOption = false;
    return key;
}

LightKey lightSwitch()
{
    LightKey key = sceneKey("light", "off, sky, sun or both", "both",
                            "Which light is computed. Key lights shine unless it is off.");
    key.read = [](LightParameters& parameters, const std::string& value) -> Status
    {
        if (value != "off" && value != "sky" && value != "sun" && value != "both")
            return refused("light", value, "off, sky, sun or both");
        parameters.lightEnabled = value != "off";
        parameters.sky.skyEnabled = value != "sun";
        parameters.sky.sunEnabled = value != "sky";
        return Nothing{};
    };
    key.copy = [](LightParameters& to, const LightParameters& from)
    {
        to.lightEnabled = from.lightEnabled;
        to.sky.skyEnabled = from.sky.skyEnabled;
        to.sky.sunEnabled = from.sky.sunEnabled;
    };
    return key;
}

LightKey skyChoice()
{
    LightKey key = sceneKey("sky", "uniform, overcast, clear, none or a file", "uniform",
                            "How the light of the sky is distributed. A file is a panorama "
                            "(OpenEXR or .hdr); it brings its own sun.");
    key.topic = Topic::Sky;
    key.read = [](LightParameters& parameters, const std::string& value) -> Status
    {
        if (value.empty())
            return refused("sky", value, "uniform, overcast, clear, none or a file");
        // It takes the place of whatever sky was set before.
        parameters.sky.skyEnabled = value != "none";
        parameters.sky.skyModel = SkyModel::Uniform;
        parameters.sky.skyHarmonics.clear();
        const bool model = value == "none" || fromString(value, parameters.sky.skyModel);
        parameters.skyFile = model ? "" : value;
        return Nothing{};
    };
    key.copy = [](LightParameters& to, const LightParameters& from)
    {
        to.sky.skyEnabled = from.sky.skyEnabled;
        to.sky.skyModel = from.sky.skyModel;
        to.sky.skyHarmonics = from.sky.skyHarmonics;
        to.skyFile = from.skyFile;
    };
    return key;
}

LightKey timeOfSun()
{
    LightKey key = sceneKey("time", "YYYY-MM-DDThh:mm[:ss[.sss]], UTC or with a zone +hh:mm",
                            "none", "Time that sets the sun's azimuth and elevation.");
    key.read = [](LightParameters& parameters, const std::string& value) -> Status
    {
        UtcTime time;
        if (const std::string wrong = readUtcTime(value, time); !wrong.empty())
            return Error{ErrorCode::Invalid, "time = " + wrong};
        parameters.time = time;
        return Nothing{};
    };
    key.copy = [](LightParameters& to, const LightParameters& from) { to.time = from.time; };
    return key;
}

LightKey placeOnEarth()
{
    LightKey key = sceneKey("place", "longitude,latitude in degrees", "middle of the terrain",
                            "Place on Earth for the time of the sun.");
    key.read = [](LightParameters& parameters, const std::string& value) -> Status
    {
        EarthPlace place;
        if (const std::string wrong = readEarthPlace(value, place); !wrong.empty())
            return Error{ErrorCode::Invalid, "place = " + wrong};
        parameters.place = place;
        return Nothing{};
    };
    key.copy = [](LightParameters& to, const LightParameters& from) { to.place = from.place; };
    return key;
}
} // namespace

const std::vector<LightKey>& lightKeys()
{
    static const std::vector<LightKey> keys = []
    {
        std::vector<LightKey> all;
        for (const Setting<LightingSettings>& setting : settingsOf<LightingSettings>())
            if (setting.isKey)
                all.push_back(keyOf(setting, &LightParameters::settings));
        for (const Setting<SkyLight>& setting : settingsOf<SkyLight>())
            if (setting.isKey)
                all.push_back(keyOf(setting, &LightParameters::sky));
        for (const LightKey& key : {lightSwitch(), skyChoice(), timeOfSun(), placeOnEarth()})
            all.push_back(key);
        return all;
    }();
    return keys;
}

const LightKey* findLightKey(const std::string& name)
{
    for (const LightKey& key : lightKeys())
        if (key.name == name || key.key() == name)
            return &key;
    return nullptr;
}

Status setLightParameter(LightParameters& parameters, const std::string& name,
                         const std::string& value)
{
    std::string known;
    for (const LightKey& key : lightKeys())
    {
        if (key.key() == name)
            return key.read(parameters, value);
        known += (known.empty() ? "" : ", ") + key.key();
    }
    return Error{ErrorCode::NotSupported,
                 name + " = \"" + value + "\": no such setting; needs one of " + known};
}

Status setKeyLight(KeyLight& key, const std::string& name, const std::string& text)
{
    std::string known;
    for (const Setting<KeyLight>& setting : settingsOf<KeyLight>())
    {
        known += (known.empty() ? "" : ", ") + setting.name;
        if (name != setting.name)
            continue;
        const Result<SettingValue> value = setting.read(text, name);
        if (!value)
            return value.error();
        setting.set(key, *value);
        return Nothing{};
    }
    return Error{ErrorCode::NotSupported, name + " = \"" + text +
                                              "\": a key light has no such setting; needs one of " +
                                              known};
}

} // namespace osgTerrainLight
