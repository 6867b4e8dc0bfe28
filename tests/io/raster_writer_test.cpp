#include "io/RasterWriter.h"

#include "support/SharedData.h"
#include "support/TestFolder.h"

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>

using namespace osgTerrainLight;

namespace
{

namespace fs = std::filesystem;
const std::string jacksboro = OTL_SOURCE_DIR "/samples/data/jacksboro_90m.tif";
constexpr float missing = std::numeric_limits<float>::quiet_NaN();

/// An empty folder for one test.
class RasterWriterTest : public testing::Test
{
protected:
    void SetUp() override { GDALAllRegister(); }

    std::string in(const std::string& name) const { return (folder / name).string(); }

    std::vector<std::string> files() const
    {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder))
            names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }

    const fs::path folder = testFolder();
};

using Names = std::vector<std::string>;

RasterFrame smallFrame()
{
    RasterFrame frame;
    frame.width = 3;
    frame.height = 2;
    frame.hasGeoTransform = true;
    frame.geoTransform = {500000, 10, 0, 4000000, 0, -10};
    OGRSpatialReference crs;
    crs.importFromEPSG(32633);
    char* text = nullptr;
    crs.exportToWkt(&text);
    frame.crs = text;
    CPLFree(text);
    return frame;
}

Raster<float> ramp(int width, int height)
{
    Raster<float> values(width, height);
    for (std::size_t i = 0; i < values.size(); ++i)
        values.values()[i] = static_cast<float>(i) + 0.25f;
    return values;
}

std::vector<RasterBand> oneBand()
{
    return {{{"horizon", "degree"}, ramp(3, 2)}};
}

GDALDatasetUniquePtr open(const std::string& path)
{
    return GDALDatasetUniquePtr(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER));
}

std::vector<float> bandValues(GDALDataset& dataset, int band)
{
    const int width = dataset.GetRasterXSize();
    const int height = dataset.GetRasterYSize();
    std::vector<float> values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    EXPECT_EQ(dataset.GetRasterBand(band)->RasterIO(GF_Read, 0, 0, width, height, values.data(),
                                                    width, height, GDT_Float32, 0, 0, nullptr),
              CE_None);
    return values;
}

Raster<float> heightsOf(const DemTile& tile)
{
    Raster<float> values(tile.width(), tile.height());
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column)
            values.at(column, row) =
                tile.isValid(column, row)
                    ? static_cast<float>(tile.heightOrigin +
                                         static_cast<double>(tile.heightAt(column, row)))
                    : missing;
    return values;
}

/// Reads a DEM, writes its heights and reads both files with GDAL alone: same place, same pixels.
void expectRoundTrip(const std::string& input, const std::string& output,
                     const DemReadOptions& options = {})
{
    SCOPED_TRACE(input);
    const Result<DemFile> dem = readDem(input, options);
    ASSERT_TRUE(dem.ok()) << dem.error().message;
    const Status written =
        writeRaster(output, dem->frame, {{{"height", "m"}, heightsOf(dem->tile)}});
    ASSERT_TRUE(written.ok()) << written.error().message;

    const GDALDatasetUniquePtr before = open(input);
    const GDALDatasetUniquePtr after = open(output);
    ASSERT_TRUE(before && after);
    double a[6] = {};
    double b[6] = {};
    before->GetGeoTransform(a);
    after->GetGeoTransform(b);
    // Heights of a tile carry the changes of the map's scale: HeightFactors.
    const Result<DemInfo> info = describeDem(input, options);
    const bool scaled = !info->geographic && info->northSpacing != std::abs(a[5]);
    const float tolerance = scaled ? 1e-4f : 0.0f;
    if (!options.window)
    {
        EXPECT_EQ(before->GetRasterXSize(), after->GetRasterXSize());
        EXPECT_EQ(before->GetRasterYSize(), after->GetRasterYSize());
        for (int i = 0; i < 6; ++i)
            EXPECT_DOUBLE_EQ(a[i], b[i]) << i;
        std::vector<float> expected = bandValues(*before, 1);
        const std::vector<float> found = bandValues(*after, 1);
        std::size_t voids = 0;
        for (std::size_t i = 0; i < found.size(); ++i)
            if (found[i] == RasterWriter::noData)
                ++voids;
            else
                ASSERT_NEAR(found[i], expected[i], tolerance * std::abs(expected[i])) << i;
        EXPECT_EQ(voids, dem->tile.postCount() - dem->tile.validCount());
    }
    else
    {
        EXPECT_DOUBLE_EQ(b[0], a[0] + options.window->column * a[1]);
        EXPECT_DOUBLE_EQ(b[3], a[3] + options.window->row * a[5]);
    }
    const OGRSpatialReference* crsBefore = before->GetSpatialRef();
    const OGRSpatialReference* crsAfter = after->GetSpatialRef();
    ASSERT_EQ(crsBefore == nullptr, crsAfter == nullptr);
    if (crsBefore)
    {
        EXPECT_TRUE(crsBefore->IsSame(crsAfter));
    }

    // And our own reader finds the same tile.
    const Result<DemFile> again = readDem(output);
    ASSERT_TRUE(again.ok()) << again.error().message;
    ASSERT_EQ(again->tile.postCount(), dem->tile.postCount());
    for (std::size_t i = 0; i < dem->tile.postCount(); ++i)
        ASSERT_NEAR(again->tile.heights()[i], dem->tile.heights()[i],
                    tolerance * std::abs(dem->tile.heights()[i]))
            << i;
    EXPECT_EQ(again->tile.validity(), dem->tile.validity());
    EXPECT_DOUBLE_EQ(again->tile.northSpacing, dem->tile.northSpacing);
    EXPECT_DOUBLE_EQ(again->tile.mapOriginX, dem->tile.mapOriginX);
    EXPECT_DOUBLE_EQ(again->tile.mapOriginY, dem->tile.mapOriginY);
}

