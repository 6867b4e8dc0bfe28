#include "io/DemReader.h"
#include "io/GroundSpacing.h"

#include "support/MemoryRaster.h"
#include "support/SharedData.h"

#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <thread>

using namespace osgTerrainLight;

namespace
{

const double missing = std::numeric_limits<double>::quiet_NaN();
const std::string jacksboro = OTL_SOURCE_DIR "/samples/data/jacksboro_90m.tif";

double heightAt(const DemTile& tile, int column, int row)
{
    return tile.heightOrigin + static_cast<double>(tile.heightAt(column, row));
}

std::pair<double, double> heightRange(const DemTile& tile)
{
    std::pair<double, double> range{1.0e9, -1.0e9};
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column)
            if (tile.isValid(column, row))
            {
                range.first = std::min(range.first, heightAt(tile, column, row));
                range.second = std::max(range.second, heightAt(tile, column, row));
            }
    return range;
}

bool mentions(const std::vector<std::string>& notes, const std::string& text)
{
    for (const std::string& note : notes)
        if (note.find(text) != std::string::npos)
            return true;
    return false;
}

std::vector<double> heightsOf(const DemTile& tile)
{
    std::vector<double> heights;
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column)
            heights.push_back(tile.isValid(column, row) ? heightAt(tile, column, row) : missing);
    return heights;
}

void expectHeights(const DemTile& tile, const std::vector<double>& expected)
{
    const std::vector<double> found = heightsOf(tile);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
        if (std::isnan(expected[i]))
            EXPECT_TRUE(std::isnan(found[i])) << i;
        else
            EXPECT_NEAR(found[i], expected[i], 1.0e-4) << i; // of float at a range of 1 km
}

} // namespace

// WGS 84: π/180 · a, and M(φ)·π/180 from M = a(1 − e²)/(1 − e² sin² φ)^1.5 worked out separately.
TEST(MetresPerRadian, KnownLengthsOfADegree)
{
    const double degree = std::acos(-1.0) / 180.0;
    const double a = 6378137.0;
    const double b = a * (1.0 - 1.0 / 298.257223563);
    EXPECT_NEAR(metresPerRadian(0.0, a, b).east * degree, 111319.4908, 1.0e-4);
    EXPECT_NEAR(metresPerRadian(0.0, a, b).north * degree, 110574.2758, 1.0e-4);
    EXPECT_NEAR(metresPerRadian(45.0 * degree, a, b).north * degree, 111131.7774, 1.0e-4);
    EXPECT_NEAR(metresPerRadian(60.0 * degree, a, b).east * degree, 55800.0, 1.0);
    EXPECT_NEAR(metresPerRadian(90.0 * degree, a, b).north * degree, 111693.97956, 1.0e-4);
    EXPECT_NEAR(metresPerRadian(-45.0 * degree, a, b).north,
                metresPerRadian(45.0 * degree, a, b).north, 1.0e-6);
}

TEST(MetresPerRadian, PolesKeepAPositiveSpacing)
{
    const double half = std::acos(-1.0) / 2.0;
    EXPECT_NEAR(metresPerRadian(half, 6378137.0, 6356752.0).east, 6.4, 0.1);
    EXPECT_GT(metresPerRadian(-half, 1737400.0, 1737400.0).east, 0.0);
}

struct Readable
{
    const char* file;
    int width, height;
    std::size_t voids;
    double lowest, highest;
    double east, north;      // spacing in the middle [m]
    double originX, originY; // post (0, 0)
    const char* note;        // part of one note; empty: no notes at all
};

struct Refused
{
    const char* file;
    ErrorCode code;
    const char* message; // part of it
};

