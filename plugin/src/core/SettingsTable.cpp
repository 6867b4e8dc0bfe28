#include "core/SettingsTable.h"

#include "core/EnumNames.h"
#include "core/KeyLightText.h"

#include <algorithm>
#include <type_traits>

namespace osgTerrainLight
{

namespace
{
using Kind = ValueForm::Kind;
using Numbers = std::vector<double>;

// Members as values, and back.

SettingValue toValue(double number)
{
    return Numbers{number};
}
SettingValue toValue(int number)
{
    return Numbers{static_cast<double>(number)};
}
SettingValue toValue(const Rgb& colour)
{
    return Numbers(colour.begin(), colour.end());
}
SettingValue toValue(const std::array<double, 3>& vector)
{
    return Numbers(vector.begin(), vector.end());
}
SettingValue toValue(const std::vector<Rgb>& colours)
{
    Numbers numbers;
    for (const Rgb& colour : colours)
        numbers.insert(numbers.end(), colour.begin(), colour.end());
    return numbers;
}
SettingValue toValue(const std::vector<KeyLight>& keys)
{
    Numbers numbers;
    for (const KeyLight& key : keys)
    {
        const Numbers one = numbersOf(key);
        numbers.insert(numbers.end(), one.begin(), one.end());
    }
    return numbers;
}

void assign(double& target, const Numbers& numbers)
{
    target = numbers.front();
}
void assign(int& target, const Numbers& numbers)
{
    target = static_cast<int>(numbers.front());
}
template <class Number>
void assign(std::array<Number, 3>& target, const Numbers& numbers)
{
    for (std::size_t i = 0; i < 3; ++i)
        target[i] = static_cast<Number>(numbers[i]);
}
void assign(std::vector<Rgb>& target, const Numbers& numbers)
{
    target.assign(numbers.size() / 3, {});
    for (std::size_t i = 0; i < numbers.size(); ++i)
        target[i / 3][i % 3] = static_cast<float>(numbers[i]);
}
void assign(std::vector<KeyLight>& target, const Numbers& numbers)
{
    target.clear();
    for (std::size_t i = 0; i + numbersPerKeyLight <= numbers.size(); i += numbersPerKeyLight)
        target.push_back(keyLightOf(&numbers[i]));
}

template <class Value>
constexpr bool isNamed = std::is_enum_v<Value> || std::is_same_v<Value, bool>;

/// The names of an enumeration, or of a switch.
template <class Enum>
ValueForm oneOf()
{
    ValueForm form;
    form.kind = Kind::Name;
    form.names.assign(EnumNames<Enum>::names.begin(), EnumNames<Enum>::names.end());
    return form;
}

ValueForm real(double minimum, double maximum, const char* unit = "")
{
    return {Kind::Real, minimum, maximum, unit, 1, false, {}};
}
ValueForm whole(double minimum, double maximum, Kind kind = Kind::Whole)
{
    return {kind, minimum, maximum, "", 1, false, {}};
}
ValueForm three(double minimum, double maximum)
{
    return {Kind::Real, minimum, maximum, "", 3, false, {}};
}
ValueForm zeroOr(double minimum, double maximum, const char* unit)
{
    return {Kind::Real, minimum, maximum, unit, 1, true, {}};
}
ValueForm list(Kind kind)
{
    return {kind, 0.0, 0.0, "", 0, false, {}};
}

/// Where else than in code a setting can be set by its name: a map's key and a reader option, the
/// tool's option, both, or neither (saved scenes have all).
enum class By
{
    Both,
    Key,
    Code
};

template <class Owner, class Value>
Setting<Owner> row(const char* name, Value Owner::*member, const ValueForm& form, Topic topic,
                   Invalidation invalidates, const char* meaning, By by = By::Both)
{
    Setting<Owner> setting;
    setting.name = name;
    setting.form = form;
    setting.topic = topic;
    setting.invalidates = invalidates;
    setting.meaning = meaning;
    setting.isKey = by != By::Code;
    setting.isOption = by == By::Both;
    setting.get = [member](const Owner& owner)
    {
        if constexpr (isNamed<Value>)
            return SettingValue(std::string(nameOf(owner.*member)));
        else
            return toValue(owner.*member);
    };
    setting.set = [member](Owner& owner, const SettingValue& value)
    {
        if constexpr (isNamed<Value>)
            readName(std::get<std::string>(value), owner.*member);
        else
            assign(owner.*member, std::get<Numbers>(value));
    };
    setting.same = [member](const Owner& a, const Owner& b) { return a.*member == b.*member; };
    return setting;
}

template <class Owner>
bool sameSettings(const Owner& a, const Owner& b)
{
    const auto& all = settingsOf<Owner>();
    return std::all_of(all.begin(), all.end(),
                       [&](const Setting<Owner>& setting) { return setting.same(a, b); });
}

template <class Owner>
Invalidation changedIn(const Owner& a, const Owner& b)
{
    Invalidation result = Invalidation::Nothing;
    for (const Setting<Owner>& setting : settingsOf<Owner>())
        if (!setting.same(a, b))
            result = result | setting.invalidates;
    return result;
}

template <class Owner>
std::string firstComplaint(const Owner& owner)
{
    for (const Setting<Owner>& setting : settingsOf<Owner>())
        if (const std::string wrong = setting.complaint(setting.get(owner)); !wrong.empty())
            return wrong;
    return {};
}
} // namespace

template <>
const std::vector<Setting<LightingSettings>>& settingsOf()
{
    using S = LightingSettings;
    using I = Invalidation;
    static const std::vector<Setting<S>> table = {
        row("azimuths", &S::azimuths, whole(4, 256, Kind::MultipleOfFour), Topic::Horizons,
            I::Horizons, "Number of azimuths in which horizons are computed."),
        row("quality", &S::quality, oneOf<HorizonQuality>(), Topic::Horizons, I::Horizons,
            "Trades speed for the error of horizons."),
        row("body-radius", &S::bodyRadius, zeroOr(1e3, 1e12, "m"), Topic::Planet,
            I::Heights | I::Horizons,
            "Radius of the planet. Distant terrain is lowered by its curvature; 0 is a flat world. "
            "Earth: 6371000, or 7323000 to include the refraction of its air."),
        row("bounces", &S::bounces, whole(0, 8), Topic::Bounces, I::Transport,
            "Number of bounces of diffuse light between slopes."),
        row("bounce-method", &S::bounceMethod, oneOf<BounceMethod>(), Topic::Bounces, I::Method,
            "How bounces are computed. The two Legendre methods compute direct light, too "
            "(Nowrouzezahrai and Snyder 2009)."),
        row("subsampling", &S::subsampling, whole(1, 4, Kind::PowerOfTwo), Topic::Bounces,
            I::Transport,
            "The Legendre methods compute light at every N-th post only. The default method "
            "does not use it."),
        row("bounce-interval", &S::bounceInterval, whole(1, 16), Topic::Bounces, I::Pace,
            "While only light changes, bounces are computed in every N-th update. The result is "
            "exact as soon as the light stands still.",
            By::Key),
        row("albedo", &S::albedo, three(0, 1), Topic::Bounces, I::Albedo,
            "Part of the light that the ground reflects, where a tile has no colours of its own."),
        row("gloss", &S::gloss, real(0, 1), Topic::Gloss, I::Gloss,
            "Part of the light that the ground mirrors, besides its albedo."),
        row("gloss-exponent", &S::glossExponent, real(1, 64), Topic::Gloss, I::Gloss,
            "Sharpness of the mirrored light: the exponent of the Phong lobe."),
        row("gloss-transfer", &S::glossTransfer, oneOf<GlossTransfer>(), Topic::Gloss,
            I::GlossTransfer,
            "How mirrored light reaches other slopes: for all directions, or as one viewer would "
            "see it."),
        row("gloss-viewer", &S::glossViewer, {Kind::Real, -1e15, 1e15, "", 3, false, {}},
            Topic::Gloss, I::GlossTransfer,
            "Direction of that viewer for gloss-transfer scalar: east, north, up.", By::Code),
        row("shadow-edges", &S::shadowEdges, oneOf<bool>(), Topic::Screen, I::Transport,
            "Whether the edge of the sun's shadow is drawn between posts: crisp near the crest "
            "that casts it, soft far away."),
        row("object-cones", &S::objectCones, whole(4, 32), Topic::Screen, I::Transport,
            "Cones by which the light among placed objects is gathered: more err less and take "
            "longer."),
        row("exposure", &S::exposure, real(-20, 20, "stops"), Topic::Picture, I::Display,
            "Brightness of the picture: colours are multiplied by 2 to this power."),
    };
    return table;
}

template <>
const std::vector<Setting<SkyLight>>& settingsOf()
{
    using S = SkyLight;
    using I = Invalidation;
    static const std::vector<Setting<S>> table = {
        row("sun-azimuth", &S::sunAzimuth, real(-360, 720, "degrees"), Topic::Sun,
            I::SunPlace | I::Light, "Azimuth of the sun, clockwise from north.", By::Key),
        row("sun-elevation", &S::sunElevation, real(-90, 90, "degrees"), Topic::Sun,
            I::SunPlace | I::Light, "Elevation of the sun above the horizontal.", By::Key),
        row("sun-radius", &S::sunAngularRadius, real(0.01, 10, "degrees"), Topic::Sun,
            I::SunPlace | I::Light, "Angular radius of the sun's disc."),
        row("sun-irradiance", &S::sunIrradiance, three(0, 1e6), Topic::Sun, I::Light,
            "Irradiance on a surface that faces the sun; with a clear sky, outside the air."),
        row("sun-enabled", &S::sunEnabled, oneOf<bool>(), Topic::Sun, I::Light,
            "Whether the sun shines.", By::Code),
        row("sky-radiance", &S::skyRadiance, three(0, 1e6), Topic::Sky, I::SkyShape | I::Light,
            "Radiance of the uniform sky, or of the overcast sky at the zenith."),
        row("turbidity", &S::turbidity, real(2, 10), Topic::Sky, I::SkyShape | I::Light,
            "Turbidity of the air of a clear sky: 2 is clear, 10 is haze."),
        row("sky-heading", &S::environmentHeading, real(-360, 720, "degrees"), Topic::Sky,
            I::SkyShape | I::Light,
            "Turns a sky that comes from a file clockwise, together with its sun."),
        row("sky-gain", &S::environmentGain, real(0, 1e6), Topic::Sky, I::SkyShape | I::Light,
            "Factor for the radiance of a sky that comes from a file."),
        row("sky-model", &S::skyModel, oneOf<SkyModel>(), Topic::Sky, I::SkyShape | I::Light,
            "How the light of a sky without file and harmonics is distributed.", By::Code),
        row("sky-enabled", &S::skyEnabled, oneOf<bool>(), Topic::Sky, I::Light,
            "Whether the sky gives light.", By::Code),
        row("sky-harmonics", &S::skyHarmonics, list(Kind::Harmonics), Topic::Sky,
            I::SkyShape | I::Light,
            "Radiance of the sky in real spherical harmonics, instead of a sky model."),
        row("key-lights", &S::keyLights, list(Kind::KeyLights), Topic::KeyLights,
            I::Keys | I::Light, "Area lights at infinity, up to eight.", By::Key),
    };
    return table;
}

template <>
const std::vector<Setting<KeyLight>>& settingsOf()
{
    using K = KeyLight;
    const Invalidation keys = Invalidation::Keys | Invalidation::Light;
    static const std::vector<Setting<K>> table = {
        row("azimuth", &K::azimuth, real(-360, 720, "degrees"), Topic::KeyLights, keys,
            "Azimuth of the middle, clockwise from north."),
        row("width", &K::width, real(0.1, 360, "degrees"), Topic::KeyLights, keys,
            "Extent in azimuth."),
        row("lowest", &K::lowest, real(-90, 90, "degrees"), Topic::KeyLights, keys,
            "Elevation of the lower edge above the horizontal."),
        row("highest", &K::highest, real(-90, 90, "degrees"), Topic::KeyLights, keys,
            "Elevation of the upper edge above the horizontal."),
        row("radiance", &K::radiance, three(0, 1e6), Topic::KeyLights, keys,
            "Radiance of the light."),
    };
    return table;
}

const std::vector<SettingRow>& budgetRows()
{
    static const std::vector<SettingRow> table = {
        {"max-error", real(1e-5, 1), Topic::Budget, Invalidation::Nothing,
         "Takes the cheapest settings whose error is measured to be at most this on the terrain: "
         "relative, root mean square.",
         false, true},
        {"max-ms", real(0.01, 1e6, "ms"), Topic::Budget, Invalidation::Nothing,
         "Takes the most exact settings that light the whole tile within this GPU time.", false,
         true},
    };
    return table;
}

Invalidation changed(const LightingSettings& a, const LightingSettings& b)
{
    return changedIn(a, b);
}

Invalidation changed(const SkyLight& a, const SkyLight& b)
{
    const Invalidation environment = a.environment == b.environment
                                         ? Invalidation::Nothing
                                         : Invalidation::SkyShape | Invalidation::Light;
    return changedIn(a, b) | environment;
}

bool operator==(const LightingSettings& a, const LightingSettings& b)
{
    return sameSettings(a, b);
}

bool operator==(const SkyLight& a, const SkyLight& b)
{
    return a.environment == b.environment && sameSettings(a, b);
}

bool operator==(const KeyLight& a, const KeyLight& b)
{
    return sameSettings(a, b);
}

std::string complaint(const SkyLight& sky)
{
    return firstComplaint(sky);
}

std::string complaint(const LightingSettings& settings)
{
    if (const std::string wrong = firstComplaint(settings); !wrong.empty())
        return wrong;
    const auto& v = settings.glossViewer;
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2] > 0.0
               ? ""
               : "gloss-viewer: needs a direction, not of length 0";
}

} // namespace osgTerrainLight
