#include "io/EnvironmentFile.h"
#include "io/ExrFile.h"
#include "support/Panoramas.h"
#include "support/TestFolder.h"

#include <gtest/gtest.h>

#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>

using namespace osgTerrainLight;

namespace
{
namespace fs = std::filesystem;
constexpr double pi = 3.14159265358979323846;
using Vector = std::array<double, 3>;

class EnvironmentFileTest : public testing::Test
{
protected:
    std::string in(const std::string& name) const { return (folder / name).string(); }

    /// Reading refuses it: the message begins with the file and holds the parts.
    void expectError(const std::string& name, ErrorCode code,
                     const std::vector<std::string>& parts = {}) const
    {
        constexpr std::size_t mostPixels = 1 << 20;
        const auto read = readEnvironmentFile(in(name), mostPixels);
        ASSERT_FALSE(read.ok()) << name;
        EXPECT_EQ(read.error().code, code) << read.error().message;
        EXPECT_EQ(read.error().message.rfind(in(name), 0), 0u) << read.error().message;
        for (const std::string& part : parts)
            EXPECT_NE(read.error().message.find(part), std::string::npos) << read.error().message;
    }

    const fs::path folder = testFolder();
};

/// Values of a channel by pixel of the data window, row by row from the top.
using Channels = std::map<std::string, std::vector<float>>;

/// Channels as the library has them, in whichever type.
class Planes
{
public:
    Planes(Imf::Header& header, const Channels& channels, Imf::PixelType type)
    {
        const Imath::Box2i window = header.dataWindow();
        const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
        for (const auto& [name, values] : channels)
        {
            header.channels().insert(name, Imf::Channel(type));
            std::vector<std::uint32_t>& plane = _planes[name];
            for (const float value : values)
            {
                plane.push_back(static_cast<std::uint32_t>(type == Imf::UINT ? value : 0.0f));
                if (type == Imf::FLOAT)
                    std::memcpy(&plane.back(), &value, sizeof value);
                if (type == Imf::HALF)
                {
                    const Imath::half narrow(value);
                    std::memcpy(&plane.back(), &narrow, sizeof narrow);
                }
            }
            buffer.insert(name, Imf::Slice::Make(type, plane.data(), window, sizeof(std::uint32_t),
                                                 sizeof(std::uint32_t) * width));
        }
    }
    Imf::FrameBuffer buffer;

private:
    std::map<std::string, std::vector<std::uint32_t>> _planes;
};

void write(const std::string& path, Imf::Header header, const Channels& channels,
           Imf::PixelType type = Imf::FLOAT)
{
    Planes planes(header, channels, type);
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(planes.buffer);
    file.writePixels(header.dataWindow().max.y - header.dataWindow().min.y + 1);
}

Channels constant(int width, int height, const std::vector<std::string>& names, float value)
{
    Channels channels;
    for (const std::string& name : names)
        channels[name].assign(static_cast<std::size_t>(width * height), value);
    return channels;
}

/// Three different ramps.
Channels colours(int width, int height, const std::string& prefix = "")
{
    Channels channels = constant(width, height, {prefix + "R", prefix + "G", prefix + "B"}, 0.0f);
    for (std::size_t i = 0; i < static_cast<std::size_t>(width * height); ++i)
    {
        channels[prefix + "R"][i] = static_cast<float>(i);
        channels[prefix + "G"][i] = static_cast<float>(2 * i + 1);
        channels[prefix + "B"][i] = static_cast<float>(1000 - i);
    }
    return channels;
}

std::string bytesOf(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

EnvironmentPicture pictureOf(const std::string& path)
{
    Result<EnvironmentPicture> read = readEnvironmentFile(path);
    EXPECT_TRUE(read.ok()) << read.error().message;
    return read.ok() ? std::move(*read) : EnvironmentPicture();
}

const Rgb& at(const EnvironmentPicture& picture, int column, int row)
{
    return picture.radiance[static_cast<std::size_t>(row * picture.columns + column)];
}

/// Where a pixel of a file ends up: docs/CONVENTIONS.md, width divisible by four.
const Rgb& ofPixel(const EnvironmentPicture& picture, int x, int y)
{
    const int column = (picture.columns * 7 / 4 - 1 - x) % picture.columns;
    return at(picture, column, picture.rows - 1 - y);
}

Vector directionOf(const EnvironmentPicture& picture, int column, int row)
{
    const double elevation = pi * (row + 0.5) / picture.rows - 0.5 * pi;
    const double azimuth = 2.0 * pi * (column + 0.5) / picture.columns;
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
}

double solidAngle(const EnvironmentPicture& picture, int row)
{
    return 2.0 * pi / picture.columns *
           (std::cos(pi * row / picture.rows) - std::cos(pi * (row + 1) / picture.rows));
}

/// Vector sum of a channel's flux; flux alone where it is taken by length.
Vector fluxVector(const EnvironmentPicture& picture, std::size_t channel, double& flux)
{
    Vector sum = {};
    flux = 0.0;
    for (int row = 0; row < picture.rows; ++row)
        for (int column = 0; column < picture.columns; ++column)
        {
            const double weight =
                solidAngle(picture, row) * static_cast<double>(at(picture, column, row)[channel]);
            flux += weight;
            for (std::size_t k = 0; k < 3; ++k)
                sum[k] += weight * directionOf(picture, column, row)[k];
        }
    return sum;
}

/// Irradiance of a surface, of all directions: 4 x 4 points of each texel.
double irradiance(const EnvironmentPicture& picture, const Vector& normal)
{
    double sum = 0.0;
    for (int row = 0; row < picture.rows; ++row)
        for (int column = 0; column < picture.columns; ++column)
            for (int i = 0; i < 16; ++i)
            {
                const double up = pi * (row + (i / 4 + 0.5) / 4.0) / picture.rows - 0.5 * pi;
                const double azimuth = 2.0 * pi * (column + (i % 4 + 0.5) / 4.0) / picture.columns;
                const double cosine = normal[0] * std::cos(up) * std::cos(azimuth) +
                                      normal[1] * std::cos(up) * std::sin(azimuth) +
                                      normal[2] * std::sin(up);
                sum += std::max(cosine, 0.0) * std::cos(up) *
                       static_cast<double>(at(picture, column, row)[1]);
            }
    return sum * 2.0 * pi * pi / (16.0 * picture.columns * picture.rows);
}

double angle(const Vector& a, const Vector& b)
{
    const Vector c = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                      a[0] * b[1] - a[1] * b[0]};
    return std::atan2(std::sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]),
                      a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

/// Of OpenEXR's y-up frame, whose +z is north.
Vector zUp(const Imath::V3f& d)
{
    return {-static_cast<double>(d.x), static_cast<double>(d.z), static_cast<double>(d.y)};
}

Imf::Header marked(int width, int height, Imf::Envmap kind)
{
    Imf::Header header(width, height);
    addEnvmap(header, kind);
    return header;
}

/// Mean over 8 x 8 points of each pixel of a face, by solid angle: what a camera there would see.
float overCubePixel(const std::function<double(const Vector&)>& radiance, Imf::CubeMapFace face,
                    int side, float across, float along)
{
    const Imath::Box2i whole({0, 0}, {1, 11}); // pixels of a face from edge to edge
    double sum = 0.0, weights = 0.0;
    for (int i = 0; i < 64; ++i)
    {
        const Imath::V3f d = Imf::CubeMap::direction(
            face, whole,
            {(across + (static_cast<float>(i % 8) + 0.5f) / 8.0f) / static_cast<float>(side),
             (along + (static_cast<float>(i / 8) + 0.5f) / 8.0f) / static_cast<float>(side)});
        const double weight = std::pow(static_cast<double>(d.length()), -3.0);
        Vector unit = zUp(d);
        for (double& component : unit)
            component /= static_cast<double>(d.length());
        sum += weight * radiance(unit);
        weights += weight;
    }
    return static_cast<float>(sum / weights);
}
} // namespace

