#include "io/RasterEnvironment.h"

#include "io/AlbedoFile.h"
#include "io/GdalErrors.h"
#include "io/PictureBands.h"

#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

namespace osgTerrainLight
{

namespace
{
/// Of codes and of light. Whole numbers that are neither have to be made light by a scale.
bool isLight(const PictureBand& band)
{
    return band.white > 0.0f || band.facts.isScaled() || !band.facts.integer;
}

/// What tells a map from a picture of a sky.
std::string noteOfMap(GDALDataset& file)
{
    const OGRSpatialReference* crs = file.GetSpatialRef();
    return crs ? std::string("a map (CRS \"") + (crs->GetName() ? crs->GetName() : "") +
                     "\") is taken as a picture of the sky"
               : "";
}

/// A camera's word on how it was held: 1 is upright.
std::string noteOfOrientation(GDALDataset& file)
{
    const char* said = file.GetMetadataItem("EXIF_Orientation");
    return said && !EQUAL(said, "1") ? std::string("its EXIF orientation, ") + said +
                                           ", is not followed: row 0 is the top"
                                     : "";
}

std::optional<Error> complaintOfBand(const std::string& path, GDALDataset& file,
                                     const PictureBand& band)
{
    const std::string unit = file.GetRasterBand(band.number)->GetUnitType();
    if (!unit.empty() && metresPerHeightUnit(unit))
        return Error{ErrorCode::Invalid, path + ": band " + std::to_string(band.number) +
                                             " holds lengths (unit " + unit + "); needed light"};
    if (!isLight(band))
        return Error{ErrorCode::NotSupported,
                     path + ": holds " + band.facts.dataType +
                         " values; needed bytes, unsigned 16-bit integers, floats or a scale"};
    return std::nullopt;
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
    if (height > 8192 || width != 2 * height || // in this order: 2 * height may overflow
        static_cast<std::size_t>(width) * static_cast<std::size_t>(height) > maxPixels)
        return Error{ErrorCode::Invalid, path + ": is " + std::to_string(width) + " x " +
                                             std::to_string(height) +
                                             " pixels; needed 2 : 1 (latitude-longitude), at most "
                                             "16384 x 8192"};
    std::vector<Rgb> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    Result<std::array<PictureBand, 3>> bands = pictureBandsOf(path, *file);
    if (!bands)
        return bands.error();
    PixelRow line;
    std::vector<bool> isVoid(pixels.size(), false);
    for (std::size_t channel = 0; channel < 3; ++channel)
    {
        PictureBand& band = (*bands)[channel];
        if (auto error = complaintOfBand(path, *file, band))
            return *error;
        const GDALColorTable* palette = file->GetRasterBand(band.number)->GetColorTable();
        if (palette) // its entries are the colours
            band.facts.scale = 1.0, band.facts.offset = 0.0;
        for (int row = 0; row < height; ++row)
        {
            if (!readPixels(*file, band.number, band.facts, 0, row, width, line))
                return Error{ErrorCode::Invalid, path + ": cannot be read: " + errors.first()};
            for (std::size_t i = 0; i < line.values.size(); ++i)
            {
                const std::size_t at = static_cast<std::size_t>(row) * line.values.size() + i;
                const float value = line.values[i];
                if (line.isVoid[i])
                    isVoid[at] = true;
                else
                    pixels[at][channel] = palette ? linearOfSrgb(colourOf(*palette, value, channel))
                                          : band.white > 0.0f ? linearOfSrgb(value / band.white)
                                                              : value;
            }
        }
    }
    const auto voids = std::count(isVoid.begin(), isVoid.end(), true);
    const std::string warning =
        joined({noteOfMap(*file), noteOfOrientation(*file),
                voids > 0 ? std::to_string(voids) +
                                " pixels have voids (nodata, mask or alpha 0), taken as 0"
                          : "",
                makeUsable(pixels)});
    EnvironmentPicture picture = fromLatitudeLongitude(width, height, pixels);
    if (!warning.empty())
        picture.warning = path + ": " + warning;
    return picture;
}

} // namespace osgTerrainLight