// Sizes, ranges and void counts are those of gdalinfo -stats, apart from feet and planted values.
// Spacings of the two equal-area maps: PROJ's geod between posts beside the middle.
// Spacings of geographic files: cell · π/180 · radius of curvature, to four digits.
// clang-format off
const Readable readable[] = {
    {"N10W110.hgt.zip", 1201, 1201, 0, 0, 9, 91.223, 92.176, -110.0, 10.0, ""},
    {"everest_voids_256.tif", 256, 256, 17062, 3374, 8642, 82.048, 92.348, 86.75, 27.7875, ""},
    {"fuji_1x1.tif", 1, 1, 0, 525, 525, 75.608, 92.458, 138.5, 35.5, ""},
    {"fuji_2x2.tif", 2, 2, 0, 494, 564, 75.608, 92.458, 138.5, 35.499166667, ""},
    {"fuji_600x1.tif", 600, 1, 1, 227, 1991, 75.608, 92.458, 138.25, 35.5, ""},
    {"fuji_cog_512.tif", 512, 512, 105, 1, 3742, 75.729, 92.456, 138.5, 35.1575, ""},
    {"fuji_moved_antimeridian.tif",
     128, 128, 0, 459, 1948, 88.946, 92.220, 179.947083373, -16.606250033, ""},
    {"fuji_moved_northpole.tif",
     128, 128, 0, 459, 1948, 0.08596, 93.078, 10.000416667, 89.89375, ""},
    {"fuji_two_part_gap.vrt", 300, 200, 12052, 278, 3742, 75.686, 92.457, 138.5, 35.333333333, ""},
    {"gdal_nodata_float.asc", 5, 5, 0, 107, 156, 60, 60, 440750, 3750150, "no CRS"},
    {"olinda_dem_utm25s.tif",
     111, 111, 0, -1, 88, 89.9941, 89.9941, 288821.247034, 9110816.405587, ""},
    {"rainier_feet_scale_offset.tif",
     128, 128, 1, 1082.04, 2013.966, 64.128, 92.632, -121.416666667, 46.310833333, ""},
    {"rainier_inf_nan_undeclared.tif",
     64, 64, 13, 1355, 2014, 64.097, 92.632, -121.416666667, 46.364166667,
     "12 posts without a finite height"},
    {"rasterio_float_nan.tif", 3, 2, 1, -1.88, 1.41, 100, 100, 50, 50, "no CRS"},
    {"rasterio_float_raster_with_nodata.tif",
     13, 12, 58, 0, 0.25, 506.111, 493.966, 6301862.204094, 3308362.230618, ""},
    {"rasterio_test_esri_wkt.tif", 2, 2, 0, 1, 4, 10.030, 9.970, -14060, 2368510, ""},
    {"topobathy_lon0_360_nonsquare.tif",
     120, 91, 0, -1437, 2205, 2439.07, 2431.55, 234.016693115, 48.016368867, ""},
};

const Refused refused[] = {
    {"PROVENANCE.md", ErrorCode::Invalid, "no raster that GDAL reads"},
    {"empty.tif", ErrorCode::Invalid, "is empty"},
    {"rasterio_all-nodata.tif", ErrorCode::NotSupported, "picture's (Blue)"},
    {"rasterio_rotated.tif", ErrorCode::NotSupported, "gdalwarp"},
    {"text_named.tif", ErrorCode::Invalid, "no raster that GDAL reads"},
    {"truncated_cog.tif", ErrorCode::Failed, "X offset 1, Y offset 0"},
    {"truncated_everest.tif", ErrorCode::Invalid, "damaged"},
};
// clang-format on