// Expected: OpenEXR's own function. It puts the first and last pixels' centres on the edges, where
// we have the pixels' edges, half a pixel apart at most. Four directions by hand.
TEST_F(EnvironmentFileTest, OnePixelSunOfLatitudeLongitude)
{
    constexpr int width = 64;
    constexpr int height = 32;
    const Imath::Box2i window({0, 0}, {width - 1, height - 1});
    for (const auto& [x, y] : {std::pair{0, 0},
                               {63, 31},
                               {32, 15},
                               {31, 16},
                               {48, 16},
                               {16, 3},
                               {5, 20},
                               {63, 12},
                               {0, 16},
                               {40, 31}})
    {
        Channels channels = constant(width, height, {"R", "G", "B"}, 0.0f);
        for (auto& [name, values] : channels)
            values[static_cast<std::size_t>(y * width + x)] = 1.0f;
        write(in("a.exr"), marked(width, height, Imf::ENVMAP_LATLONG), channels);
        double flux = 0.0;
        const Vector found = fluxVector(pictureOf(in("a.exr")), 1, flux);
        const Vector expected = zUp(Imf::LatLongMap::direction(
            window, Imath::V2f(static_cast<float>(x), static_cast<float>(y))));
        EXPECT_LT(angle(found, expected), pi / height) << x << ' ' << y;
        const double middle = 2.0 * pi * (0.75 - (x + 0.5) / width);
        const double up = 0.5 * pi - pi * (y + 0.5) / height;
        EXPECT_LT(angle(found, {std::cos(up) * std::cos(middle), std::cos(up) * std::sin(middle),
                                std::sin(up)}),
                  1e-6)
            << x << ' ' << y;
    }
    const auto towards = [&](int x, int y)
    {
        Channels channels = constant(width, height, {"Y"}, 0.0f);
        channels["Y"][static_cast<std::size_t>(y * width + x)] = 1.0f;
        write(in("b.exr"), Imf::Header(width, height), channels);
        double flux = 0.0;
        return fluxVector(pictureOf(in("b.exr")), 0, flux);
    };
    constexpr double texel = pi / height;
    EXPECT_LT(angle(towards(32, 16), {0, 1, 0}), texel) << "middle: north";
    EXPECT_LT(angle(towards(48, 16), {1, 0, 0}), texel) << "right of it: east";
    EXPECT_LT(angle(towards(16, 16), {-1, 0, 0}), texel) << "left of it: west";
    EXPECT_LT(angle(towards(0, 16), {0, -1, 0}), texel) << "edges: south";
    EXPECT_LT(angle(towards(20, 0), {0, 0, 1}), texel) << "top: zenith";
}

