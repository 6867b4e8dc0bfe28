#include "io/EnvironmentFile.h"
#include "support/TestFolder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

using namespace osgTerrainLight;

namespace
{
namespace fs = std::filesystem;

class RadianceFileTest : public testing::Test
{
protected:
    std::string write(const std::string& variables, const std::string& resolution,
                      const std::string& pixels) const
    {
        const std::string path = (folder / "a.hdr").string();
        std::ofstream(path, std::ios::binary) << "#?RADIANCE\n"
                                              << variables << '\n'
                                              << resolution << '\n'
                                              << pixels;
        return path;
    }

    const fs::path folder = testFolder();
};

/// Mantissas and exponent of the format (Ward, Real Pixels): value = mantissa / 256 · 2^(e − 128).
std::string coded(const Rgb& colour)
{
    const float greatest = std::max({colour[0], colour[1], colour[2]});
    int exponent = 0;
    std::frexp(greatest, &exponent);
    std::string bytes;
    for (const float value : colour)
        bytes += static_cast<char>(std::lround(std::ldexp(value, 8 - exponent)));
    return bytes + static_cast<char>(exponent + 128);
}

std::string times(const std::string& text, int count)
{
    std::string all;
    for (int i = 0; i < count; ++i)
        all += text;
    return all;
}

constexpr const char* rgbe = "FORMAT=32-bit_rle_rgbe\n";

/// Every texel of a picture of one colour.
void expectAll(const std::string& path, const Rgb& colour, float relative, const std::string& what)
{
    const Result<EnvironmentPicture> picture = readEnvironmentFile(path);
    ASSERT_TRUE(picture) << what << ": " << picture.error().message;
    for (const Rgb& texel : picture->radiance)
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(texel[c], colour[c], relative * std::max({colour[0], colour[1], colour[2]}))
                << what << ", channel " << c;
}
} // namespace

// Axes of the resolution string (filefmts.pdf): the first runs over scan lines; -Y begins at the
// top, +X at the left. The right picture is the standard order's.
TEST_F(RadianceFileTest, EveryResolutionString)
{
    constexpr int width = 8, height = 4;
    const auto colourAt = [](int x, int fromTop) {
        return coded({1.0f, 0.25f * static_cast<float>(fromTop), 0.0625f * static_cast<float>(x)});
    };
    std::vector<Rgb> standard;
    for (const std::string first : {"-Y", "+Y", "-X", "+X"})
        for (const std::string sign : {"+", "-"})
        {
            const bool byRows = first[1] == 'Y';
            const std::string second = sign + (byRows ? "X" : "Y");
            std::string pixels;
            const auto place = [](const std::string& axis, int i)
            {
                // From the left, from the top.
                const bool forward = axis == "+X" || axis == "-Y";
                return forward ? i : (axis[1] == 'X' ? width : height) - 1 - i;
            };
            for (int i = 0; i < (byRows ? height : width); ++i)
                for (int k = 0; k < (byRows ? width : height); ++k)
                    pixels += byRows ? colourAt(place(second, k), place(first, i))
                                     : colourAt(place(first, i), place(second, k));
            const auto size = [&](bool rows) { return std::to_string(rows ? height : width); };
            const std::string resolution =
                first + " " + size(byRows) + " " + second + " " + size(!byRows);
            const Result<EnvironmentPicture> picture =
                readEnvironmentFile(write(rgbe, resolution, pixels));
            ASSERT_TRUE(picture) << picture.error().message;
            EXPECT_EQ(picture->columns, width);
            EXPECT_EQ(picture->rows, height);
            if (standard.empty())
                standard = picture->radiance; // -Y +X: environment_reader_test has its places
            EXPECT_EQ(picture->radiance, standard) << resolution;
        }
}

