#include "io/AlbedoFile.h"

#include "io/GdalErrors.h"
#include "io/InputFiles.h"
#include "io/PictureBands.h"

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <array>
#include <cmath>
#include <memory>
#include <optional>

namespace osgTerrainLight
{

namespace
{
/// Whether two corners of the raster lie where the DEM's CRS has them. CRSs of different names can
/// be the same, so places are compared.
bool sameCrs(const OGRSpatialReference& theirCrs, const DemInfo& dem)
{
    OGRSpatialReference ours, theirs(theirCrs);
    if (ours.importFromWkt(dem.frame.crs.c_str()) != OGRERR_NONE)
        return true;
    for (OGRSpatialReference* crs : {&ours, &theirs})
    {
        crs->StripVertical();
        crs->DemoteTo2D(nullptr);
        crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    }
    const char* const way[] = {"CRITERION=EQUIVALENT", nullptr};
    if (ours.IsSame(&theirs, way))
        return true;
    const std::unique_ptr<OGRCoordinateTransformation> transform(
        OGRCreateCoordinateTransformation(&theirs, &ours));
    const RasterFrame& frame = dem.frame;
    for (const int end : {0, 1})
    {
        const double x = frame.mapX(end * (frame.width - 1));
        const double y = frame.mapY(end * (frame.height - 1));
        double ourX = x, ourY = y;
        if (!transform || !transform->Transform(1, &ourX, &ourY) ||
            !(std::hypot((ourX - x) / frame.geoTransform[1], (ourY - y) / frame.geoTransform[5]) <
              0.5))
            return false;
    }
    return true;
}

std::optional<Error> complaintOfPlace(const std::string& path, GDALDataset& dataset,
                                      const DemInfo& dem)
{
    std::array<double, 6> place = {};
    if (!dem.frame.hasGeoTransform || dataset.GetGeoTransform(place.data()) != CE_None)
        return std::nullopt;
    const PixelWindow& window = dem.window;
    const std::array<double, 6>& ours = dem.frame.geoTransform;
    const double pixels = std::hypot((place[0] + window.column * place[1] - ours[0]) / ours[1],
                                     (place[3] + window.row * place[5] - ours[3]) / ours[5]);
    if (!(pixels < 0.5) || std::abs(place[1] / ours[1] - 1.0) * dem.rasterWidth > 0.5 ||
        std::abs(place[5] / ours[5] - 1.0) * dem.rasterHeight > 0.5)
        return Error{ErrorCode::Invalid, path + ": lies elsewhere than the DEM: needs its pixels "
                                                "(gdalwarp -te ... -ts ...)"};
    const OGRSpatialReference* crs = dataset.GetSpatialRef();
    if (crs && !dem.frame.crs.empty() && !sameCrs(*crs, dem))
        return Error{ErrorCode::Invalid, path + ": lies elsewhere than the DEM, in CRS \"" +
                                             (crs->GetName() ? crs->GetName() : "") +
                                             "\": needs the DEM's, \"" + dem.crsName +
                                             "\" (gdalwarp -t_srs ...)"};
    return std::nullopt;
}
} // namespace

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
    if (const std::optional<Error> elsewhere = complaintOfPlace(path, *dataset, dem))
        return *elsewhere;
    const Result<std::array<PictureBand, 3>> bands = pictureBandsOf(path, *dataset);
    if (!bands)
        return bands.error();
    Raster<Rgb> albedo(window.width, window.height, Rgb{});
    PixelRow pixels;
    for (std::size_t channel = 0; channel < 3; ++channel)
    {
        const PictureBand& band = (*bands)[channel];
        for (int row = 0; row < window.height; ++row)
        {
            if (!readPixels(*dataset, band.number, band.facts, window.column, window.row + row,
                            window.width, pixels))
                return Error{ErrorCode::Failed, path + ": cannot be read: " + errors.first()};
            const int tileRow = dem.frame.northUp ? window.height - 1 - row : row;
            for (int column = 0; column < window.width; ++column)
            {
                const std::size_t i = static_cast<std::size_t>(column);
                const float value = pixels.values[i];
                if (pixels.isVoid[i] || !std::isfinite(value))
                    continue;
                if (!band.isByte() && (value < 0.0f || value > 1.0f))
                    return Error{ErrorCode::Invalid,
                                 path + ": " + CPLSPrintf("%.6g", static_cast<double>(value)) +
                                     " at pixel " + std::to_string(window.column + column) + ", " +
                                     std::to_string(window.row + row) +
                                     ": an albedo needs 0 ... 1 (bytes are sRGB colours)"};
                const int tileColumn = dem.frame.westFirst ? column : window.width - 1 - column;
                albedo.at(tileColumn, tileRow)[channel] =
                    band.isByte() ? linearOfSrgb(value / band.white) : value;
            }
        }
    }
    return albedo;
}

} // namespace osgTerrainLight