// The same of each face's middle, edges and corners; and what the pixel sends is not lost: its
// solid angle in closed form, Σ ± atan(uv / √(1 + u² + v²)).
TEST_F(EnvironmentFileTest, OnePixelSunOfACube)
{
    constexpr int side = 24;
    const Imath::Box2i window({0, 0}, {side - 1, 6 * side - 1});
    double worstPlace = 0.0, worstFlux = 0.0;
    for (int f = 0; f < 6; ++f)
        for (const auto& [across, along] : {std::pair{0, 0},
                                            {side - 1, 0},
                                            {0, side - 1},
                                            {side - 1, side - 1},
                                            {side / 2, 5},
                                            {side / 2, side / 2},
                                            {3, 17},
                                            {0, 9},
                                            {side / 2 - 1, side / 2}})
        {
            const auto face = static_cast<Imf::CubeMapFace>(f);
            const Imath::V2f place(static_cast<float>(across), static_cast<float>(along));
            const Imath::V2f pixel = Imf::CubeMap::pixelPosition(face, window, place);
            Channels channels = constant(side, 6 * side, {"R", "G", "B"}, 0.0f);
            for (auto& [name, values] : channels)
                values[static_cast<std::size_t>(pixel.y) * side +
                       static_cast<std::size_t>(pixel.x)] = 100.0f;
            write(in("a.exr"), marked(side, 6 * side, Imf::ENVMAP_CUBE), channels);
            double flux = 0.0;
            const Vector found = fluxVector(pictureOf(in("a.exr")), 0, flux);
            const double away = angle(found, zUp(Imf::CubeMap::direction(face, window, place)));
            const auto corner = [&](int i, int j)
            {
                const double u = 2.0 * i / side - 1.0;
                const double v = 2.0 * j / side - 1.0;
                return std::atan2(u * v, std::sqrt(1.0 + u * u + v * v));
            };
            const double expected =
                100.0 * (corner(across + 1, along + 1) - corner(across, along + 1) -
                         corner(across + 1, along) + corner(across, along));
            worstPlace = std::max(worstPlace, away);
            worstFlux = std::max(worstFlux, std::abs(flux / expected - 1.0));
        }
    std::cout << "worst: " << worstPlace * side / (0.5 * pi) << " pixels, flux " << worstFlux
              << '\n';
    EXPECT_LT(worstPlace, 0.5 * pi / side);
    EXPECT_LT(worstFlux, 1e-3); // chords for parallels, measured 7e-4
}

// π L on level ground, and the very value everywhere.
TEST_F(EnvironmentFileTest, Constant)
{
    write(in("flat.exr"), marked(128, 64, Imf::ENVMAP_LATLONG),
          constant(128, 64, {"R", "G", "B"}, 2.5f));
    for (const int side : {1, 3, 32})
        write(in("cube" + std::to_string(side) + ".exr"), marked(side, 6 * side, Imf::ENVMAP_CUBE),
              constant(side, 6 * side, {"R", "G", "B"}, 2.5f));
    for (const auto& entry : fs::directory_iterator(folder))
    {
        const EnvironmentPicture picture = pictureOf(entry.path().string());
        for (const Rgb& texel : picture.radiance)
            ASSERT_EQ(texel, (Rgb{2.5f, 2.5f, 2.5f}));
        EXPECT_NEAR(irradiance(picture, {0, 0, 1}), pi * 2.5, 1e-3 * pi * 2.5) << entry.path();
    }
}

