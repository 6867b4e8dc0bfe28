// --max-error and --max-ms: what they choose, say and refuse. The promise itself is held in
// tests/scene/settings_choice_test.cpp.
#include "ToolRun.h"

#include <cmath>
#include <fstream>
#include <iterator>

using namespace osgTerrainLight::testing;

namespace
{
using Budget = GlToolTest;

const std::string window = " -srcwin 100 100 160 140";

double rootMeanSquare(const std::vector<float>& a, const std::vector<float>& b)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
    {
        const double difference = static_cast<double>(a[i]) - static_cast<double>(b[i]);
        sum += difference * difference;
    }
    return std::sqrt(sum / static_cast<double>(a.size()));
}

std::string contentsOf(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}
} // namespace

TEST_F(Budget, MaxErrorChoosesAndSaysSo)
{
    const ToolRun result = run("svf " + jacksboro + " svf.tif --max-error 0.001" + window);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.out.substr(0, result.out.find('\n')),
              "0...10...20...30...40...50...60...70...80...90...100 - done.");
    EXPECT_NE(result.out.find("svf: chosen: quality "), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("; measured error at most "), std::string::npos) << result.out;
    const ReadRaster chosen(path("svf.tif"));
    const int azimuths = std::stoi(chosen.metadata("TERRAINLIGHT_AZIMUTHS"));
    EXPECT_GE(azimuths, 8);
    EXPECT_LT(azimuths, 192);
    const double bound = std::stod(chosen.metadata("TERRAINLIGHT_ERROR_BOUND"));
    EXPECT_GT(bound, 0.0);
    EXPECT_LE(bound, 0.001);

    // All posts against the most exact settings there are.
    ASSERT_EQ(run("svf " + jacksboro + " exact.tif --azimuths 256 --quality best" + window).status,
              0);
    const ReadRaster exact(path("exact.tif"));
    EXPECT_EQ(exact.metadata("TERRAINLIGHT_ERROR_BOUND"), "");
    const std::vector<float> nothing(exact.bands[0].size(), 0.0f);
    EXPECT_LE(rootMeanSquare(chosen.bands[0], exact.bands[0]),
              0.001 * rootMeanSquare(exact.bands[0], nothing));
}

TEST_F(Budget, ALargerErrorIsNotDearer)
{
    int last = 1000;
    for (const char* error : {"0.0005", "0.005"})
    {
        ASSERT_EQ(
            run("svf " + jacksboro + " svf.tif --max-error " + std::string(error) + window).status,
            0);
        const int azimuths =
            std::stoi(ReadRaster(path("svf.tif")).metadata("TERRAINLIGHT_AZIMUTHS"));
        EXPECT_LT(azimuths, last);
        last = azimuths;
    }
}

// Expected: settings are ranked by counted work, and nothing of the file tells a time.
TEST_F(Budget, TheSameCommandGivesTheSameFile)
{
    for (const std::string& mode : {std::string("svf"), std::string("shade")})
    {
        const std::string arguments =
            mode + " " + jacksboro + " out.tif --max-error 0.004 -srcwin 100 100 160 140";
        ASSERT_EQ(run(arguments).status, 0);
        const std::string first = contentsOf(path("out.tif"));
        ASSERT_EQ(run(arguments).status, 0);
        EXPECT_TRUE(first == contentsOf(path("out.tif"))) << mode;
        EXPECT_GT(first.size(), 1000u);
    }
}

TEST_F(Budget, EveryRasterOfLightTakesIt)
{
    for (const std::string& mode :
         {std::string("svf IN OUT --definition solid-angle"), std::string("shadow IN OUT"),
          std::string("shade IN OUT"), std::string("shade IN OUT --no-sun")})
        for (const std::string& budget :
             {std::string(" --max-error 0.05"), std::string(" --max-ms 1000000")})
        {
            // Of the whole, which the part would see, the curvature is warned of.
            std::string arguments = mode + budget + " -srcwin 100 100 64 64 --isolated";
            arguments.replace(arguments.find("IN"), 2, jacksboro);
            arguments.replace(arguments.find("OUT"), 3, "out.tif");
            const ToolRun result = run(arguments);
            ASSERT_EQ(result.status, 0) << arguments << ": " << result.err;
            EXPECT_EQ(result.err, "");
            EXPECT_NE(ReadRaster(path("out.tif")).metadata("TERRAINLIGHT_ERROR_BOUND"), "")
                << arguments;
        }
}

TEST_F(Budget, OneThatCannotBeMetIsRefusedAndNothingIsWritten)
{
    const ToolRun error = run("svf " + jacksboro + " svf.tif --max-error 0.00001" + window);
    EXPECT_EQ(error.status, 1);
    EXPECT_TRUE(error.complains("jacksboro_90m.tif: --max-error 1e-05: the most exact settings "
                                "tried (quality best, 192 azimuths) reach "))
        << error.err;
    const ToolRun time = run("shade " + jacksboro + " shade.tif --max-ms 0.01" + window);
    EXPECT_EQ(time.status, 1);
    EXPECT_TRUE(time.complains("--max-ms 0.01: the fastest settings tried (quality draft, 8 "
                               "azimuths) need "))
        << time.err;
    EXPECT_EQ(left(), std::set<std::string>{});
}

TEST_F(Budget, ExcludesWhatItChooses)
{
    for (const char* wrong : {"--max-error 0.01 --azimuths 16", "--max-ms 5 --quality best",
                              "--max-error 0.01 --max-ms 5"})
    {
        const ToolRun result = run("svf " + jacksboro + " svf.tif " + wrong);
        EXPECT_EQ(result.status, 2) << wrong;
        EXPECT_TRUE(result.complains("excludes")) << result.err;
    }
    for (const char* wrong : {"--max-error 0", "--max-error 2", "--max-error nan", "--max-ms -1"})
    {
        const ToolRun result = run("svf " + jacksboro + " svf.tif " + wrong);
        EXPECT_EQ(result.status, 2) << wrong;
        EXPECT_TRUE(result.complains(": needs ")) << result.err;
    }
    // The bands of horizon are the user's to name.
    EXPECT_EQ(run("horizon " + jacksboro + " h.tif --max-error 0.01").status, 2);
    EXPECT_EQ(left(), std::set<std::string>{});
}
