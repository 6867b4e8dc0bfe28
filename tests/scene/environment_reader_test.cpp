#include <osgTerrainLight/Environment.h>

#include "support/Panoramas.h"
#include "support/TestFolder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

using namespace osgTerrainLight;

namespace
{
namespace fs = std::filesystem;

class EnvironmentReaderTest : public testing::Test
{
protected:
    std::string in(const std::string& name) const { return (folder / name).string(); }

    const fs::path folder = testFolder();
};

/// Radiance's format, flat: mantissas of red, green and blue over 256, times 2^(exponent - 128).
/// One pixel is 2, 1, 0.5, all others are 0.25.
void writeHdr(const std::string& path, int width, int height, int x, int y)
{
    std::ofstream file(path, std::ios::binary);
    file << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " << height << " +X " << width << '\n';
    for (int i = 0; i < width * height; ++i)
        file << (i == y * width + x ? std::string("\x80\x40\x20\x82", 4)
                                    : std::string("\x80\x80\x80\x7f", 4));
}
} // namespace

// The same place as of an OpenEXR file (docs/CONVENTIONS.md): the middle is north, the top is up.
TEST_F(EnvironmentReaderTest, RadianceFile)
{
    for (const auto& [x, y, column, row] :
         {std::array{4, 1, 1, 2}, {6, 0, 7, 3}, {0, 3, 5, 0}, {5, 2, 0, 1}})
    {
        writeHdr(in("a.hdr"), 8, 4, x, y);
        std::string problem;
        const auto made = readEnvironment(in("a.hdr"), problem);
        ASSERT_NE(made, nullptr) << problem;
        EXPECT_EQ(problem, "");
        EXPECT_EQ(made->name, in("a.hdr"));
        ASSERT_EQ(made->columns, 8);
        ASSERT_EQ(made->rows, 4);
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 8; ++c)
            {
                const Rgb expected =
                    r == row && c == column ? Rgb{2.0f, 1.0f, 0.5f} : Rgb{0.25f, 0.25f, 0.25f};
                EXPECT_EQ(made->at(c, r), expected) << x << ' ' << y << ": " << c << ' ' << r;
            }
    }
}

TEST_F(EnvironmentReaderTest, OpenExrFile)
{
    OTL_SKIP_WITHOUT_PANORAMAS();
    std::string problem;
    const auto made = readEnvironment(panorama("sunrise"), problem);
    ASSERT_NE(made, nullptr) << problem;
    EXPECT_EQ(made->columns, 1024);
    EXPECT_TRUE(made->hasSun);
    // The brightest texel of the file is (614, 233): 35.9° right of the middle, 8.0° up.
    EXPECT_NEAR(made->sunAzimuth, (614.5 / 1024.0 - 0.5) * 360.0, 0.36);
    EXPECT_NEAR(made->sunElevation, (0.5 - 233.5 / 512.0) * 180.0, 0.36);
}

TEST_F(EnvironmentReaderTest, ErrorsNameTheFile)
{
    writeHdr(in("square.hdr"), 4, 4, 0, 0);
    std::ofstream(in("empty.exr"));
    std::ofstream(in("empty.hdr"));
    std::ofstream(in("text.xyz_no_plugin")) << "text";
    for (const auto& [name, part] : {std::pair{"none.exr", "no such file"},
                                     {"none.hdr", "no such file"},
                                     {"square.hdr", "4 x 4"},
                                     {"empty.exr", "OpenEXR"},
                                     {"empty.hdr", "Radiance"},
                                     {"text.xyz_no_plugin", "no picture that GDAL reads"}})
    {
        std::string problem;
        EXPECT_EQ(readEnvironment(in(name), problem), nullptr) << name;
        EXPECT_EQ(problem.rfind(in(name), 0), 0u) << problem;
        EXPECT_NE(problem.find(part), std::string::npos) << problem;
    }
}
