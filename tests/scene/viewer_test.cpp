#include "support/GlContext.h"
#include "support/TestFolder.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace
{
struct Outcome
{
    int exitCode = -1;
    std::string output;
};

Outcome run(const std::string& command)
{
    Outcome outcome;
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    if (!pipe)
        return outcome;
    std::array<char, 4096> buffer{};
    while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe))
        outcome.output += buffer.data();
    const int status = pclose(pipe);
    outcome.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return outcome;
}

/// On a display of its own, with OSG's checks for OpenGL errors on and this build's plugins.
Outcome runOnDisplay(const std::string& command, const std::string& environment = "")
{
    return run("timeout 240 xvfb-run -a -s '-screen 0 1024x768x24' env OSG_GL_ERROR_CHECKING=ON "
               "OSG_NOTIFY_LEVEL=NOTICE LD_LIBRARY_PATH=" OTL_BINARY_DIR
               "/lib:$LD_LIBRARY_PATH OSG_LIBRARY_PATH=" OTL_BINARY_DIR "/lib " +
               environment + " " + command);
}

bool has(const std::string& program)
{
    return run("command -v " + program).exitCode == 0;
}

#define OTL_NEED(program)                                                                          \
    if (!has(program))                                                                             \
    GTEST_SKIP() << "skipped: the program " << program                                             \
                 << " is absent (.ci/install_deps.sh installs it)"

void expectNoGlError(const std::string& output)
{
    for (const char* sign : {"OpenGL error", "invalid enum", "invalid value", "invalid operation"})
        EXPECT_EQ(output.find(sign), std::string::npos) << output;
}

/// osgviewer for `seconds`; it has no argument that ends it, so 124 says that it was still running.
Outcome runOsgviewer(const std::string& arguments, const std::string& environment = "",
                     int seconds = 5)
{
    return runOnDisplay("timeout " + std::to_string(seconds) +
                            " osgviewer --window 10 10 320 240 " + arguments,
                        environment);
}

const std::string sources = OTL_SOURCE_DIR;
const std::string dem = sources + "/samples/data/jacksboro_90m.tif";
} // namespace

class ViewerThreads : public testing::TestWithParam<std::pair<const char*, int>>
{
};

TEST_P(ViewerThreads, DrawWithoutErrors)
{
    OTL_NEED("xvfb-run");
    const Outcome outcome =
        runOnDisplay(std::string(OTL_BINARY_DIR "/bin/viewer_program ") + GetParam().first + " " +
                     std::to_string(GetParam().second));
    if (outcome.exitCode == 77)
        GTEST_SKIP()
            << "skipped: xvfb's display gives no OpenGL window (install Mesa's libgl1-mesa-dri): "
            << outcome.output;
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    expectNoGlError(outcome.output);
    // Its tiles come and go: none of them stays alone for long.
    EXPECT_EQ(outcome.output, "");
}

INSTANTIATE_TEST_SUITE_P(
    Models, ViewerThreads,
    testing::Values(std::pair{"SingleThreaded", 1}, std::pair{"SingleThreaded", 2},
                    std::pair{"DrawThreadPerContext", 1}, std::pair{"DrawThreadPerContext", 2},
                    std::pair{"CullThreadPerCameraDrawThreadPerContext", 2}),
    [](const auto& each)
    { return std::string(each.param.first) + std::to_string(each.param.second); });

TEST(DynamicSample, DrawsWithoutAWindowAndDigsWhereOneClicks)
{
    OTL_NEED_GL(context);
    const std::string program = "env LD_LIBRARY_PATH=" OTL_BINARY_DIR
                                "/lib:$LD_LIBRARY_PATH OSG_LIBRARY_PATH=" OTL_BINARY_DIR
                                "/lib " OTL_BINARY_DIR "/bin/dynamic ";
    // Frames that change, 20 of them; the clicks are in the 6th and 16th.
    const std::pair<std::string, int> ways[] = {{"waves --posts 40", 20},
                                                {"dunes --posts 40", 20},
                                                {"craters --posts 40", 3},
                                                {"craters " + dem, 3}};
    for (const auto& [way, lit] : ways)
    {
        const Outcome outcome = run(program + way + " --frames 20");
        EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
        EXPECT_NE(outcome.output.find("20 frames"), std::string::npos) << outcome.output;
        EXPECT_NE(outcome.output.find(" 0 OpenGL errors; lit " + std::to_string(lit) + " times"),
                  std::string::npos)
            << way << ": " << outcome.output;
    }
    EXPECT_EQ(run(program + "craters no_such.tif --frames 2").exitCode, 1);
    EXPECT_EQ(run(program + "rivers").exitCode, 2);
}

