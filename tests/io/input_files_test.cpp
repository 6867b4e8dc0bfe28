#include "io/InputFiles.h"
#include "support/TestFolder.h"

#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <gdal_utils.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
namespace fs = std::filesystem;

class InputFilesTest : public testing::Test
{
protected:
    void SetUp() override
    {
        GDALAllRegister();
        fs::create_directories(folder / "sub");
        for (const char* name : {"a.tif", "sub/b.tif"})
        {
            GDALDatasetUniquePtr file(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
                in(name).c_str(), 4, 4, 1, GDT_Float32, nullptr));
            double place[] = {0.0, 1.0, 0.0, 4.0, 0.0, -1.0};
            file->SetGeoTransform(place);
        }
    }
    std::string in(const std::string& name) const { return (folder / name).string(); }
    void text(const std::string& name, const std::string& content) const
    {
        std::ofstream(in(name)) << content;
    }
    std::string virtualOf(const std::string& source) const
    {
        return "<VRTDataset rasterXSize=\"4\" rasterYSize=\"4\"><VRTRasterBand "
               "dataType=\"Float32\" "
               "band=\"1\"><SimpleSource><SourceFilename relativeToVRT=\"1\">" +
               source + "</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>";
    }
    /// Whether the input is made of each of these files and not of "other".
    void expectFiles(const std::string& input, const std::vector<std::string>& names) const
    {
        const std::vector<std::string> files = filesOf(input);
        for (const std::string& name : names)
            EXPECT_NE(sameFile(files, in(name)), "") << input << " without " << name;
        text("other", "");
        EXPECT_EQ(sameFile(files, in("other")), "");
    }

    const fs::path folder = testFolder();
};
} // namespace

// What each dataset is made of is how it is written here.
TEST_F(InputFilesTest, EveryFileThatAnInputIsMadeOf)
{
    text("a.tif.aux.xml", "<PAMDataset/>");
    text("a.tif.msk", "");
    expectFiles(in("a.tif"), {"a.tif", "a.tif.aux.xml", "a.tif.msk"});
    text("one.vrt", virtualOf("sub/b.tif"));
    text("two.vrt", virtualOf("one.vrt"));
    text("three.vrt", virtualOf("two.vrt"));
    text("sub/b.tif.ovr", "");
    expectFiles(in("three.vrt"), {"three.vrt", "two.vrt", "one.vrt", "sub/b.tif", "sub/b.tif.ovr"});
    expectFiles("vrt://" + in("a.tif") + "?bands=1", {"a.tif"});
    expectFiles("GTIFF_DIR:1:" + in("a.tif"), {"a.tif"});
    expectFiles("NETCDF:\"" + in("a.tif") + "\":Band1", {"a.tif"});
    expectFiles("/vsizip/" + in("a.tif") + "/x.tif", {"a.tif"});
    expectFiles("/vsizip/{" + in("a.tif") + "}/x.tif", {"a.tif"});
    fs::copy_file(in("a.tif"), in("q,1:2.tif"));
    expectFiles("/vsisubfile/0_100000," + in("q,1:2.tif"), {"q,1:2.tif"});
    expectFiles("NETCDF:\"" + in("q,1:2.tif") + "\":Band1", {"q,1:2.tif"});
    expectFiles(in("a.tif") + ".terrainlight", {"a.tif"});
    text("a.exr", "");
    expectFiles(in("a.exr"), {"a.exr"});
}

// Names that ask OpenSceneGraph for one reader on top of another.
TEST_F(InputFilesTest, ScenesThatAreTurnedMovedOrScaled)
{
    text("s.osgt", "");
    expectFiles(in("s.osgt") + ".0,0,30.rot", {"s.osgt"});
    expectFiles(in("s.osgt") + ".2,2,2.scale.0,1.5,0.trans", {"s.osgt"});
    expectFiles(in("a.tif") + ".terrainlight.0,0,10.rot", {"a.tif"});
    expectFiles("/vsizip/" + in("a.tif") + "/x.tif.terrainlight", {"a.tif"});
    EXPECT_TRUE(filesOf(in("none") + ".0,0,10.rot").empty());
}

TEST_F(InputFilesTest, AMapIsMadeOfItsLayersAndItsSky)
{
    text("sky.hdr", "");
    text("v.vrt", virtualOf("sub/b.tif"));
    text("m.earth", "<map><GDALElevation url='v.vrt'/><GDALImage url='a.tif'/>"
                    "<terrain_light sky='sky.hdr'/></map>");
    expectFiles(in("m.earth"), {"m.earth", "v.vrt", "sub/b.tif", "a.tif", "sky.hdr"});
    expectFiles(in("m.earth") + ".terrainlight", {"m.earth", "sub/b.tif"});
}

TEST_F(InputFilesTest, LinksAreTheSameFile)
{
    fs::create_symlink(in("a.tif"), in("symbolic.tif"));
    fs::create_hard_link(in("a.tif"), in("hard.tif"));
    fs::copy_file(in("a.tif"), in("copy.tif"));
    EXPECT_EQ(sameFile(filesOf(in("a.tif")), in("symbolic.tif")), in("a.tif"));
    EXPECT_EQ(sameFile(filesOf(in("a.tif")), in("hard.tif")), in("a.tif"));
    EXPECT_EQ(sameFile(filesOf(in("symbolic.tif")), in("a.tif")), in("symbolic.tif"));
    EXPECT_EQ(sameFile(filesOf(in("a.tif")), in("copy.tif")), "");
    EXPECT_TRUE(filesOf("").empty());
    EXPECT_TRUE(filesOf(in("none.tif")).empty());
}
