// What was written is held against what comes out of the file again, and return codes count, not
// messages: drivers of our own that lie, and files that are damaged between writing and reading.
#include "io/WrittenFile.h"

#include "io/ExrFile.h"
#include "io/PendingFile.h"
#include "io/RasterWriter.h"
#include "support/TestFolder.h"

#include <cpl_error.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_srs_api.h>

#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

using namespace osgTerrainLight;

namespace
{
namespace fs = std::filesystem;

/// What the lying driver does with the pixels that it is given, and says while it does it.
std::function<GDALDataset*(const char*, GDALDataset&)> lie;
std::string said;

GDALDataset* createLying(const char* path, GDALDataset* from, int, char**, GDALProgressFunc, void*)
{
    if (!said.empty())
        CPLError(CE_Failure, CPLE_AppDefined, "%s", said.c_str());
    return lie(path, *from);
}

GDALDataset* openLying(GDALOpenInfo* info)
{
    const char* drivers[] = {"GTiff", nullptr};
    return GDALDataset::Open(info->pszFilename, GDAL_OF_RASTER, drivers);
}

/// A copy as GeoTIFF, after a change.
GDALDataset* copied(const char* path, GDALDataset& from,
                    const std::function<void(GDALDataset&)>& change)
{
    GDALDriver& driver = *GetGDALDriverManager()->GetDriverByName("GTiff");
    GDALDataset* copy = driver.CreateCopy(path, &from, FALSE, nullptr, nullptr, nullptr);
    change(*copy);
    return copy;
}

void set(GDALDataset& dataset, int column, int row, float value)
{
    EXPECT_EQ(dataset.GetRasterBand(1)->RasterIO(GF_Write, column, row, 1, 1, &value, 1, 1,
                                                 GDT_Float32, 0, 0, nullptr),
              CE_None);
}

class WrittenFileTest : public testing::Test
{
protected:
    void SetUp() override
    {
        GDALAllRegister();
        if (!GetGDALDriverManager()->GetDriverByName("LYING"))
        {
            auto driver = std::make_unique<GDALDriver>();
            driver->SetDescription("LYING");
            driver->SetMetadataItem(GDAL_DCAP_RASTER, "YES");
            driver->pfnCreateCopy = createLying;
            driver->pfnOpen = openLying;
            GetGDALDriverManager()->RegisterDriver(driver.release());
        }
        said.clear();
        std::ofstream(folder / "o.lie") << "what was there";
    }

    /// Ten by eight values of 1 … 80, one of them void, by the lying driver over an older file.
    Status write() const
    {
        RasterFrame frame;
        frame.width = 10;
        frame.height = 8;
        Raster<float> values(10, 8);
        for (std::size_t i = 0; i < values.size(); ++i)
            values.values()[i] = static_cast<float>(i + 1);
        values.at(3, 2) = std::numeric_limits<float>::quiet_NaN();
        RasterWriteOptions options;
        options.driver = "LYING";
        return writeRaster((folder / "o.lie").string(), frame, {{{"", ""}, values}}, options);
    }
    std::size_t fileCount() const
    {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
    }

    const fs::path folder = testFolder();
};

std::string content(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}
} // namespace

// Every lie of a driver that reports success is found out, and the older file stays.
TEST_F(WrittenFileTest, AFileThatDiffersIsRefused)
{
    const auto cut = [](const char* path, GDALDataset& from)
    {
        delete copied(path, from, [](GDALDataset&) {});
        fs::resize_file(path, fs::file_size(path) - 100);
        return GetGDALDriverManager()->GetDriverByName("MEM")->Create("", 1, 1, 1, GDT_Byte,
                                                                      nullptr);
    };
    const auto create = [](int width, int height, int bands)
    {
        return [=](const char* path, GDALDataset&)
        {
            return GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
                path, width, height, bands, GDT_Float32, nullptr);
        };
    };
    const auto changed = [](int column, int row, float value)
    {
        return [=](const char* path, GDALDataset& from)
        { return copied(path, from, [=](GDALDataset& copy) { set(copy, column, row, value); }); };
    };
    const struct
    {
        const char* what;
        std::function<GDALDataset*(const char*, GDALDataset&)> lie;
        const char* message;
    } lies[] = {
        {"another value", changed(4, 3, 1000.0f), "row 4 of band 1 has other values"},
        {"a value for a void", changed(3, 5, 34.0f), "row 6 of band 1 has other values"},
        {"a void for a value", changed(9, 7, -9999.0f), "row 8 of band 1 has other values"},
        {"not a number", changed(0, 0, std::numeric_limits<float>::quiet_NaN()), "row 1 of band 1"},
        {"zeros", create(10, 8, 1), "row 1 of band 1 has other values"},
        {"rows that are missing", create(10, 7, 1), "10 x 7 pixels in 1 bands"},
        {"columns too many", create(11, 8, 1), "11 x 8 pixels in 1 bands"},
        {"a band too many", create(10, 8, 2), "10 x 8 pixels in 2 bands"},
        {"a file that is cut off", cut, "cannot be completed: "},
        {"no file at all",
         [](const char*, GDALDataset&) {
             return GetGDALDriverManager()->GetDriverByName("MEM")->Create("", 1, 1, 1, GDT_Byte,
                                                                           nullptr);
         },
         "wrote no file of that name"},
    };
    for (const auto& each : lies)
    {
        lie = each.lie;
        const Status written = write();
        ASSERT_FALSE(written) << each.what;
        EXPECT_EQ(written.error().message.rfind((folder / "o.lie").string() + ": ", 0), 0u);
        EXPECT_NE(written.error().message.find(each.message), std::string::npos)
            << each.what << ": " << written.error().message;
        EXPECT_EQ(written.error().message.find("partial"), std::string::npos)
            << written.error().message;
        EXPECT_EQ(content(folder / "o.lie"), "what was there") << each.what;
        EXPECT_EQ(fileCount(), 1u) << each.what;
    }
}

