#include "core/SettingRow.h"

#include "core/KeyLightText.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <locale>
#include <sstream>
#include <string_view>

namespace osgTerrainLight
{

namespace
{
using Kind = ValueForm::Kind;

constexpr const char* harmonicsForm = "1, 4, 9 or 16 coefficients, each one number or each three";

/// "a, b or c".
std::string listed(const std::vector<std::string>& names)
{
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
    return text;
}

std::string shortText(double value)
{
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << value;
    return text.str();
}

std::string kindText(Kind kind)
{
    return kind == Kind::Whole            ? "a whole number, "
           : kind == Kind::MultipleOfFour ? "a multiple of 4, "
           : kind == Kind::PowerOfTwo     ? "a power of 2, "
                                          : "";
}

std::string rangeText(const ValueForm& form)
{
    return (form.zeroToo ? "0, or " : "") + shortText(form.minimum) + " ... " +
           shortText(form.maximum);
}

bool isLegal(const ValueForm& form, double value)
{
    if (form.zeroToo && value == 0.0)
        return true;
    if (!(value >= form.minimum && value <= form.maximum)) // NaN, too
        return false;
    const bool isWhole = value == std::floor(value);
    switch (form.kind)
    {
    case Kind::Whole:
        return isWhole;
    case Kind::MultipleOfFour:
        return std::fmod(value, 4.0) == 0.0;
    case Kind::PowerOfTwo:
        return isWhole && (static_cast<long>(value) & (static_cast<long>(value) - 1)) == 0;
    default:
        return true;
    }
}

/// Three numbers per coefficient, whether the text has one or three.
std::vector<double> harmonicsOf(const std::vector<double>& values)
{
    for (const std::size_t coefficients : {1u, 4u, 9u, 16u})
        if (values.size() == 3 * coefficients)
            return values;
    std::vector<double> spread;
    for (const double value : values)
        spread.insert(spread.end(), 3, value);
    return spread;
}

std::string harmonicsComplaint(const SettingRow& row, const std::vector<double>& values)
{
    const std::size_t count = values.size() / 3;
    if (count != 0 && count != 1 && count != 4 && count != 9 && count != 16)
        return row.name + ": " + std::to_string(count) + " coefficients: needs 1, 4, 9 or 16";
    const bool finite = std::all_of(values.begin(), values.end(),
                                    [](double value) { return std::isfinite(value); });
    return finite ? "" : row.name + ": a coefficient is not finite";
}
} // namespace

std::vector<double> numbersIn(const std::string& text)
{
    std::vector<double> values;
    const char* const separators = " \t\r\n,";
    for (std::size_t at = text.find_first_not_of(separators); at != std::string::npos;
         at = text.find_first_not_of(separators, at))
    {
        const std::size_t end = std::min(text.find_first_of(separators, at), text.size());
        std::string_view word(text.data() + at, end - at);
        if (word.size() > 1 && word.front() == '+' && word[1] != '-')
            word.remove_prefix(1);
        double value = 0.0;
        const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || stop != word.data() + word.size() || !std::isfinite(value))
            return {};
        values.push_back(value);
        at = end;
    }
    return values;
}

std::string numberText(double value)
{
    std::array<char, 32> digits{};
    const float single = static_cast<float>(value);
    const auto end = static_cast<double>(single) == value
                         ? std::to_chars(digits.begin(), digits.end(), single).ptr
                         : std::to_chars(digits.begin(), digits.end(), value).ptr;
    return {digits.begin(), end};
}

Error refused(const std::string& name, const std::string& value, const std::string& needed)
{
    return {ErrorCode::Invalid, name + " = \"" + value + "\": needs " + needed};
}

std::string SettingRow::key() const
{
    std::string key = name;
    std::replace(key.begin(), key.end(), '-', '_');
    return key;
}

std::string SettingRow::needs() const
{
    switch (form.kind)
    {
    case Kind::Name:
        return listed(form.names);
    case Kind::Harmonics:
        return harmonicsForm;
    case Kind::KeyLights:
        return keyLightForm;
    default:
        break;
    }
    const std::string kind = form.count == 3           ? "one number or three, "
                             : form.kind == Kind::Real ? "a number, "
                                                       : kindText(form.kind);
    return kind + rangeText(form) + (form.unit.empty() ? "" : " ") + form.unit;
}

Result<SettingValue> SettingRow::read(const std::string& given, const std::string& called) const
{
    if (form.kind == Kind::Name)
    {
        if (std::find(form.names.begin(), form.names.end(), given) == form.names.end())
            return refused(called, given, needs());
        return SettingValue(given);
    }
    if (form.kind == Kind::KeyLights)
    {
        const Result<std::vector<double>> keys = readKeyLights(given);
        if (!keys)
            return Error{keys.error().code, called + ": " + keys.error().message};
        return SettingValue(*keys);
    }
    std::vector<double> values = numbersIn(given);
    if (form.kind == Kind::Harmonics)
    {
        const std::vector<double> harmonics = harmonicsOf(values);
        const bool nothing = given.find_first_not_of(" ") == std::string::npos;
        if ((values.empty() && !nothing) || !harmonicsComplaint(*this, harmonics).empty())
            return refused(called, given,
                           needs() + "; these are " + std::to_string(values.size()) + " numbers");
        return SettingValue(harmonics);
    }
    bool good = values.size() == 1 || (form.count == 3 && values.size() == 3);
    for (const double value : values)
        good = good && isLegal(form, value);
    if (!good)
        return refused(called, given, needs());
    if (values.size() < form.count)
        values.assign(form.count, values.front());
    return SettingValue(values);
}

std::string SettingRow::complaint(double value) const
{
    if (isLegal(form, value))
        return {};
    return name + " = " + shortText(value) + (form.unit.empty() ? "" : " ") + form.unit +
           ": needs " + kindText(form.kind) + rangeText(form);
}

std::string SettingRow::complaint(const SettingValue& value) const
{
    if (const auto* chosen = std::get_if<std::string>(&value))
        return std::find(form.names.begin(), form.names.end(), *chosen) != form.names.end()
                   ? ""
                   : refused(name, *chosen, needs()).message;
    const auto& values = std::get<std::vector<double>>(value);
    if (form.kind == Kind::Harmonics)
        return harmonicsComplaint(*this, values);
    if (form.kind == Kind::KeyLights)
        return keyLightsComplaint(values);
    for (const double number : values)
        if (const std::string wrong = complaint(number); !wrong.empty())
            return wrong;
    return {};
}

std::string SettingRow::text(const SettingValue& value) const
{
    if (const auto* chosen = std::get_if<std::string>(&value))
        return *chosen;
    const auto& values = std::get<std::vector<double>>(value);
    std::string result;
    for (std::size_t i = 0; i < values.size(); ++i)
        result += (i == 0                                                        ? ""
                   : form.kind == Kind::KeyLights && i % numbersPerKeyLight == 0 ? ";"
                                                                                 : ",") +
                  numberText(values[i]);
    return result;
}

} // namespace osgTerrainLight
