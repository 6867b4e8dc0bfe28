#pragma once

#include "core/Result.h"
#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>

#include <string>
#include <vector>

namespace osgTerrainLight
{

/// What people set by name, as reader options (name=value) and in <terrain_light> alike.
struct LightParameters
{
    SkyLight sky;
    LightingSettings settings;
    bool lightEnabled = true;
};

/// Names, for messages and documentation: those of ParameterRange with '_' for '-', then
/// "quality" (draft, normal, best) and "light" (off, sky, sun, both).
OSGTERRAINLIGHT_EXPORT std::vector<std::string> lightParameterNames();

/// Sets one parameter. Colours are one number or three, separated by blanks or commas. The error
/// names the parameter, the value and what it needs; the parameters are then unchanged.
OSGTERRAINLIGHT_EXPORT Status setLightParameter(LightParameters& parameters,
                                                const std::string& name, const std::string& value);

/// Empty where every value is legal; else a sentence that names the first that is not.
OSGTERRAINLIGHT_EXPORT std::string complaint(const SkyLight& sky);
OSGTERRAINLIGHT_EXPORT std::string complaint(const LightingSettings& settings);

} // namespace osgTerrainLight
