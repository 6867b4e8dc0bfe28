#include "io/AlbedoFile.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

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

namespace
{
/// Of what write() made.
GDALDatasetUniquePtr open(const std::string& path)
{
    return GDALDatasetUniquePtr(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
}

void setCrs(GDALDataset& dataset, const std::string& crs)
{
    OGRSpatialReference reference;
    ASSERT_EQ(reference.SetFromUserInput(crs.c_str()), OGRERR_NONE);
    dataset.SetSpatialRef(&reference);
}

/// WKT, as a DEM has it.
std::string wktOf(const std::string& crs)
{
    OGRSpatialReference reference;
    EXPECT_EQ(reference.SetFromUserInput(crs.c_str()), OGRERR_NONE);
    char* text = nullptr;
    const char* wkt2[] = {"FORMAT=WKT2_2019", nullptr};
    reference.exportToWkt(&text, wkt2);
    const std::string wkt = text;
    CPLFree(text);
    return wkt;
}
} // namespace

// value = stored · scale + offset: 5000 · 0.0001 = 0.5, as reflectances are stored. Bytes with a
// scale are no sRGB colours: 51 / 255 = 0.2.
TEST(AlbedoFile, ScaleAndOffsetCount)
{
    const struct
    {
        GDALDataType type;
        float stored;
        double scale, offset;
        float expected;
    } kinds[] = {{GDT_Int16, 5000.0f, 0.0001, 0.0, 0.5f},
                 {GDT_Float32, 0.8f, 0.5, 0.0, 0.4f},
                 {GDT_UInt16, 10000.0f, 0.00005, -0.25, 0.25f},
                 {GDT_Byte, 51.0f, 1.0 / 255.0, 0.0, 0.2f}};
    for (const auto& kind : kinds)
    {
        const std::string path = write("scale", kind.type, {std::vector<float>(6, kind.stored)});
        open(path)->GetRasterBand(1)->SetScale(kind.scale);
        open(path)->GetRasterBand(1)->SetOffset(kind.offset);
        const auto albedo = readAlbedo(path, dem());
        ASSERT_TRUE(albedo.ok()) << albedo.error().message;
        EXPECT_NEAR(albedo->at(1, 1)[0], kind.expected, 1e-6f);
    }
}

// Fewer bits: 15 of four is white. Red, green and blue where bands say they are.
TEST(AlbedoFile, BitsAndColoursOfBandsCount)
{
    const std::string path = write(
        "bgr", GDT_Byte,
        {std::vector<float>(6, 0.0f), std::vector<float>(6, 0.0f), std::vector<float>(6, 255.0f)});
    {
        const GDALDatasetUniquePtr dataset = open(path);
        const GDALColorInterp colours[] = {GCI_BlueBand, GCI_GreenBand, GCI_RedBand};
        for (int i = 0; i < 3; ++i)
            dataset->GetRasterBand(i + 1)->SetColorInterpretation(colours[i]);
    }
    const auto albedo = readAlbedo(path, dem());
    ASSERT_TRUE(albedo.ok()) << albedo.error().message;
    EXPECT_EQ(albedo->at(1, 1), (Rgb{1.0f, 0.0f, 0.0f}));
    const std::string four = write("four", GDT_Byte, {std::vector<float>(6, 15.0f)});
    const char* const bits[] = {"NBITS=4", nullptr};
    GDALDatasetUniquePtr(GetGDALDriverManager()->GetDriverByName("GTiff")->CreateCopy(
        "/vsimem/bits.tif", open(four).get(), TRUE, const_cast<char**>(bits), nullptr, nullptr));
    const auto white = readAlbedo("/vsimem/bits.tif", dem());
    ASSERT_TRUE(white.ok());
    EXPECT_FLOAT_EQ(white->at(1, 1)[0], 1.0f);
}

TEST(AlbedoFile, WhatIsVoidIsBlack)
{
    const std::string path =
        write("void", GDT_Float32,
              {{0.5f, 0.25f, 0.5f, 0.5f, 0.5f, 0.5f}, {1.0f, 1.0f, 0.0f, 0.25f, 1.0f, 1.0f}});
    open(path)->GetRasterBand(2)->SetColorInterpretation(GCI_AlphaBand);
    open(path)->GetRasterBand(1)->SetNoDataValue(0.25);
    const auto albedo = readAlbedo(path, dem());
    ASSERT_TRUE(albedo.ok()) << albedo.error().message;
    const Rgb grey = {0.5f, 0.5f, 0.5f};
    EXPECT_EQ(albedo->at(0, 1), grey);
    EXPECT_EQ(albedo->at(1, 1), Rgb{}) << "nodata";
    EXPECT_EQ(albedo->at(2, 1), Rgb{}) << "alpha 0";
    EXPECT_EQ(albedo->at(0, 0), grey) << "partly transparent";
}

// The same CRS by a code and by its numbers; a vertical part does not matter.
TEST(AlbedoFile, TheCrsIsTheDems)
{
    DemInfo info = dem();
    const std::string path = write("crs", GDT_Float32, {std::vector<float>(6, 0.5f)});
    setCrs(*open(path), "EPSG:32633");
    for (const char* same :
         {"EPSG:32633", "EPSG:32633+5773", "+proj=utm +zone=33 +ellps=WGS84 +units=m"})
    {
        info.frame.crs = wktOf(same);
        const auto albedo = readAlbedo(path, info);
        EXPECT_TRUE(albedo.ok()) << same << albedo.error().message;
    }
    info.frame.crs = wktOf("EPSG:32632");
    const auto other = readAlbedo(path, info);
    ASSERT_FALSE(other.ok());
    EXPECT_NE(other.error().message.find("in CRS \"WGS 84 / UTM zone 33N\""), std::string::npos)
        << other.error().message;
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
    refused(write("complex", GDT_CFloat32, {grey}), dem(), "complex numbers");
    const std::string cyan = write("cyan", GDT_Byte, {grey, grey, grey, grey});
    open(cyan)->GetRasterBand(1)->SetColorInterpretation(GCI_CyanBand);
    refused(cyan, dem(), "is Cyan");
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
