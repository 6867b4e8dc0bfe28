#include "io/EarthLayers.h"

#include "core/SettingRow.h"
#include "io/EarthXml.h"

#include <charconv>

namespace osgTerrainLight
{
namespace
{
/// As osgEarth reads a flag: these words, in any case, are no; the rest leaves the layer in.
bool isNo(const std::string& value)
{
    const std::string word = lowerCase(value);
    return word == "false" || word == "no" || word == "off";
}
} // namespace

std::optional<LayerKind> layerKindOf(const pugi::xml_node& element)
{
    const std::string tag = lowerCase(element.name());
    const std::string driver = lowerCase(valueOf(element, "driver"));
    if (tag == "heightfield")
        return LayerKind{true, driver};
    for (const std::string held : {"elevation", "image"})
        if (tag.size() >= held.size() &&
            tag.compare(tag.size() - held.size(), held.size(), held) == 0)
            return LayerKind{held == "elevation",
                             tag == held ? driver : tag.substr(0, tag.size() - held.size())};
    return std::nullopt;
}

std::string switchOf(const pugi::xml_node& layer)
{
    for (const char* key : {"open", "enabled", "visible"})
        if (isNo(valueOf(layer, key)))
            return std::string(key) + " is " + valueOf(layer, key);
    return {};
}

std::vector<pugi::xml_node> partsOf(const pugi::xml_node& composite)
{
    std::vector<pugi::xml_node> parts;
    for (const pugi::xml_node& child : composite.children())
        if (lowerCase(child.name()) != "layers")
        {
            if (layerKindOf(child))
                parts.push_back(child);
        }
        else
            for (const pugi::xml_node& layer : child.children())
                if (layer.type() == pugi::node_element)
                    parts.push_back(layer);
    return parts;
}

Result<double> opacityOf(const pugi::xml_node& image)
{
    const std::string text = valueOf(image, "opacity");
    if (text.empty())
        return 1.0;
    double opacity = 0.0;
    const char* end = text.data() + text.size();
    const auto [stop, failed] = std::from_chars(text.data(), end, opacity);
    if (failed != std::errc() || stop != end || !(opacity >= 0.0 && opacity <= 1.0))
        return refused("opacity", text, "a number, 0 ... 1");
    return opacity;
}

bool isYes(const std::string& value)
{
    const std::string word = lowerCase(value);
    return word == "true" || word == "yes" || word == "on";
}

std::string datumName(const std::string& text)
{
    return text.find('.') == std::string::npos ? lowerCase(text) : withSlashes(text);
}

std::string verticalDatumOf(const pugi::xml_node& elevation)
{
    const std::string own = valueOf(elevation, "vdatum");
    if (!own.empty())
        return datumName(own);
    for (const pugi::xml_node& child : elevation.children())
        if (lowerCase(child.name()) == "profile")
            return datumName(valueOf(child, "vdatum"));
    return {};
}

} // namespace osgTerrainLight