// One environment in both shapes: a sky with a sun of 0.7°, brighter by 10,000.
TEST_F(EnvironmentFileTest, CubeAndLatitudeLongitudeAgree)
{
    const Vector sun = {0.36, 0.48, 0.8};
    const auto radiance = [&](const Vector& d)
    {
        return angle(d, sun) < 0.7 * pi / 180.0
                   ? 1e4
                   : 1.5 + d[0] + 0.3 * std::sin(7.0 * d[1]) + 0.2 * d[2];
    };
    constexpr int side = 64;
    const Imath::Box2i window({0, 0}, {side - 1, 6 * side - 1});
    Channels cube = constant(side, 6 * side, {"Y"}, 0.0f);
    for (int f = 0; f < 6; ++f)
        for (int i = 0; i < side * side; ++i)
        {
            const auto face = static_cast<Imf::CubeMapFace>(f);
            const Imath::V2f place(static_cast<float>(i % side), static_cast<float>(i / side));
            const Imath::V2f pixel = Imf::CubeMap::pixelPosition(face, window, place);
            cube["Y"]
                [static_cast<std::size_t>(pixel.y) * side + static_cast<std::size_t>(pixel.x)] =
                    overCubePixel(radiance, face, side, place.x, place.y);
        }
    write(in("cube.exr"), marked(side, 6 * side, Imf::ENVMAP_CUBE), cube);
    EnvironmentPicture flat;
    flat.columns = 512;
    flat.rows = 256;
    for (int row = 0; row < flat.rows; ++row)
        for (int column = 0; column < flat.columns; ++column)
        {
            double sum = 0.0, weights = 0.0;
            for (int i = 0; i < 64; ++i)
            {
                const double up = pi * (row + (i / 8 + 0.5) / 8.0) / flat.rows - 0.5 * pi;
                const double azimuth = 2.0 * pi * (column + (i % 8 + 0.5) / 8.0) / flat.columns;
                weights += std::cos(up);
                sum += std::cos(up) * radiance({std::cos(up) * std::cos(azimuth),
                                                std::cos(up) * std::sin(azimuth), std::sin(up)});
            }
            const float mean = static_cast<float>(sum / weights);
            flat.radiance.push_back({mean, mean, mean});
        }
    // Through a file of its own, so that both take the way in: undo of ofPixel().
    Channels rows = constant(flat.columns, flat.rows, {"Y"}, 0.0f);
    for (int y = 0; y < flat.rows; ++y)
        for (int x = 0; x < flat.columns; ++x)
            rows["Y"][static_cast<std::size_t>(y * flat.columns + x)] = ofPixel(flat, x, y)[0];
    write(in("flat.exr"), Imf::Header(flat.columns, flat.rows), rows);

    const EnvironmentPicture a = pictureOf(in("cube.exr"));
    const EnvironmentPicture b = pictureOf(in("flat.exr"));
    double worst = 0.0;
    for (const Vector& normal : {Vector{0, 0, 1},
                                 {0.6, 0, 0.8},
                                 {-0.6, 0, 0.8},
                                 {0, 0.8, 0.6},
                                 {0, -0.8, 0.6},
                                 {1, 0, 0},
                                 {0, 0, -1},
                                 {-0.48, -0.36, 0.8}})
    {
        const double first = irradiance(a, normal), second = irradiance(b, normal);
        worst = std::max(worst, std::abs(first / second - 1.0));
    }
    std::cout << "worst difference " << worst << '\n';
    EXPECT_LT(worst, 0.005);
}

