#pragma once

#include "core/Result.h"

#include <pugixml.hpp>

#include <optional>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// What a layer of a map holds, and who reads it (lower case): <GDALImage> and
/// <image driver="gdal"> alike.
struct LayerKind
{
    bool isElevation = false;
    std::string driver;
};

/// Nothing where the element is no layer of heights or colours.
std::optional<LayerKind> layerKindOf(const pugi::xml_node& element);

/// The key that switches the layer off, as "open is false"; empty where none does.
std::string switchOf(const pugi::xml_node& layer);

/// The layers of a composite: osgEarth 3 has them in <layers>, osgEarth 2 in the element itself.
std::vector<pugi::xml_node> partsOf(const pugi::xml_node& composite);

/// 0 … 1; 1 where none is given. The error names key, value and what is needed.
Result<double> opacityOf(const pugi::xml_node& image);

/// As osgEarth reads a flag: true, yes and on, in any case, are yes.
bool isYes(const std::string& value);

/// A vertical datum as messages name it: in lower case, but for a file of a geoid's grid, which
/// keeps its case and has / for \.
std::string datumName(const std::string& text);

/// The vertical datum of a layer's heights, its own or that of its profile, by datumName(); empty
/// where none is given.
std::string verticalDatumOf(const pugi::xml_node& elevation);

} // namespace osgTerrainLight
