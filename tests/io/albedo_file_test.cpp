#include "io/AlbedoFile.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
/// A 3 x 2 GeoTIFF in memory, north up, pixels of 10 m from (100, 200).
std::string write(const std::string& name, GDALDataType type,
                  const std::vector<std::vector<float>>& bands, double west = 100.0)
{
    GDALAllRegister();
    const std::string path = "/vsimem/" + name + ".tif";
    GDALDatasetUniquePtr dataset(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        path.c_str(), 3, 2, static_cast<int>(bands.size()), type, nullptr));
    double place[6] = {west, 10.0, 0.0, 200.0, 0.0, -10.0};
    dataset->SetGeoTransform(place);
    int count = 0;
    for (std::vector<float> band : bands)
        EXPECT_EQ(dataset->GetRasterBand(++count)->RasterIO(GF_Write, 0, 0, 3, 2, band.data(), 3, 2,
                                                            GDT_Float32, 0, 0, nullptr),
                  CE_None);
    return path;
}

DemInfo dem(int column = 0, int width = 3)
{
    DemInfo info;
    info.rasterWidth = 3;
    info.rasterHeight = 2;
    info.window = {column, 0, width, 2};
    info.frame.width = width;
    info.frame.height = 2;
    info.frame.hasGeoTransform = true;
    info.frame.geoTransform = {100.0 + 10.0 * column, 10.0, 0.0, 200.0, 0.0, -10.0};
    return info;
}
} // namespace

TEST(AlbedoFile, LinearOneBandIsGreyAndRowsRunNorth)
{
    const auto albedo =
        readAlbedo(write("grey", GDT_Float32, {{0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f}}), dem());
    ASSERT_TRUE(albedo.ok());
    EXPECT_EQ(albedo->at(0, 1), (Rgb{0.1f, 0.1f, 0.1f}));
    EXPECT_EQ(albedo->at(2, 0), (Rgb{0.6f, 0.6f, 0.6f}));
    const auto part = readAlbedo("/vsimem/grey.tif", dem(1, 2));
    ASSERT_TRUE(part.ok());
    EXPECT_EQ(part->at(0, 0), (Rgb{0.5f, 0.5f, 0.5f}));
}

// IEC 61966-2-1: 0 and 255 are the ends, 188 is 0.5029, 10 lies on the linear part: 10/255/12.92.
TEST(AlbedoFile, BytesAreSrgbColours)
{
    const auto albedo =
        readAlbedo(write("colour", GDT_Byte,
                         {{255, 0, 0, 0, 0, 0}, {188, 0, 0, 0, 0, 0}, {10, 0, 0, 0, 0, 255}}),
                   dem());
    ASSERT_TRUE(albedo.ok());
    EXPECT_FLOAT_EQ(albedo->at(0, 1)[0], 1.0f);
    EXPECT_NEAR(albedo->at(0, 1)[1], 0.5029f, 1e-4f);
    EXPECT_NEAR(albedo->at(0, 1)[2], 0.0030353f, 1e-6f);
    EXPECT_EQ(albedo->at(2, 0), (Rgb{0.0f, 0.0f, 1.0f}));
}

TEST(AlbedoFile, WhatIsNotFiniteIsBlack)
{
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto albedo =
        readAlbedo(write("nan", GDT_Float32, {{nan, 1.0f, 0.0f, 0.5f, 0.5f, 0.5f}}), dem());
    ASSERT_TRUE(albedo.ok());
    EXPECT_EQ(albedo->at(0, 1), Rgb{});
    EXPECT_EQ(albedo->at(1, 1), (Rgb{1.0f, 1.0f, 1.0f}));
}

TEST(AlbedoFile, RefusesWhatDoesNotFit)
{
    const std::vector<float> grey(6, 0.5f);
    const auto refused = [](const std::string& path, const DemInfo& info, const char* word)
    {
        const auto albedo = readAlbedo(path, info);
        ASSERT_FALSE(albedo.ok()) << word;
        EXPECT_NE(albedo.error().message.find(path), std::string::npos) << albedo.error().message;
        EXPECT_NE(albedo.error().message.find(word), std::string::npos) << albedo.error().message;
    };
    refused("/vsimem/no_such.tif", dem(), "cannot be opened");
    DemInfo larger = dem();
    larger.rasterWidth = 4;
    refused(write("small", GDT_Float32, {grey}), larger, "4 x 2");
    refused(write("bright", GDT_Float32, {{0.5f, 1.5f, 0.5f, 0.5f, 0.5f, 0.5f}}), dem(),
            "1.5 at pixel 1, 0");
    refused(write("east", GDT_Float32, {grey}, 130.0), dem(), "lies elsewhere");
    const std::string palette = write("palette", GDT_Byte, {{0, 1, 0, 1, 0, 1}});
    {
        const GDALDatasetUniquePtr dataset(GDALDataset::Open(palette.c_str(), GDAL_OF_UPDATE));
        GDALColorTable table;
        const GDALColorEntry white = {255, 255, 255, 255};
        table.SetColorEntry(1, &white);
        dataset->GetRasterBand(1)->SetColorTable(&table);
    }
    refused(palette, dem(), "palette");
}
