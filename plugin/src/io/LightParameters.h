#pragma once

#include "core/Result.h"
#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>
#include <osgTerrainLight/SunPosition.h>

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

/// Names, for messages and documentation: those of ParameterRange with '_' for '-', then
/// "quality" (draft, normal, best), "bounce_method", "gloss_transfer", "light" (off, sky, sun,
/// both), "sky" (uniform, overcast, clear, none or an environment's file), "sky_harmonics",
/// "key_lights", "time" (as readUtcTime) and "place" (as readEarthPlace).
OSGTERRAINLIGHT_EXPORT std::vector<std::string> lightParameterNames();

/// Sets one parameter. Colours are one number or three, separated by blanks or commas.
/// sky_harmonics: 1, 4, 9 or 16 coefficients, each one number or each three; nothing: a uniform
/// sky. key_lights: as parseKeyLight has each, separated by semicolons; they take the place of all
/// before. The error names the parameter, the value and what it needs; the parameters are then
/// unchanged.
OSGTERRAINLIGHT_EXPORT Status setLightParameter(LightParameters& parameters,
                                                const std::string& name, const std::string& value);

/// "azimuth, width, lowest, highest[, radiance]": four numbers, or five, or seven where radiance is
/// a colour.
OSGTERRAINLIGHT_EXPORT Result<KeyLight> parseKeyLight(const std::string& text);

/// Sets one number or colour of a key light by its name: azimuth, width, lowest, highest, radiance.
OSGTERRAINLIGHT_EXPORT Status setKeyLight(KeyLight& key, const std::string& name,
                                          const std::string& value);

/// What key_lights and sky_harmonics take: with commas and semicolons, without blanks.
OSGTERRAINLIGHT_EXPORT std::string textOf(const std::vector<KeyLight>& keys);
OSGTERRAINLIGHT_EXPORT std::string textOf(const std::vector<Rgb>& harmonics);

/// Empty where every value is legal; else a sentence that names the first that is not.
OSGTERRAINLIGHT_EXPORT std::string complaint(const KeyLight& key);
OSGTERRAINLIGHT_EXPORT std::string complaint(const SkyLight& sky);
OSGTERRAINLIGHT_EXPORT std::string complaint(const LightingSettings& settings);

} // namespace osgTerrainLight
