// Folders of tiles as one raster: where each pixel lies, in closed form.
#include "io/TileRaster.h"

#include "io/DemReader.h"
#include "support/TestFolder.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

using namespace osgTerrainLight;

namespace
{
constexpr int side = 4;
constexpr double halfOfMercator = 20037508.342789244;

/// A grey tile of one value, below the folder of the test.
void write(const std::string& name, double value)
{
    GDALAllRegister();
    const std::filesystem::path path = testFolder() / name;
    std::filesystem::create_directories(path.parent_path());
    const GDALDatasetUniquePtr tile(GetGDALDriverManager()->GetDriverByName("MEM")->Create(
        "", side, side, 1, GDT_Byte, nullptr));
    tile->GetRasterBand(1)->Fill(value);
    const GDALDatasetUniquePtr file(GetGDALDriverManager()->GetDriverByName("PNG")->CreateCopy(
        path.string().c_str(), tile.get(), FALSE, nullptr, nullptr, nullptr));
    ASSERT_TRUE(file);
}

/// Values of the middles of tiles, row after row from the north; -1 where alpha is 0.
std::vector<int> tilesOf(const Result<TileRaster>& raster, std::array<double, 6>& place)
{
    EXPECT_TRUE(raster) << (raster ? "" : raster.error().message);
    const GDALDatasetUniquePtr file(raster ? GDALDataset::Open(raster->path().c_str()) : nullptr);
    std::vector<int> values;
    if (!file || file->GetRasterCount() != 2)
        return values;
    file->GetGeoTransform(place.data());
    for (int y = 1; y < file->GetRasterYSize(); y += side)
        for (int x = 1; x < file->GetRasterXSize(); x += side)
        {
            std::array<GByte, 2> pixel{};
            EXPECT_EQ(file->RasterIO(GF_Read, x, y, 1, 1, pixel.data(), 1, 1, GDT_Byte, 2, nullptr,
                                     0, 0, 0, nullptr),
                      CE_None);
            values.push_back(pixel[1] == 0 ? -1 : pixel[0]);
        }
    return values;
}

void expectPlace(const std::array<double, 6>& found, double west, double north, double pixel)
{
    EXPECT_NEAR(found[0], west, 1.0e-6);
    EXPECT_NEAR(found[1], pixel, 1.0e-9 * pixel);
    EXPECT_NEAR(found[3], north, 1.0e-6);
    EXPECT_NEAR(found[5], -pixel, 1.0e-9 * pixel);
}
} // namespace

// Expected: a level-2 tile is a quarter of the map wide; rows count from the north, or the south.
TEST(TileRasters, OfAPatternInMercator)
{
    for (const char* name : {"1/0/0.png", "2/1/1.png", "2/2/1.png", "2/2/2.png", "2/2/2.txt"})
        write(name, name[0] == '1' ? 99 : 10 * (name[2] - '0') + (name[4] - '0'));
    const std::string pattern = (testFolder() / "{z}/{x}/{y}.png").string();
    const double tile = 0.5 * halfOfMercator;
    std::array<double, 6> place{};
    EXPECT_EQ(tilesOf(TileRaster::ofPattern(pattern, "", false), place),
              (std::vector<int>{11, 21, -1, 22}));
    expectPlace(place, -tile, tile, tile / side);
    EXPECT_EQ(tilesOf(TileRaster::ofPattern(pattern, "spherical-mercator", true), place),
              (std::vector<int>{-1, 22, 11, 21}));
    expectPlace(place, -tile, tile, tile / side);
}

// Expected: on level 1 of degrees there are 4 x 2 tiles of 90 degrees.
TEST(TileRasters, OfAPatternInDegrees)
{
    write("1/3/0.png", 7);
    std::array<double, 6> place{};
    EXPECT_EQ(tilesOf(TileRaster::ofPattern((testFolder() / "{z}/{x}/{y}.png").string(),
                                            "global-geodetic", false),
                      place),
              (std::vector<int>{7}));
    expectPlace(place, 90.0, 90.0, 90.0 / side);
}