// A raster that is drawn as one tile, and one that is paged.
TEST(StreamingSample, FliesAndReports)
{
    OTL_NEED_GL(context);
    const std::string large = (osgTerrainLight::testFolder() / "large.tif").string();
    ASSERT_EQ(run(OTL_BINARY_DIR "/bin/terrainlight generate fractal " + large +
                  " --size 2300 --seed 3 -q")
                  .exitCode,
              0);
    const std::string program = "env LD_LIBRARY_PATH=" OTL_BINARY_DIR
                                "/lib:$LD_LIBRARY_PATH OSG_LIBRARY_PATH=" OTL_BINARY_DIR
                                "/lib " OTL_BINARY_DIR "/bin/streaming ";
    for (const std::string& raster : {dem, large})
    {
        const std::string report = (osgTerrainLight::testFolder() / "flight.csv").string();
        const Outcome outcome =
            run(program + raster + ".terrainlight --headless --frames 5 --report " + report);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
        EXPECT_NE(outcome.output.find("5 frames"), std::string::npos) << outcome.output;
        std::ifstream rows(report);
        std::string row;
        std::getline(rows, row);
        EXPECT_EQ(row,
                  "frame,milliseconds,light_milliseconds,tiles,lit,waiting,loading,light_bytes");
        for (int frame = 0; frame < 5; ++frame)
        {
            ASSERT_TRUE(std::getline(rows, row)) << frame;
            EXPECT_EQ(row.rfind(std::to_string(frame) + ",", 0), 0u) << row;
        }
        EXPECT_FALSE(std::getline(rows, row));
    }
    EXPECT_EQ(run(program + "no_such.tif.terrainlight --headless").exitCode, 1);
    EXPECT_EQ(
        run(program + dem + ".terrainlight --headless --report /no/such/folder/a.csv").exitCode, 1);
    EXPECT_EQ(run(program + dem + ".terrainlight --frames 0").exitCode, 1);
}

TEST(ObjectsSample, DrawsAVillage)
{
    OTL_NEED_GL(context);
    const std::filesystem::path folder = osgTerrainLight::testFolder();
    const std::string program = "env XDG_CACHE_HOME=" + folder.string() +
                                " LD_LIBRARY_PATH=" OTL_BINARY_DIR
                                "/lib:$LD_LIBRARY_PATH " OTL_BINARY_DIR "/bin/objects ";
    const std::filesystem::path picture = folder / "village.png";
    const Outcome outcome = run(program + "--headless " + picture.string() + " --hour 17.5");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    // 1280 x 720 pixels that are not all alike.
    EXPECT_GT(std::filesystem::file_size(picture), 10000u);
    EXPECT_FALSE(std::filesystem::is_empty(folder / "osgterrainlight/objects"));
    EXPECT_EQ(run(program + "--hour 25").exitCode, 2);
}

TEST(Osgviewer, ShowsADemWithoutErrors)
{
    OTL_NEED("xvfb-run");
    OTL_NEED("osgviewer");
    for (const char* model : {"--SingleThreaded", "--DrawThreadPerContext"})
    {
        const Outcome outcome = runOsgviewer(std::string(model) + " " + dem + ".terrainlight");
        EXPECT_EQ(outcome.exitCode, 124) << outcome.output;
        EXPECT_EQ(outcome.output, "");
    }
}

TEST(Osgviewer, ShowsAMapAndAllOfItThatCanBeRead)
{
    OTL_NEED("xvfb-run");
    OTL_NEED("osgviewer");
    Outcome outcome = runOsgviewer("-e terrainlight " + sources + "/earth_files/jacksboro.earth");
    EXPECT_EQ(outcome.exitCode, 124) << outcome.output;
    EXPECT_EQ(outcome.output, "");
    outcome = runOsgviewer("-e terrainlight " + sources + "/earth_files/errors/missing_file.earth");
    EXPECT_EQ(outcome.exitCode, 124) << outcome.output;
    EXPECT_NE(outcome.output.find("no_such.tif"), std::string::npos) << outcome.output;
    // A file that cannot be read beside one that can.
    outcome = runOsgviewer(dem + ".terrainlight " + sources + "/README.md.terrainlight");
    EXPECT_EQ(outcome.exitCode, 124) << outcome.output;
    EXPECT_NE(outcome.output.find("README.md"), std::string::npos) << outcome.output;
}

TEST(Osgviewer, ShowsAClockWithoutErrors)
{
    OTL_NEED("xvfb-run");
    OTL_NEED("osgviewer");
    for (const char* model : {"--SingleThreaded", "--DrawThreadPerContext"})
    {
        const Outcome outcome = runOsgviewer(
            std::string(model) + " -O time=2024-06-21T08:00-04:00 " + dem + ".terrainlight");
        EXPECT_EQ(outcome.exitCode, 124) << outcome.output;
        EXPECT_EQ(outcome.output, "");
    }
}

TEST(Osgviewer, DrawsUnlitOnOldOpenGL)
{
    OTL_NEED("xvfb-run");
    OTL_NEED("osgviewer");
    for (const char* version : {"2.1", "3.0"})
    {
        const Outcome outcome =
            runOsgviewer(dem + ".terrainlight", std::string("MESA_GL_VERSION_OVERRIDE=") + version);
        EXPECT_EQ(outcome.exitCode, 124) << outcome.output;
        if (outcome.output.empty())
            GTEST_SKIP()
                << "skipped: this OpenGL driver ignores MESA_GL_VERSION_OVERRIDE; needs Mesa's";
        const std::size_t first = outcome.output.find("needs OpenGL 4.3");
        EXPECT_NE(first, std::string::npos) << outcome.output;
        EXPECT_EQ(outcome.output.find("needs OpenGL 4.3", first + 1), std::string::npos);
        EXPECT_NE(outcome.output.find(version), std::string::npos) << outcome.output;
        expectNoGlError(outcome.output);
    }
}
