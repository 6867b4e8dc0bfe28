#include "io/EarthXml.h"

#include <algorithm>

namespace osgTerrainLight
{

int EarthXml::lineAt(std::size_t offset) const
{
    const std::size_t end = std::min(offset, _text.size());
    return 1 + static_cast<int>(std::count(_text.begin(),
                                           _text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
}

int EarthXml::lineOf(const pugi::xml_node& node) const
{
    return lineAt(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, node.offset_debug())));
}

int EarthXml::lineOf(const pugi::xml_node& node, const std::string& attribute) const
{
    const std::size_t start = static_cast<std::size_t>(node.offset_debug());
    const std::size_t found = _text.find(attribute, start + std::string(node.name()).size());
    return lineAt(std::min(found, _text.size()));
}

Error EarthXml::error(int line, const std::string& sentence) const
{
    return {ErrorCode::Invalid, _source + ":" + std::to_string(line) + ": " + sentence};
}

std::string lowerCase(std::string text)
{
    for (char& c : text)
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return text;
}

std::string trimmed(const std::string& text)
{
    const char* blanks = " \t\r\n";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string::npos)
        return {};
    return text.substr(first, text.find_last_not_of(blanks) + 1 - first);
}

std::string valueOf(const pugi::xml_node& element, const std::string& key)
{
    for (const pugi::xml_attribute& attribute : element.attributes())
        if (const std::string value = trimmed(attribute.value());
            lowerCase(attribute.name()) == key && !value.empty())
            return value;
    for (const pugi::xml_node& child : element.children())
        if (const std::string value = trimmed(child.text().get());
            lowerCase(child.name()) == key && !value.empty())
            return value;
    return {};
}

std::vector<std::string> keysOf(const pugi::xml_node& element)
{
    std::vector<std::string> keys;
    for (const pugi::xml_attribute& attribute : element.attributes())
        keys.emplace_back(attribute.name());
    for (const pugi::xml_node& child : element.children())
        if (child.type() == pugi::node_element)
            keys.emplace_back(child.name());
    return keys;
}

std::string withSlashes(std::string path)
{
    std::replace(path.begin(), path.end(), '\\', '/');
    return path;
}

void append(std::string& list, const std::string& item)
{
    list += (list.empty() ? "" : ", ") + item;
}

} // namespace osgTerrainLight