// radiance = pixel / (all EXPOSURE · all COLORCORR), by filefmts.pdf; pixels are 2, 4, 1.
TEST_F(RadianceFileTest, VariablesOfTheHeader)
{
    const std::string pixels = times(coded({2.0f, 4.0f, 1.0f}), 32);
    const struct
    {
        const char* variables;
        Rgb expected;
    } cases[] = {
        {"", {2.0f, 4.0f, 1.0f}},
        {"EXPOSURE=1e-3\n", {2000.0f, 4000.0f, 1000.0f}},
        {"EXPOSURE= +4.000e+00\nEXPOSURE=0.5\nEXPOSURE=2\n", {0.5f, 1.0f, 0.25f}},
        {"COLORCORR= 0.5 2 4\nCOLORCORR= 2 2 0.5\n", {2.0f, 1.0f, 0.5f}},
        {"EXPOSURE=2\nCOLORCORR=1 0.5 0.25\n", {1.0f, 4.0f, 2.0f}},
        {"\tEXPOSURE=16\n EXPOSURE=16\n", {2.0f, 4.0f, 1.0f}}, // of pictures it was made from
        {"EXPOSURE=2\r\nSOFTWARE=x\r\n", {1.0f, 2.0f, 0.5f}},
        {"PIXASPECT=2\nPIXASPECT=0.5\n", {2.0f, 4.0f, 1.0f}},
        {"PRIMARIES= .64 .33 .29 .6 .15 .06 .333 .333\n", {2.0f, 4.0f, 1.0f}},
        {"PRIMARIES=.64 .33 .3 .6 .15 .06 .3127 .329\n", {2.0f, 4.0f, 1.0f}},
    };
    for (const auto& [variables, expected] : cases)
        for (const bool before : {false, true})
            expectAll(write(before ? variables + std::string(rgbe) : rgbe + std::string(variables),
                            "-Y 4 +X 8", pixels),
                      expected, 1e-6f, variables);
}

TEST_F(RadianceFileTest, ShapeCountsThePixelsAspect)
{
    const std::string pixels = times(coded({1.0f, 1.0f, 1.0f}), 64);
    // Pixels half as high as wide: 8 x 8 of them are 2 : 1.
    const Result<EnvironmentPicture> flat =
        readEnvironmentFile(write("PIXASPECT=0.5\n", "-Y 8 +X 8", pixels));
    ASSERT_TRUE(flat) << flat.error().message;
    EXPECT_EQ(flat->columns, 8);
    EXPECT_EQ(flat->rows, 8);
    EXPECT_TRUE(readEnvironmentFile(write("PIXASPECT=2\n", "-Y 4 +X 16", pixels)));
    EXPECT_FALSE(readEnvironmentFile(write("PIXASPECT=2\n", "-Y 4 +X 8", pixels)));
    EXPECT_FALSE(readEnvironmentFile(write("", "-Y 8 +X 8", pixels)));
}

// Luminances of Radiance's primaries with its white (color.h: CIE_rf, CIE_gf, CIE_bf), and XYZ from
// their chromaticities: X = x / y · Y, Z = (1 − x − y) / y · Y. Pixels are lumens, 179 to a watt. A
// byte's mantissa is right to 1/256 of the greatest.
TEST_F(RadianceFileTest, XyzBecomesRedGreenAndBlue)
{
    const struct
    {
        double x, y, luminance;
        Rgb colour;
    } primaries[] = {{0.640, 0.330, 0.26507413, {1.0f, 0.0f, 0.0f}},
                     {0.290, 0.600, 0.67011463, {0.0f, 1.0f, 0.0f}},
                     {0.150, 0.060, 0.06481124, {0.0f, 0.0f, 1.0f}},
                     {1.0 / 3.0, 1.0 / 3.0, 1.0, {1.0f, 1.0f, 1.0f}}};
    for (const auto& [x, y, luminance, colour] : primaries)
    {
        const double scale = 179.0 * luminance / y;
        const Rgb xyz = {static_cast<float>(scale * x), static_cast<float>(scale * y),
                         static_cast<float>(scale * (1.0 - x - y))};
        const std::string path =
            write("FORMAT=32-bit_rle_xyze\n", "-Y 4 +X 8", times(coded(xyz), 32));
        const Result<EnvironmentPicture> picture = readEnvironmentFile(path);
        ASSERT_TRUE(picture) << picture.error().message;
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(picture->radiance[0][c], colour[c], 0.02f) << x << ' ' << y;
        // As ra_xyze writes it: pixels as of RGBE, and EXPOSURE = 1 / 179.
        const Rgb small = {xyz[0] / 179.0f, xyz[1] / 179.0f, xyz[2] / 179.0f};
        const Result<EnvironmentPicture> scaled =
            readEnvironmentFile(write("FORMAT=32-bit_rle_xyze\nEXPOSURE=5.586592e-03\n",
                                      "-Y 4 +X 8", times(coded(small), 32)));
        ASSERT_TRUE(scaled) << scaled.error().message;
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(scaled->radiance[0][c], colour[c], 0.02f) << x << ' ' << y;
    }
}