TEST_F(EnvironmentFileTest, EveryLayoutOfChannels)
{
    constexpr int width = 16;
    constexpr int height = 8;
    const Imf::Header header(width, height);
    const Channels plain = colours(width, height);
    const auto expectPlain =
        [&](const std::string& name, float tolerance, const std::string& taken = "")
    {
        const EnvironmentPicture picture = pictureOf(in(name));
        ASSERT_EQ(picture.columns, width) << name;
        ASSERT_EQ(picture.rows, height) << name;
        EXPECT_EQ(picture.warning, taken.empty() ? "" : in(name) + ": " + taken);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
            {
                const std::size_t i = static_cast<std::size_t>(y * width + x);
                const Rgb expected = {plain.at("R")[i], plain.at("G")[i], plain.at("B")[i]};
                for (std::size_t c = 0; c < 3; ++c)
                    ASSERT_NEAR(ofPixel(picture, x, y)[c], expected[c], tolerance * expected[c])
                        << name << ' ' << x << ' ' << y;
            }
    };
    write(in("float.exr"), header, plain);
    write(in("half.exr"), header, plain, Imf::HALF);
    write(in("uint.exr"), header, plain, Imf::UINT);
    Channels more = plain;
    more["A"].assign(width * height, 0.5f);
    more["depth.Z"].assign(width * height, 7.0f);
    more["diffuse.R"] = more["diffuse.G"] = more["diffuse.B"] = more["A"];
    write(in("rgba.exr"), header, more);
    Channels layered = colours(width, height, "beauty.main.");
    layered["A"] = layered["depth.Y.Z"] = more["A"];
    layered["other.R"] = layered["other.G"] = layered["other.B"] = more["A"];
    write(in("layer.exr"), header, layered);
    {
        Imf::Header tiled = header;
        tiled.setTileDescription(Imf::TileDescription(5, 3, Imf::ONE_LEVEL));
        Planes planes(tiled, plain, Imf::FLOAT);
        Imf::TiledOutputFile file(in("tiled.exr").c_str(), tiled);
        file.setFrameBuffer(planes.buffer);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    }
    {
        std::vector<Imf::Header> headers(3, header);
        std::vector<Channels> parts = {constant(width, height, {"Z"}, 1.0f), plain,
                                       constant(width, height, {"R", "G", "B"}, 9.0f)};
        std::vector<Planes> planes;
        for (std::size_t i = 0; i < 3; ++i)
        {
            headers[i].setName("part" + std::to_string(i));
            headers[i].setType(Imf::SCANLINEIMAGE);
            planes.emplace_back(headers[i], parts[i], Imf::FLOAT);
        }
        Imf::MultiPartOutputFile file(in("parts.exr").c_str(), headers.data(), 3);
        for (int i = 0; i < 3; ++i)
        {
            Imf::OutputPart part(file, i);
            part.setFrameBuffer(planes[static_cast<std::size_t>(i)].buffer);
            part.writePixels(height);
        }
    }
    for (const char* name : {"float.exr", "uint.exr", "tiled.exr"})
        expectPlain(name, 0.0f);
    expectPlain("rgba.exr", 0.0f,
                "the layer without a name is taken as light, not the layer \"diffuse\"");
    expectPlain("layer.exr", 0.0f,
                "the layer \"beauty.main\" is taken as light, not the layer \"other\"");
    expectPlain("parts.exr", 0.0f, "part \"part1\" is taken as light, not part \"part2\"");
    Channels blender = colours(width, height, "View Layer.Combined.");
    for (const char* name : {"View Layer.AO.R", "View Layer.AO.G", "View Layer.AO.B"})
        blender[name] = more["A"];
    write(in("blender.exr"), header, blender);
    expectPlain(
        "blender.exr", 0.0f,
        "the layer \"View Layer.Combined\" is taken as light, not the layer \"View Layer.AO\"");
    expectPlain("half.exr", 1.0f / 2048.0f);

    write(in("grey.exr"), header, {{"Y", plain.at("G")}});
    EXPECT_EQ(ofPixel(pictureOf(in("grey.exr")), 3, 2), (Rgb{71.0f, 71.0f, 71.0f}));
}

// Written by OpenEXR with chroma for every second pixel and line. A picture that is smooth over
// these loses what rounding to 10 bits (luminance) and to 8 bits (chroma) takes.
TEST_F(EnvironmentFileTest, LuminanceAndChroma)
{
    constexpr int width = 64;
    constexpr int height = 32;
    std::vector<Imf::Rgba> pixels(width * height);
    const auto expected = [](int x, int y)
    {
        const float turn = 2.0f * static_cast<float>(pi) * static_cast<float>(x) / width;
        return Rgb{2.0f + std::cos(turn), 2.0f + 0.03f * static_cast<float>(y),
                   1.5f + 0.5f * std::sin(turn)};
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
        {
            const Rgb c = expected(x, y);
            pixels[static_cast<std::size_t>(y * width + x)] = Imf::Rgba(c[0], c[1], c[2]);
        }
    {
        Imf::RgbaOutputFile file(in("a.exr").c_str(), Imf::Header(width, height), Imf::WRITE_YC);
        file.setYCRounding(10, 8);
        file.setFrameBuffer(pixels.data(), 1, width);
        file.writePixels(height);
    }
    const EnvironmentPicture picture = pictureOf(in("a.exr"));
    double worst = 0.0;
    for (int y = 2; y < height - 2; ++y) // the filter that thins chroma out meets the edges
        for (int x = 2; x < width - 2; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                worst = std::max(worst, std::abs(static_cast<double>(
                                            ofPixel(picture, x, y)[c] / expected(x, y)[c] - 1.0f)));
    std::cout << "worst error " << worst << '\n';
    EXPECT_LT(worst, 0.01);
}

// The display window counts.
TEST_F(EnvironmentFileTest, DataWindowOtherThanDisplayWindow)
{
    const Imath::Box2i display({10, -5}, {10 + 15, -5 + 7});
    const Imath::Box2i smaller({12, -4}, {12 + 3, -4 + 1});
    const Imath::Box2i larger({8, -9}, {8 + 19, -9 + 15});
    for (const Imath::Box2i& data : {smaller, larger, display})
    {
        const int width = data.max.x - data.min.x + 1;
        const int height = data.max.y - data.min.y + 1;
        Channels channels = constant(width, height, {"R", "G", "B"}, 0.0f);
        for (int y = data.min.y; y <= data.max.y; ++y)
            for (int x = data.min.x; x <= data.max.x; ++x)
                channels["G"][static_cast<std::size_t>((y - data.min.y) * width + x - data.min.x)] =
                    static_cast<float>(100 * x + y + 1000);
        write(in("a.exr"), Imf::Header(display, data), channels);
        const EnvironmentPicture picture = pictureOf(in("a.exr"));
        ASSERT_EQ(picture.columns, 16);
        ASSERT_EQ(picture.rows, 8);
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 16; ++x)
                ASSERT_EQ(ofPixel(picture, x, y)[1],
                          data.intersects(Imath::V2i(x + 10, y - 5))
                              ? static_cast<float>(100 * (x + 10) + y - 5 + 1000)
                              : 0.0f);
    }
}

// Recommendation ITU-R BT.2087 has the matrix from the primaries of BT.2020 to those of BT.709.
TEST_F(EnvironmentFileTest, ChromaticitiesAreConverted)
{
    Imf::Header header(4, 2);
    addChromaticities(header, Imf::Chromaticities({0.708f, 0.292f}, {0.170f, 0.797f},
                                                  {0.131f, 0.046f}, {0.3127f, 0.3290f}));
    Channels channels = constant(4, 2, {"R", "G", "B"}, 0.0f);
    channels["R"].assign(8, 0.6f);
    channels["G"].assign(8, 0.5f);
    channels["B"].assign(8, 0.4f);
    write(in("a.exr"), header, channels);
    const Rgb found = at(pictureOf(in("a.exr")), 0, 0);
    EXPECT_NEAR(found[0], 1.6605f * 0.6f - 0.5876f * 0.5f - 0.0728f * 0.4f, 2e-4f);
    EXPECT_NEAR(found[1], -0.1246f * 0.6f + 1.1329f * 0.5f - 0.0083f * 0.4f, 2e-4f);
    EXPECT_NEAR(found[2], -0.0182f * 0.6f - 0.1006f * 0.5f + 1.1187f * 0.4f, 2e-4f);

    Imf::Header bad(4, 2);
    addChromaticities(bad, Imf::Chromaticities({0.3f, 0.3f}, {0.3f, 0.3f}, {0.3f, 0.3f}));
    write(in("bad.exr"), bad, channels);
    const auto read = readEnvironmentFile(in("bad.exr"));
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().message.find("chromaticities"), std::string::npos);
}

