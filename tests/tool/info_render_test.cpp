// info and render.
#include "ToolRun.h"

#include <cmath>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{

using Info = GlToolTest;
using Render = GlToolTest;

bool has(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

/// The number after a name at a line's start.
double valueOf(const std::string& text, const std::string& name)
{
    const std::size_t at = text.find("\n" + name);
    return at == std::string::npos ? -1.0 : std::stod(text.substr(at + 1 + name.size()));
}

TEST_F(Info, SaysWhatThereIsAndWhatItCosts)
{
    const ToolRun result = run("info");
    EXPECT_EQ(result.status, 0);
    for (const char* name : {"terrainlight:", "GDAL:", "OpenSceneGraph:", "OpenGL vendor:",
                             "OpenGL renderer:", "OpenGL version:", "Platform:"})
        EXPECT_TRUE(has(result.out, name)) << name;
    EXPECT_TRUE(has(result.out, "(software)") || has(result.out, "(hardware)"));
    EXPECT_TRUE(has(result.out, "1024 x 1024 posts, 32 azimuths"));
    EXPECT_EQ(valueOf(result.out, "Horizon map:"), 64.0);
    EXPECT_EQ(valueOf(result.out, "Shading:"), 8.0);
}

TEST_F(Info, DescribesARaster)
{
    const ToolRun result = run("info " + jacksboro + " --azimuths 64");
    EXPECT_EQ(result.status, 0);
    for (const char* fact : {"403 x 344", "WGS 84 (geographic)", "236 ... 1076 m", "0 of 138632",
                             "GTiff, Int16, 1 band", "74.57", "64 azimuths"})
        EXPECT_TRUE(has(result.out, fact)) << fact << " not in\n" << result.out;
    EXPECT_EQ(valueOf(result.out, "Horizon map:"), 16.92); // 403·344·64·2 bytes
}

TEST_F(Info, RefusesSurroundingsThatAreNotThere)
{
    const ToolRun result = run("info " + jacksboro + " --surroundings nowhere.tif");
    EXPECT_EQ(result.status, 1);
    EXPECT_TRUE(result.complains("nowhere.tif")) << result.err;
}

TEST_F(Info, RateMeasuresTheEstimatedTextures)
{
    const ToolRun result = run("info " + jacksboro + " --rate --azimuths 8 -srcwin 0 0 128 96");
    ASSERT_EQ(result.status, 0) << result.err;
    const double estimated = valueOf(result.out, "Heights:") + valueOf(result.out, "Horizon map:") +
                             valueOf(result.out, "Working space:");
    for (const std::string quality : {"draft", "normal", "best"})
    {
        const std::size_t at = result.out.find("\n" + quality);
        ASSERT_NE(at, std::string::npos) << result.out;
        std::istringstream row(result.out.substr(at + 1 + quality.size()));
        double milliseconds = 0.0, rate = 0.0, bytes = 0.0;
        row >> milliseconds >> rate >> bytes;
        EXPECT_GT(milliseconds, 0.0);
        // Both are printed with one decimal.
        EXPECT_NEAR(rate * milliseconds / (128 * 96 * 8 * 1e-3), 1.0,
                    0.06 / milliseconds + 0.06 / rate);
        if (quality == "normal")
        {
            EXPECT_NEAR(bytes, estimated, 0.02);
        }
    }
}

double brightness(const ReadRaster& picture, int column, int row)
{
    return double(picture.at(1, column, row) + picture.at(2, column, row) +
                  picture.at(3, column, row)) /
           3.0;
}

double mean(const ReadRaster& picture, int left, int top, int width, int height)
{
    double sum = 0.0;
    for (int row = top; row < top + height; ++row)
        for (int column = left; column < left + width; ++column)
            sum += brightness(picture, column, row);
    return sum / (width * height);
}

// A ridge from south to north through the middle: seen from above with north up and the sun in the
// east, its right side is bright and its left dark; with the sun in the west the other way round.
TEST_F(Render, TopViewIsNorthUpAndLitFromTheSun)
{
    const int size = 65;
    std::vector<float> ridge, step;
    for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column)
        {
            const int acrossX = std::abs(column - size / 2);
            const int acrossY = std::abs(row - size / 2);
            ridge.push_back(static_cast<float>(std::max(0, 20 - acrossX)) * 10.0f);
            step.push_back(static_cast<float>(std::max(0, 20 - acrossY)) * 10.0f);
        }
    writeRaster("ridge.tif", size, size, ridge, {0, 10, 0, 0, 0, -10});
    writeRaster("step.tif", size, size, step, {0, 10, 0, 0, 0, -10});
    const std::string options = " p.png --top --size 130 -q --light sun --azimuths 8 --sun ";
    const struct
    {
        const char* input;
        const char* sun;
        int brightX, brightY; // the middle of the bright flank in the picture
    } cases[] = {{"ridge.tif", "90,30", 85, 65},
                 {"ridge.tif", "270,30", 45, 65},
                 {"step.tif", "0,30", 65, 45},
                 {"step.tif", "180,30", 65, 85}};
    for (const auto& c : cases)
    {
        const ToolRun result = run("render " + std::string(c.input) + options + c.sun);
        ASSERT_EQ(result.status, 0) << result.err;
        EXPECT_EQ(result.out, "");
        const ReadRaster picture(path("p.png"));
        ASSERT_EQ(picture.width, 130);
        ASSERT_EQ(picture.height, 130);
        ASSERT_EQ(picture.count, 3);
        const double bright = mean(picture, c.brightX - 5, c.brightY - 5, 10, 10);
        const double dark = mean(picture, 130 - c.brightX - 5, 130 - c.brightY - 5, 10, 10);
        EXPECT_GT(bright, dark + 50.0) << c.input << " sun " << c.sun;
    }
}

