// Inputs and outputs that cannot be used: the exit status, what is said, and nothing left behind.
#include "ToolRun.h"

#include "support/SharedData.h"

#include <cmath>
#include <csignal>

#include <sys/stat.h>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{

const std::string quick = " -q --quality draft --azimuths 8";

/// Tests of failures that come before OpenGL is asked for.
using Failure = ToolTest;
using GlFailure = GlToolTest;

TEST_F(Failure, InputNamesFileAndReason)
{
    std::ofstream(path("empty.tif"));
    std::ofstream(path("text.tif")) << "not a raster\n";
    writeRaster("nan.tif", 2, 2, std::vector<float>(4, -9999.0f), {0, 10, 0, 0, 0, -10});
    writeRaster("rotated.tif", 2, 2, std::vector<float>(4, 1.0f), {0, 10, 5, 0, 5, -10});
    const auto before = left();
    const struct
    {
        const char* input;
        const char* reason;
    } inputs[] = {{"missing.tif", "no such file"},
                  {"empty.tif", "is empty"},
                  {"text.tif", "no raster"},
                  {"rotated.tif", "rotated"},
                  {".", "folder"}};
    for (const std::string mode : {"horizon", "svf", "shadow", "shade", "info"})
        for (const auto& input : inputs)
        {
            const ToolRun result =
                run(mode + " " + input.input + (mode == "info" ? "" : " o.tif -q"));
            EXPECT_EQ(result.status, 1);
            EXPECT_TRUE(result.complains(std::string("terrainlight: ") + input.input))
                << result.err;
            EXPECT_TRUE(result.complains(input.reason)) << result.err;
            EXPECT_EQ(left(), before);
        }
}

TEST_F(Failure, SkyNamesFileAndReason)
{
    writeRaster("plain.tif", 4, 4, std::vector<float>(16, 1.0f), {0, 10, 0, 0, 0, -10});
    std::ofstream(path("text.exr")) << "not a picture\n";
    const auto before = left();
    for (const std::string mode : {"shade plain.tif o.tif -q", "render plain.tif o.png -q"})
        for (const std::string file : {"missing.exr", "text.exr", "missing.hdr"})
        {
            const ToolRun result = run(mode + " --sky " + file);
            EXPECT_EQ(result.status, 1) << mode << file;
            EXPECT_TRUE(result.complains("terrainlight: " + file)) << result.err;
            EXPECT_EQ(left(), before);
        }
}

TEST_F(Failure, OutputIsCheckedBeforeTheWork)
{
    const struct
    {
        const char* output;
        const char* reason;
    } outputs[] = {{"nowhere/o.tif", "cannot write into nowhere"},
                   {"o.tif -of NOPE", "no driver \"NOPE\""},
                   {"o.tif -of AIG", "does not write"},
                   {"o.frob", ".frob"},
                   {"o.png", "Float32"},
                   {"o.tif -co FROB=1", "FROB"},
                   {".", "is a folder"}};
    for (const auto& output : outputs)
    {
        SCOPED_TRACE(output.output);
        const ToolRun result = run("svf " + jacksboro + " " + output.output);
        EXPECT_EQ(result.status, 1);
        EXPECT_EQ(result.out, "") << "no progress: nothing was begun";
        EXPECT_TRUE(result.complains(output.reason)) << result.err;
        EXPECT_FALSE(result.complains("probe")) << result.err;
        EXPECT_TRUE(left().empty());
    }
    const ToolRun bands = run("horizon " + jacksboro + " h.asc");
    EXPECT_EQ(bands.status, 1);
    EXPECT_TRUE(bands.complains("h.asc: cannot be written as AAIGrid: h.asc: ")) << bands.err;
    const ToolRun exr = run("shade " + jacksboro + " s.exr -co COMPRESS=ZIP");
    EXPECT_EQ(exr.status, 1);
    EXPECT_TRUE(exr.complains("s.exr")) << exr.err;
    EXPECT_TRUE(left().empty());
}

TEST_F(Failure, WindowAndBandAreTheInputs)
{
    for (const char* option : {"-srcwin 400 0 10 10", "-srcwin -1 0 10 10", "-srcwin 0 0 0 5",
                               "-srcwin 2147483647 0 2147483647 1", "--band 2", "--band 0"})
    {
        const ToolRun result = run("svf " + jacksboro + " o.tif -q " + option);
        EXPECT_EQ(result.status, 1) << option;
        EXPECT_TRUE(result.complains(jacksboro)) << result.err;
        EXPECT_TRUE(left().empty());
    }
}

TEST_F(Failure, NoOpenGlIsOneSentence)
{
    // Mesa's switch: an OpenGL too old; elsewhere the driver may not care.
    const ToolRun result = run("svf " + jacksboro + " o.tif -q -srcwin 0 0 8 8",
                               "export MESA_GL_VERSION_OVERRIDE=3.0");
    if (result.status == 0)
        GTEST_SKIP()
            << "skipped: this OpenGL driver ignores MESA_GL_VERSION_OVERRIDE; needs Mesa's";
    EXPECT_EQ(result.status, 1);
    EXPECT_TRUE(result.complains("OpenGL")) << result.err;
    EXPECT_TRUE(left().empty());
}