TEST(AwkwardDem, EveryFileIsReadOrRefusedAsExpected)
{
    OTL_SKIP_WITHOUT_SHARED_DATA();
    testing::internal::CaptureStderr();
    for (const Refused& expected : refused)
    {
        SCOPED_TRACE(expected.file);
        const std::string path = sharedData("awkward/") + expected.file;
        const Result<DemFile> read = readDem(path);
        ASSERT_FALSE(read.ok());
        EXPECT_EQ(read.error().code, expected.code) << read.error().message;
        EXPECT_NE(read.error().message.find(expected.message), std::string::npos)
            << read.error().message;
        EXPECT_EQ(read.error().message.rfind(path, 0), 0u) << "names the file first";
    }
    for (const Readable& expected : readable)
    {
        SCOPED_TRACE(expected.file);
        const std::string path = sharedData("awkward/") + expected.file;
        const Result<DemFile> read = readDem(path);
        ASSERT_TRUE(read.ok()) << read.error().message;
        const DemTile& tile = read->tile;
        EXPECT_EQ(tile.width(), expected.width);
        EXPECT_EQ(tile.height(), expected.height);
        EXPECT_EQ(tile.postCount() - tile.validCount(), expected.voids);
        const auto [lowest, highest] = heightRange(tile);
        EXPECT_NEAR(lowest, expected.lowest, 1.0e-3);
        EXPECT_NEAR(highest, expected.highest, 1.0e-3);
        EXPECT_EQ(tile.heightOrigin, std::round(0.5 * (lowest + highest)));
        EXPECT_NEAR(tile.nominalEastSpacing(), expected.east, 1.0e-4 * expected.east);
        EXPECT_NEAR(tile.northSpacing, expected.north, 1.0e-4 * expected.north);
        EXPECT_NEAR(tile.mapOriginX, expected.originX, 1.0e-6);
        EXPECT_NEAR(tile.mapOriginY, expected.originY, 1.0e-6);
        for (const double spacing : tile.eastSpacings)
            ASSERT_GT(spacing, 0.0);
        if (std::string(expected.note).empty())
            EXPECT_TRUE(read->notes.empty()) << read->notes.front();
        else
            EXPECT_TRUE(mentions(read->notes, expected.note));

        const Result<DemInfo> info = describeDem(path);
        ASSERT_TRUE(info.ok());
        EXPECT_DOUBLE_EQ(info->eastSpacing, tile.nominalEastSpacing());
        EXPECT_DOUBLE_EQ(info->northSpacing, tile.northSpacing);
        EXPECT_EQ(info->frame.geoTransform, read->frame.geoTransform);
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "GDAL's messages are ours to give";
}

TEST(AwkwardDem, TheTableHasEveryFileOfTheFolder)
{
    OTL_SKIP_WITHOUT_SHARED_DATA();
    std::set<std::string> known;
    for (const Readable& entry : readable)
        known.insert(entry.file);
    for (const Refused& entry : refused)
        known.insert(entry.file);
    std::size_t found = 0;
    for (const auto& entry : std::filesystem::directory_iterator(sharedData("awkward")))
    {
        ++found;
        EXPECT_EQ(known.count(entry.path().filename().string()), 1u) << entry.path();
    }
    EXPECT_EQ(found, known.size());
}

TEST(AwkwardDem, PlantedValuesAreVoidWhereTheyWerePlanted)
{
    OTL_SKIP_WITHOUT_SHARED_DATA();
    const Result<DemFile> read = readDem(sharedData("awkward/rainier_inf_nan_undeclared.tif"));
    ASSERT_TRUE(read.ok()) << read.error().message;
    const auto validAt = [&](int column, int fileRow)
    { return read->tile.isValid(column, 63 - fileRow); };
    EXPECT_FALSE(validAt(10, 10));
    EXPECT_FALSE(validAt(20, 20));
    EXPECT_FALSE(validAt(31, 31));
    EXPECT_FALSE(validAt(40, 40));
    EXPECT_TRUE(validAt(11, 10));
    EXPECT_TRUE(validAt(10, 40));
    EXPECT_TRUE(mentions(read->notes, "1 post of -32768"));
}

TEST(AwkwardDem, ZippedByPathAndHintForAnArchive)
{
    OTL_SKIP_WITHOUT_SHARED_DATA();
    const std::string archive = "/vsizip/" + sharedData("awkward/N10W110.hgt.zip");
    EXPECT_TRUE(readDem(archive + "/N10W110.hgt").ok());
    const Result<DemFile> whole = readDem(archive);
    ASSERT_FALSE(whole.ok());
    EXPECT_NE(whole.error().message.find("such as N10W110.hgt"), std::string::npos)
        << whole.error().message;
}

TEST(AwkwardDem, AllVoidIsAnErrorOfItsOwn)
{
    OTL_SKIP_WITHOUT_SHARED_DATA();
    DemReadOptions options;
    options.band = 4; // not a colour of the picture
    const Result<DemFile> read = readDem(sharedData("awkward/rasterio_all-nodata.tif"), options);
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().message.find("holds no valid height"), std::string::npos);
}

