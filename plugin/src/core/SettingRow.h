#pragma once

#include "core/Result.h"

#include <string>
#include <variant>
#include <vector>

namespace osgTerrainLight
{

/// The value of a setting: numbers, or one of the names that its row has.
using SettingValue = std::variant<std::vector<double>, std::string>;

/// Which values a setting takes.
struct ValueForm
{
    enum class Kind
    {
        Real,
        Whole,
        MultipleOfFour,
        PowerOfTwo,
        Name,      ///< one of `names`
        Harmonics, ///< 1, 4, 9 or 16 coefficients, three numbers each; none: no harmonics
        KeyLights  ///< seven numbers per key light
    };
    Kind kind = Kind::Real;
    double minimum = 0.0, maximum = 0.0; ///< of each number
    std::string unit;
    std::size_t count = 1; ///< of numbers; 3: one alone stands for all three
    bool zeroToo = false;  ///< 0 is legal, too, below the minimum
    std::vector<std::string> names;
};

/// What must be computed anew where a setting changes: a set of these.
enum class Invalidation : unsigned
{
    Nothing = 0,
    Display = 1u << 0,   ///< what host shaders are told: no light is computed
    Heights = 1u << 1,   ///< the shape of the ground
    Horizons = 1u << 2,  ///< all horizons, and what is made from them
    Method = 1u << 3,    ///< everything: light is computed in another way
    Transport = 1u << 4, ///< which work light needs between slopes
    Pace = 1u << 5,      ///< in which updates bounces are computed
    Albedo = 1u << 6,
    Gloss = 1u << 7,         ///< of the ground
    GlossTransfer = 1u << 8, ///< which work light needs between glossy slopes
    SunPlace = 1u << 9,      ///< horizons towards the sun
    SkyShape = 1u << 10,     ///< what the sky sends from where, but for a clear sky's sun
    Keys = 1u << 11,         ///< key lights
    Light = 1u << 12         ///< anything of a light
};

constexpr Invalidation operator|(Invalidation a, Invalidation b)
{
    return static_cast<Invalidation>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
/// Whether two sets have anything in common.
constexpr bool meets(Invalidation a, Invalidation b)
{
    return (static_cast<unsigned>(a) & static_cast<unsigned>(b)) != 0;
}

/// What a setting is about: modes of the tool take the options of some topics.
enum class Topic
{
    Horizons,
    Planet,
    Bounces,
    Gloss,
    Picture,
    Screen, ///< how it is drawn: no raster shows it
    Sun,
    Sky,
    KeyLights,
    Budget
};

/// One row of the table of settings, without the place of its value.
struct SettingRow
{
    /// Words joined by '-': the tool's option is --NAME, a map's key has '_' instead.
    std::string name;
    ValueForm form;
    Topic topic = Topic::Horizons;
    Invalidation invalidates = Invalidation::Nothing;
    /// One whole sentence: what the setting changes in the result.
    std::string meaning;
    bool isKey = true;    ///< of <terrain_light> and of the reader's options
    bool isOption = true; ///< of the tool

    /// The name with '_' for '-'.
    std::string key() const;
    /// Legal values, for messages: "a multiple of 4, 4 ... 256".
    std::string needs() const;
    /// A value from text. Numbers are separated by blanks or commas, key lights by semicolons. The
    /// message names the value, and the setting as `called`, and what is needed.
    Result<SettingValue> read(const std::string& text, const std::string& called) const;
    /// Empty where the value is legal; else a sentence that names setting, value and what it needs.
    std::string complaint(const SettingValue& value) const;
    std::string complaint(double value) const;
    /// What read() takes and gives the same value for: without blanks, every digit that counts.
    std::string text(const SettingValue& value) const;
};

/// Finite numbers of a text, separated by blanks or commas; empty where it holds anything else.
std::vector<double> numbersIn(const std::string& text);
/// The shortest digits that read back as the same number; of a float, as the same float.
std::string numberText(double value);

/// "KEY = "VALUE": needs NEEDED".
Error refused(const std::string& name, const std::string& value, const std::string& needed);

} // namespace osgTerrainLight