TEST_F(EnvironmentFileTest, ValuesThatAreNoLight)
{
    Channels channels = constant(4, 2, {"R", "G", "B"}, 1.0f);
    channels["R"][0] = std::numeric_limits<float>::quiet_NaN();
    channels["G"][0] = std::numeric_limits<float>::infinity();
    channels["B"][0] = -std::numeric_limits<float>::infinity();
    channels["R"][1] = -3.0f;
    channels["G"][1] = 3e38f;
    write(in("a.exr"), Imf::Header(4, 2), channels);
    const EnvironmentPicture picture = pictureOf(in("a.exr"));
    EXPECT_EQ(ofPixel(picture, 0, 0), (Rgb{0.0f, 65504.0f, 0.0f}));
    EXPECT_EQ(ofPixel(picture, 1, 0), (Rgb{0.0f, 65504.0f, 1.0f}));
    EXPECT_EQ(picture.warning, in("a.exr") + ": 1 values are no number and taken as 0, 3 are "
                                             "infinite and taken as 65504 (or 0 where negative)");
    channels["R"][0] = channels["G"][0] = channels["B"][0] = channels["G"][1] = 1.0f;
    write(in("b.exr"), Imf::Header(4, 2), channels);
    EXPECT_EQ(pictureOf(in("b.exr")).warning, "") << "negative values alone pass in silence";
}

TEST_F(EnvironmentFileTest, BrokenFilesAreErrors)
{
    expectError("none.exr", ErrorCode::NotFound, {"no such file"});
    fs::create_directory(in("folder.exr"));
    expectError("folder.exr", ErrorCode::Invalid, {"folder"});
    std::ofstream(in("empty.exr"));
    expectError("empty.exr", ErrorCode::Invalid, {"OpenEXR"});

    write(in("whole.exr"), Imf::Header(64, 32), colours(64, 32));
    const std::string whole = bytesOf(in("whole.exr"));
    for (std::size_t length = 1; length < whole.size(); length += 97)
    {
        std::ofstream(in("cut.exr"), std::ios::binary) << whole.substr(0, length);
        expectError("cut.exr", ErrorCode::Invalid);
    }
}