TEST(DemReader, SampleTile)
{
    const Result<DemFile> read = readDem(jacksboro);
    ASSERT_TRUE(read.ok()) << read.error().message;
    const DemTile& tile = read->tile;
    EXPECT_EQ(tile.width(), 403);
    EXPECT_EQ(tile.height(), 344);
    EXPECT_EQ(tile.validCount(), tile.postCount());
    EXPECT_EQ(heightRange(tile), std::make_pair(236.0, 1076.0));
    EXPECT_EQ(tile.heightOrigin, 656.0);
    EXPECT_EQ(tile.eastSpacings.size(), 344u);
    EXPECT_GT(tile.eastSpacings.front(), tile.eastSpacings.back()) << "row 0 is the southernmost";
    EXPECT_TRUE(read->frame.northUp);
    EXPECT_TRUE(read->frame.hasGeoTransform);
    EXPECT_FALSE(tile.crs.empty());
}

TEST(DemReader, WindowIsThatPartOfTheWhole)
{
    const Result<DemFile> whole = readDem(jacksboro);
    DemReadOptions options;
    options.window = PixelWindow{100, 37, 51, 20};
    const Result<DemFile> part = readDem(jacksboro, options);
    ASSERT_TRUE(whole.ok() && part.ok());
    const int shift = 344 - 37 - 20; // of rows, from the south
    for (int row = 0; row < 20; ++row)
        for (int column = 0; column < 51; ++column)
            ASSERT_EQ(heightAt(part->tile, column, row),
                      heightAt(whole->tile, column + 100, row + shift));
    EXPECT_NEAR(part->tile.mapOriginX, whole->tile.mapOriginX + 100 * whole->tile.mapStepX, 1e-9);
    EXPECT_NEAR(part->tile.mapOriginY, whole->tile.mapOriginY + shift * whole->tile.mapStepY, 1e-9);
    EXPECT_DOUBLE_EQ(part->tile.eastSpacing(3), whole->tile.eastSpacing(3 + shift));

    for (const PixelWindow& bad :
         {PixelWindow{-1, 0, 5, 5}, PixelWindow{0, 0, 404, 5}, PixelWindow{400, 0, 4, 5},
          PixelWindow{0, 0, 0, 5}, PixelWindow{2147483647, 0, 2147483647, 1}})
    {
        options.window = bad;
        const Result<DemFile> read = readDem(jacksboro, options);
        ASSERT_FALSE(read.ok());
        EXPECT_NE(read.error().message.find("403 x 344"), std::string::npos);
    }
}

TEST(DemReader, TooManyPostsAreRefusedUnread)
{
    DemReadOptions options;
    options.maxPosts = 1000;
    const Result<DemFile> read = readDem(jacksboro, options);
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().message.find("403 x 344"), std::string::npos);
    EXPECT_NE(read.error().message.find("1000"), std::string::npos);
    EXPECT_NE(read.error().message.find("window"), std::string::npos);
    EXPECT_TRUE(describeDem(jacksboro, options).ok());
    options.window = PixelWindow{0, 0, 100, 10};
    EXPECT_TRUE(readDem(jacksboro, options).ok());

    MemoryRaster huge;
    huge.width = huge.height = 200000;
    huge.values = {1, 2, 3, 4, 5, 6};
    huge.creation = {"SPARSE_OK=TRUE", "TILED=YES", "BLOCKXSIZE=4096", "BLOCKYSIZE=4096"};
    const std::string path = "/vsimem/huge.tif";
    GDALAllRegister();
    CPLStringList creation;
    for (const std::string& option : huge.creation)
        creation.AddString(option.c_str());
    GDALDatasetUniquePtr dataset(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        path.c_str(), huge.width, huge.height, 1, GDT_Float32, creation.List()));
    dataset->SetGeoTransform(huge.transform.data());
    dataset.reset();
    EXPECT_FALSE(readDem(path).ok());
    options.maxPosts = 100;
    options.window = PixelWindow{199990, 199990, 10, 10};
    EXPECT_TRUE(readDem(path, options).ok());
}

TEST(DemReader, MissingFileIsNotFound)
{
    const Result<DemFile> read = readDem("/nowhere/at_all.tif");
    ASSERT_FALSE(read.ok());
    EXPECT_EQ(read.error().code, ErrorCode::NotFound);
    EXPECT_EQ(readDem("").error().code, ErrorCode::NotFound);
    EXPECT_EQ(describeDem("/nowhere/at_all.tif").error().code, ErrorCode::NotFound);
    EXPECT_EQ(readDem(OTL_SOURCE_DIR).error().code, ErrorCode::Invalid);
}

