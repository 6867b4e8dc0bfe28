#pragma once

#include <osgTerrainLight/Export.h>

#include <string>
#include <vector>

namespace osgTerrainLight
{

/// How exactly horizons are computed; docs/ARCHITECTURE.md has each one's error and cost.
enum class HorizonQuality
{
    Draft,
    Normal,
    Best
};

OSGTERRAINLIGHT_EXPORT const char* toString(HorizonQuality quality);
/// False where the text is none of draft, normal, best; quality is then unchanged.
OSGTERRAINLIGHT_EXPORT bool fromString(const std::string& text, HorizonQuality& quality);

/// Every parameter of the lighting computation that is not the light itself: plain data.
struct OSGTERRAINLIGHT_EXPORT LightingSettings
{
    /// Azimuths of the horizon map: a multiple of 4, 4 … 256.
    int azimuths = 32;
    HorizonQuality quality = HorizonQuality::Normal;
    /// Multiplies the colour before it is encoded to sRGB, in the default program and in PNG
    /// output: 2^exposure. Stops, −20 … 20.
    double exposure = 0.0;
};

/// One numeric parameter's name, unit and legal range: the table that parser, setters and
/// documentation share.
struct OSGTERRAINLIGHT_EXPORT ParameterRange
{
    std::string name;
    std::string unit;
    double minimum = 0.0;
    double maximum = 0.0;
    std::string meaning;

    /// Names accepted: azimuths, exposure, sun-azimuth, sun-elevation, sun-radius, sun-irradiance,
    /// sky-radiance. Null where there is no such parameter.
    static const ParameterRange* find(const std::string& name);
    static const std::vector<ParameterRange>& all();

    /// Empty where the value is legal; else a sentence that names the parameter, the value and the
    /// range.
    std::string complaint(double value) const;
};

} // namespace osgTerrainLight
