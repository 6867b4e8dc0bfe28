#include "core/KeyLightText.h"

#include "core/KeySlices.h"
#include "core/SettingsTable.h"

#include <sstream>

namespace osgTerrainLight
{

namespace
{
std::string tooMany(std::size_t count)
{
    return std::to_string(count) + " key lights: needs at most " + std::to_string(maxKeyLights);
}
} // namespace

std::vector<double> numbersOf(const KeyLight& key)
{
    return {key.azimuth,
            key.width,
            key.lowest,
            key.highest,
            static_cast<double>(key.radiance[0]),
            static_cast<double>(key.radiance[1]),
            static_cast<double>(key.radiance[2])};
}

KeyLight keyLightOf(const double* numbers)
{
    KeyLight key;
    key.azimuth = numbers[0];
    key.width = numbers[1];
    key.lowest = numbers[2];
    key.highest = numbers[3];
    for (std::size_t c = 0; c < 3; ++c)
        key.radiance[c] = static_cast<float>(numbers[4 + c]);
    return key;
}

Result<KeyLight> readKeyLight(const std::string& text)
{
    std::vector<double> values = numbersIn(text);
    if (values.size() != 4 && values.size() != 5 && values.size() != numbersPerKeyLight)
        return refused("key light", text, keyLightForm);
    const double radiance = values.size() == 5 ? values[4] : 1.0;
    values.resize(numbersPerKeyLight, radiance);
    const KeyLight key = keyLightOf(values.data());
    if (const std::string wrong = complaint(key); !wrong.empty())
        return Error{ErrorCode::Invalid, wrong};
    return key;
}

Result<std::vector<double>> readKeyLights(const std::string& text)
{
    std::vector<double> numbers;
    std::istringstream list(text);
    for (std::string one; std::getline(list, one, ';');)
    {
        const Result<KeyLight> key = readKeyLight(one);
        if (!key)
            return key.error();
        const std::vector<double> of = numbersOf(*key);
        numbers.insert(numbers.end(), of.begin(), of.end());
    }
    if (const std::string wrong = keyLightsComplaint(numbers); !wrong.empty())
        return Error{ErrorCode::Invalid, wrong};
    return numbers;
}

std::string keyLightsComplaint(const std::vector<double>& numbers)
{
    if (numbers.size() > maxKeyLights * numbersPerKeyLight)
        return tooMany(numbers.size() / numbersPerKeyLight);
    for (std::size_t i = 0; i + numbersPerKeyLight <= numbers.size(); i += numbersPerKeyLight)
        if (const std::string wrong = complaint(keyLightOf(&numbers[i])); !wrong.empty())
            return wrong;
    return {};
}

std::string complaint(const KeyLight& key)
{
    for (const Setting<KeyLight>& setting : settingsOf<KeyLight>())
        if (const std::string wrong = setting.complaint(setting.get(key)); !wrong.empty())
            return "key light: " + wrong;
    if (key.lowest < key.highest)
        return {};
    return "key light: lowest = " + numberText(key.lowest) +
           " degrees, highest = " + numberText(key.highest) + " degrees: needs lowest < highest";
}

} // namespace osgTerrainLight