TEST(DemReader, RowAndColumnOrder)
{
    MemoryRaster raster;
    Result<DemFile> read = readDem(raster.write());
    ASSERT_TRUE(read.ok()) << read.error().message;
    expectHeights(read->tile, {4, 5, 6, 1, 2, 3});
    EXPECT_EQ(read->tile.mapOriginX, 500005.0);
    EXPECT_EQ(read->tile.mapOriginY, 3999985.0);

    raster.transform = {500000, 10, 0, 4000000, 0, 10}; // south-up
    read = readDem(raster.write());
    expectHeights(read->tile, {1, 2, 3, 4, 5, 6});
    EXPECT_FALSE(read->frame.northUp);
    EXPECT_EQ(read->tile.mapOriginY, 4000005.0);

    raster.transform = {500000, -10, 0, 4000000, 0, -20}; // east first, not square
    read = readDem(raster.write());
    expectHeights(read->tile, {6, 5, 4, 3, 2, 1});
    EXPECT_FALSE(read->frame.westFirst);
    EXPECT_EQ(read->tile.mapOriginX, 500000.0 - 25.0);
    EXPECT_EQ(read->tile.mapStepX, 10.0);
    EXPECT_EQ(read->tile.northSpacing, 20.0);
    EXPECT_EQ(read->tile.eastSpacing(0), 10.0);
}

TEST(DemReader, HeightUnits)
{
    struct Case
    {
        const char* unit;
        double metres;
        bool note;
    };
    const double surveyFoot = 1200.0 / 3937.0;
    for (const Case& unit :
         {Case{"", 1.0, false}, Case{"m", 1.0, false}, Case{"Metre", 1.0, false},
          Case{"ft", 0.3048, false}, Case{"foot", 0.3048, false},
          Case{"US survey foot", surveyFoot, false}, Case{"ftUS", surveyFoot, false},
          Case{"us-ft", surveyFoot, false}, Case{"cubits", 1.0, true}})
    {
        SCOPED_TRACE(unit.unit);
        MemoryRaster raster;
        raster.unit = unit.unit;
        const Result<DemFile> read = readDem(raster.write());
        ASSERT_TRUE(read.ok());
        EXPECT_NEAR(heightAt(read->tile, 2, 0), 6.0 * unit.metres, 1e-6);
        EXPECT_EQ(mentions(read->notes, unit.unit + std::string("\" is not known")), unit.note);
    }
}

TEST(DemReader, HeightUnitOfACompoundCrs)
{
    MemoryRaster raster;
    raster.crs = "EPSG:32633+6360"; // NAVD88 in US survey feet
    const Result<DemFile> read = readDem(raster.write());
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_NEAR(heightAt(read->tile, 2, 0), 6.0 * 1200.0 / 3937.0, 1e-6);
    EXPECT_EQ(read->tile.northSpacing, 10.0) << "the map unit is not the height unit";
}

