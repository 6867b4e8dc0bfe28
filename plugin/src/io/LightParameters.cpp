#include "io/LightParameters.h"

#include "core/KeySlices.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
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
    const Error bad =
        refused(name, text,
                (colour                        ? "one number or three, "
                 : range.name == "azimuths"    ? "a multiple of 4, "
                 : range.name == "subsampling" ? "a power of 2, "
                 : range.name == "bounces" || range.name == "bounce-interval" ? "a whole number, "
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
    else if (range.name == "bounce-interval")
        parameters.settings.bounceInterval = static_cast<int>(value);
    else if (range.name == "gloss")
        parameters.settings.gloss = value;
    else if (range.name == "gloss-exponent")
        parameters.settings.glossExponent = value;
    else if (range.name == "body-radius")
        parameters.settings.bodyRadius = value;
    else if (range.name == "turbidity")
        parameters.sky.turbidity = value;
    else if (range.name == "sky-heading")
        parameters.sky.environmentHeading = value;
    else if (range.name == "sky-gain")
        parameters.sky.environmentGain = value;
    else if (range.name == "exposure")
        parameters.settings.exposure = value;
    else if (range.name == "sun-azimuth")
    {
        parameters.sky.sunAzimuth = value;
        parameters.time.reset();
    }
    else if (range.name == "sun-elevation")
    {
        parameters.sky.sunElevation = value;
        parameters.time.reset();
    }
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

/// Of each key light.
const std::vector<ParameterRange>& keyRanges()
{
    static const std::vector<ParameterRange> table = {
        {"azimuth", "degrees", -360, 720, "of its middle, clockwise from north"},
        {"width", "degrees", 0.1, 360, "of azimuth"},
        {"lowest", "degrees", -90, 90, "above the horizontal"},
        {"highest", "degrees", -90, 90, "above the horizontal"},
        {"radiance", "", 0, 1e6, "per channel"},
    };
    return table;
}

constexpr const char* keyLightForm = "azimuth,width,lowest,highest, then nothing, a radiance or "
                                     "red,green,blue";
constexpr const char* harmonicsForm = "1, 4, 9 or 16 coefficients, each one number or each three";

std::string tooMany(std::size_t count)
{
    return std::to_string(count) + " key lights: needs at most " + std::to_string(maxKeyLights);
}

Status setHarmonics(SkyLight& sky, const std::string& name, const std::string& text)
{
    const std::vector<double> values = numbersIn(text);
    const std::size_t count = values.size();
    std::size_t channels = 0;
    for (const std::size_t coefficients : {1u, 4u, 9u, 16u})
        for (const std::size_t each : {1u, 3u})
            if (count == each * coefficients)
                channels = each;
    if (channels == 0 && text.find_first_not_of(" ") != std::string::npos)
        return refused(name, text,
                       std::string(harmonicsForm) + "; these are " + std::to_string(count) +
                           " numbers");
    std::vector<Rgb> harmonics(channels ? count / channels : 0);
    for (std::size_t i = 0; i < harmonics.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            harmonics[i][c] = static_cast<float>(values[channels * i + (channels == 3 ? c : 0)]);
    sky.skyHarmonics = harmonics;
    if (!harmonics.empty())
        sky.skyModel = SkyModel::Uniform;
    return Nothing{};
}

Status setKeyLights(SkyLight& sky, const std::string& name, const std::string& text)
{
    std::vector<KeyLight> keys;
    std::istringstream list(text);
    for (std::string one; std::getline(list, one, ';');)
    {
        const Result<KeyLight> key = parseKeyLight(one);
        if (!key)
            return Error{ErrorCode::Invalid, name + ": " + key.error().message};
        keys.push_back(*key);
    }
    if (keys.size() > maxKeyLights)
        return Error{ErrorCode::Invalid, name + ": " + tooMany(keys.size())};
    sky.keyLights = keys;
    return Nothing{};
}

std::string numbersText(const std::vector<double>& values)
{
    std::string text;
    for (const double value : values)
    {
        // The shortest that reads back as the same; of a float, as the same float.
        std::array<char, 32> digits{};
        const float single = static_cast<float>(value);
        const auto end = static_cast<double>(single) == value
                             ? std::to_chars(digits.begin(), digits.end(), single).ptr
                             : std::to_chars(digits.begin(), digits.end(), value).ptr;
        text += (text.empty() ? "" : ",") + std::string(digits.begin(), end);
    }
    return text;
}
} // namespace

std::vector<std::string> lightParameterNames()
{
    std::vector<std::string> names;
    for (const ParameterRange& range : ParameterRange::all())
        names.push_back(underscored(range.name));
    names.insert(names.end(), {"quality", "bounce_method", "gloss_transfer", "light", "sky",
                               "sky_harmonics", "key_lights", "time", "place"});
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
    if (name == "gloss_transfer")
        return fromString(value, parameters.settings.glossTransfer)
                   ? Status(Nothing{})
                   : Status(refused(name, value, "vector or scalar"));
    if (name == "light")
    {
        if (value != "off" && value != "sky" && value != "sun" && value != "both")
            return refused(name, value, "off, sky, sun or both");
        parameters.lightEnabled = value != "off";
        parameters.sky.skyEnabled = value != "sun";
        parameters.sky.sunEnabled = value != "sky";
        return Nothing{};
    }
    if (name == "sky")
    {
        if (value.empty())
            return refused(name, value, "uniform, overcast, clear, none or a file");
        // It takes the place of whatever sky was set before.
        parameters.sky.skyEnabled = value != "none";
        parameters.sky.skyModel = SkyModel::Uniform;
        parameters.sky.skyHarmonics.clear();
        const bool model = value == "none" || fromString(value, parameters.sky.skyModel);
        parameters.skyFile = model ? "" : value;
        return Nothing{};
    }
    if (name == "sky_harmonics")
    {
        const Status set = setHarmonics(parameters.sky, name, value);
        if (set && !parameters.sky.skyHarmonics.empty())
            parameters.skyFile.clear();
        return set;
    }
    if (name == "key_lights")
        return setKeyLights(parameters.sky, name, value);
    if (name == "time")
    {
        UtcTime time;
        if (const std::string wrong = readUtcTime(value, time); !wrong.empty())
            return Error{ErrorCode::Invalid, name + " = " + wrong};
        parameters.time = time;
        return Nothing{};
    }
    if (name == "place")
    {
        EarthPlace place;
        if (const std::string wrong = readEarthPlace(value, place); !wrong.empty())
            return Error{ErrorCode::Invalid, name + " = " + wrong};
        parameters.place = place;
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

Result<KeyLight> parseKeyLight(const std::string& text)
{
    const std::vector<double> values = numbersIn(text);
    if (values.size() != 4 && values.size() != 5 && values.size() != 7)
        return refused("key light", text, keyLightForm);
    KeyLight key;
    key.azimuth = values[0];
    key.width = values[1];
    key.lowest = values[2];
    key.highest = values[3];
    for (std::size_t c = 0; values.size() > 4 && c < 3; ++c)
        key.radiance[c] = static_cast<float>(values[values.size() == 7 ? 4 + c : 4]);
    if (const std::string wrong = complaint(key); !wrong.empty())
        return Error{ErrorCode::Invalid, wrong};
    return key;
}

Status setKeyLight(KeyLight& key, const std::string& name, const std::string& value)
{
    const std::vector<double> values = numbersIn(value);
    std::string known;
    for (const ParameterRange& range : keyRanges())
    {
        known += (known.empty() ? "" : ", ") + range.name;
        if (name != range.name)
            continue;
        const bool colour = name == "radiance";
        bool good = values.size() == 1 || (colour && values.size() == 3);
        for (double number : values)
            good = good && range.complaint(number).empty();
        if (!good)
            return refused(name, value,
                           (colour ? "one number or three, " : "a number, ") + rangeOf(range));
        for (std::size_t c = 0; colour && c < 3; ++c)
            key.radiance[c] = static_cast<float>(values[values.size() == 3 ? c : 0]);
        if (!colour)
            (name == "azimuth"  ? key.azimuth
             : name == "width"  ? key.width
             : name == "lowest" ? key.lowest
                                : key.highest) = values.front();
        return Nothing{};
    }
    return Error{ErrorCode::NotSupported, name + " = \"" + value +
                                              "\": a key light has no such setting; needs one of " +
                                              known};
}

std::string textOf(const std::vector<KeyLight>& keys)
{
    std::string text;
    for (const KeyLight& key : keys)
        text +=
            (text.empty() ? "" : ";") +
            numbersText({key.azimuth, key.width, key.lowest, key.highest,
                         static_cast<double>(key.radiance[0]), static_cast<double>(key.radiance[1]),
                         static_cast<double>(key.radiance[2])});
    return text;
}

std::string textOf(const std::vector<Rgb>& harmonics)
{
    std::vector<double> values;
    for (const Rgb& coefficient : harmonics)
        values.insert(values.end(), coefficient.begin(), coefficient.end());
    return numbersText(values);
}

std::string complaint(const KeyLight& key)
{
    const std::array<double, 4> places = {key.azimuth, key.width, key.lowest, key.highest};
    for (std::size_t i = 0; i < 7; ++i)
    {
        const double value = i < 4 ? places[i] : static_cast<double>(key.radiance[i - 4]);
        if (const std::string text = keyRanges()[std::min<std::size_t>(i, 4)].complaint(value);
            !text.empty())
            return "key light: " + text;
    }
    if (key.lowest < key.highest)
        return {};
    return "key light: lowest = " + numbersText({key.lowest}) +
           " degrees, highest = " + numbersText({key.highest}) + " degrees: needs lowest < highest";
}

std::string complaint(const SkyLight& sky)
{
    std::vector<std::string> found = {
        complaintOf("sun-azimuth", sky.sunAzimuth), complaintOf("sun-elevation", sky.sunElevation),
        complaintOf("sun-radius", sky.sunAngularRadius), complaintOf("turbidity", sky.turbidity),
        complaintOf("sky-gain", sky.environmentGain)};
    if (!std::isfinite(sky.environmentHeading))
        found.push_back("sky-heading: not finite");
    for (std::size_t i = 0; i < 3; ++i)
    {
        found.push_back(complaintOf("sun-irradiance", static_cast<double>(sky.sunIrradiance[i])));
        found.push_back(complaintOf("sky-radiance", static_cast<double>(sky.skyRadiance[i])));
    }
    for (const KeyLight& key : sky.keyLights)
        found.push_back(complaint(key));
    if (sky.keyLights.size() > maxKeyLights)
        found.push_back(tooMany(sky.keyLights.size()));
    const std::size_t count = sky.skyHarmonics.size();
    if (count != 0 && count != 1 && count != 4 && count != 9 && count != 16)
        found.push_back("sky harmonics: " + std::to_string(count) +
                        " coefficients: needs 1, 4, 9 or 16");
    for (const Rgb& coefficient : sky.skyHarmonics)
        if (!std::all_of(coefficient.begin(), coefficient.end(),
                         [](float channel) { return std::isfinite(channel); }))
            found.push_back("sky harmonics: a coefficient is not finite");
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
                                      complaintOf("bounce-interval", settings.bounceInterval),
                                      complaintOf("gloss", settings.gloss),
                                      complaintOf("gloss-exponent", settings.glossExponent),
                                      complaintOf("body-radius", settings.bodyRadius),
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
