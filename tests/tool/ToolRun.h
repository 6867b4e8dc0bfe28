#pragma once

#include "support/TestFolder.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <vector>

namespace osgTerrainLight::testing
{

inline const std::string jacksboro = OTL_SOURCE_DIR "/samples/data/jacksboro_90m.tif";

/// What a run of the tool left behind.
struct ToolRun
{
    int status = -1; ///< exit status; minus the signal that ended it
    std::string out, err;

    bool complains(const std::string& text) const { return err.find(text) != std::string::npos; }
};

inline std::string contentOf(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// A raster as GDAL reads it, all bands as float.
struct ReadRaster
{
    explicit ReadRaster(const std::string& path)
    {
        GDALAllRegister();
        dataset.reset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER));
        if (!dataset)
        {
            ADD_FAILURE() << "GDAL cannot open " << path;
            return;
        }
        width = dataset->GetRasterXSize();
        height = dataset->GetRasterYSize();
        count = dataset->GetRasterCount();
        dataset->GetGeoTransform(transform);
        for (int band = 1; band <= count; ++band)
        {
            std::vector<float> values(static_cast<std::size_t>(width) *
                                      static_cast<std::size_t>(height));
            EXPECT_EQ(dataset->GetRasterBand(band)->RasterIO(GF_Read, 0, 0, width, height,
                                                             values.data(), width, height,
                                                             GDT_Float32, 0, 0, nullptr),
                      CE_None);
            bands.push_back(std::move(values));
        }
    }

    /// Column and row of the file.
    float at(int band, int column, int row) const
    {
        return bands[static_cast<std::size_t>(band - 1)]
                    [static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(column)];
    }
    std::string metadata(const char* name) const
    {
        const char* value = dataset->GetMetadataItem(name);
        return value ? value : "";
    }
    std::string description(int band) const
    {
        return dataset->GetRasterBand(band)->GetDescription();
    }

    GDALDatasetUniquePtr dataset;
    int width = 0, height = 0, count = 0;
    double transform[6] = {};
    std::vector<std::vector<float>> bands;
};

inline void expectSamePlace(const ReadRaster& a, const ReadRaster& b)
{
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    for (int i = 0; i < 6; ++i)
        EXPECT_DOUBLE_EQ(a.transform[i], b.transform[i]) << "geotransform " << i;
    const OGRSpatialReference* first = a.dataset->GetSpatialRef();
    const OGRSpatialReference* second = b.dataset->GetSpatialRef();
    ASSERT_EQ(first == nullptr, second == nullptr);
    if (first)
    {
        EXPECT_TRUE(first->IsSame(second));
    }
}

/// Tests that run the tool in a folder of their own.
class ToolTest : public ::testing::Test
{
protected:
    /// arguments: as typed in a shell; the working folder is the test's own. before: what the shell
    /// does first. with: a program that runs the tool, with its arguments.
    ToolRun run(const std::string& arguments, const std::string& before = ":",
                const std::string& with = "") const
    {
        // Streams go beside the folder, so that what is in it was left by the tool.
        const std::string streams = folder.string() + ".stream";
        const std::string command = "export OSGTERRAINLIGHT_CACHE='" + levelFolder + "'; cd '" +
                                    folder.string() + "' && " + before + " && exec " + with + " '" +
                                    OTL_TOOL + "' " + arguments + " >'" + streams + "out' 2>'" +
                                    streams + "err'";
        const int raw = std::system(command.c_str());
        ToolRun result;
        result.status = WIFEXITED(raw) ? WEXITSTATUS(raw) : -WTERMSIG(raw);
        result.out = contentOf(streams + "out");
        result.err = contentOf(streams + "err");
        std::filesystem::remove(streams + "out");
        std::filesystem::remove(streams + "err");
        return result;
    }

    std::string path(const std::string& name) const { return (folder / name).string(); }

    /// Names of all that lies in the test's folder.
    std::set<std::string> left() const
    {
        std::set<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            names.insert(entry.path().filename().string());
        return names;
    }

    /// A Float32 GeoTIFF of values in file order; no CRS.
    void writeRaster(const std::string& name, int width, int height,
                     const std::vector<float>& values, std::vector<double> transform,
                     double noData = -9999.0) const
    {
        GDALAllRegister();
        GDALDatasetUniquePtr dataset(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
            path(name).c_str(), width, height, 1, GDT_Float32, nullptr));
        if (!transform.empty())
            dataset->SetGeoTransform(transform.data());
        dataset->GetRasterBand(1)->SetNoDataValue(noData);
        std::vector<float> copy = values;
        ASSERT_EQ(dataset->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, width, height, copy.data(),
                                                      width, height, GDT_Float32, 0, 0, nullptr),
                  CE_None);
    }

    ~ToolTest() override { std::filesystem::remove_all(levelFolder); }

    const std::filesystem::path folder = testFolder();
    const std::string levelFolder =
        folder.string() + ".levels"; ///< where the tool keeps coarse ones
};

/// Tests of modes that compute: skipped where the tool finds no OpenGL 4.3.
class GlToolTest : public ToolTest
{
protected:
    void SetUp() override
    {
        static const ToolRun info = run("info");
        if (info.status != 0)
            GTEST_SKIP() << "skipped: no OpenGL 4.3 here (install Mesa's libgl1-mesa-dri): "
                         << info.err;
    }
};

} // namespace osgTerrainLight::testing