TEST(DemReader, MapUnits)
{
    MemoryRaster raster;
    raster.crs = "EPSG:2263"; // New York, US survey feet
    raster.transform = {980000, 100, 0, 200000, 0, -100};
    Result<DemFile> read = readDem(raster.write());
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_NEAR(read->tile.northSpacing, 100.0 * 1200.0 / 3937.0, 1e-9);
    EXPECT_NEAR(heightAt(read->tile, 2, 0), 6.0 * 1200.0 / 3937.0, 1e-6);
    EXPECT_TRUE(mentions(read->notes, "in the map's, US survey foot"));

    raster.crs = "EPSG:2263+6360";
    read = readDem(raster.write());
    EXPECT_NEAR(read->tile.northSpacing, 100.0 * 1200.0 / 3937.0, 1e-9);
    EXPECT_NEAR(heightAt(read->tile, 2, 0), 6.0 * 1200.0 / 3937.0, 1e-6);

    raster.crs = "";
    read = readDem(raster.write());
    EXPECT_EQ(read->tile.northSpacing, 100.0);
    ASSERT_EQ(read->notes.size(), 1u);
    EXPECT_NE(read->notes.front().find("no CRS"), std::string::npos);

    raster.crs = "LOCAL_CS[\"site\",UNIT[\"foot\",0.3048]]";
    read = readDem(raster.write());
    EXPECT_NEAR(read->tile.northSpacing, 30.48, 1e-9);
    EXPECT_TRUE(mentions(read->notes, "local CRS"));

    raster.crs = "EPSG:3857"; // at 60° north its metres are half a metre
    raster.transform = {0, 100, 0, 8399737.89, 0, -100};
    read = readDem(raster.write());
    // By the radii of curvature on the ellipsoid; the map's own radius is a.
    const MetresPerRadian metres =
        metresPerRadian(59.9996 * std::acos(-1.0) / 180.0, 6378137.0, 6356752.314245);
    EXPECT_NEAR(read->tile.eastSpacing(0), 100.0 * metres.east / 6378137.0, 1e-3);
    EXPECT_NEAR(read->tile.northSpacing,
                100.0 * metres.north * std::cos(59.9996 * std::acos(-1.0) / 180.0) / 6378137.0,
                1e-3);
    EXPECT_TRUE(read->notes.empty()) << read->notes.front();
}

TEST(DemReader, ScaleOffsetAndUnitTogether)
{
    MemoryRaster raster;
    raster.type = GDT_UInt16;
    raster.values = {0, 2000, 2001, 65535, 4000, 5000};
    raster.noData = 65535;
    raster.scale = 0.5;
    raster.offset = -1000;
    raster.unit = "ft";
    const Result<DemFile> read = readDem(raster.write());
    ASSERT_TRUE(read.ok()) << read.error().message;
    expectHeights(read->tile, {missing, 304.8, 457.2, -304.8, 0, 0.1524});
}

TEST(DemReader, VoidsOfEveryKind)
{
    const double inf = std::numeric_limits<double>::infinity();
    MemoryRaster raster;
    raster.values = {1, missing, inf, -inf, 3.4e38, -1000001};
    Result<DemFile> read = readDem(raster.write());
    ASSERT_TRUE(read.ok());
    expectHeights(read->tile, {missing, missing, missing, 1, missing, missing});
    EXPECT_TRUE(mentions(read->notes, "5 posts"));

    raster.values = {1, -99999.123, 3, 4, 5, 6}; // rounded to float on the way in
    raster.noData = -99999.123;
    read = readDem(raster.write());
    expectHeights(read->tile, {4, 5, 6, 1, missing, 3});
    raster.type = GDT_Float64;
    read = readDem(raster.write());
    expectHeights(read->tile, {4, 5, 6, 1, missing, 3});

    raster.type = GDT_Int32;
    raster.values = {1, 16777217, 3, 4, 5, 6};
    raster.scale = 0.01;
    raster.noData = 16777216; // not the same as its neighbour, though float has no place for both
    read = readDem(raster.write());
    EXPECT_TRUE(read->tile.isValid(1, 1));

    raster = MemoryRaster();
    raster.type = GDT_Int16;
    raster.values = {1, -32768, 3, -9999, 5, 6};
    read = readDem(raster.write());
    expectHeights(read->tile, {missing, 5, 6, 1, missing, 3});
    EXPECT_TRUE(mentions(read->notes, "1 post of -32768"));
    EXPECT_TRUE(mentions(read->notes, "1 post of -9999"));

    raster = MemoryRaster();
    raster.datasetMask = {255, 0, 255, 255, 255, 0};
    read = readDem(raster.write());
    expectHeights(read->tile, {4, 5, missing, 1, missing, 3});

    raster = MemoryRaster();
    raster.type = GDT_UInt16;
    raster.bands = 2;
    raster.creation = {"ALPHA=YES"}; // never written, so 0 everywhere
    EXPECT_NE(readDem(raster.write()).error().message.find("no valid height"), std::string::npos);
}