TEST_F(GlFailure, AllVoidIsRefused)
{
    writeRaster("void.tif", 4, 4, std::vector<float>(16, -9999.0f), {0, 10, 0, 0, 0, -10});
    const ToolRun result = run("svf void.tif o.tif" + quick);
    EXPECT_EQ(result.status, 1);
    EXPECT_TRUE(result.complains("void.tif: holds no valid height")) << result.err;
    EXPECT_EQ(left(), std::set<std::string>{"void.tif"});
}

TEST_F(GlFailure, AnExistingOutputSurvives)
{
    std::ofstream(path("o.tif")) << "precious";
    writeRaster("void.tif", 4, 4, std::vector<float>(16, -9999.0f), {0, 10, 0, 0, 0, -10});
    EXPECT_EQ(run("svf void.tif o.tif -q").status, 1);
    EXPECT_EQ(contentOf(path("o.tif")), "precious");
    EXPECT_EQ(run("svf " + jacksboro + " o.tif -srcwin 0 0 8 8" + quick).status, 0);
    EXPECT_EQ(ReadRaster(path("o.tif")).width, 8);
}

TEST_F(GlFailure, TinyAndThin)
{
    for (const auto& [width, height] : {std::pair<int, int>{1, 1}, {2, 2}, {60, 1}, {1, 60}})
    {
        std::vector<float> heights;
        for (int i = 0; i < width * height; ++i)
            heights.push_back(static_cast<float>(i % 5));
        writeRaster("d.tif", width, height, heights, {0, 10, 0, 0, 0, -10});
        for (const std::string mode : {"horizon", "svf", "shade"})
        {
            const ToolRun result = run(mode + " d.tif o.tif" + quick);
            ASSERT_EQ(result.status, 0) << mode << ": " << result.err;
            const ReadRaster raster(path("o.tif"));
            EXPECT_EQ(raster.width, width);
            EXPECT_EQ(raster.height, height);
            for (const std::vector<float>& band : raster.bands)
                for (const float value : band)
                {
                    EXPECT_TRUE(std::isfinite(value)) << mode;
                    EXPECT_NE(value, -9999.0f) << mode << ": no post is void";
                }
        }
    }
}

TEST_F(GlFailure, SharedAwkwardRasters)
{
    OTL_SKIP_WITHOUT_SHARED_DATA();
    const struct
    {
        const char* name;
        const char* reason; // null: a result
    } files[] = {{"empty.tif", "is empty"},
                 {"text_named.tif", "no raster"},
                 {"truncated_everest.tif", "no raster"},
                 {"truncated_cog.tif", "cannot read rows"},
                 {"rasterio_all-nodata.tif", "picture"},
                 {"rasterio_rotated.tif", "rotated"},
                 {"fuji_1x1.tif", nullptr},
                 {"fuji_2x2.tif", nullptr},
                 {"fuji_600x1.tif", nullptr},
                 {"everest_voids_256.tif", nullptr},
                 {"rasterio_float_nan.tif", nullptr},
                 {"rainier_feet_scale_offset.tif", nullptr},
                 {"fuji_moved_northpole.tif", nullptr},
                 {"olinda_dem_utm25s.tif", nullptr},
                 {"gdal_nodata_float.asc", nullptr}};
    for (const auto& file : files)
    {
        SCOPED_TRACE(file.name);
        const std::string input = sharedData(std::string("awkward/") + file.name);
        const ToolRun result = run("svf " + input + " o.tif" + quick);
        EXPECT_EQ(result.out, "");
        if (file.reason)
        {
            EXPECT_EQ(result.status, 1);
            EXPECT_TRUE(result.complains(file.reason)) << result.err;
            EXPECT_TRUE(result.complains(file.name)) << result.err;
            EXPECT_TRUE(left().empty());
            continue;
        }
        ASSERT_EQ(result.status, 0) << result.err;
        const ReadRaster output(path("o.tif"));
        const ReadRaster source(input);
        expectSamePlace(output, source);
        int declared = FALSE;
        const double stored = source.dataset->GetRasterBand(1)->GetNoDataValue(&declared);
        for (std::size_t i = 0; i < output.bands[0].size(); ++i)
        {
            const float value = output.bands[0][i];
            const float height = source.bands[0][i];
            const bool isVoid =
                std::isnan(height) || (declared && height == static_cast<float>(stored));
            EXPECT_EQ(value == -9999.0f, isVoid) << i;
            EXPECT_TRUE(isVoid || (value >= 0.0f && value <= 1.0001f)) << value;
        }
        EXPECT_EQ(left(), std::set<std::string>{"o.tif"});
        std::filesystem::remove(path("o.tif"));
    }
}

