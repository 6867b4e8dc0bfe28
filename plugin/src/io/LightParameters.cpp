#include "io/LightParameters.h"

#include <algorithm>
#include <locale>
#include <sstream>

namespace osgTerrainLight
{

namespace
{
std::string underscored(std::string name)
{
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

/// The numbers in a text, separated by blanks or commas; empty where it holds anything else.
std::vector<double> numbersIn(std::string text)
{
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream stream(text);
    stream.imbue(std::locale::classic());
    std::vector<double> values;
    double value = 0.0;
    while (stream >> value)
        values.push_back(value);
    return stream.eof() ? values : std::vector<double>();
}

Error refused(const std::string& name, const std::string& value, const std::string& needed)
{
    return {ErrorCode::Invalid, name + " = \"" + value + "\": needs " + needed};
}

std::string rangeOf(const ParameterRange& range)
{
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << range.minimum << " ... " << range.maximum << (range.unit.empty() ? "" : " ")
         << range.unit;
    return text.str();
}

Status setNumbers(LightParameters& parameters, const ParameterRange& range, const std::string& name,
                  const std::string& text)
{
    Rgb* colour = range.name == "sun-irradiance" ? &parameters.sky.sunIrradiance
                  : range.name == "sky-radiance" ? &parameters.sky.skyRadiance
                  : range.name == "albedo"       ? &parameters.settings.albedo
                                                 : nullptr;
    const Error bad = refused(name, text,
                              (colour                        ? "one number or three, "
                               : range.name == "azimuths"    ? "a multiple of 4, "
                               : range.name == "subsampling" ? "a power of 2, "
                               : range.name == "bounces"     ? "a whole number, "
                                                             : "a number, ") +
                                  rangeOf(range));
    const std::vector<double> values = numbersIn(text);
    if (values.size() != 1 && !(colour && values.size() == 3))
        return bad;
    for (double value : values)
        if (!range.complaint(value).empty())
            return bad;
    const double value = values.front();
    if (colour)
        for (std::size_t i = 0; i < 3; ++i)
            (*colour)[i] = static_cast<float>(values[values.size() == 3 ? i : 0]);
    else if (range.name == "azimuths")
        parameters.settings.azimuths = static_cast<int>(value);
    else if (range.name == "bounces")
        parameters.settings.bounces = static_cast<int>(value);
    else if (range.name == "subsampling")
        parameters.settings.subsampling = static_cast<int>(value);
    else if (range.name == "gloss")
        parameters.settings.gloss = value;
    else if (range.name == "gloss-exponent")
        parameters.settings.glossExponent = value;
    else if (range.name == "exposure")
        parameters.settings.exposure = value;
    else if (range.name == "sun-azimuth")
        parameters.sky.sunAzimuth = value;
    else if (range.name == "sun-elevation")
        parameters.sky.sunElevation = value;
    else if (range.name == "sun-radius")
        parameters.sky.sunAngularRadius = value;
    else
        return Error{ErrorCode::NotSupported, name + " cannot be set here"};
    return Nothing{};
}

std::string complaintOf(const char* name, double value)
{
    return ParameterRange::find(name)->complaint(value);
}
} // namespace

std::vector<std::string> lightParameterNames()
{
    std::vector<std::string> names;
    for (const ParameterRange& range : ParameterRange::all())
        names.push_back(underscored(range.name));
    names.insert(names.end(), {"quality", "bounce_method", "light"});
    return names;
}

Status setLightParameter(LightParameters& parameters, const std::string& name,
                         const std::string& value)
{
    if (name == "quality")
        return fromString(value, parameters.settings.quality)
                   ? Status(Nothing{})
                   : Status(refused(name, value, "draft, normal or best"));
    if (name == "bounce_method")
        return fromString(value, parameters.settings.bounceMethod)
                   ? Status(Nothing{})
                   : Status(refused(name, value, "slices, legendre or legendre-bspline"));
    if (name == "light")
    {
        if (value != "off" && value != "sky" && value != "sun" && value != "both")
            return refused(name, value, "off, sky, sun or both");
        parameters.lightEnabled = value != "off";
        parameters.sky.skyEnabled = value != "sun";
        parameters.sky.sunEnabled = value != "sky";
        return Nothing{};
    }
    for (const ParameterRange& range : ParameterRange::all())
        if (name == underscored(range.name))
            return setNumbers(parameters, range, name, value);

    std::string known;
    for (const std::string& other : lightParameterNames())
        known += (known.empty() ? "" : ", ") + other;
    return Error{ErrorCode::NotSupported,
                 name + " = \"" + value + "\": no such setting; needs one of " + known};
}

std::string complaint(const SkyLight& sky)
{
    std::vector<std::string> found = {complaintOf("sun-azimuth", sky.sunAzimuth),
                                      complaintOf("sun-elevation", sky.sunElevation),
                                      complaintOf("sun-radius", sky.sunAngularRadius)};
    for (std::size_t i = 0; i < 3; ++i)
    {
        found.push_back(complaintOf("sun-irradiance", static_cast<double>(sky.sunIrradiance[i])));
        found.push_back(complaintOf("sky-radiance", static_cast<double>(sky.skyRadiance[i])));
    }
    for (const std::string& text : found)
        if (!text.empty())
            return text;
    return {};
}

std::string complaint(const LightingSettings& settings)
{
    std::vector<std::string> found = {complaintOf("azimuths", settings.azimuths),
                                      complaintOf("bounces", settings.bounces),
                                      complaintOf("subsampling", settings.subsampling),
                                      complaintOf("gloss", settings.gloss),
                                      complaintOf("gloss-exponent", settings.glossExponent),
                                      complaintOf("exposure", settings.exposure)};
    for (const float channel : settings.albedo)
        found.push_back(complaintOf("albedo", static_cast<double>(channel)));
    const auto& v = settings.glossViewer;
    const double length = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (!(length > 0.0 && length < 1e30))
        found.push_back("gloss viewer: needs a direction, not of length 0");
    for (const std::string& text : found)
        if (!text.empty())
            return text;
    return {};
}

} // namespace osgTerrainLight
