#include "io/MapReader.h"

#include "io/GdalErrors.h"
#include "io/GroundSpacing.h"
#include "io/InputFiles.h"
#include "io/PictureBands.h"

#include <cpl_string.h>
#include <gdal_priv.h>
#include <gdal_utils.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace osgTerrainLight
{

namespace
{
std::string number(double value)
{
    return CPLSPrintf("%.17g", value);
}

Result<GDALDatasetUniquePtr> openPicture(const std::string& path, const GdalErrors& errors)
{
    if (const std::string wrong = complaintOfFile(path); !wrong.empty())
        return Error{ErrorCode::Invalid, path + ": " + wrong};
    GDALDatasetUniquePtr picture(
        GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
    VSIStatBufL stat;
    if (!picture)
        return VSIStatL(path.c_str(), &stat) != 0
                   ? Error{ErrorCode::NotFound, path + ": no such file"}
                   : Error{ErrorCode::Invalid,
                           path + ": is no picture that GDAL reads (" + errors.first() + ")"};
    if (picture->GetRasterCount() == 0)
        return Error{ErrorCode::Invalid, path + ": holds no raster band itself"};
    const GDALDataType type = picture->GetRasterBand(1)->GetRasterDataType();
    if (type != GDT_Byte)
        return Error{ErrorCode::NotSupported, path + ": holds " + GDALGetDataTypeName(type) +
                                                  " values; needs 8 bits per channel"};
    std::array<double, 6> place{};
    if (picture->GetGeoTransform(place.data()) != CE_None)
        return Error{ErrorCode::Invalid, path + ": has no geotransform; needs one"};
    return picture;
}

/// 0: there is none.
int alphaBandOf(GDALDataset& picture)
{
    for (int band = picture.GetRasterCount(); band > 0; --band)
        if (picture.GetRasterBand(band)->GetColorInterpretation() == GCI_AlphaBand)
            return band;
    return 0;
}

/// A view of the picture's red, green and blue of 8 bits, and its alpha, which reads from it and
/// must go before it.
Result<GDALDatasetUniquePtr> coloursOf(const std::string& path, GDALDataset& picture,
                                       const GdalErrors& errors)
{
    CPLStringList arguments;
    const auto add = [&](const std::vector<std::string>& words)
    {
        for (const std::string& word : words)
            arguments.AddString(word.c_str());
    };
    add({"-of", "VRT"});
    if (picture.GetRasterBand(1)->GetColorTable())
        add({"-expand", "rgba"});
    else
    {
        const Result<std::array<PictureBand, 3>> bands = pictureBandsOf(path, picture);
        if (!bands)
            return bands.error();
        for (std::size_t i = 0; i < bands->size(); ++i)
        {
            const PictureBand& band = (*bands)[i];
            add({"-b", std::to_string(band.number)});
            if (band.isByte() && band.white < 255.0f)
                add({"-scale_" + std::to_string(i + 1), "0", number(band.white), "0", "255"});
        }
        if (const int alpha = alphaBandOf(picture))
            add({"-b", std::to_string(alpha), "-colorinterp_4", "alpha"});
    }
    GDALTranslateOptions* options = GDALTranslateOptionsNew(arguments.List(), nullptr);
    GDALDatasetUniquePtr view(GDALDataset::FromHandle(
        GDALTranslate("", GDALDataset::ToHandle(&picture), options, nullptr)));
    GDALTranslateOptionsFree(options);
    if (!view)
        return Error{ErrorCode::Failed,
                     path + ": its colours cannot be read (" + errors.first() + ")"};
    return view;
}

GDALDatasetUniquePtr warped(GDALDataset& picture, const DemTile& tile)
{
    CPLStringList arguments;
    for (const char* argument : {"-of", "VRT", "-r", "bilinear", "-te"})
        arguments.AddString(argument);
    for (double edge :
         {tile.mapOriginX, tile.mapOriginY, tile.mapOriginX + (tile.width() - 1) * tile.mapStepX,
          tile.mapOriginY + (tile.height() - 1) * tile.mapStepY})
        arguments.AddString(number(edge).c_str());
    if (!tile.crs.empty())
    {
        arguments.AddString("-t_srs");
        arguments.AddString(tile.crs.c_str());
        if (!picture.GetSpatialRef())
        {
            arguments.AddString("-s_srs");
            arguments.AddString(tile.crs.c_str());
        }
    }
    if (alphaBandOf(picture) == 0)
        arguments.AddString("-dstalpha");
    GDALWarpAppOptions* options = GDALWarpAppOptionsNew(arguments.List(), nullptr);
    GDALDatasetH source = GDALDataset::ToHandle(&picture);
    GDALDatasetUniquePtr result(
        GDALDataset::FromHandle(GDALWarp("", nullptr, 1, &source, options, nullptr)));
    GDALWarpAppOptionsFree(options);
    return result;
}
} // namespace

Result<ColourImage> readColour(const std::string& path, const DemTile& tile, int maxSize)
{
    GdalErrors errors;
    Result<GDALDatasetUniquePtr> opened = openPicture(path, errors);
    if (!opened)
        return opened.error();
    const Result<GDALDatasetUniquePtr> view = coloursOf(path, **opened, errors);
    if (!view)
        return view.error();
    const GDALDatasetUniquePtr fitted = warped(**view, tile);
    if (!fitted)
        return Error{ErrorCode::Failed,
                     path + ": cannot be warped to the terrain (" + errors.first() + ")"};

    ColourImage image;
    image.width = std::min(fitted->GetRasterXSize(), maxSize);
    image.height = std::min(fitted->GetRasterYSize(), maxSize);
    const std::size_t count =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    image.pixels.resize(4 * count);
    GDALRasterIOExtraArg extra;
    INIT_RASTERIO_EXTRA_ARG(extra);
    extra.eResampleAlg = GRIORA_Average;
    for (int channel = 0; channel < 4; ++channel)
    {
        // Row 0 south: from the last row of the buffer upwards.
        std::uint8_t* start =
            image.pixels.data() + 4 * (count - static_cast<std::size_t>(image.width)) + channel;
        if (fitted->GetRasterBand(channel + 1)
                ->RasterIO(GF_Read, 0, 0, fitted->GetRasterXSize(), fitted->GetRasterYSize(), start,
                           image.width, image.height, GDT_Byte, 4,
                           -4 * static_cast<GSpacing>(image.width), &extra) != CE_None)
            return Error{ErrorCode::Failed, path + ": cannot be read (" + errors.last() + ")"};
    }
    bool seen = false;
    for (std::size_t i = 0; i < count && !seen; ++i)
        seen = image.pixels[4 * i + 3] != 0;
    if (!seen)
        return Error{ErrorCode::Elsewhere, path + ": does not overlap the terrain"};
    return image;
}

Result<DemTile> levelTileUnder(const std::string& path)
{
    GdalErrors errors;
    Result<GDALDatasetUniquePtr> opened = openPicture(path, errors);
    if (!opened)
        return opened.error();
    GDALDataset& picture = **opened;
    std::array<double, 6> t{};
    picture.GetGeoTransform(t.data());
    const double spanX = t[1] * picture.GetRasterXSize();
    const double spanY = t[5] * picture.GetRasterYSize();
    MetresPerRadian metres{1.0, 1.0};
    double radians = 1.0;
    DemTile tile(2, 2, 1.0);
    if (const OGRSpatialReference* crs = picture.GetSpatialRef())
    {
        char* wkt = nullptr;
        const char* wkt2[] = {"FORMAT=WKT2_2019", nullptr};
        if (crs->exportToWkt(&wkt, wkt2) == OGRERR_NONE)
            tile.crs = wkt;
        CPLFree(wkt);
        if (crs->IsGeographic())
        {
            radians = crs->GetAngularUnits();
            metres = metresPerRadian((t[3] + 0.5 * spanY) * radians, crs->GetSemiMajor(),
                                     crs->GetSemiMinor());
        }
        else
            radians = crs->GetLinearUnits();
    }
    tile.northSpacing = std::abs(spanY) * radians * metres.north;
    tile.eastSpacings = {std::abs(spanX) * radians * metres.east};
    tile.mapOriginX = std::min(t[0], t[0] + spanX);
    tile.mapOriginY = std::min(t[3], t[3] + spanY);
    tile.mapStepX = std::abs(spanX);
    tile.mapStepY = std::abs(spanY);
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 2; ++column)
            tile.setHeight(column, row, 0.0f);
    return tile;
}

} // namespace osgTerrainLight
