#include "io/RasterEnvironment.h"

#include "io/AlbedoFile.h"
#include "io/GdalErrors.h"

#include <cpl_vsi.h>
#include <gdal_priv.h>

#include <vector>

namespace osgTerrainLight
{

namespace
{
/// The greatest value of a type of sRGB colours; 0: a type of linear values; below: neither.
float greatestOf(GDALDataType type)
{
    return type == GDT_Byte                             ? 255.0f
           : type == GDT_UInt16                         ? 65535.0f
           : type == GDT_Float32 || type == GDT_Float64 ? 0.0f
                                                        : -1.0f;
}

/// A colour of a palette; 0 where it has no such entry.
float colourOf(const GDALColorTable& palette, float index, std::size_t channel)
{
    const GDALColorEntry* entry = palette.GetColorEntry(static_cast<int>(index));
    if (!entry)
        return 0.0f;
    const short parts[] = {entry->c1, entry->c2, entry->c3};
    return static_cast<float>(parts[channel]) / 255.0f;
}
} // namespace

Result<EnvironmentPicture> readRasterEnvironment(const std::string& path, std::size_t maxPixels)
{
    GdalErrors errors;
    const GDALDatasetUniquePtr file(
        GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_VERBOSE_ERROR));
    VSIStatBufL stat;
    if (!file || file->GetRasterCount() == 0)
        return VSIStatL(path.c_str(), &stat) != 0
                   ? Error{ErrorCode::NotFound, path + ": no such file"}
                   : Error{ErrorCode::Invalid, path + ": is no picture that GDAL reads (" +
                                                   (file ? "it has no band" : errors.first()) +
                                                   "); needed OpenEXR, .hdr or another picture"};
    const int width = file->GetRasterXSize(), height = file->GetRasterYSize();
    if (width != 2 * height || height > 8192 ||
        static_cast<std::size_t>(width) * static_cast<std::size_t>(height) > maxPixels)
        return Error{ErrorCode::Invalid, path + ": is " + std::to_string(width) + " x " +
                                             std::to_string(height) +
                                             " pixels; needed 2 : 1 (latitude-longitude), at most "
                                             "16384 x 8192"};
    std::vector<Rgb> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    std::vector<float> line(static_cast<std::size_t>(width));
    for (std::size_t channel = 0; channel < 3; ++channel)
    {
        const int number = file->GetRasterCount() >= 3 ? static_cast<int>(channel) + 1 : 1;
        GDALRasterBand& band = *file->GetRasterBand(number);
        const GDALColorTable* palette = band.GetColorTable();
        const float greatest = greatestOf(band.GetRasterDataType());
        if (greatest < 0.0f)
            return Error{ErrorCode::NotSupported,
                         path + ": holds " + GDALGetDataTypeName(band.GetRasterDataType()) +
                             " values; needed bytes, unsigned 16-bit integers or floats"};
        for (int row = 0; row < height; ++row)
        {
            if (band.RasterIO(GF_Read, 0, row, width, 1, line.data(), width, 1, GDT_Float32, 0, 0,
                              nullptr) != CE_None)
                return Error{ErrorCode::Invalid, path + ": cannot be read: " + errors.first()};
            for (std::size_t i = 0; i < line.size(); ++i)
                pixels[static_cast<std::size_t>(row) * line.size() + i][channel] =
                    palette           ? linearOfSrgb(colourOf(*palette, line[i], channel))
                    : greatest > 0.0f ? linearOfSrgb(line[i] / greatest)
                                      : line[i];
        }
    }
    const std::string warning = makeUsable(pixels);
    EnvironmentPicture picture = fromLatitudeLongitude(width, height, pixels);
    if (!warning.empty())
        picture.warning = path + ": " + warning;
    return picture;
}

} // namespace osgTerrainLight