/// Byte by byte.
std::string content(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

} // namespace

TEST_F(RasterWriterTest, RoundTripKeepsPlaceAndPixels)
{
    expectRoundTrip(jacksboro, in("whole.tif"));
    DemReadOptions options;
    options.window = PixelWindow{100, 37, 51, 20};
    expectRoundTrip(jacksboro, in("part.tif"), options);
    EXPECT_EQ(files(), (Names{"part.tif", "whole.tif"}));
}

TEST_F(RasterWriterTest, RoundTripOfAwkwardFiles)
{
    OTL_SKIP_WITHOUT_SHARED_DATA();
    for (const char* name :
         {"everest_voids_256.tif", "fuji_1x1.tif", "fuji_600x1.tif", "olinda_dem_utm25s.tif",
          "rasterio_float_nan.tif", "rasterio_float_raster_with_nodata.tif",
          "rasterio_test_esri_wkt.tif", "topobathy_lon0_360_nonsquare.tif",
          "fuji_moved_antimeridian.tif", "N10W110.hgt.zip"})
        expectRoundTrip(sharedData("awkward/") + name, in(std::string(name) + ".tif"));
}

TEST_F(RasterWriterTest, OrientationOfTheSource)
{
    for (const bool northUp : {true, false})
        for (const bool westFirst : {true, false})
        {
            RasterFrame frame = smallFrame();
            frame.northUp = northUp;
            frame.westFirst = westFirst;
            frame.geoTransform[1] = westFirst ? 10 : -10;
            frame.geoTransform[5] = northUp ? -20 : 20;
            const std::string path = in("oriented.tif");
            ASSERT_TRUE(writeRaster(path, frame, oneBand()).ok());
            const GDALDatasetUniquePtr dataset = open(path);
            double t[6] = {};
            dataset->GetGeoTransform(t);
            EXPECT_TRUE(std::equal(t, t + 6, frame.geoTransform.begin()));
            // The tile's south-west value stands where the map says south-west.
            const std::size_t at = (northUp ? 3u : 0u) + (westFirst ? 0u : 2u);
            EXPECT_EQ(bandValues(*dataset, 1)[at], 0.25f);
            const Result<DemFile> dem = readDem(path);
            ASSERT_TRUE(dem.ok());
            EXPECT_EQ(heightsOf(dem->tile).values(), ramp(3, 2).values());
        }
}

