#pragma once

#include "core/Result.h"
#include "io/RasterBand.h"

#include <array>
#include <string>

namespace osgTerrainLight
{

/// A band of a picture for one of red, green and blue.
struct PictureBand
{
    int number = 1;
    PixelFacts facts;
    float white = 0.0f; ///< greatest code of Byte and UInt16 by their bits; 0 of all other values

    /// Codes are sRGB colours; a scale or an offset makes quantities of them.
    bool isByte() const { return white > 0.0f && facts.dataType == "Byte"; }
};

/// The bands that say they are red, green and blue. Else the first three, and of one or two bands
/// the first for all. Errors: those of readPixelFacts; NotSupported where one is something else,
/// such as cyan or alpha.
Result<std::array<PictureBand, 3>> pictureBandsOf(const std::string& path, GDALDataset& dataset);

} // namespace osgTerrainLight
