#pragma once

#include "core/Result.h"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// One channel's values, row by row from the top, as EXR has them: row 0 is the northernmost.
struct ExrChannel
{
    std::string name; ///< R, G, B, A, Y, layer.R …
    std::vector<float> values;
};

struct ExrImage
{
    int width = 0;
    int height = 0;
    std::vector<ExrChannel> channels;        ///< read: in alphabetical order of their names
    std::map<std::string, std::string> text; ///< string attributes of the header

    /// Null where there is no channel of that name.
    const ExrChannel* find(const std::string& name) const;
};

enum class ExrPixelType
{
    Half, ///< 11 significant bits, to ±65504; larger values become infinities
    Float
};

/// Writes a scanline file, ZIP-compressed without loss. Written into a hidden folder beside the
/// target, read again, compared, and moved over it: a failure leaves the target as it was.
Status writeExr(const std::string& path, const ExrImage& image,
                ExrPixelType type = ExrPixelType::Half);

/// Reads every channel of the data window, whatever its type, as float. More than maxValues values
/// (width · height · channels) are refused before any is allocated; so are sub-sampled channels and
/// deep pixels. Of a file with several parts, the first is read.
Result<ExrImage> readExr(const std::string& path, std::size_t maxValues = std::size_t(1) << 28);

} // namespace osgTerrainLight