// Expected: rows of a TileMap count from its origin in the south.
TEST(TileRasters, OfATileMap)
{
    write("a/0/0.png", 1);
    write("b/0/1.png", 2);
    write("b/1/0.png", 3);
    const std::string path = (testFolder() / "tms.xml").string();
    std::ofstream(path) << R"(<?xml version="1.0"?><TileMap version="1.0.0"><SRS>EPSG:32633</SRS>
<Origin x="500000" y="4000000"/><TileFormat width="4" height="4" extension="png"/>
<TileSets profile="local"><TileSet href="b" units-per-pixel="5" order="1"/>
<TileSet href="a" units-per-pixel="10" order="0"/></TileSets></TileMap>)";
    std::array<double, 6> place{};
    EXPECT_EQ(tilesOf(TileRaster::ofTileMap(path), place), (std::vector<int>{2, -1, -1, 3}));
    expectPlace(place, 500000.0, 4000040.0, 5.0);
}

// Expected: heights of the two tiles, and voids where the other two are missing.
TEST(TileRasters, OfHeights)
{
    GDALAllRegister();
    for (const auto& [name, height] :
         {std::pair("1/0/0.tif", -12.0), std::pair("1/1/1.tif", 700.0)})
    {
        const std::filesystem::path path = testFolder() / name;
        std::filesystem::create_directories(path.parent_path());
        const GDALDatasetUniquePtr file(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
            path.string().c_str(), side, side, 1, GDT_Int16, nullptr));
        file->GetRasterBand(1)->Fill(height);
    }
    const Result<TileRaster> raster =
        TileRaster::ofPattern((testFolder() / "{z}/{x}/{y}.tif").string(), "", false);
    ASSERT_TRUE(raster) << raster.error().message;
    DemReadOptions options;
    options.byMapScale = false;
    const Result<DemFile> file = readDem(raster->path(), options);
    ASSERT_TRUE(file) << file.error().message;
    const DemTile& tile = file->tile;
    ASSERT_EQ(tile.width(), 2 * side);
    ASSERT_EQ(tile.height(), 2 * side);
    for (int row = 0; row < 2 * side; ++row)
        for (int column = 0; column < 2 * side; ++column)
        {
            const bool isWest = column < side, isSouth = row < side;
            ASSERT_EQ(tile.isValid(column, row), isWest != isSouth);
            if (tile.isValid(column, row))
            {
                ASSERT_EQ(tile.heightOrigin + double(tile.heightAt(column, row)),
                          isWest ? -12.0 : 700.0);
            }
        }
}

TEST(TileRasters, ErrorsNameThePath)
{
    const std::string folder = testFolder().string();
    const auto said = [](const Result<TileRaster>& raster)
    { return raster ? std::string("nothing") : raster.error().message; };
    EXPECT_NE(said(TileRaster::ofPattern(folder + "/{z}/{x}/{y}.png", "", false))
                  .find(folder + "/{z}/{x}/{y}.png: no level with 1 to 1024 tiles"),
              std::string::npos);
    EXPECT_NE(said(TileRaster::ofPattern(folder + "/{z}.png", "", false)).find("needs a path"),
              std::string::npos);
    EXPECT_NE(said(TileRaster::ofPattern(folder + "/{z}/{x}/{y}.png", "moon", false))
                  .find("profile = \"moon\": needs"),
              std::string::npos);
    EXPECT_NE(said(TileRaster::ofTileMap(folder + "/tms.xml")).find("no such file"),
              std::string::npos);
    std::ofstream(folder + "/tms.xml") << "<map/>";
    EXPECT_NE(said(TileRaster::ofTileMap(folder + "/tms.xml")).find("is no TileMap"),
              std::string::npos);
}
