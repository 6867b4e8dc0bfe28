// Light that bounces from beyond a window: parts of a raster, runs that are killed, jobs, albedo
// rasters, budgets, and what is refused. Expected values: the raster in one piece.
#include "ToolRun.h"

#include <algorithm>
#include <cmath>
#include <csignal>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{
const std::string light = " --azimuths 8 --quality draft --bounces 2 --sun 250,30";

class WindowBounces : public GlToolTest
{
protected:
    void SetUp() override
    {
        GlToolTest::SetUp();
        if (IsSkipped())
            return;
        ASSERT_EQ(run("generate fractal d.tif --size 460,420 --seed 9 -q").status, 0);
    }

    /// The 99th percentile of differences of a file from a part of d.tif's light in one piece, of
    /// the colours.
    double differenceFromPart(const std::string& file, int column, int row,
                              const std::string& more = "") const
    {
        EXPECT_EQ(run("shade d.tif one.tif -q" + light + more).status, 0);
        const ReadRaster whole(path("one.tif"));
        const ReadRaster part(path(file));
        std::vector<float> differences;
        for (std::size_t band = 0; band < 3; ++band)
            for (int y = 0; y < part.height; ++y)
                for (int x = 0; x < part.width; ++x)
                    differences.push_back(
                        std::abs(part.bands[band][static_cast<std::size_t>(y * part.width + x)] -
                                 whole.bands[band][static_cast<std::size_t>(
                                     (row + y) * whole.width + column + x)]));
        const auto p99 = differences.begin() + static_cast<std::ptrdiff_t>(
                                                   0.99 * static_cast<double>(differences.size()));
        std::nth_element(differences.begin(), p99, differences.end());
        return static_cast<double>(*p99);
    }
};
} // namespace

TEST_F(WindowBounces, OfAPartAreThoseOfTheWhole)
{
    const ToolRun result = run("shade d.tif part.tif -srcwin 150 130 160 160" + light);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_LE(differenceFromPart("part.tif", 150, 130), 5e-3);
}

// A wall that only coarse levels around a part show, where what is lit with the part sees them. The
// posts at its foot and its top have normals between the wall's and the plain's, so its light is
// known to some percent; what was never lit would miss all of it.
TEST_F(WindowBounces, OfAPartComeFromAsFarAsItSees)
{
    constexpr int width = 540, height = 240, part = 100;
    for (const int wall : {300, 430, 460, 500})
    {
        std::vector<float> heights(std::size_t(width) * height, 0.0f);
        for (int row = 0; row < height; ++row)
            for (int column = wall; column < wall + 30; ++column)
                heights[static_cast<std::size_t>(row * width + column)] = 4000.0f;
        writeRaster("wall.tif", width, height, heights, {0, 30, 0, 9000, 0, -30});
        const std::string sun =
            " -q --azimuths 16 --sky none --sun 270,30 --albedo 0.8 --bounces 1";
        ASSERT_EQ(run("shade wall.tif one.tif" + sun).status, 0);
        ASSERT_EQ(run("shade wall.tif part.tif -srcwin 0 70 100 100" + sun).status, 0);
        const std::string direct = " -q --azimuths 16 --sky none --sun 270,30";
        ASSERT_EQ(run("shade wall.tif direct.tif" + direct).status, 0);
        const ReadRaster whole(path("one.tif")), found(path("part.tif")),
            unbounced(path("direct.tif"));
        double bounced = 0.0, expected = 0.0;
        for (int row = 0; row < part; ++row)
            for (int column = 0; column < part; ++column)
            {
                const double sunlit = unbounced.at(1, column, 70 + row);
                bounced += static_cast<double>(found.at(1, column, row)) - sunlit;
                expected += static_cast<double>(whole.at(1, column, 70 + row)) - sunlit;
            }
        std::printf("wall at %d: %.6f of %.6f\n", wall, bounced / (part * part),
                    expected / (part * part));
        EXPECT_GT(expected, 1e-3 * part * part);
        EXPECT_NEAR(bounced, expected, 0.1 * expected) << wall;
    }
}

TEST_F(WindowBounces, OfAnAlbedoRasterAreThoseOfTheWhole)
{
    std::vector<float> albedo(460 * 420);
    for (std::size_t i = 0; i < albedo.size(); ++i)
        albedo[i] = (i % 460) / 115 % 2 == 0 ? 0.8f : 0.2f;
    const ReadRaster terrain(path("d.tif"));
    writeRaster("a.tif", 460, 420, albedo,
                {terrain.transform[0], terrain.transform[1], terrain.transform[2],
                 terrain.transform[3], terrain.transform[4], terrain.transform[5]});
    const ToolRun result = run("shade d.tif many.tif --window-size 192 --albedo a.tif" + light);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_LE(differenceFromPart("many.tif", 0, 0, " --albedo a.tif"), 5e-3);
}

TEST_F(WindowBounces, GoOnAfterKillAndInJobsToTheSameBytes)
{
    const std::string command = " --window-size 192" + light;
    ASSERT_EQ(run("shade d.tif whole.tif -q" + command).status, 0);
    const std::string expected = contentOf(path("whole.tif"));
    int killed = 0;
    for (const char* delay : {"0.6", "1.5", "2.6"})
        killed += run("shade d.tif o.tif" + command,
                      "{ (sleep " + std::string(delay) + "; kill -KILL $$) >/dev/null 2>&1 & }")
                      .status == -SIGKILL;
    EXPECT_GT(killed, 0);
    // A level of light that was damaged meanwhile is made anew.
    std::error_code failure;
    if (std::filesystem::exists(path(".o.tif.windows/light-2"), failure))
        std::filesystem::resize_file(path(".o.tif.windows/light-2"), 100);
    ASSERT_EQ(run("shade d.tif o.tif --job 2/2" + command).status, 0);
    const ToolRun last = run("shade d.tif o.tif" + command);
    ASSERT_EQ(last.status, 0) << last.err;
    EXPECT_EQ(contentOf(path("o.tif")), expected);
    EXPECT_FALSE(std::filesystem::exists(path(".o.tif.windows")));
}

TEST_F(WindowBounces, ByABudgetHaveTheSettingsOfAllWindows)
{
    const ToolRun result = run("shade d.tif o.tif --bounces 1 --max-error 0.2 --window-size 256");
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("chosen: "), std::string::npos) << result.out;
}

TEST_F(WindowBounces, ByABudgetThatCannotBeMetLeaveNothing)
{
    const ToolRun result = run("shade d.tif o.tif --bounces 1 --max-ms 1 --window-size 256");
    EXPECT_EQ(result.status, 1);
    EXPECT_FALSE(std::filesystem::exists(path(".o.tif.windows")));
}

TEST_F(WindowBounces, OfTheLegendreMethodAreRefused)
{
    for (const char* window : {"--window-size 128", "-srcwin 100 100 64 64"})
    {
        const ToolRun result =
            run("shade d.tif o.tif --bounce-method legendre " + std::string(window));
        EXPECT_NE(result.status, 0);
        EXPECT_TRUE(result.complains("--bounce-method legendre: sees nothing beyond"))
            << result.err;
        EXPECT_FALSE(std::filesystem::exists(path("o.tif")));
        EXPECT_FALSE(std::filesystem::exists(path(".o.tif.windows")));
    }
}
