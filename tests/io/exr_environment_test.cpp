// Which layer of an OpenEXR file is the picture, and what luminance and chroma become.
#include "io/EnvironmentFile.h"
#include "support/TestFolder.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
namespace fs = std::filesystem;
constexpr int width = 16, height = 8;

/// Channels of one value each, by name; where sampling is 2, RY and BY have every second pixel.
using Values = std::map<std::string, float>;

struct Plane
{
    Plane(float value) : values(width * height, value) {}
    std::vector<float> values;
};

int samplingOf(const std::string& name, int sampling)
{
    return name.size() > 1 && name[name.size() - 1] == 'Y' && name[name.size() - 2] != '.'
               ? sampling
               : 1;
}

class ExrEnvironmentTest : public testing::Test
{
protected:
    static Imf::FrameBuffer declare(Imf::Header& header, const Values& values,
                                    std::map<std::string, Plane>& planes, int sampling)
    {
        Imf::FrameBuffer buffer;
        for (const auto& [name, value] : values)
        {
            const int each = samplingOf(name, sampling);
            header.channels().insert(name, Imf::Channel(Imf::FLOAT, each, each));
            std::vector<float>& plane = planes.emplace(name, value).first->second.values;
            buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(plane.data()),
                                           sizeof(float), sizeof(float) * width / std::size_t(each),
                                           each, each));
        }
        return buffer;
    }

    void write(Imf::Header header, const Values& values, int sampling = 1) const
    {
        std::map<std::string, Plane> planes;
        const Imf::FrameBuffer buffer = declare(header, values, planes, sampling);
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(height);
    }

    struct Part
    {
        std::string name, view;
        Values values;
    };
    void write(const std::vector<Part>& parts) const
    {
        std::vector<Imf::Header> headers;
        std::vector<std::map<std::string, Plane>> planes(parts.size());
        std::vector<Imf::FrameBuffer> buffers;
        for (std::size_t i = 0; i < parts.size(); ++i)
        {
            headers.emplace_back(width, height);
            headers.back().setName(parts[i].name);
            headers.back().setType(Imf::SCANLINEIMAGE);
            if (!parts[i].view.empty())
                headers.back().setView(parts[i].view);
            buffers.push_back(declare(headers.back(), parts[i].values, planes[i], 1));
        }
        Imf::MultiPartOutputFile file(path.c_str(), headers.data(),
                                      static_cast<int>(headers.size()));
        for (std::size_t i = 0; i < parts.size(); ++i)
        {
            Imf::OutputPart part(file, static_cast<int>(i));
            part.setFrameBuffer(buffers[i]);
            part.writePixels(height);
        }
    }

    void expectColour(const Rgb& colour, float tolerance, const std::string& warning) const
    {
        const Result<EnvironmentPicture> picture = readEnvironmentFile(path);
        ASSERT_TRUE(picture) << picture.error().message;
        for (const Rgb& texel : picture->radiance)
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(texel[c], colour[c], tolerance) << c;
        EXPECT_EQ(picture->warning, warning.empty() ? "" : path + ": " + warning);
    }

    const std::string path = (testFolder() / "a.exr").string();
};

Values rgb(float value, const std::string& prefix = "")
{
    return {{prefix + "R", value}, {prefix + "G", 2 * value}, {prefix + "B", 3 * value}};
}
} // namespace

// The part's name is its layers': how Nuke, Blender and Houdini write files of several parts.
TEST_F(ExrEnvironmentTest, PartsByTheirNames)
{
    write({{"normal", "", rgb(1)}, {"rgba", "", rgb(2)}, {"specular", "", rgb(3)}});
    expectColour({2, 4, 6}, 0,
                 "part \"rgba\" is taken as light, not part \"specular\", part \"normal\"");
    write({{"depth", "", {{"Z", 5}}}, {"sky", "", rgb(7)}});
    expectColour({7, 14, 21}, 0, "");
    write({{"a", "", rgb(1, "AO.")}, {"b", "", rgb(4, "Beauty.")}});
    expectColour({4, 8, 12}, 0,
                 "the layer \"Beauty\" of part \"b\" is taken as light, not the layer \"AO\" of "
                 "part \"a\"");
    write({{"rgb.right", "right", rgb(5)}, {"rgb.left", "left", rgb(6)}});
    expectColour({5, 10, 15}, 0, "part \"rgb.right\" is taken as light, not part \"rgb.left\"");
}

