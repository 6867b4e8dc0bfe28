// Colours of a map's picture.
#include "io/MapReader.h"
#include "support/TestFolder.h"

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
/// 6 x 4 pixels; band b holds 10 b + column, the last is alpha where that is asked for.
std::string picture(const std::string& name, int bands, bool hasAlpha)
{
    GDALAllRegister();
    const std::string path = (testFolder() / name).string();
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

/// 2 x 2 pixels of bands with a colour each, whose values are 10, 20, 30 and so on.
Result<ColourImage> coloursOf(const std::vector<GDALColorInterp>& colours, const char* bits = "8")
{
    const std::string path = "/vsimem/map_colour_test.tif";
    GDALAllRegister();
    const std::string option = std::string("NBITS=") + bits;
    const char* options[] = {option.c_str(), "PHOTOMETRIC=MINISBLACK", nullptr};
    {
        const GDALDatasetUniquePtr file(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
            path.c_str(), 2, 2, static_cast<int>(colours.size()), GDT_Byte,
            const_cast<char**>(options)));
        double place[] = {500000, 10, 0, 5000000, 0, -10};
        file->SetGeoTransform(place);
        for (int band = 1; band <= file->GetRasterCount(); ++band)
        {
            file->GetRasterBand(band)->SetColorInterpretation(
                colours[static_cast<std::size_t>(band - 1)]);
            file->GetRasterBand(band)->Fill(10.0 * band);
        }
    }
    const Result<DemTile> tile = levelTileUnder(path);
    return tile ? readColour(path, *tile) : Result<ColourImage>(tile.error());
}

using Pixel = std::array<int, 4>;

Pixel firstPixel(const Result<ColourImage>& image)
{
    EXPECT_TRUE(image) << (image ? "" : image.error().message);
    return image ? Pixel{image->pixels[0], image->pixels[1], image->pixels[2], image->pixels[3]}
                 : Pixel{};
}
} // namespace

// By their colour interpretation, wherever they stand.
TEST(MapColour, BandsThatSayWhatColourTheyAre)
{
    EXPECT_EQ(firstPixel(coloursOf({GCI_BlueBand, GCI_GreenBand, GCI_RedBand})),
              (Pixel{30, 20, 10, 255}));
    EXPECT_EQ(firstPixel(coloursOf({GCI_AlphaBand, GCI_RedBand, GCI_GreenBand, GCI_BlueBand})),
              (Pixel{20, 30, 40, 10}));
    EXPECT_EQ(firstPixel(coloursOf(
                  {GCI_Undefined, GCI_BlueBand, GCI_GreenBand, GCI_RedBand, GCI_AlphaBand})),
              (Pixel{40, 30, 20, 50}));
    EXPECT_EQ(firstPixel(coloursOf({GCI_GrayIndex, GCI_AlphaBand})), (Pixel{10, 10, 10, 20}));
    EXPECT_EQ(firstPixel(coloursOf({GCI_GrayIndex})), (Pixel{10, 10, 10, 255}));
    const Result<ColourImage> print =
        coloursOf({GCI_CyanBand, GCI_MagentaBand, GCI_YellowBand, GCI_BlackBand});
    ASSERT_FALSE(print);
    EXPECT_NE(print.error().message.find("needed red, green and blue"), std::string::npos)
        << print.error().message;
}

// A mask and a nodata value cover as alpha does, also where bands are taken in another order.
TEST(MapColour, WhatIsVoidIsTransparent)
{
    const std::string path = "/vsimem/map_colour_mask.tif";
    GDALAllRegister();
    for (const bool byMask : {true, false})
    {
        {
            const CPLConfigOptionSetter inside("GDAL_TIFF_INTERNAL_MASK", "YES", false);
            const char* options[] = {"PHOTOMETRIC=MINISBLACK", nullptr};
            const GDALDatasetUniquePtr file(
                GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
                    path.c_str(), 4, 4, 3, GDT_Byte, const_cast<char**>(options)));
            double place[] = {500000, 10, 0, 5000000, 0, -10};
            file->SetGeoTransform(place);
            const GDALColorInterp colours[] = {GCI_BlueBand, GCI_GreenBand, GCI_RedBand};
            for (int band = 1; band <= 3; ++band)
            {
                GDALRasterBand& to = *file->GetRasterBand(band);
                to.SetColorInterpretation(colours[band - 1]);
                std::vector<unsigned char> values(16, static_cast<unsigned char>(10 * band));
                for (std::size_t i = 0; i < 16; ++i)
                    values[i] = i % 4 < 2 && !byMask ? 7 : values[i];
                if (!byMask)
                    to.SetNoDataValue(7.0);
                EXPECT_EQ(
                    to.RasterIO(GF_Write, 0, 0, 4, 4, values.data(), 4, 4, GDT_Byte, 0, 0, nullptr),
                    CE_None);
            }
            if (byMask)
            {
                EXPECT_EQ(file->CreateMaskBand(GMF_PER_DATASET), CE_None);
                std::vector<unsigned char> mask(16);
                for (std::size_t i = 0; i < 16; ++i)
                    mask[i] = i % 4 < 2 ? 0 : 255;
                EXPECT_EQ(file->GetRasterBand(1)->GetMaskBand()->RasterIO(
                              GF_Write, 0, 0, 4, 4, mask.data(), 4, 4, GDT_Byte, 0, 0, nullptr),
                          CE_None);
            }
        }
        const Result<DemTile> tile = levelTileUnder(path);
        ASSERT_TRUE(tile) << tile.error().message;
        const Result<ColourImage> image = readColour(path, *tile);
        ASSERT_TRUE(image) << image.error().message;
        ASSERT_EQ(image->width, 4);
        EXPECT_EQ(image->pixels[3], 0) << byMask;
        const std::size_t east = 4 * 3;
        EXPECT_EQ(image->pixels[east], 30) << byMask;
        EXPECT_EQ(image->pixels[east + 2], 10);
        EXPECT_EQ(image->pixels[east + 3], 255);
    }
}

// The greatest number of so many bits is white: 10 of 15 is 170 of 255.
TEST(MapColour, FewerBitsThanEight)
{
    EXPECT_EQ(firstPixel(coloursOf({GCI_GrayIndex}, "4")), (Pixel{170, 170, 170, 255}));
}

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
