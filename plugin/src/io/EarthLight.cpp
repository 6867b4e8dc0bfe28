#include "io/EarthLight.h"

#include "io/EarthXml.h"

#include <charconv>
#include <chrono>
#include <ratio>

namespace osgTerrainLight
{
namespace
{
Status readKeyLight(const EarthXml& xml, const pugi::xml_node& element, LightParameters& light)
{
    KeyLight key;
    for (const pugi::xml_attribute& attribute : element.attributes())
        if (Status set = setKeyLight(key, lowerCase(attribute.name()), attribute.value()); !set)
            return xml.error(xml.lineOf(element, attribute.name()),
                             "<key_light> " + set.error().message);
    for (const pugi::xml_node& child : element.children())
    {
        if (child.type() != pugi::node_element)
            continue;
        if (Status set = setKeyLight(key, lowerCase(child.name()), trimmed(child.text().get()));
            !set)
            return xml.error(xml.lineOf(child), "<key_light> " + set.error().message);
    }
    light.sky.keyLights.push_back(key);
    if (const std::string wrong = complaint(light.sky); !wrong.empty())
        return xml.error(xml.lineOf(element), "<key_light> " + wrong);
    return Nothing{};
}
} // namespace

Status readTerrainLight(const EarthXml& xml, const pugi::xml_node& element, LightParameters& light)
{
    for (const pugi::xml_attribute& attribute : element.attributes())
    {
        Status set = setLightParameter(light, lowerCase(attribute.name()), attribute.value());
        if (!set)
            return xml.error(xml.lineOf(element, attribute.name()),
                             "<terrain_light> " + set.error().message);
    }
    for (const pugi::xml_node& child : element.children())
    {
        if (child.type() != pugi::node_element)
            continue;
        const bool key = lowerCase(child.name()) == "key_light";
        if (Status read = key ? readKeyLight(xml, child, light) : Status(Nothing{}); !read)
            return read;
        if (key)
            continue;
        Status set = setLightParameter(light, lowerCase(child.name()), trimmed(child.text().get()));
        if (!set)
            return xml.error(xml.lineOf(child), "<terrain_light> " + set.error().message);
    }
    return Nothing{};
}

Result<std::optional<UtcTime>> readSkyTime(const pugi::xml_node& element)
{
    using Days = std::chrono::duration<int, std::ratio<86400>>;
    using Hours = std::chrono::duration<double, std::ratio<3600>>;
    const std::string hours = valueOf(element, "hours");
    const std::string date = valueOf(element, "date_time");
    if (hours.empty() && date.empty())
        return std::optional<UtcTime>();
    UtcTime time = std::chrono::floor<UtcTime::duration>(std::chrono::system_clock::now());
    constexpr std::size_t lengthOfDay = 10; // YYYY-MM-DD
    if (!date.empty())
        if (const std::string wrong =
                readUtcTime(date + (date.size() == lengthOfDay ? "T00:00" : ""), time);
            !wrong.empty())
            return Error{ErrorCode::Invalid, "date_time = " + wrong};
    if (hours.empty())
        return std::optional(time);
    double hour = 0.0;
    const char* end = hours.data() + hours.size();
    const auto [stop, failed] = std::from_chars(hours.data(), end, hour);
    if (failed != std::errc() || stop != end || !(hour >= 0.0 && hour <= 24.0))
        return Error{ErrorCode::Invalid,
                     "hours = \"" + hours + "\": needs a number of hours of UTC, 0 ... 24"};
    return std::optional<UtcTime>(std::chrono::floor<Days>(time) +
                                  std::chrono::round<UtcTime::duration>(Hours(hour)));
}

} // namespace osgTerrainLight
