#include "io/EarthLight.h"

#include "io/EarthXml.h"

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

} // namespace osgTerrainLight