// Data and display window alike, since either is believed.
TEST_F(EnvironmentFileTest, WindowsOfOtherSizesThanThePixels)
{
    write(in("whole.exr"), Imf::Header(64, 32), colours(64, 32));
    const std::string whole = bytesOf(in("whole.exr"));
    const auto resized = [&](const std::string& name, const char* which, std::array<int, 4> corners)
    {
        std::string bytes = whole;
        for (const char* attribute : {"dataWindow", "displayWindow"})
        {
            if (std::string(which) != "both" && std::string(which) != attribute)
                continue;
            const std::string start = attribute + std::string("\0box2i\0\x10\0\0\0", 11);
            const std::size_t place = bytes.find(start);
            ASSERT_NE(place, std::string::npos);
            std::memcpy(&bytes[place + start.size()], corners.data(), sizeof corners);
        }
        std::ofstream(in(name), std::ios::binary) << bytes;
    };
    resized("zero.exr", "both", {0, 0, -1, -1});
    expectError("zero.exr", ErrorCode::Invalid);
    resized("zero_data.exr", "dataWindow", {5, 5, 4, 4});
    expectError("zero_data.exr", ErrorCode::Invalid);
    for (const char* which : {"both", "dataWindow", "displayWindow"})
        for (const std::array<int, 4>& corners :
             {std::array{0, 0, 199999, 99999},
              {0, 0, 1 << 29, 1 << 28},
              {std::numeric_limits<int>::min(), std::numeric_limits<int>::min(),
               std::numeric_limits<int>::max(), std::numeric_limits<int>::max()}})
        {
            resized("huge.exr", which, corners);
            expectError("huge.exr", ErrorCode::Invalid);
        }
    resized("limit.exr", "both", {0, 0, 2047, 1023});
    expectError("limit.exr", ErrorCode::Invalid, {"2048 x 1024", "1048576"});
}

// Two gigabytes in a file of a few bytes.
TEST_F(EnvironmentFileTest, AttributesThatClaimMoreThanTheFile)
{
    write(in("whole.exr"), Imf::Header(64, 32), colours(64, 32));
    const std::string whole = bytesOf(in("whole.exr"));
    for (const std::string& attribute :
         {std::string("compression\0compression", 23), std::string("channels\0chlist", 15)})
    {
        std::string bytes = whole;
        const std::size_t place = bytes.find(attribute);
        ASSERT_NE(place, std::string::npos);
        bytes.replace(place + attribute.size() + 1, 4, "\xff\xff\xff\x7f");
        std::ofstream(in("claim.exr"), std::ios::binary) << bytes;
        expectError("claim.exr", ErrorCode::Invalid, {"claims 2147483647 bytes"});
        EXPECT_EQ(readExr(in("claim.exr")).error().code, ErrorCode::Invalid);
    }
}

TEST_F(EnvironmentFileTest, ShapesAndChannelsThatAreNoPanorama)
{
    Channels none = constant(64, 32, {"R", "G", "Z"}, 1.0f);
    write(in("missing.exr"), Imf::Header(64, 32), none);
    expectError("missing.exr", ErrorCode::NotSupported, {"G, R, Z", "R, G and B, or Y"});
    write(in("square.exr"), Imf::Header(64, 64), colours(64, 64));
    expectError("square.exr", ErrorCode::Invalid, {"64 x 64", "2 : 1", "1 : 6"});
    write(in("lying.exr"), Imf::Header(48, 8), colours(48, 8));
    expectError("lying.exr", ErrorCode::Invalid, {"48 x 8", "2 : 1"});
    write(in("cube.exr"), marked(64, 32, Imf::ENVMAP_CUBE), colours(64, 32));
    expectError("cube.exr", ErrorCode::Invalid, {"marked as a cube", "1 : 6"});
    // What needs no mark, and what a mark allows.
    write(in("strip.exr"), Imf::Header(4, 24), colours(4, 24));
    EXPECT_EQ(pictureOf(in("strip.exr")).rows, 32);
    write(in("odd.exr"), marked(20, 7, Imf::ENVMAP_LATLONG), colours(20, 7));
    EXPECT_EQ(pictureOf(in("odd.exr")).rows, 7);
}

// Attribute pixelAspectRatio: width of a pixel by its height, so 16 x 16 pixels of 2 are twice as
// wide as high. A mark says what the picture is, whatever its shape.
TEST_F(EnvironmentFileTest, ShapeCountsThePixelsAspect)
{
    const auto sized = [&](int width, int height, float aspect)
    {
        Imf::Header header(width, height, aspect);
        write(in("a.exr"), header, colours(width, height));
        return readEnvironmentFile(in("a.exr"));
    };
    const Result<EnvironmentPicture> wide = sized(16, 16, 2.0f);
    ASSERT_TRUE(wide) << wide.error().message;
    EXPECT_EQ(wide->columns, 16);
    EXPECT_EQ(wide->rows, 16);
    EXPECT_EQ(wide->warning, "");
    EXPECT_TRUE(sized(32, 8, 0.5f));
    EXPECT_TRUE(sized(16, 8, 1.0f));
    EXPECT_FALSE(sized(4, 24, 2.0f));
    EXPECT_FALSE(sized(32, 16, 2.0f));
    expectError("a.exr", ErrorCode::Invalid,
                {"32 x 16", "2.000000 times as wide as high (pixelAspectRatio)", "2 : 1"});
    Imf::Header header(32, 16, 2.0f);
    addEnvmap(header, Imf::ENVMAP_LATLONG);
    write(in("a.exr"), header, colours(32, 16));
    EXPECT_EQ(pictureOf(in("a.exr")).columns, 32);
}