TEST_F(Render, DefaultViewIsFromTheSouthAndFillsThePicture)
{
    const ToolRun result = run("render " + jacksboro + " p.png --size 200,150");
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.out.substr(0, result.out.find('\n')),
              "0...10...20...30...40...50...60...70...80...90...100 - done.");
    const ReadRaster picture(path("p.png"));
    ASSERT_EQ(picture.width, 200);
    ASSERT_EQ(picture.height, 150);
    const auto isBackground = [&](int column, int row)
    {
        return picture.at(1, column, row) == picture.at(1, 0, 0) &&
               picture.at(2, column, row) == picture.at(2, 0, 0);
    };
    EXPECT_TRUE(isBackground(100, 2)) << "sky above";
    EXPECT_FALSE(isBackground(100, 75)) << "terrain in the middle";
    int terrain = 0;
    for (int row = 0; row < 150; ++row)
        for (int column = 0; column < 200; ++column)
            terrain += isBackground(column, row) ? 0 : 1;
    EXPECT_GT(terrain, 200 * 150 / 3);
}

TEST_F(Render, ExposureAndLightReachTheScene)
{
    const auto middle = [&](const std::string& options)
    {
        const ToolRun result =
            run("render " + jacksboro + " p.png -q --top --size 40 --azimuths 8 " + options);
        EXPECT_EQ(result.status, 0) << result.err;
        return mean(ReadRaster(path("p.png")), 15, 15, 10, 10);
    };
    const double sky = middle("--light sky --exposure -1");
    const double both = middle("--light both --exposure -1 --sun 315,60");
    const double darker = middle("--light both --exposure -3 --sun 315,60");
    EXPECT_LT(sky, both);
    EXPECT_LT(darker, both);
}

