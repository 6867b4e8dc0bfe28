#pragma once

#include <cpl_string.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace osgTerrainLight
{

/// A small GeoTIFF in memory, 3 columns by 2 rows of 1 2 3 / 4 5 6 unless told otherwise.
struct MemoryRaster
{
    int width = 3;
    int height = 2;
    GDALDataType type = GDT_Float32;
    std::vector<double> values = {1, 2, 3, 4, 5, 6};
    std::vector<double> transform = {500000, 10, 0, 4000000, 0, -10};
    std::string crs = "EPSG:32633";
    std::string unit;
    std::optional<double> noData;
    double scale = 1.0, offset = 0.0;
    int bands = 1;
    std::vector<std::string> creation;
    std::vector<GByte> datasetMask;
    std::vector<std::pair<std::string, std::string>> metadata; ///< of the band
    bool colourTable = false;
    double epoch = 0.0;

    std::string write() const
    {
        static int counter = 0;
        GDALAllRegister();
        const std::string path = "/vsimem/memory_raster_" + std::to_string(counter++) + ".tif";
        CPLStringList options;
        for (const std::string& option : creation)
            options.AddString(option.c_str());
        GDALDatasetUniquePtr dataset(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
            path.c_str(), width, height, bands, type, options.List()));
        if (transform.size() == 6)
        {
            std::vector<double> copy = transform;
            dataset->SetGeoTransform(copy.data());
        }
        if (!crs.empty())
        {
            OGRSpatialReference reference;
            EXPECT_EQ(reference.SetFromUserInput(crs.c_str()), OGRERR_NONE);
            reference.SetCoordinateEpoch(epoch);
            dataset->SetSpatialRef(&reference);
        }
        GDALRasterBand& band = *dataset->GetRasterBand(1);
        if (!unit.empty())
            band.SetUnitType(unit.c_str());
        if (noData)
            band.SetNoDataValue(*noData);
        if (scale != 1.0 || offset != 0.0)
        {
            band.SetScale(scale);
            band.SetOffset(offset);
        }
        if (colourTable)
        {
            GDALColorTable colours;
            const GDALColorEntry red = {255, 0, 0, 255};
            colours.SetColorEntry(1, &red);
            band.SetColorTable(&colours);
        }
        for (const auto& [name, value] : metadata)
            band.SetMetadataItem(name.c_str(), value.c_str());
        std::vector<double> copy = values;
        EXPECT_EQ(band.RasterIO(GF_Write, 0, 0, width, height, copy.data(), width, height,
                                GDT_Float64, 0, 0, nullptr),
                  CE_None);
        if (!datasetMask.empty())
        {
            CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES");
            dataset->CreateMaskBand(GMF_PER_DATASET);
            std::vector<GByte> mask = datasetMask;
            EXPECT_EQ(band.GetMaskBand()->RasterIO(GF_Write, 0, 0, width, height, mask.data(),
                                                   width, height, GDT_Byte, 0, 0, nullptr),
                      CE_None);
            CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", nullptr);
        }
        return path;
    }
};

/// By the nearest pixel, into the file.
inline void addOverviews(const std::string& path, std::vector<int> factors)
{
    GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_UPDATE));
    ASSERT_TRUE(dataset);
    EXPECT_EQ(dataset->BuildOverviews("NEAREST", static_cast<int>(factors.size()), factors.data(),
                                      0, nullptr, nullptr, nullptr),
              CE_None);
}

/// A raster in memory whose heights are a function of the map place of each pixel's middle; void
/// where that is NaN.
inline std::string rasterOfPlaces(int width, int height, const std::vector<double>& transform,
                                  const std::function<double(double x, double y)>& heightAt,
                                  const std::string& crs = "EPSG:32633")
{
    MemoryRaster made;
    made.width = width;
    made.height = height;
    made.transform = transform;
    made.crs = crs;
    made.type = GDT_Float64;
    made.noData = -9999.0;
    made.values.clear();
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
        {
            const double value = heightAt(transform[0] + (column + 0.5) * transform[1],
                                          transform[3] + (row + 0.5) * transform[5]);
            made.values.push_back(std::isnan(value) ? -9999.0 : value);
        }
    return made.write();
}

} // namespace osgTerrainLight