TEST_F(RasterWriterTest, LabelsUnitsNoDataAndMetadata)
{
    RasterWriteOptions options;
    options.metadata = {{"AZIMUTHS", "32"}, {"METHOD", "sweep"}};
    options.creationOptions = {"COMPRESS=DEFLATE", "TILED=YES"};
    Raster<float> holed = ramp(3, 2);
    holed.at(1, 0) = missing;
    const std::string path = in("labels.tif");
    const Status written = writeRaster(
        path, smallFrame(), {{{"north", "degree"}, ramp(3, 2)}, {{"east", ""}, holed}}, options);
    ASSERT_TRUE(written.ok()) << written.error().message;
    const GDALDatasetUniquePtr dataset = open(path);
    EXPECT_STREQ(dataset->GetRasterBand(1)->GetDescription(), "north");
    EXPECT_STREQ(dataset->GetRasterBand(1)->GetUnitType(), "degree");
    EXPECT_STREQ(dataset->GetRasterBand(2)->GetDescription(), "east");
    EXPECT_STREQ(dataset->GetMetadataItem("AZIMUTHS"), "32");
    EXPECT_STREQ(dataset->GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE"), "DEFLATE");
    EXPECT_EQ(dataset->GetRasterBand(2)->GetNoDataValue(), -9999.0);
    EXPECT_EQ(bandValues(*dataset, 2)[4], -9999.0f);
    EXPECT_EQ(files(), Names{"labels.tif"}) << "no sidecar file";
}

TEST_F(RasterWriterTest, DriverByExtensionOrName)
{
    struct Case
    {
        const char* file;
        const char* driver;
        const char* expected;
    };
    for (const Case& c :
         {Case{"a.tif", "", "GTiff"}, Case{"b.TIFF", "", "GTiff"}, Case{"c", "", "GTiff"},
          Case{"d.tif", "COG", "COG"}, Case{"e.asc", "", "AAIGrid"}, Case{"f.img", "", "HFA"},
          Case{"g.bin", "ENVI", "ENVI"}, Case{"h.asc", "gtiff", "GTiff"}})
    {
        SCOPED_TRACE(c.file);
        RasterWriteOptions options;
        options.driver = c.driver;
        const Status written = writeRaster(in(c.file), smallFrame(), oneBand(), options);
        ASSERT_TRUE(written.ok()) << written.error().message;
        const GDALDatasetUniquePtr dataset = open(in(c.file));
        ASSERT_TRUE(dataset);
        if (std::string(c.expected) == "COG")
            EXPECT_STREQ(dataset->GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE"), "COG");
        else
            EXPECT_STREQ(dataset->GetDriver()->GetDescription(), c.expected);
        EXPECT_EQ(bandValues(*dataset, 1)[0], 3.25f);
        ASSERT_NE(dataset->GetSpatialRef(), nullptr);
    }
    for (const std::string& name : files())
        EXPECT_EQ(name.find("partial"), std::string::npos);
    EXPECT_TRUE(fs::exists(in("g.hdr"))) << "sidecar files carry the final name";
    EXPECT_TRUE(fs::exists(in("e.prj")));
}

TEST_F(RasterWriterTest, BandsComeOneByOneInAnyOrder)
{
    Result<RasterWriter> writer =
        RasterWriter::open(in("bands.tif"), smallFrame(), std::vector<BandLabel>(64));
    ASSERT_TRUE(writer.ok()) << writer.error().message;
    for (int band = 64; band >= 1; --band)
    {
        const Raster<float> values(3, 2, static_cast<float>(band));
        ASSERT_TRUE(writer->writeBand(band, values).ok());
    }
    EXPECT_FALSE(writer->writeBand(1, ramp(3, 2)).ok()) << "twice";
    EXPECT_FALSE(writer->writeBand(0, ramp(3, 2)).ok());
    EXPECT_FALSE(writer->writeBand(65, ramp(3, 2)).ok());
    ASSERT_TRUE(writer->finish().ok());
    EXPECT_FALSE(writer->finish().ok()) << "twice";
    EXPECT_FALSE(writer->writeBand(1, ramp(3, 2)).ok());
    const GDALDatasetUniquePtr dataset = open(in("bands.tif"));
    EXPECT_EQ(bandValues(*dataset, 64)[0], 64.0f);
    EXPECT_STREQ(dataset->GetMetadataItem("INTERLEAVE", "IMAGE_STRUCTURE"), "BAND");
}

TEST_F(RasterWriterTest, AbandonedWriterLeavesNothing)
{
    {
        Result<RasterWriter> writer =
            RasterWriter::open(in("gone.tif"), smallFrame(), std::vector<BandLabel>(2));
        ASSERT_TRUE(writer.ok());
        ASSERT_TRUE(writer->writeBand(1, ramp(3, 2)).ok());
        EXPECT_FALSE(fs::exists(in("gone.tif"))) << "nothing at the target before finish";
    }
    EXPECT_EQ(files(), Names{});
    {
        Result<RasterWriter> writer =
            RasterWriter::open(in("gone.tif"), smallFrame(), std::vector<BandLabel>(2));
        ASSERT_TRUE(writer->writeBand(2, ramp(3, 2)).ok());
        const Status finished = writer->finish();
        ASSERT_FALSE(finished.ok());
        EXPECT_NE(finished.error().message.find("1 of 2"), std::string::npos);
    }
    EXPECT_EQ(files(), Names{});
}

TEST_F(RasterWriterTest, FailuresNameTheReasonAndLeaveTheTarget)
{
    std::ofstream(in("keep.tif")) << "what was there";
    std::ofstream(in("plain")) << "a file";
    fs::create_directories(folder / "sub");
    struct Case
    {
        std::string path;
        RasterWriteOptions options;
        const char* message;
    };
    std::vector<Case> cases(9);
    cases[0] = {in("nowhere/keep.tif"), {}, "existing folder"};
    cases[1] = {in("plain/keep.tif"), {}, "existing folder"};
    cases[2] = {in("sub"), {}, "is a folder"};
    cases[3] = {in("keep.unheardof"), {}, "no GDAL driver writes .unheardof"};
    cases[4] = {in("keep.tif"), {}, "no driver \"NoSuch\""};
    cases[4].options.driver = "NoSuch";
    cases[5] = {in("keep.tif"), {}, "exists already"};
    cases[5].options.overwrite = false;
    cases[6] = {in("keep.tif"), {}, "COMPRES"};
    cases[6].options.creationOptions = {"COMPRES=LZW"};
    cases[7] = {in("keep.tif"), {}, "PNG"}; // has no Float32
    cases[7].options.driver = "PNG";
    cases[8] = {in("keep.tif"), {}, "does not write"};
    cases[8].options.driver = "MEM";
    testing::internal::CaptureStderr();
    for (const Case& c : cases)
    {
        const Status written = writeRaster(c.path, smallFrame(), oneBand(), c.options);
        ASSERT_FALSE(written.ok()) << c.message;
        EXPECT_NE(written.error().message.find(c.message), std::string::npos)
            << written.error().message;
        EXPECT_EQ(written.error().message.rfind(c.path, 0), 0u) << written.error().message;
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");

    RasterFrame frame = smallFrame();
    frame.crs = "not WKT";
    EXPECT_FALSE(writeRaster(in("keep.tif"), frame, oneBand()).ok());
    frame = smallFrame();
    frame.width = 4;
    EXPECT_FALSE(writeRaster(in("keep.tif"), frame, oneBand()).ok()) << "values of another size";
    EXPECT_FALSE(writeRaster(in("keep.tif"), smallFrame(), {}).ok()) << "no band";

    EXPECT_EQ(files(), (Names{"keep.tif", "plain", "sub"}));
    EXPECT_EQ(content(in("keep.tif")), "what was there");
    EXPECT_TRUE(fs::is_empty(folder / "sub"));
}

TEST_F(RasterWriterTest, APipeIsNotReplaced)
{
    ASSERT_EQ(mkfifo(in("pipe.tif").c_str(), 0600), 0);
    const Status written = writeRaster(in("pipe.tif"), smallFrame(), oneBand());
    ASSERT_FALSE(written.ok());
    EXPECT_NE(written.error().message.find("a device or a pipe"), std::string::npos);
    EXPECT_TRUE(fs::is_fifo(in("pipe.tif")));
}

TEST_F(RasterWriterTest, FolderWithoutLeaveToWrite)
{
    if (geteuid() == 0)
        GTEST_SKIP() << "skipped: the superuser may write everywhere; run as another user";
    fs::permissions(folder, fs::perms::owner_read | fs::perms::owner_exec);
    const Status written = writeRaster(in("a.tif"), smallFrame(), oneBand());
    fs::permissions(folder, fs::perms::owner_all);
    EXPECT_FALSE(written.ok());
    EXPECT_EQ(files(), Names{});
}

TEST_F(RasterWriterTest, FullDiskLeavesTheTarget)
{
    std::ofstream(in("keep.tif")) << "what was there";
    RasterFrame frame = smallFrame();
    frame.width = frame.height = 512;
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    rlimit small = before;
    small.rlim_cur = 100000; // the file would have 1 MB
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    const Status direct = writeRaster(in("keep.tif"), frame, {{{"", ""}, ramp(512, 512)}});
    RasterWriteOptions options;
    options.driver = "AAIGrid";
    const Status copied = writeRaster(in("keep.tif"), frame, {{{"", ""}, ramp(512, 512)}}, options);
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_FALSE(direct.ok());
    EXPECT_FALSE(copied.ok());
    EXPECT_EQ(files(), Names{"keep.tif"});
    EXPECT_EQ(content(in("keep.tif")), "what was there");
}

TEST_F(RasterWriterTest, ReplacesAFileAndItsStaleSidecars)
{
    std::ofstream(in("a.tif")) << "what was there";
    std::ofstream(in("a.tif.aux.xml")) << "<PAMDataset/>";
    std::ofstream(in("a.tif.ovr")) << "overviews of it";
    ASSERT_TRUE(writeRaster(in("a.tif"), smallFrame(), oneBand()).ok());
    EXPECT_EQ(files(), Names{"a.tif"});
}

TEST_F(RasterWriterTest, FramesWithoutPlaceAndPathsWithoutFolder)
{
    RasterFrame frame = smallFrame();
    frame.hasGeoTransform = false;
    frame.crs.clear();
    ASSERT_TRUE(writeRaster(in("bare.tif"), frame, oneBand()).ok());
    double t[6];
    const GDALDatasetUniquePtr dataset = open(in("bare.tif"));
    EXPECT_NE(dataset->GetGeoTransform(t), CE_None);
    EXPECT_EQ(dataset->GetSpatialRef(), nullptr);

    ASSERT_TRUE(writeRaster("/vsimem/raster_writer_test.tif", frame, oneBand()).ok());
    EXPECT_TRUE(open("/vsimem/raster_writer_test.tif"));
    const fs::path before = fs::current_path();
    fs::current_path(folder);
    const Status written = writeRaster("here.tif", frame, oneBand());
    fs::current_path(before);
    EXPECT_TRUE(written.ok());
    EXPECT_EQ(files(), (Names{"bare.tif", "here.tif"}));
}

TEST_F(RasterWriterTest, PictureWithNorthUp)
{
    // 2 x 2, tile order: south-west red, south-east green, north-west blue, north-east clear.
    const std::vector<std::uint8_t> pixels = {255, 0, 0,   255, 0, 255, 0, 255,
                                              0,   0, 255, 255, 0, 0,   0, 0};
    for (const bool northUp : {true, false})
    {
        RasterFrame frame = smallFrame();
        frame.width = frame.height = 2;
        frame.northUp = northUp;
        frame.geoTransform = {100, 10, 0, northUp ? 220.0 : 200.0, 0, northUp ? -10.0 : 10.0};
        RasterWriteOptions options;
        options.creationOptions = {"WORLDFILE=YES"};
        const Status written = writeRgb8(in("a.png"), frame, pixels, options);
        ASSERT_TRUE(written.ok()) << written.error().message;
        const GDALDatasetUniquePtr dataset = open(in("a.png"));
        ASSERT_EQ(dataset->GetRasterCount(), 4);
        EXPECT_EQ(bandValues(*dataset, 1), (std::vector<float>{0, 0, 255, 0}));
        EXPECT_EQ(bandValues(*dataset, 2), (std::vector<float>{0, 0, 0, 255}));
        EXPECT_EQ(bandValues(*dataset, 3), (std::vector<float>{255, 0, 0, 0}));
        EXPECT_EQ(bandValues(*dataset, 4), (std::vector<float>{255, 0, 255, 255}));
        EXPECT_EQ(dataset->GetRasterBand(4)->GetColorInterpretation(), GCI_AlphaBand);
        double t[6] = {};
        EXPECT_EQ(dataset->GetGeoTransform(t), CE_None);
        EXPECT_EQ(t[3], 220.0);
        EXPECT_EQ(t[5], -10.0);
        EXPECT_NE(dataset->GetSpatialRef(), nullptr);
        EXPECT_EQ(files(), (Names{"a.png", "a.png.aux.xml", "a.wld"}));
    }
}

TEST_F(RasterWriterTest, PictureErrors)
{
    RasterFrame frame = smallFrame();
    EXPECT_FALSE(writeRgb8(in("a.png"), frame, std::vector<std::uint8_t>(17)).ok());
    EXPECT_FALSE(writeRgb8(in("a.png"), frame, {}).ok());
    EXPECT_FALSE(writeRgb8(in("no/a.png"), frame, std::vector<std::uint8_t>(18)).ok());
    EXPECT_FALSE(writeRgb8(in("a.asc"), frame, std::vector<std::uint8_t>(18)).ok());
    EXPECT_EQ(files(), Names{});
    EXPECT_TRUE(writeRgb8(in("a.tif"), frame, std::vector<std::uint8_t>(18)).ok());
    EXPECT_TRUE(writeRgb8(in("a.jpg"), frame, std::vector<std::uint8_t>(18)).ok());
}
