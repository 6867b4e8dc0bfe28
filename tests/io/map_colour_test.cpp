// Colours of a map's picture.
#include "io/MapReader.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
/// 6 x 4 pixels; band b holds 10 b + column, the last is alpha where that is asked for.
std::string picture(const std::string& name, int bands, bool hasAlpha)
{
    GDALAllRegister();
    const std::filesystem::path folder = std::filesystem::path(OTL_BINARY_DIR) / "map_colour_test";
    std::filesystem::create_directories(folder);
    const std::string path = (folder / name).string();
    const char* options[] = {"INTERLEAVE=PIXEL", nullptr};
    const GDALDatasetUniquePtr file(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        path.c_str(), 6, 4, bands, GDT_Byte, const_cast<char**>(options)));
    double place[] = {500000, 10, 0, 5000000, 0, -10};
    file->SetGeoTransform(place);
    if (hasAlpha)
        file->GetRasterBand(bands)->SetColorInterpretation(GCI_AlphaBand);
    for (int band = 1; band <= bands; ++band)
        for (int row = 0; row < 4; ++row)
        {
            std::vector<unsigned char> line(6);
            for (int column = 0; column < 6; ++column)
                line[static_cast<std::size_t>(column)] =
                    static_cast<unsigned char>(10 * band + column);
            EXPECT_EQ(file->GetRasterBand(band)->RasterIO(GF_Write, 0, row, 6, 1, line.data(), 6, 1,
                                                          GDT_Byte, 0, 0, nullptr),
                      CE_None);
        }
    return path;
}
} // namespace

// Bands behind the third are no colours, however many; the last counts where it is alpha.
TEST(MapColour, OfManyBandsTheFirstThree)
{
    const std::string plain = picture("plain.tif", 3, false);
    const Result<DemTile> tile = levelTileUnder(plain);
    ASSERT_TRUE(tile) << tile.error().message;
    const Result<ColourImage> three = readColour(plain, *tile);
    ASSERT_TRUE(three) << three.error().message;
    for (const int bands : {5, 8, 300})
    {
        const Result<ColourImage> many = readColour(picture("many.tif", bands, false), *tile);
        ASSERT_TRUE(many) << many.error().message;
        EXPECT_EQ(many->pixels, three->pixels) << bands;
    }
    const Result<ColourImage> four = readColour(picture("four.tif", 4, true), *tile);
    const Result<ColourImage> seven = readColour(picture("seven.tif", 7, true), *tile);
    ASSERT_TRUE(four && seven);
    for (std::size_t i = 0; i < four->pixels.size(); i += 4)
    {
        EXPECT_EQ(four->pixels[i], seven->pixels[i]);
        EXPECT_EQ(four->pixels[i + 3] + 30, seven->pixels[i + 3]) << "alpha of band 4 and 7";
    }
}
