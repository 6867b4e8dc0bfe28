#include "io/RasterEnvironment.h"
#include "support/TestFolder.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
namespace fs = std::filesystem;

class RasterEnvironmentTest : public testing::Test
{
protected:
    void SetUp() override { GDALAllRegister(); }

    /// One value in each band.
    std::string write(const std::string& name, const char* driver, GDALDataType type,
                      const std::vector<double>& bands, int width = 8, int height = 4,
                      const GDALColorTable* palette = nullptr) const
    {
        GDALDriverManager& drivers = *GetGDALDriverManager();
        const GDALDatasetUniquePtr made(drivers.GetDriverByName("MEM")->Create(
            "", width, height, static_cast<int>(bands.size()), type, nullptr));
        for (std::size_t i = 0; i < bands.size(); ++i)
            made->GetRasterBand(static_cast<int>(i) + 1)->Fill(bands[i]);
        if (palette)
            made->GetRasterBand(1)->SetColorTable(const_cast<GDALColorTable*>(palette));
        const std::string path = (folder / name).string();
        const GDALDatasetUniquePtr file(drivers.GetDriverByName(driver)->CreateCopy(
            path.c_str(), made.get(), TRUE, nullptr, nullptr, nullptr));
        EXPECT_TRUE(file) << name;
        return path;
    }

    /// A GeoTIFF of one value in each band, of which more is said.
    std::string made(const char* name, GDALDataType type, const std::vector<double>& bands,
                     const std::function<void(GDALDataset&)>& say) const
    {
        const std::string path = write(name, "GTiff", type, bands);
        const GDALDatasetUniquePtr file(
            GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
        say(*file);
        return path;
    }

    const fs::path folder = testFolder();
};

void expectAll(const std::string& path, const Rgb& colour)
{
    const Result<EnvironmentPicture> picture = readEnvironmentFile(path);
    ASSERT_TRUE(picture) << picture.error().message;
    EXPECT_EQ(picture->columns, 8);
    EXPECT_EQ(picture->rows, 4);
    for (const Rgb& texel : picture->radiance)
        for (std::size_t c = 0; c < 3; ++c)
            ASSERT_NEAR(texel[c], colour[c], 1e-5f) << path;
}
} // namespace

// IEC 61966-2-1: ((v + 0.055) / 1.055) ^ 2.4, and v / 12.92 below 0.04045.
TEST_F(RasterEnvironmentTest, SrgbAndLinearValues)
{
    const auto linear = [](double v)
    { return static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4)); };
    const Rgb bytes = {linear(255 / 255.0), linear(100 / 255.0), linear(5 / 255.0)};
    expectAll(write("a.png", "PNG", GDT_Byte, {255, 100, 5}), bytes);
    expectAll(write("b.png", "PNG", GDT_Byte, {255, 100, 5, 1}), bytes); // alpha is not light
    expectAll(write("c.bmp", "BMP", GDT_Byte, {255, 100, 5}), bytes);
    expectAll(write("d.tif", "GTiff", GDT_UInt16, {65535, 25700, 1285}), bytes);
    expectAll(write("e.tif", "GTiff", GDT_Float32, {12.5, 0.25, 3.0}), {12.5f, 0.25f, 3.0f});
    expectAll(write("f.tif", "GTiff", GDT_Float64, {7.0}), {7.0f, 7.0f, 7.0f});
    expectAll(write("g.png", "PNG", GDT_Byte, {100, 255}),
              {linear(100 / 255.0), linear(100 / 255.0), linear(100 / 255.0)});
    GDALColorTable palette;
    const GDALColorEntry entry = {255, 100, 5, 255};
    palette.SetColorEntry(3, &entry);
    expectAll(write("h.png", "PNG", GDT_Byte, {3}, 8, 4, &palette), bytes);
}

// What else a band says: value = stored · scale + offset is light, white is the greatest number of
// the bits in use, and what is void is black.
TEST_F(RasterEnvironmentTest, WhatItsBandsSay)
{
    const auto scaled = [](double scale, double offset)
    {
        return [=](GDALDataset& file)
        {
            file.GetRasterBand(1)->SetScale(scale);
            file.GetRasterBand(1)->SetOffset(offset);
        };
    };
    const auto grey = [](float v) { return Rgb{v, v, v}; };
    expectAll(made("a.tif", GDT_Float32, {3.0}, scaled(2.0, 0.5)), grey(6.5f));
    expectAll(made("b.tif", GDT_Int16, {300}, scaled(0.01, 0.0)), grey(3.0f));
    const GDALDatasetUniquePtr wide(
        GDALDataset::Open(write("wide.tif", "GTiff", GDT_UInt16, {4095}).c_str(), GDAL_OF_RASTER));
    const char* const bits[] = {"NBITS=12", nullptr};
    const std::string twelve = (folder / "twelve.tif").string();
    GDALDatasetUniquePtr(GetGDALDriverManager()->GetDriverByName("GTiff")->CreateCopy(
        twelve.c_str(), wide.get(), TRUE, const_cast<char**>(bits), nullptr, nullptr));
    expectAll(twelve, grey(1.0f));
    const std::string nodata =
        made("d.tif", GDT_Float32, {0.5},
             [](GDALDataset& file) { file.GetRasterBand(1)->SetNoDataValue(0.5); });
    expectAll(nodata, grey(0.0f));
    EXPECT_NE(readEnvironmentFile(nodata)->warning.find("32 pixels have voids"), std::string::npos);
    expectAll(write("e.png", "PNG", GDT_Byte, {255, 100, 5, 0}), grey(0.0f));
    expectAll(made("f.tif", GDT_Byte, {255, 0, 0},
                   [](GDALDataset& file)
                   {
                       file.GetRasterBand(1)->SetColorInterpretation(GCI_BlueBand);
                       file.GetRasterBand(2)->SetColorInterpretation(GCI_GreenBand);
                       file.GetRasterBand(3)->SetColorInterpretation(GCI_RedBand);
                   }),
              {0.0f, 0.0f, 1.0f});
}