// White is white in any primaries; a colour within both triangles keeps its luminance's order.
TEST_F(RadianceFileTest, OtherPrimariesKeepWhite)
{
    for (const char* primaries : {"PRIMARIES=.708 .292 .17 .797 .131 .046 .3127 .329\n",
                                  "PRIMARIES=.7347 .2653 .1596 .8404 .0366 .0001 .3457 .3585\n"})
        expectAll(write(primaries, "-Y 4 +X 8", times(coded({2.0f, 2.0f, 2.0f}), 32)),
                  {2.0f, 2.0f, 2.0f}, 1e-3f, primaries);
    // A red of wider primaries is a stronger red in ours: green and blue go below 0 and become 0.
    const Result<EnvironmentPicture> red =
        readEnvironmentFile(write("PRIMARIES=.708 .292 .17 .797 .131 .046 .3127 .329\n",
                                  "-Y 4 +X 8", times(coded({1.0f, 0.0f, 0.0f}), 32)));
    ASSERT_TRUE(red);
    EXPECT_GT(red->radiance[0][0], 1.3f);
    EXPECT_EQ(red->radiance[0][1], 0.0f);
}

TEST_F(RadianceFileTest, RunsAreAsFlatPixels)
{
    const std::string a = coded({1.0f, 0.5f, 0.25f}), b = coded({0.5f, 0.5f, 0.5f});
    const auto radiance = [&](const std::string& pixels)
    {
        const Result<EnvironmentPicture> picture =
            readEnvironmentFile(write(rgbe, "-Y 4 +X 8", pixels));
        EXPECT_TRUE(picture) << picture.error().message;
        return picture ? picture->radiance : std::vector<Rgb>();
    };
    const std::vector<Rgb> flat = radiance(times(times(a, 6) + times(b, 2), 4));
    // Old runs: 1 1 1 n repeats the pixel before.
    EXPECT_EQ(radiance(times(a + "\x01\x01\x01\x05" + times(b, 2), 4)), flat);
    // New runs, per channel: 128 + n equal bytes, or n different ones.
    std::string line = std::string("\x02\x02\x00\x08", 4);
    for (std::size_t c = 0; c < 4; ++c)
        line += std::string("\x85") + a[c] + std::string("\x03") + a[c] + b[c] + b[c];
    EXPECT_EQ(radiance(times(line, 4)), flat);
}

TEST_F(RadianceFileTest, AViewIsSaid)
{
    const Result<EnvironmentPicture> picture =
        readEnvironmentFile(write("VIEW= -vtv -vp 0 0 0\nVIEW= -vth -vh 180\n", "-Y 4 +X 8",
                                  times(coded({1.0f, 1.0f, 1.0f}), 32)));
    ASSERT_TRUE(picture);
    EXPECT_NE(picture->warning.find("VIEW is of type -vth"), std::string::npos) << picture->warning;
}

// What a header says and the picture does not follow; of several FORMAT lines the last counts.
TEST_F(RadianceFileTest, VariablesThatAreNotFollowedAreSaid)
{
    const std::string xyze = "FORMAT=32-bit_rle_xyze\n";
    const std::string both = "its FORMAT lines contradict each other; the last one, ";
    const std::pair<std::string, std::string> cases[] = {
        {"GAMMA=2.2\n", "its GAMMA is 2.2; it is taken as linear light"},
        {"GAMMA=x\n", "its GAMMA is x; it is taken as linear light"},
        {"GAMMA= 1.0\n", ""},
        {"\tGAMMA=2.2\n", ""}, // of a picture that it was made from
        {rgbe + std::string(rgbe), ""},
        {rgbe + xyze, both + "32-bit_rle_xyze, counts"},
        {xyze + rgbe, both + "32-bit_rle_rgbe, counts"},
        {xyze + rgbe + "GAMMA=2\n",
         both + "32-bit_rle_rgbe, counts; its GAMMA is 2; it is taken as linear light"}};
    for (const auto& [variables, said] : cases)
    {
        const std::string path =
            write(variables, "-Y 4 +X 8", times(coded({1.0f, 1.0f, 1.0f}), 32));
        const Result<EnvironmentPicture> picture = readEnvironmentFile(path);
        ASSERT_TRUE(picture) << picture.error().message;
        EXPECT_EQ(picture->warning, said.empty() ? "" : path + ": " + said) << variables;
    }
}