// Expected: what would be black all over is no sky.
TEST_F(EnvironmentFileTest, PixelsOutsideTheDisplayWindowAloneAreAnError)
{
    const Imath::Box2i display({0, 0}, {15, 7});
    for (const Imath::V2i& corner : {Imath::V2i(16, 0), Imath::V2i(0, 8), Imath::V2i(-4, -4)})
    {
        const Imath::Box2i data(corner, corner + Imath::V2i(3, 3));
        write(in("a.exr"), Imf::Header(display, data), colours(4, 4));
        expectError("a.exr", ErrorCode::Invalid, {"no pixels within its display window"});
    }
    write(in("a.exr"), Imf::Header(display, Imath::Box2i({15, 7}, {18, 10})), colours(4, 4));
    EXPECT_EQ(pictureOf(in("a.exr")).columns, 16);
}

TEST_F(EnvironmentFileTest, DeepPixelsAreRefused)
{
    {
        Imf::Header header(64, 32);
        header.setType(Imf::DEEPSCANLINE);
        header.compression() = Imf::ZIPS_COMPRESSION;
        for (const char* name : {"R", "G", "B"})
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        std::vector<unsigned> counts(64 * 32, 1);
        std::vector<float> values(64 * 32, 1.0f);
        std::vector<float*> pointers;
        for (float& value : values)
            pointers.push_back(&value);
        Imf::DeepFrameBuffer buffer;
        buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()),
                                                 sizeof(unsigned), sizeof(unsigned) * 64));
        for (const char* name : {"R", "G", "B"})
            buffer.insert(name, Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(pointers.data()),
                                               sizeof(float*), sizeof(float*) * 64, sizeof(float)));
        Imf::DeepScanLineOutputFile file(in("deep.exr").c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(32);
    }
    expectError("deep.exr", ErrorCode::NotSupported, {"R (deep)", "not deep"});
    EXPECT_EQ(readExr(in("deep.exr")).error().code, ErrorCode::NotSupported);
}

// Every byte of the header turned over: an error or a picture, never an exception or a crash.
TEST_F(EnvironmentFileTest, DamagedHeadersDoNotThrow)
{
    write(in("a.exr"), marked(4, 24, Imf::ENVMAP_CUBE), colours(4, 24));
    const std::string bytes = bytesOf(in("a.exr"));
    for (std::size_t i = 0; i < std::min<std::size_t>(bytes.size(), 500); ++i)
    {
        std::string damaged = bytes;
        damaged[i] = static_cast<char>(~damaged[i]);
        std::ofstream(in("b.exr"), std::ios::binary) << damaged;
        readEnvironmentFile(in("b.exr"), 1 << 16);
    }
}

// Real panoramas: what is found in them, printed. Sunrise and city have a sun in the picture, in
// the south by the photographer's heading; courtyard is in the shade.
TEST(EnvironmentFile, RealPanoramas)
{
    OTL_SKIP_WITHOUT_PANORAMAS();
    for (const char* name :
         {"city", "courtyard", "forest", "interior", "night", "studio", "sunrise", "sunset"})
    {
        EnvironmentPicture picture = pictureOf(panorama(name));
        std::string problem;
        double before = 0.0, after = 0.0;
        for (int row = 0; row < picture.rows; ++row)
            for (int column = 0; column < picture.columns; ++column)
                before +=
                    solidAngle(picture, row) * static_cast<double>(at(picture, column, row)[1]);
        const auto made =
            createEnvironment(picture.columns, picture.rows, picture.radiance, problem);
        ASSERT_NE(made, nullptr) << problem;
        EnvironmentPicture left = picture;
        left.radiance = made->radiance;
        for (int row = 0; row < left.rows; ++row)
            for (int column = 0; column < left.columns; ++column)
                after += solidAngle(left, row) * static_cast<double>(at(left, column, row)[1]);
        const double radius = made->sunAngularRadius * pi / 180.0;
        const double sun = made->hasSun ? static_cast<double>(made->sunIrradiance[1]) * 2.0 /
                                              (1.0 + std::cos(radius))
                                        : 0.0;
        EXPECT_NEAR(after + sun, before, 1e-4 * before) << name;
        std::cout << name << ": ";
        if (made->hasSun)
            std::cout << "sun at " << made->sunAzimuth << " degrees, elevation "
                      << made->sunElevation << ", radius " << made->sunAngularRadius
                      << ", irradiance " << made->sunIrradiance[0] << ' ' << made->sunIrradiance[1]
                      << ' ' << made->sunIrradiance[2] << ", " << 100.0 * sun / before
                      << " % of the flux\n";
        else
            std::cout << "no sun\n";
    }
}