// A message of failure beside a return code of success and the right file is no failure; where the
// file is wrong, the message is the reason.
TEST_F(WrittenFileTest, MessagesAloneAreNoFailure)
{
    lie = [](const char* path, GDALDataset& from)
    { return copied(path, from, [](GDALDataset&) {}); };
    said = "Something went wrong, but not really";
    const Status written = write();
    EXPECT_TRUE(written) << written.error().message;
    EXPECT_NE(content(folder / "o.lie"), "what was there");

    lie = [](const char* path, GDALDataset& from)
    { return copied(path, from, [](GDALDataset& copy) { set(copy, 0, 0, 5000.0f); }); };
    said = "Disk of this test is full";
    const Status refused = write();
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find(said), std::string::npos) << refused.error().message;

    lie = [](const char*, GDALDataset&) { return nullptr; };
    ASSERT_FALSE(write());
    said.clear();
    ASSERT_FALSE(write()) << "a failure without a message is one";
}

// HF2 keeps hundredths, BAG adds a band of uncertainty: both as they should.
TEST_F(WrittenFileTest, FormatsThatKeepLessOrMoreAreWritten)
{
    for (const auto& [driver, name, step] :
         std::vector<std::tuple<const char*, const char*, float>>{{"HF2", "o.hf2", 0.01f},
                                                                  {"BAG", "o.bag", 1e-6f}})
    {
        if (!GetGDALDriverManager()->GetDriverByName(driver))
            continue;
        RasterFrame frame;
        frame.width = frame.height = 4;
        frame.hasGeoTransform = true;
        frame.crs = SRS_WKT_WGS84_LAT_LONG;
        frame.geoTransform = {10.0, 0.001, 0.0, 50.0, 0.0, -0.001};
        Raster<float> values(4, 4);
        for (int i = 0; i < 16; ++i)
            values.at(i % 4, i / 4) = 0.5f + 0.0333f * static_cast<float>(i);
        RasterWriteOptions options;
        options.driver = driver;
        const std::string path = (folder / name).string();
        const Status written = writeRaster(path, frame, {{{"", ""}, values}}, options);
        ASSERT_TRUE(written) << driver << ": " << written.error().message;
        const GDALDatasetUniquePtr file(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER));
        ASSERT_TRUE(file) << driver;
        float corner = 0.0f; // of the file's last row, which is the tile's first
        EXPECT_EQ(file->GetRasterBand(1)->RasterIO(GF_Read, 3, 3, 1, 1, &corner, 1, 1, GDT_Float32,
                                                   0, 0, nullptr),
                  CE_None);
        EXPECT_NEAR(corner, values.at(3, 0), step) << driver;
    }
}

TEST_F(WrittenFileTest, RehearsalLeavesTheTarget)
{
    RasterFrame frame;
    frame.width = frame.height = 1;
    const std::string path = (folder / "o.tif").string();
    Result<RasterWriter> writer = RasterWriter::open(path, frame, {{}});
    ASSERT_TRUE(writer);
    ASSERT_TRUE(writer->writeBand(1, Raster<float>(1, 1)));
    EXPECT_TRUE(writer->rehearse());
    EXPECT_FALSE(writer->finish());
    EXPECT_FALSE(fs::exists(path));
    EXPECT_EQ(fileCount(), 1u);
}

// The system's own words, by a limit of the length of files: what a library says of it is seldom
// the reason.
TEST_F(WrittenFileTest, TheSystemsReasonComesFirst)
{
    PendingFile file((folder / "o.bin").string());
    ASSERT_TRUE(file.create(true));
    EXPECT_EQ(file.reason("it failed", 1e5), "it failed");
    EXPECT_EQ(file.reason(file.path() + ": it failed", 1e5),
              (folder / "o.bin").string() + ": it failed");
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    rlimit small = before;
    small.rlim_cur = 100000;
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    const std::string larger = file.reason("it failed", 1e6), alone = file.reason("", 1e6);
    const std::string fits = file.reason("it failed", 5e4);
    ExrImage image;
    image.width = image.height = 300;
    image.channels.push_back({"Y", std::vector<float>(90000)});
    for (std::size_t i = 0; i < image.channels[0].values.size(); ++i) // not to be compressed
        image.channels[0].values[i] = static_cast<float>(i * 2654435761u % 1000003u);
    const Status exr = writeExr((folder / "o.exr").string(), image, ExrPixelType::Float);
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(larger, "File too large (it failed)");
    EXPECT_EQ(alone, "File too large");
    EXPECT_EQ(fits, "it failed");
    ASSERT_FALSE(exr);
    EXPECT_NE(exr.error().message.find("o.exr: cannot be written: File too large"),
              std::string::npos)
        << exr.error().message;
    EXPECT_FALSE(fs::exists(folder / "o.exr"));
}