TEST_F(ExrEnvironmentTest, LuminanceAlone)
{
    write(Imf::Header(width, height), {{"Y", 3}});
    expectColour({3, 3, 3}, 0, "");
    write(Imf::Header(width, height), {{"sky.Y", 2}, {"sky.A", 1}});
    expectColour({2, 2, 2}, 0, "");
    Values both = rgb(1, "mask.");
    both["Y"] = 4;
    write(Imf::Header(width, height), both);
    expectColour({4, 4, 4}, 0,
                 "the layer without a name is taken as light, not the layer \"mask\"");
    both = {{"velocity.X", 1}, {"velocity.Y", 2}, {"dome.Y", 5}};
    write(Imf::Header(width, height), both);
    expectColour({5, 5, 5}, 0, "");
}

// Y = w · (R, G, B), RY = (R − Y) / Y, BY = (B − Y) / Y (ImfRgbaYca.h); w of Rec. 709 by default.
// One colour all over, so that sub-sampled chroma is exact. In BT.2020's primaries w is BT.2020's
// own, and BT.2087 has the matrix to Rec. 709.
TEST_F(ExrEnvironmentTest, LuminanceAndChromaOfOneColour)
{
    const auto coded = [](const Rgb& c, const Rgb& weights, const std::string& prefix)
    {
        const float y = weights[0] * c[0] + weights[1] * c[1] + weights[2] * c[2];
        return Values{
            {prefix + "Y", y}, {prefix + "RY", (c[0] - y) / y}, {prefix + "BY", (c[2] - y) / y}};
    };
    const Rgb colour = {0.8f, 0.5f, 0.2f}, rec709 = {0.2126f, 0.7152f, 0.0722f};
    for (const int sampling : {1, 2})
        for (const std::string prefix : {"", "beauty."})
        {
            write(Imf::Header(width, height), coded(colour, rec709, prefix), sampling);
            expectColour(colour, 2e-4f, "");
        }
    Imf::Header wide(width, height);
    addChromaticities(wide, Imf::Chromaticities({0.708f, 0.292f}, {0.170f, 0.797f},
                                                {0.131f, 0.046f}, {0.3127f, 0.3290f}));
    const Rgb same = {0.6f, 0.5f, 0.4f};
    write(wide, coded(same, {0.2627f, 0.6780f, 0.0593f}, ""), 2);
    expectColour({1.6605f * 0.6f - 0.5876f * 0.5f - 0.0728f * 0.4f,
                  -0.1246f * 0.6f + 1.1329f * 0.5f - 0.0083f * 0.4f,
                  -0.0182f * 0.6f - 0.1006f * 0.5f + 1.1187f * 0.4f},
                 4e-4f, "");
}

// Attributes that say something of the light and are not followed. Rec. 709 has the white D65, ACES
// another (TB-2014-004).
TEST_F(ExrEnvironmentTest, AttributesThatAreNotFollowedAreSaid)
{
    const Imath::V2f d65(0.3127f, 0.3290f), aces(0.32168f, 0.33767f);
    Imf::Header header(width, height);
    addWhiteLuminance(header, 100.0f);
    write(header, rgb(1));
    expectColour({1, 2, 3}, 0, "its whiteLuminance is not used: pixels are taken as radiance");
    addAdoptedNeutral(header, aces);
    write(header, rgb(1));
    expectColour({1, 2, 3}, 0,
                 "its whiteLuminance is not used: pixels are taken as radiance; its adoptedNeutral "
                 "is another white than that of its chromaticities; white is not adapted");
    // The white that the values have already is no news.
    Imf::Header neutral(width, height);
    addAdoptedNeutral(neutral, d65);
    write(neutral, rgb(1));
    expectColour({1, 2, 3}, 0, "");
}