TEST_F(GlFailure, ZippedInput)
{
    OTL_SKIP_WITHOUT_SHARED_DATA();
    const ToolRun result = run("svf /vsizip/" + sharedData("awkward/N10W110.hgt.zip") +
                               "/N10W110.hgt o.tif -srcwin 0 0 64 64" + quick);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(ReadRaster(path("o.tif")).width, 64);
}

// An input gets no file beside it.
TEST_F(GlFailure, GzippedInputStaysAlone)
{
    writeRaster("d.tif", 16, 16, std::vector<float>(256, 5.0f), {0, 10, 0, 160, 0, -10});
    const std::string plain = contentOf(path("d.tif"));
    VSILFILE* packed = VSIFOpenL(("/vsigzip/" + path("d.tif.gz")).c_str(), "wb");
    ASSERT_NE(packed, nullptr);
    EXPECT_EQ(VSIFWriteL(plain.data(), 1, plain.size(), packed), plain.size());
    VSIFCloseL(packed);
    std::filesystem::remove(path("d.tif"));
    const ToolRun result = run("svf /vsigzip/d.tif.gz o.tif" + quick);
    ASSERT_EQ(result.status, 0) << result.err;
    run("render /vsigzip/d.tif.gz o.png --size 16 -q");
    run("shade /vsigzip/d.tif.gz p.tif --sky /vsigzip/d.tif.gz" + quick);
    for (const std::string& name : left())
        EXPECT_EQ(name.find(".properties"), std::string::npos) << name;
}

// A pipe that nobody writes into would be waited for without end.
TEST_F(Failure, PipesAreRefused)
{
    ASSERT_EQ(mkfifo(path("p").c_str(), 0600), 0);
    ASSERT_EQ(mkfifo(path("p.earth").c_str(), 0600), 0);
    ASSERT_EQ(mkfifo(path("p.osgt").c_str(), 0600), 0);
    for (const std::string& command :
         {std::string("svf p o.tif"), std::string("info p"), std::string("render p o.png"),
          std::string("render p.earth o.png"), std::string("render p.osgt o.png"),
          "shade " + jacksboro + " o.tif --sky p",
          "shade " + jacksboro + " o.tif --bounces 1 --albedo p"})
    {
        const ToolRun result = run(command, ":", "timeout 60");
        if (result.complains("OpenGL"))
            continue;
        EXPECT_EQ(result.status, 1) << command;
        EXPECT_TRUE(result.complains(": is a device or a pipe; needed a file")) << result.err;
        EXPECT_EQ(left(), (std::set<std::string>{"p", "p.earth", "p.osgt"}));
    }
}

TEST_F(GlFailure, NoPictureWithoutTheLight)
{
    const struct
    {
        const char* shader;
        const char* said;
    } broken[] = {{"passes/shade.comp", "shader passes/shade.comp does not compile: "},
                  {"host/default_terrain.frag", "shader host/default_terrain.frag does not"}};
    for (const auto& each : broken)
    {
        const std::filesystem::path shaders = folder.string() + ".shaders";
        std::filesystem::create_directories((shaders / each.shader).parent_path());
        std::ofstream(shaders / each.shader)
            << contentOf(std::filesystem::path(OTL_SOURCE_DIR "/shaders") / each.shader)
            << "\njunk\n";
        const ToolRun result = run("render " + jacksboro + " o.png --size 64" + quick,
                                   "export OSGTERRAINLIGHT_SHADERS='" + shaders.string() + "'");
        EXPECT_EQ(result.status, 1);
        EXPECT_TRUE(result.complains("terrainlight: " + jacksboro + ": not lit: ")) << result.err;
        EXPECT_TRUE(result.complains(each.said)) << result.err;
        EXPECT_FALSE(result.complains("\n; drawing")) << result.err;
        EXPECT_TRUE(left().empty());
        std::filesystem::remove_all(shaders);
    }
}

// A signal at any moment: the run ends by it, and no partial file is left.
TEST_F(GlFailure, InterruptLeavesNothing)
{
    ASSERT_EQ(run("generate fractal big.tif --size 700 -q").status, 0);
    const auto before = left();
    int interrupted = 0;
    for (const char* delay : {"0.05", "0.3", "0.6", "1", "1.5", "2", "3"})
    {
        // exec keeps the shell's process id; a sleeping child of it signals that.
        const ToolRun result =
            run("horizon big.tif h.tif -q --azimuths 64 --quality draft -co COMPRESS=DEFLATE",
                std::string("{ (sleep ") + delay + "; kill -TERM $$) >/dev/null 2>&1 & }");
        if (result.status == 0)
        {
            EXPECT_EQ(ReadRaster(path("h.tif")).count, 64);
            std::filesystem::remove(path("h.tif"));
        }
        else
        {
            EXPECT_EQ(result.status, -SIGTERM);
            ++interrupted;
        }
        EXPECT_EQ(left(), before) << "after " << delay << " s";
    }
    EXPECT_GT(interrupted, 0);
}

} // namespace
