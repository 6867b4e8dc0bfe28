#include "io/AlbedoFile.h"

#include "io/GdalErrors.h"
#include "io/InputFiles.h"

#include <cpl_string.h>
#include <gdal_priv.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace osgTerrainLight
{

float linearOfSrgb(float encoded)
{
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

Result<Raster<Rgb>> readAlbedo(const std::string& path, const DemInfo& dem)
{
    if (const std::string wrong = complaintOfFile(path); !wrong.empty())
        return Error{ErrorCode::Invalid, path + ": " + wrong};
    GdalErrors errors;
    const GDALDatasetUniquePtr dataset(
        GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
    if (!dataset)
        return Error{ErrorCode::NotFound, path + ": cannot be opened: " + errors.first()};
    const auto size = [](int width, int height)
    { return std::to_string(width) + " x " + std::to_string(height); };
    if (dataset->GetRasterXSize() != dem.rasterWidth ||
        dataset->GetRasterYSize() != dem.rasterHeight)
        return Error{ErrorCode::Invalid,
                     path + ": is " + size(dataset->GetRasterXSize(), dataset->GetRasterYSize()) +
                         " pixels: needs the size of the DEM, " +
                         size(dem.rasterWidth, dem.rasterHeight)};
    const PixelWindow& window = dem.window;
    if (dataset->GetRasterCount() < 3 && dataset->GetRasterBand(1)->GetColorTable())
        return Error{ErrorCode::NotSupported,
                     path + ": has a palette: needs colours (gdal_translate -expand rgb)"};
    std::array<double, 6> place = {};
    if (dem.frame.hasGeoTransform && dataset->GetGeoTransform(place.data()) == CE_None)
    {
        const std::array<double, 6>& theirs = dem.frame.geoTransform;
        const double pixels =
            std::hypot((place[0] + window.column * place[1] - theirs[0]) / theirs[1],
                       (place[3] + window.row * place[5] - theirs[3]) / theirs[5]);
        if (!(pixels < 0.5) || std::abs(place[1] / theirs[1] - 1.0) * dem.rasterWidth > 0.5 ||
            std::abs(place[5] / theirs[5] - 1.0) * dem.rasterHeight > 0.5)
            return Error{ErrorCode::Invalid, path +
                                                 ": lies elsewhere than the DEM: needs its pixels "
                                                 "(gdalwarp -te ... -ts ...)"};
    }
    Raster<Rgb> albedo(window.width, window.height, Rgb{});
    const int bands = dataset->GetRasterCount();
    std::vector<float> values(static_cast<std::size_t>(window.width));
    std::vector<std::uint8_t> mask(values.size());
    for (std::size_t channel = 0; channel < 3; ++channel)
    {
        GDALRasterBand* band =
            dataset->GetRasterBand(bands >= 3 ? static_cast<int>(channel) + 1 : 1);
        const bool encoded = band->GetRasterDataType() == GDT_Byte;
        for (int row = 0; row < window.height; ++row)
        {
            if (band->RasterIO(GF_Read, window.column, window.row + row, window.width, 1,
                               values.data(), window.width, 1, GDT_Float32, 0, 0,
                               nullptr) != CE_None ||
                band->GetMaskBand()->RasterIO(GF_Read, window.column, window.row + row,
                                              window.width, 1, mask.data(), window.width, 1,
                                              GDT_Byte, 0, 0, nullptr) != CE_None)
                return Error{ErrorCode::Failed, path + ": cannot be read: " + errors.first()};
            const int tileRow = dem.frame.northUp ? window.height - 1 - row : row;
            for (int column = 0; column < window.width; ++column)
            {
                const std::size_t i = static_cast<std::size_t>(column);
                if (mask[i] == 0 || !std::isfinite(values[i]))
                    continue;
                if (!encoded && (values[i] < 0.0f || values[i] > 1.0f))
                    return Error{ErrorCode::Invalid,
                                 path + ": " + CPLSPrintf("%.6g", static_cast<double>(values[i])) +
                                     " at pixel " + std::to_string(window.column + column) + ", " +
                                     std::to_string(window.row + row) +
                                     ": an albedo needs 0 ... 1 (bytes are sRGB colours)"};
                const int tileColumn = dem.frame.westFirst ? column : window.width - 1 - column;
                albedo.at(tileColumn, tileRow)[channel] =
                    encoded ? linearOfSrgb(values[i] / 255.0f) : values[i];
            }
        }
    }
    return albedo;
}

} // namespace osgTerrainLight