TEST_F(RadianceFileTest, DamageGivesOneMessageAlwaysTheSame)
{
    const std::string pixels = times(coded({1.0f, 1.0f, 1.0f}), 32);
    const std::string eight = std::string("\x02\x02\x00\x08", 4);
    const struct
    {
        std::string variables, resolution, pixels, part;
    } cases[] = {
        {rgbe, "-Y 4 +X", pixels, "resolution string is \"-Y 4 +X\""},
        {rgbe, "", pixels, "resolution string is \"\""},
        {rgbe, "-Y 4 -Y 8", pixels, "resolution string"},
        {rgbe, "-Y 0 +X 0", pixels, "resolution string"},
        {rgbe, "-Y -4 +X 8", pixels, "resolution string"},
        {rgbe, "Y 4 X 8", pixels, "resolution string"},
        {rgbe, "-Y 4 +X 8 +Z 2", pixels, "resolution string"},
        {rgbe, "-Y 99999999999 +X 8", pixels, "resolution string"},
        {rgbe, "-Y 8192 +X 16384", pixels, "scan line 1 of 8192"},
        {rgbe, "-Y 100000 +X 200000", pixels, "at most 16384 x 8192"},
        {rgbe, "-Y 2147483647 +X 2147483647", pixels, "needed 2 : 1"},
        {rgbe, "-Y 4 +X 8", pixels.substr(0, 100), "scan line 4 of 4"},
        {rgbe, "-Y 4 +X 8", "", "scan line 1 of 4"},
        {rgbe, "-Y 4 +X 8", eight + std::string("\x89\x01", 2), "scan line 1 of 4"}, // 9 of 8
        {rgbe, "-Y 4 +X 8", eight + std::string("\x00\x01", 2), "scan line 1 of 4"},
        {rgbe, "-Y 4 +X 8", std::string("\x02\x02\x00\x09", 4) + pixels, "scan line 1 of 4"},
        {rgbe, "-Y 4 +X 8", "\x01\x01\x01\x05" + pixels, "scan line 1 of 4"}, // nothing to repeat
        {"FORMAT=ascii\n", "-Y 4 +X 8", pixels, "32-bit_rle_xyze"},
        {"EXPOSURE=0\n", "-Y 4 +X 8", pixels, "\"EXPOSURE=0\"; needed a number > 0"},
        {"EXPOSURE=-1\n", "-Y 4 +X 8", pixels, "needed a number > 0"},
        {"EXPOSURE=nan\n", "-Y 4 +X 8", pixels, "needed a number > 0"},
        {"EXPOSURE=\n", "-Y 4 +X 8", pixels, "needed a number > 0"},
        {"COLORCORR=1 1\n", "-Y 4 +X 8", pixels, "needed three numbers > 0"},
        {"PIXASPECT=0\n", "-Y 4 +X 8", pixels, "needed a number > 0"},
        {"PRIMARIES=.3 .3\n", "-Y 4 +X 8", pixels, "red, green, blue and white"},
        {"PRIMARIES=0 0 0 0 0 0 0 0\n", "-Y 4 +X 8", pixels, "span no colours"},
        {"PRIMARIES=.3 .3 .3 .3 .3 .3 .3 .3\n", "-Y 4 +X 8", pixels, "span no colours"},
    };
    for (const auto& [variables, resolution, data, part] : cases)
    {
        const std::string path = write(variables, resolution, data);
        std::string first;
        for (int i = 0; i < 3; ++i)
        {
            const Result<EnvironmentPicture> picture = readEnvironmentFile(path);
            ASSERT_FALSE(picture) << variables << resolution;
            const std::string& said = picture.error().message;
            EXPECT_EQ(said.rfind(path + ": ", 0), 0u) << said;
            EXPECT_NE(said.find(part), std::string::npos) << said;
            EXPECT_EQ(said, i == 0 ? said : first);
            first = said;
        }
    }
    const std::string path = (folder / "cut.hdr").string();
    std::ofstream(path, std::ios::binary) << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n";
    EXPECT_NE(readEnvironmentFile(path).error().message.find("ends in its header"),
              std::string::npos);
}