// An APP1 segment behind the first two bytes: TIFF of one entry, tag 274, a short (EXIF 2.3, 4.6).
TEST_F(RasterEnvironmentTest, AnOrientationThatIsNotFollowedIsSaid)
{
    const std::string path = write("a.jpg", "JPEG", GDT_Byte, {255, 100, 5}, 16, 8);
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    for (const char orientation : {'\1', '\3', '\6'})
    {
        std::string tiff = std::string("II*\0\x08\0\0\0\1\0\x12\1\3\0\1\0\0\0", 18);
        tiff += orientation + std::string(7, '\0');
        const std::string segment = std::string("\xff\xe1\0", 3) +
                                    static_cast<char>(2 + 6 + tiff.size()) +
                                    std::string("Exif\0\0", 6) + tiff;
        const std::string turned = (folder / "turned.jpg").string();
        std::ofstream(turned, std::ios::binary) << bytes.substr(0, 2) << segment << bytes.substr(2);
        const Result<EnvironmentPicture> picture = readEnvironmentFile(turned);
        ASSERT_TRUE(picture) << picture.error().message;
        EXPECT_EQ(picture->warning.find("EXIF orientation") != std::string::npos,
                  orientation != '\1')
            << picture->warning;
    }
}

TEST_F(RasterEnvironmentTest, WhatIsNoSky)
{
    const auto refused = [](const std::string& path, const char* part)
    {
        const Result<EnvironmentPicture> picture = readEnvironmentFile(path);
        ASSERT_FALSE(picture) << path;
        EXPECT_NE(picture.error().message.find(part), std::string::npos) << picture.error().message;
    };
    refused(made("cmyk.tif", GDT_Byte, {1, 2, 3, 4},
                 [](GDALDataset& file)
                 {
                     for (int i = 0; i < 4; ++i)
                         file.GetRasterBand(i + 1)->SetColorInterpretation(
                             static_cast<GDALColorInterp>(GCI_CyanBand + i));
                 }),
            "band 1 of 4 is Cyan");
    refused(made("dem.tif", GDT_Float32, {500},
                 [](GDALDataset& file) { file.GetRasterBand(1)->SetUnitType("m"); }),
            "holds lengths (unit m); needed light");
    const std::string map = made("map.tif", GDT_Float32, {500},
                                 [](GDALDataset& file)
                                 {
                                     OGRSpatialReference crs;
                                     crs.importFromEPSG(32633);
                                     file.SetSpatialRef(&crs);
                                 });
    EXPECT_NE(readEnvironmentFile(map)->warning.find("a map (CRS \"WGS 84 / UTM zone 33N\")"),
              std::string::npos);
}

TEST_F(RasterEnvironmentTest, ErrorsNameFileAndReason)
{
    const std::string whole = write("whole.png", "PNG", GDT_Byte, {1, 2, 3});
    std::ifstream file(whole, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    std::ofstream(folder / "cut.png", std::ios::binary) << bytes.substr(0, 60);
    std::ofstream(folder / "text.png") << "no picture";
    const struct
    {
        std::string path;
        const char* part;
    } cases[] = {
        {(folder / "none.png").string(), "no such file"},
        {(folder / "cut.png").string(), ""},
        {(folder / "text.png").string(), "no picture that GDAL reads"},
        {write("square.png", "PNG", GDT_Byte, {1, 2, 3}, 8, 8), "8 x 8 pixels; needed 2 : 1"},
        {write("whole.tif", "GTiff", GDT_Int16, {1, 2, 3}), "Int16 values"},
        {write("complex.tif", "GTiff", GDT_CFloat32, {1}), "complex numbers (CFloat32)"}};
    for (const auto& each : cases)
        for (int i = 0; i < 2; ++i)
        {
            const Result<EnvironmentPicture> picture = readEnvironmentFile(each.path);
            ASSERT_FALSE(picture) << each.path;
            EXPECT_EQ(picture.error().message.rfind(each.path + ": ", 0), 0u)
                << picture.error().message;
            EXPECT_NE(picture.error().message.find(each.part), std::string::npos)
                << picture.error().message;
        }
    EXPECT_FALSE(readRasterEnvironment(whole, 31)) << "8 x 4 pixels are 32";
}