TEST(DemReader, PreciseHeightsSurviveALargeOffset)
{
    MemoryRaster raster;
    raster.type = GDT_Float64;
    raster.values = {900000.125, 900000.25, 900000.375, 900000.5, 900000.625, 900000.001};
    const Result<DemFile> read = readDem(raster.write());
    ASSERT_TRUE(read.ok());
    EXPECT_NEAR(heightAt(read->tile, 2, 0), 900000.001, 1e-7);
    EXPECT_EQ(read->tile.heightOrigin, 900000.0);
}

TEST(DemReader, PixelIsPointPostsAreWhereTheFileSays)
{
    MemoryRaster raster;
    const std::string path = raster.write();
    GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
    dataset->SetMetadataItem("AREA_OR_POINT", "Point");
    dataset->SetGeoTransform(raster.transform.data());
    dataset.reset();
    const Result<DemFile> read = readDem(path);
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(read->tile.mapOriginX, 500005.0);
    EXPECT_EQ(read->tile.mapOriginY, 3999985.0);
}

TEST(DemReader, NoGeotransformNeedsACellSize)
{
    MemoryRaster raster;
    raster.transform.clear();
    raster.crs = "";
    const std::string path = raster.write();
    Result<DemFile> read = readDem(path);
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().message.find("no geotransform"), std::string::npos);

    DemReadOptions options;
    options.cellSize = 25.0;
    read = readDem(path, options);
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(read->tile.northSpacing, 25.0);
    EXPECT_EQ(read->tile.eastSpacing(0), 25.0);
    EXPECT_FALSE(read->frame.hasGeoTransform);
    expectHeights(read->tile, {4, 5, 6, 1, 2, 3});
    EXPECT_EQ(read->notes.size(), 1u);

    for (const double bad : {0.0, -1.0, missing})
    {
        options.cellSize = bad;
        EXPECT_FALSE(readDem(path, options).ok());
    }
    options.cellSize = 25.0;
    read = readDem(MemoryRaster().write(), options);
    EXPECT_EQ(read->tile.northSpacing, 10.0);
    EXPECT_TRUE(mentions(read->notes, "cell size given is not used"));
}

TEST(DemReader, PlacesThatAreNoneAreRefused)
{
    const struct
    {
        std::vector<double> transform;
        const char* said;
    } places[] = {{{0, 10, 5, 0, 5, -10}, "is rotated (10, 5; 5, -10)"},
                  {{0, 10, 0.1, 0, 0, -10}, "is rotated"}, // 0.2 m over 2 rows
                  {{0, 0, 10, 0, 10, 0}, "is rotated"},    // rows along the other axis
                  {{0, 10, 0, 0, 0, 0}, "has no cell size"},
                  {{1.7e308, 1e307, 0, 0, 0, -10}, "no finite place"}, // east of 1.797e308
                  {{0, 10, 0, -1.7e308, 0, -1e308}, "no finite place"},
                  {{0, 0, 0, 0, 0, -10}, "has no cell size"},
                  {{0, missing, 0, 0, 0, -10}, "has no cell size"}};
    for (const auto& place : places)
    {
        // GeoTIFF writes some of them in another way.
        std::string text = "<VRTDataset rasterXSize=\"3\" rasterYSize=\"2\"><GeoTransform>";
        for (const double number : place.transform)
            text += (text.back() == '>' ? "" : ",") + std::to_string(number);
        text += "</GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\"/></VRTDataset>";
        const Result<DemFile> read = readDem(text);
        ASSERT_FALSE(read) << place.said;
        EXPECT_NE(read.error().message.find(place.said), std::string::npos) << read.error().message;
    }
    MemoryRaster raster;
    raster.transform = {0, 10, 0.001, 0, 0, -10}; // rounding of whoever wrote it
    EXPECT_TRUE(readDem(raster.write()));

    raster.transform.clear();
    raster.crs.clear();
    const std::string path = raster.write();
    {
        GDALDatasetUniquePtr dataset(
            GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
        GDAL_GCP points[3];
        GDALInitGCPs(3, points);
        for (int i = 0; i < 3; ++i)
        {
            points[i].dfGCPPixel = i % 2 * 3.0;
            points[i].dfGCPLine = i / 2 * 2.0;
            points[i].dfGCPX = 1000.0 + i % 2 * 30.0;
            points[i].dfGCPY = 2000.0 - i / 2 * 20.0;
        }
        OGRSpatialReference crs;
        crs.importFromEPSG(32633);
        ASSERT_EQ(dataset->SetGCPs(3, points, &crs), CE_None);
        GDALDeinitGCPs(3, points);
    }
    const Result<DemFile> read = readDem(path);
    ASSERT_FALSE(read);
    EXPECT_NE(read.error().message.find("only ground control points; gdalwarp"), std::string::npos)
        << read.error().message;
    DemReadOptions options;
    options.cellSize = 10.0;
    const Result<DemFile> cells = readDem(path, options);
    ASSERT_TRUE(cells) << cells.error().message;
    EXPECT_TRUE(mentions(cells->notes, "ground control points, and the place that they give, are "
                                       "not used"));
    EXPECT_FALSE(mentions(readDem(raster.write(), options)->notes, "ground control"));
}

TEST(DemReader, Poles)
{
    MemoryRaster raster;
    raster.crs = "EPSG:4326";
    raster.width = 1;
    raster.height = 6;
    raster.transform = {10, 1, 0, 91.5, 0, -1}; // posts at 91, 90, 89 …
    Result<DemFile> read = readDem(raster.write());
    ASSERT_TRUE(read.ok()) << read.error().message;
    expectHeights(read->tile, {6, 5, 4, 3, 2, missing});
    EXPECT_NEAR(read->tile.eastSpacing(4), 111694.0e-6, 1e-6) << "the floor at the pole";
    EXPECT_TRUE(mentions(read->notes, "beyond a pole"));

    raster.transform = {500000, 10, 0, 4000000, 0, -10}; // metres under a geographic CRS
    read = readDem(raster.write());
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().message.find("-90 to 90"), std::string::npos);
}

