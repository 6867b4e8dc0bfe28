#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// What the channels of a layer hold.
enum class LayerKind
{
    Colours,         ///< R, G, B
    Luminance,       ///< Y
    LuminanceChroma, ///< Y, RY, BY
};

/// A part of an OpenEXR file, as its header has it.
struct ExrPart
{
    std::string name;                  ///< empty where it has none, as in most files of one part
    std::vector<std::string> channels; ///< empty where its pixels are deep
    std::vector<std::string> views;    ///< attribute multiView, or its own view alone; or none
};

/// A layer: channels of a part whose names begin alike.
struct ExrLayer
{
    std::size_t part = 0;
    std::string prefix; ///< of the channels; empty, or with its full stop
    std::string name;   ///< the part's name and the prefix: what the layer is called
    LayerKind kind = LayerKind::Colours;
};

/// Layers that can be light, the one that is the picture first. A layer has R, G and B, or Y
/// without X and Z, which would be a vector. First comes the layer without a name; then those that
/// programs write for the whole picture (Combined, beauty, rgba, rgb, color, composite, final,
/// main; of any case, by the last part of the name); last those whose names say that they hold no
/// light (normals, positions, depth, motion, masks, colours of surfaces, occlusion). Of equals,
/// those of the view that comes first, then the part that comes first, then by name.
std::vector<ExrLayer> lightLayers(const std::vector<ExrPart>& parts);

/// Whether the layer's name says that it holds no light.
bool isNoLight(const ExrLayer& layer);

} // namespace osgTerrainLight
