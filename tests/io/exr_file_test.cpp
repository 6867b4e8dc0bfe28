#include "io/ExrFile.h"
#include "support/TestFolder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

using namespace osgTerrainLight;

namespace
{

namespace fs = std::filesystem;

class ExrFileTest : public testing::Test
{
protected:
    std::string in(const std::string& name) const { return (folder / name).string(); }

    std::size_t fileCount() const
    {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
    }

    const fs::path folder = testFolder();
};

ExrImage ramp(int width, int height, const std::vector<std::string>& names)
{
    ExrImage image;
    image.width = width;
    image.height = height;
    float value = 0.0f;
    for (const std::string& name : names)
    {
        ExrChannel channel{name, {}};
        for (int i = 0; i < width * height; ++i)
            channel.values.push_back(value += 0.1f);
        image.channels.push_back(channel);
    }
    return image;
}

} // namespace

TEST_F(ExrFileTest, FloatRoundTripIsExact)
{
    ExrImage image = ramp(7, 5, {"A", "B", "G", "R"});
    image.channels[0].values[3] = std::numeric_limits<float>::infinity();
    image.text["comment"] = "azimuth 315";
    ASSERT_TRUE(writeExr(in("a.exr"), image, ExrPixelType::Float).ok());
    const Result<ExrImage> read = readExr(in("a.exr"));
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(read->width, 7);
    EXPECT_EQ(read->height, 5);
    ASSERT_EQ(read->channels.size(), 4u);
    for (const ExrChannel& channel : image.channels)
    {
        ASSERT_NE(read->find(channel.name), nullptr);
        EXPECT_EQ(read->find(channel.name)->values, channel.values) << channel.name;
    }
    EXPECT_EQ(read->text.at("comment"), "azimuth 315");
    EXPECT_EQ(read->find("Z"), nullptr);
    EXPECT_EQ(fileCount(), 1u);
}

TEST_F(ExrFileTest, HalfRoundTripIsWithinHalfAStep)
{
    const ExrImage image = ramp(64, 3, {"R", "G", "B"}); // in no alphabetical order
    ASSERT_TRUE(writeExr(in("a.exr"), image).ok());
    const Result<ExrImage> read = readExr(in("a.exr"));
    ASSERT_TRUE(read.ok()) << read.error().message;
    for (const ExrChannel& channel : image.channels)
        for (std::size_t i = 0; i < channel.values.size(); ++i)
            EXPECT_NEAR(read->find(channel.name)->values[i], channel.values[i],
                        channel.values[i] / 2048.0f);
}

TEST_F(ExrFileTest, OnePixel)
{
    ASSERT_TRUE(writeExr(in("a.exr"), ramp(1, 1, {"Y"}), ExrPixelType::Float).ok());
    EXPECT_EQ(readExr(in("a.exr"))->channels.front().values, std::vector<float>{0.1f});
}

TEST_F(ExrFileTest, SizesAreCheckedBeforeAllocation)
{
    ASSERT_TRUE(writeExr(in("a.exr"), ramp(16, 16, {"R", "G", "B"})).ok());
    EXPECT_TRUE(readExr(in("a.exr"), 768).ok());
    const Result<ExrImage> read = readExr(in("a.exr"), 767);
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().message.find("16 x 16"), std::string::npos);
}

TEST_F(ExrFileTest, BadFilesAreErrors)
{
    EXPECT_EQ(readExr(in("none.exr")).error().code, ErrorCode::NotFound);
    EXPECT_EQ(readExr(folder.string()).error().code, ErrorCode::Invalid);
    std::ofstream(in("empty.exr"));
    std::ofstream(in("text.exr")) << "this is no picture";
    ASSERT_TRUE(writeExr(in("whole.exr"), ramp(256, 256, {"R", "G"}), ExrPixelType::Float).ok());
    std::ifstream file(in("whole.exr"), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    for (const std::size_t length : {std::size_t(20), std::size_t(200), bytes.size() / 2})
        std::ofstream(in("cut" + std::to_string(length) + ".exr"), std::ios::binary)
            << bytes.substr(0, length);
    for (const auto& entry : fs::directory_iterator(folder))
    {
        if (entry.path().filename() == "whole.exr")
            continue;
        const Result<ExrImage> read = readExr(entry.path().string());
        ASSERT_FALSE(read.ok()) << entry.path();
        EXPECT_EQ(read.error().code, ErrorCode::Invalid);
        EXPECT_EQ(read.error().message.rfind(entry.path().string(), 0), 0u);
    }
}

// Every byte of the header turned over: an error or an image, never an exception or a crash.
TEST_F(ExrFileTest, DamagedHeadersDoNotThrow)
{
    ASSERT_TRUE(writeExr(in("a.exr"), ramp(8, 8, {"R", "G"}), ExrPixelType::Float).ok());
    std::ifstream file(in("a.exr"), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    for (std::size_t i = 0; i < std::min<std::size_t>(bytes.size(), 400); ++i)
    {
        std::string damaged = bytes;
        damaged[i] = static_cast<char>(~damaged[i]);
        std::ofstream(in("b.exr"), std::ios::binary) << damaged;
        readExr(in("b.exr"), 1 << 20);
    }
}

TEST_F(ExrFileTest, FailedWritesLeaveNothing)
{
    std::ofstream(in("plain")) << "a file";
    const ExrImage good = ramp(4, 4, {"R"});
    EXPECT_EQ(writeExr(in("nowhere/a.exr"), good).error().code, ErrorCode::Failed);
    EXPECT_FALSE(writeExr(in("plain/a.exr"), good).ok());
    EXPECT_FALSE(writeExr(folder.string(), good).ok());
    ExrImage bad = good;
    bad.channels.front().values.pop_back();
    EXPECT_EQ(writeExr(in("a.exr"), bad).error().code, ErrorCode::Invalid);
    bad = good;
    bad.channels.push_back(bad.channels.front());
    EXPECT_FALSE(writeExr(in("a.exr"), bad).ok()) << "two channels of one name";
    EXPECT_FALSE(writeExr(in("a.exr"), ExrImage()).ok());
    EXPECT_EQ(fileCount(), 1u);
    const Status written = writeExr(in("nowhere/a.exr"), good);
    EXPECT_EQ(written.error().message.find("partial"), std::string::npos)
        << written.error().message;
}
