#include "io/ExrLayers.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <set>
#include <utility>

namespace osgTerrainLight
{

namespace
{
std::string lower(std::string text)
{
    for (char& c : text)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

/// The parts between full stops, in lower case.
std::vector<std::string> partsOf(const std::string& prefix)
{
    std::vector<std::string> parts;
    for (std::size_t start = 0; start < prefix.size();)
    {
        const std::size_t end = prefix.find('.', start);
        parts.push_back(lower(prefix.substr(start, end - start)));
        start = end == std::string::npos ? prefix.size() : end + 1;
    }
    return parts;
}

bool isWholePicture(const std::string& name)
{
    static const std::set<std::string> names = {"combined", "beauty",    "rgba",  "rgb",  "color",
                                                "colour",   "composite", "final", "main", "image"};
    return names.count(name) != 0;
}
} // namespace

namespace
{
bool endsWith(const std::string& text, const std::string& end)
{
    return text.size() >= end.size() &&
           text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// Colours of surfaces, by which light is multiplied: albedo, DiffCol, diffuse_color,
/// VRayDiffuseFilter. word: lower case, without blanks, hyphens and underscores.
bool isSurfaceColour(const std::string& word)
{
    if (word.find("albedo") != std::string::npos || word.find("reflectance") != std::string::npos ||
        endsWith(word, "filter"))
        return true;
    static const char* const surfaces[] = {"base",   "diff",    "gloss",      "spec",  "trans",
                                           "reflec", "refrac",  "subsurface", "sheen", "coat",
                                           "object", "surface", "material",   "vertex"};
    const bool isColour =
        endsWith(word, "col") || endsWith(word, "color") || endsWith(word, "colour");
    return isColour && std::any_of(std::begin(surfaces), std::end(surfaces),
                                   [&](const char* surface)
                                   { return word.find(surface) != std::string::npos; });
}
} // namespace

bool isNoLight(const ExrLayer& layer)
{
    static const char* const starts[] = {"crypto", "normal",   "position", "depth", "motion",
                                         "vector", "velocity", "uv",       "mask",  "index"};
    static const std::set<std::string> names = {"ao", "id", "mist", "n", "occlusion", "p", "st"};
    for (std::string part : partsOf(layer.name))
    {
        part.erase(std::remove_if(part.begin(), part.end(),
                                  [](char c) { return c == ' ' || c == '-' || c == '_'; }),
                   part.end());
        if (names.count(part) != 0 || isSurfaceColour(part))
            return true;
        for (const char* start : starts)
            if (part.rfind(start, 0) == 0)
                return true;
    }
    return false;
}

namespace
{
void addLayers(std::vector<ExrLayer>& layers, std::size_t number, const ExrPart& part)
{
    const std::set<std::string> names(part.channels.begin(), part.channels.end());
    std::set<std::string> prefixes;
    for (const std::string& name : names)
    {
        const std::size_t stop = name.rfind('.');
        prefixes.insert(stop == std::string::npos ? "" : name.substr(0, stop + 1));
    }
    const auto has = [&](const std::string& name) { return names.count(name) != 0; };
    for (const std::string& prefix : prefixes)
    {
        const std::string name = part.name + (part.name.empty() ? "" : ".") + prefix;
        if (has(prefix + "R") && has(prefix + "G") && has(prefix + "B"))
            layers.push_back({number, prefix, name, LayerKind::Colours});
        else if (has(prefix + "Y") && !has(prefix + "X") && !has(prefix + "Z"))
            layers.push_back({number, prefix, name,
                              has(prefix + "RY") && has(prefix + "BY") ? LayerKind::LuminanceChroma
                                                                       : LayerKind::Luminance});
    }
}

/// Less is better: of what kind the layer's name is, and of which view.
std::pair<int, std::size_t> rankOf(const ExrLayer& layer, const std::vector<std::string>& views)
{
    std::vector<std::string> parts = partsOf(layer.name);
    std::size_t view = 0; // channels of the first view need not name it
    for (std::size_t i = 0; i < views.size(); ++i)
        if (const auto found = std::find(parts.begin(), parts.end(), lower(views[i]));
            found != parts.end())
        {
            view = i;
            parts.erase(found);
            break;
        }
    const int kind = isNoLight(layer)               ? 3
                     : parts.empty()                ? 0
                     : isWholePicture(parts.back()) ? 1
                                                    : 2;
    return {kind, view};
}
} // namespace

std::vector<ExrLayer> lightLayers(const std::vector<ExrPart>& parts)
{
    std::vector<ExrLayer> layers;
    for (std::size_t i = 0; i < parts.size(); ++i)
        addLayers(layers, i, parts[i]);
    std::stable_sort(layers.begin(), layers.end(),
                     [&](const ExrLayer& a, const ExrLayer& b)
                     { return rankOf(a, parts[a.part].views) < rankOf(b, parts[b.part].views); });
    return layers;
}

} // namespace osgTerrainLight