TEST(DemReader, OtherBodiesAndAngularUnits)
{
    MemoryRaster raster;
    raster.crs = "GEOGCS[\"Moon\",DATUM[\"Moon\",SPHEROID[\"Moon\",1737400,0]],"
                 "PRIMEM[\"0\",0],UNIT[\"degree\",0.0174532925199433]]";
    raster.transform = {0, 1, 0, 1, 0, -1};
    Result<DemFile> read = readDem(raster.write());
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_NEAR(read->tile.northSpacing, 1737400.0 * std::acos(-1.0) / 180.0, 0.01);
}

TEST(DemReader, PicturesAndComplexNumbersAreRefused)
{
    MemoryRaster raster;
    raster.type = GDT_Byte;
    raster.bands = 3;
    raster.creation = {"PHOTOMETRIC=RGB"};
    Result<DemFile> read = readDem(raster.write());
    ASSERT_FALSE(read.ok());
    EXPECT_EQ(read.error().code, ErrorCode::NotSupported);
    EXPECT_NE(read.error().message.find("not a DEM"), std::string::npos);

    raster = MemoryRaster();
    raster.type = GDT_CFloat32;
    EXPECT_EQ(readDem(raster.write()).error().code, ErrorCode::NotSupported);

    DemReadOptions options;
    options.band = 2;
    read = readDem(jacksboro, options);
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().message.find("no band 2"), std::string::npos);
}

TEST(DemReader, ProgressAndCancel)
{
    DemReadOptions options;
    double last = -1.0;
    options.progress = [&](double done)
    {
        EXPECT_GT(done, last);
        last = done;
        return true;
    };
    ASSERT_TRUE(readDem(jacksboro, options).ok());
    EXPECT_EQ(last, 1.0);
    options.progress = [](double) { return false; };
    const Result<DemFile> read = readDem(jacksboro, options);
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().message.find("cancelled"), std::string::npos);
}

TEST(DemReader, ManyThreadsReadTheSame)
{
    const Result<DemFile> expected = readDem(jacksboro);
    ASSERT_TRUE(expected.ok());
    std::vector<char> same(8, 0);
    std::vector<std::thread> threads;
    for (char& result : same)
        threads.emplace_back(
            [&result, &expected]
            {
                const Result<DemFile> read = readDem(jacksboro);
                result = read.ok() && read->tile.heights() == expected->tile.heights() &&
                         read->tile.eastSpacings == expected->tile.eastSpacings;
            });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(same, std::vector<char>(8, 1));
}
