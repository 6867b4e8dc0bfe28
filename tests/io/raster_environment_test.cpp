#include "io/RasterEnvironment.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
namespace fs = std::filesystem;

class RasterEnvironmentTest : public testing::Test
{
protected:
    void SetUp() override
    {
        GDALAllRegister();
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder = fs::path(OTL_BINARY_DIR) / "raster_environment_test" / test->name();
        fs::remove_all(folder);
        fs::create_directories(folder);
    }

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

    fs::path folder;
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
    expectAll(write("b.png", "PNG", GDT_Byte, {255, 100, 5, 0}), bytes); // alpha is not light
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
        {write("complex.tif", "GTiff", GDT_CFloat32, {1}), "CFloat32 values"}};
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
