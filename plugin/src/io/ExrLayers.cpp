#include "io/ExrLayers.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <tuple>

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

bool isNoLight(const ExrLayer& layer)
{
    static const char* const starts[] = {"crypto", "normal",   "position", "depth",   "motion",
                                         "vector", "velocity", "uv",       "mask",    "index",
                                         "albedo", "diffcol",  "glosscol", "transcol"};
    for (const std::string& part : partsOf(layer.prefix))
        for (const char* start : starts)
            if (part.rfind(start, 0) == 0)
                return true;
    return false;
}

std::vector<ExrLayer> lightLayers(const std::vector<std::string>& channels,
                                  const std::vector<std::string>& views)
{
    const std::set<std::string> names(channels.begin(), channels.end());
    std::set<std::string> prefixes;
    for (const std::string& name : names)
    {
        const std::size_t stop = name.rfind('.');
        prefixes.insert(stop == std::string::npos ? "" : name.substr(0, stop + 1));
    }
    const auto has = [&](const std::string& name) { return names.count(name) != 0; };
    std::vector<ExrLayer> layers;
    for (const std::string& prefix : prefixes)
        if (has(prefix + "R") && has(prefix + "G") && has(prefix + "B"))
            layers.push_back({prefix, LayerKind::Colours});
        else if (has(prefix + "Y") && !has(prefix + "X") && !has(prefix + "Z"))
            layers.push_back({prefix, has(prefix + "RY") && has(prefix + "BY")
                                          ? LayerKind::LuminanceChroma
                                          : LayerKind::Luminance});
    const auto rank = [&](const ExrLayer& layer)
    {
        std::vector<std::string> parts = partsOf(layer.prefix);
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
        return std::tuple(kind, view);
    };
    std::stable_sort(layers.begin(), layers.end(),
                     [&](const ExrLayer& a, const ExrLayer& b) { return rank(a) < rank(b); });
    return layers;
}

} // namespace osgTerrainLight