TEST_F(Render, FailuresLeaveNothing)
{
    std::ofstream(path("text.osgt")) << "no scene\n";
    const auto before = left();
    for (const std::string scene : {"missing.tif", "text.osgt"})
    {
        const ToolRun result = run("render " + scene + " p.png -q");
        EXPECT_EQ(result.status, 1);
        EXPECT_TRUE(result.complains("terrainlight: " + scene)) << result.err;
        EXPECT_EQ(left(), before);
    }
    std::ofstream(path("m.earth")) << "<map><elevation driver='noise' url='a'/></map>";
    for (const std::string suffix : {"", ".terrainlight"})
    {
        const ToolRun result = run("render m.earth" + suffix + " p.png -q");
        const std::string reason = "terrainlight: m.earth:1: holds no layer that can be drawn";
        EXPECT_EQ(result.err.substr(0, reason.size()), reason);
    }
    std::filesystem::remove(path("m.earth"));
    EXPECT_EQ(run("render " + jacksboro + " nowhere/p.png -q --size 32").status, 1);
    EXPECT_EQ(run("render " + jacksboro + " p.frob -q --size 32").status, 1);
    EXPECT_EQ(left(), before);
}

TEST_F(Render, AFormerVersionsSceneLooksAsItDid)
{
    // data/former: scenes saved before properties had names, and pictures of them. Grey levels may
    // differ by what another driver rounds, as in the other tests of pictures.
    const std::string data = OTL_SOURCE_DIR "/tests/scene/data/former/";
    for (const std::string name : {"lit", "day"})
        for (const std::string extension : {".osgt", ".osgb", ".osgx"})
        {
            SCOPED_TRACE(name + extension);
            const ToolRun result =
                run("render " + data + name + extension + " p.png --top --size 64 -q");
            ASSERT_EQ(result.status, 0) << result.err;
            const ReadRaster now(path("p.png")), then(data + name + ".png");
            ASSERT_EQ(now.bands.size(), then.bands.size());
            float most = 0.0f;
            for (std::size_t b = 0; b < now.bands.size(); ++b)
                for (std::size_t i = 0; i < now.bands[b].size(); ++i)
                    most = std::max(most, std::abs(now.bands[b][i] - then.bands[b][i]));
            EXPECT_LE(most, 3.0f);
        }
}

// Expected: the picture that --eye and --center make of the same place, which is the middle of the
// raster: 10 km away with a slope of 3 to 4, the eye is 8 km south and 6 km above. A step of a
// number in the map may move single pixels at edges.
TEST_F(Render, FromAViewpointOfTheMap)
{
    std::ofstream(path("m.earth"))
        << "<map><GDALElevation url='" << jacksboro
        << "'/><viewpoints><viewpoint name='a' lat='36.58958333333' long='-84.24583333333' "
           "height='500' pitch='-36.869897645844' range='10km'/>"
           "<viewpoint name='Far' lat='36.6' long='-84.2' pitch='-30' range='20km'/></viewpoints>"
           "</map>";
    const auto picture = [&](const std::string& options)
    {
        const ToolRun result = run("render m.earth p.png -q --size 64 --azimuths 8 " + options);
        EXPECT_EQ(result.status, 0) << result.err;
        return ReadRaster(path("p.png")).bands;
    };
    const auto meanDifference = [](const auto& one, const auto& other)
    {
        double sum = 0.0;
        for (std::size_t band = 0; band < one.size(); ++band)
            for (std::size_t i = 0; i < one[band].size(); ++i)
                sum += std::abs(double(one[band][i]) - double(other[band][i]));
        return sum / (3.0 * 64.0 * 64.0);
    };
    const auto wanted = picture("--eye 0,-8000,6500 --center 0,0,500");
    for (const char* name : {"home", "a", "A"})
        EXPECT_LT(meanDifference(picture(std::string("--viewpoint ") + name), wanted), 0.1);
    EXPECT_GT(meanDifference(picture("--viewpoint far"), wanted), 5.0);

    const ToolRun wrong = run("render m.earth p.png -q --viewpoint b");
    EXPECT_EQ(wrong.status, 1);
    EXPECT_TRUE(
        wrong.complains("--viewpoint b: m.earth has no such viewpoint; it has \"a\", \"Far\""))
        << wrong.err;
    const ToolRun none = run("render " + jacksboro + " p.png -q --viewpoint b");
    EXPECT_TRUE(none.complains("has no viewpoint")) << none.err;
    EXPECT_EQ(run("render m.earth p.png -q --viewpoint a --top").status, 2);
}

} // namespace
