#pragma once

#include "core/KeyLightText.h"
#include "core/Result.h"
#include "core/SettingsTable.h"
#include "io/DemReader.h"
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>
#include <osgTerrainLight/SunPosition.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// What people set by name, as reader options (name=value) and in <terrain_light> alike.
struct LightParameters
{
    /// Its environment is not set: a file is read where the light is made.
    SkyLight sky;
    std::string skyFile; ///< empty: no environment
    LightingSettings settings;
    bool lightEnabled = true;
    /// The sun by time, instead of its azimuth and elevation; whichever was set later.
    std::optional<UtcTime> time;
    std::optional<EarthPlace> place; ///< else the terrain's own
};

/// A key of <terrain_light>, and a reader option: a row of the table of settings, or one of what a
/// scene has besides.
struct LightKey : SettingRow
{
    std::function<Status(LightParameters&, const std::string& value)> read;
    /// Takes this key's value from another light.
    std::function<void(LightParameters& to, const LightParameters& from)> copy;
    std::string defaultText;
};

/// All keys, those of the table first. "light", "sky", "time" and "place" follow.
const std::vector<LightKey>& lightKeys();
/// By a row's name or by its key. Null where there is none.
const LightKey* findLightKey(const std::string& name);

/// Sets one parameter by its key. Of keys that contradict each other the later one holds:
/// sun_azimuth and time, sky and sky_harmonics. The error names the parameter, the value and what
/// it needs; the parameters are then unchanged.
Status setLightParameter(LightParameters& parameters, const std::string& name,
                         const std::string& value);

/// What a program asks the reader for, over what a map says, as values: plugin data of
/// osgDB::Options under this name. It lives as long as the reading.
struct GivenLight
{
    static constexpr const char* pluginData = "osgTerrainLight::GivenLight";
    std::vector<std::function<void(LightParameters&)>> changes; ///< in this order
    DemReadOptions read;                                        ///< of a raster
    bool geocentric = false;                                    ///< terrain lies on its ellipsoid
};

/// Sets one number or colour of a key light by its name.
Status setKeyLight(KeyLight& key, const std::string& name, const std::string& value);

} // namespace osgTerrainLight
