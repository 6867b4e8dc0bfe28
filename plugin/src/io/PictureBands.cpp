#include "io/PictureBands.h"

#include <gdal_priv.h>

#include <cstdlib>

namespace osgTerrainLight
{
namespace
{
constexpr GDALColorInterp colours[] = {GCI_RedBand, GCI_GreenBand, GCI_BlueBand};

/// 0: no band says it is this colour.
int bandOf(GDALDataset& dataset, GDALColorInterp colour)
{
    for (int i = 1; i <= dataset.GetRasterCount(); ++i)
        if (dataset.GetRasterBand(i)->GetColorInterpretation() == colour)
            return i;
    return 0;
}

float whiteOf(GDALRasterBand& band, const PixelFacts& facts)
{
    if (facts.isScaled() || (facts.dataType != "Byte" && facts.dataType != "UInt16"))
        return 0.0f;
    const char* said = band.GetMetadataItem("NBITS", "IMAGE_STRUCTURE");
    const int all = facts.dataType == "Byte" ? 8 : 16;
    const int bits = said ? std::atoi(said) : all;
    return static_cast<float>((1 << (bits > 0 && bits < all ? bits : all)) - 1);
}
} // namespace

Result<std::array<PictureBand, 3>> pictureBandsOf(const std::string& path, GDALDataset& dataset)
{
    const int count = dataset.GetRasterCount();
    std::array<PictureBand, 3> bands;
    bool named = true;
    for (std::size_t i = 0; i < bands.size(); ++i)
        named = named && bandOf(dataset, colours[i]) != 0;
    for (std::size_t i = 0; i < bands.size(); ++i)
    {
        PictureBand& band = bands[i];
        band.number = named        ? bandOf(dataset, colours[i])
                      : count >= 3 ? static_cast<int>(i) + 1
                                   : 1;
        GDALRasterBand& asked = *dataset.GetRasterBand(band.number);
        const GDALColorInterp colour = asked.GetColorInterpretation();
        if (colour != GCI_Undefined && colour != GCI_GrayIndex && colour != GCI_PaletteIndex &&
            colour != GCI_RedBand && colour != GCI_GreenBand && colour != GCI_BlueBand)
            return Error{ErrorCode::NotSupported, path + ": band " + std::to_string(band.number) +
                                                      " of " + std::to_string(count) + " is " +
                                                      GDALGetColorInterpretationName(colour) +
                                                      "; needed red, green and blue, or grey"};
        Result<PixelFacts> facts = readPixelFacts(path, dataset, band.number);
        if (!facts)
            return facts.error();
        band.facts = std::move(*facts);
        band.white = whiteOf(asked, band.facts);
    }
    return bands;
}

} // namespace osgTerrainLight
