#pragma once

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

/// A layer of an OpenEXR file: channels whose names begin alike.
struct ExrLayer
{
    std::string prefix; ///< empty, or with its full stop
    LayerKind kind;
};

/// Layers that can be light, the one that is the picture first. A layer has R, G and B, or Y
/// without X and Z, which would be a vector. First comes the layer without a name; then those that
/// programs write for the whole picture (Combined, beauty, rgba, rgb, color, composite, final,
/// main; of any case, by the last part of the name); last those whose names say that they hold no
/// light (normals, positions, depth, motion, masks, albedo). Of equals, those of the view that
/// comes first
/// (`views`, the attribute multiView; empty: none), then by name.
std::vector<ExrLayer> lightLayers(const std::vector<std::string>& channels,
                                  const std::vector<std::string>& views);

/// Whether the layer's name says that it holds no light.
bool isNoLight(const ExrLayer& layer);

} // namespace osgTerrainLight
