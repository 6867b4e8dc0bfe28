// Damaged OpenEXR files through the readers and on to an environment: whatever comes in, what comes
// out is an error that names the file, or light. Plain mutation of files of every layout, no
// guidance by coverage, so that any compiler will do; meant for the build with sanitizers.
// Usage: environment_fuzz [--seed N] [--runs N | --seconds N] [--keep FOLDER]
// The file at hand is FOLDER/input.exr, so it is there after a crash.
#include "io/EnvironmentFile.h"
#include "io/ExrFile.h"

#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
namespace fs = std::filesystem;
using Random = std::mt19937_64;

/// Small, so that headers are a good part of a file, and light from a mutant is light again.
constexpr std::size_t maxPixels = 1 << 16;

std::string bytesOf(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Files of each layout and compression.
std::vector<std::string> seeds(const std::string& path)
{
    std::vector<std::string> found;
    const auto write = [&](Imf::Header header, const std::vector<std::string>& names, int tile)
    {
        const Imath::Box2i window = header.dataWindow();
        const int width = window.max.x - window.min.x + 1;
        const int height = window.max.y - window.min.y + 1;
        std::vector<float> values(static_cast<std::size_t>(width * height));
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = i % 37 == 5 ? 9000.0f : static_cast<float>(i % 11);
        Imf::FrameBuffer buffer;
        for (const std::string& name : names)
        {
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
            buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, values.data(), window));
        }
        if (tile > 0)
        {
            header.setTileDescription(
                Imf::TileDescription(static_cast<unsigned>(tile), static_cast<unsigned>(tile)));
            Imf::TiledOutputFile file(path.c_str(), header);
            file.setFrameBuffer(buffer);
            file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
        }
        else
        {
            Imf::OutputFile file(path.c_str(), header);
            file.setFrameBuffer(buffer);
            file.writePixels(height);
        }
        found.push_back(bytesOf(path));
    };
    for (const Imf::Compression compression :
         {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION,
          Imf::PXR24_COMPRESSION, Imf::B44A_COMPRESSION, Imf::DWAA_COMPRESSION})
    {
        Imf::Header header(16, 8);
        header.compression() = compression;
        write(header, {"R", "G", "B"}, 0);
    }
    Imf::Header cube(3, 18);
    addEnvmap(cube, Imf::ENVMAP_CUBE);
    addChromaticities(cube, Imf::Chromaticities({0.708f, 0.292f}, {0.17f, 0.797f}, {0.131f, 0.046f},
                                                {0.3127f, 0.329f}));
    write(cube, {"layer.R", "layer.G", "layer.B", "Z"}, 0);
    write(Imf::Header(16, 8), {"Y", "A"}, 5);
    write(Imf::Header(Imath::Box2i({4, 4}, {19, 11}), Imath::Box2i({2, 6}, {30, 20})),
          {"R", "G", "B", "A"}, 0);
    {
        std::vector<Imf::Rgba> pixels(32 * 16, Imf::Rgba(3.0f, 2.0f, 1.0f));
        Imf::RgbaOutputFile file(path.c_str(), Imf::Header(32, 16), Imf::WRITE_YC);
        file.setFrameBuffer(pixels.data(), 1, 32);
        file.writePixels(16);
    }
    found.push_back(bytesOf(path));
    return found;
}

/// One to eight changes: of bits and bytes, of 32-bit integers, of blocks, of the length.
std::string mutated(std::string bytes, const std::string& other, Random& random)
{
    const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
    constexpr std::uint32_t odd[] = {0u,          1u,          2u,      0xffffffffu,
                                     0x7fffffffu, 0x80000000u, 0xffffu, 0x7fc00000u,
                                     0x7f800000u, 16u,         100000u};
    for (std::size_t change = 1 + below(8); change > 0; --change)
    {
        // Half of them in the header.
        const std::size_t reach =
            random() % 2 ? std::min<std::size_t>(bytes.size(), 400) : bytes.size();
        const std::size_t place = below(reach);
        const std::size_t length = std::min(1 + below(16), bytes.size() - place);
        if (bytes.empty())
            return bytes;
        switch (random() % 8)
        {
        case 0:
            bytes[place] = static_cast<char>(bytes[place] ^ (1 << random() % 8));
            break;
        case 1:
            bytes[place] = static_cast<char>(random());
            break;
        case 2:
        case 3:
            if (place + 4 <= bytes.size())
                std::memcpy(&bytes[place], &odd[below(std::size(odd))], 4);
            break;
        case 4:
            bytes.erase(place, length);
            break;
        case 5:
            bytes.insert(place, bytes.substr(below(bytes.size()), length));
            break;
        case 6:
            if (!other.empty())
                bytes.replace(place, length, other.substr(below(other.size()), length));
            break;
        default:
            if (random() % 4 == 0)
                bytes.resize(place);
        }
    }
    return bytes;
}

void require(bool holds, const char* what)
{
    if (holds)
        return;
    std::cerr << "environment_fuzz: " << what << '\n';
    std::abort();
}

/// Whether there was light.
bool tryFile(const std::string& path)
{
    const Result<ExrImage> image = readExr(path, maxPixels);
    require(image.ok() || image.error().message.rfind(path, 0) == 0, "an error without its file");
    Result<EnvironmentPicture> picture = readEnvironmentFile(path, maxPixels);
    if (!picture)
    {
        require(picture.error().message.rfind(path, 0) == 0, "an error without its file");
        return false;
    }
    std::string problem;
    const auto made =
        createEnvironment(picture->columns, picture->rows, std::move(picture->radiance), problem);
    require(made != nullptr, problem.c_str());
    for (const Rgb& texel : made->radiance)
        for (const float value : texel)
            require(value >= 0.0f && value <= 1e30f, "radiance out of its range");
    for (const Rgb& coefficient : made->harmonics)
        for (const float value : coefficient)
            require(std::isfinite(value), "a coefficient is not finite");
    if (made->hasSun)
    {
        require(made->sunElevation >= 0.0 && made->sunElevation <= 90.0 &&
                    made->sunAzimuth >= 0.0 && made->sunAzimuth <= 360.0 &&
                    made->sunAngularRadius >= 0.01 && made->sunAngularRadius <= 10.0,
                "a sun out of its range");
        for (const float value : made->sunIrradiance)
            require(value >= 0.0f && std::isfinite(value), "a sun's light is not finite");
    }
    return true;
}
} // namespace

int main(int count, char** arguments)
{
    std::uint64_t seed = 1, runs = 0;
    double seconds = 10.0;
    fs::path folder = fs::temp_directory_path() / "environment_fuzz";
    for (int i = 1; i + 1 < count; i += 2)
    {
        const std::string name = arguments[i];
        if (name == "--seed")
            seed = std::strtoull(arguments[i + 1], nullptr, 10);
        else if (name == "--runs")
            runs = std::strtoull(arguments[i + 1], nullptr, 10);
        else if (name == "--seconds")
            seconds = std::atof(arguments[i + 1]);
        else if (name == "--keep")
            folder = arguments[i + 1];
        else
        {
            std::cerr << name << ": needed --seed, --runs, --seconds or --keep\n";
            return 2;
        }
    }
    fs::create_directories(folder);
    const std::string path = (folder / "input.exr").string();
    std::vector<std::string> files = seeds(path);
    const std::size_t first = files.size();
    for (const std::string& file : files)
    {
        std::ofstream(path, std::ios::binary) << file;
        require(tryFile(path), "a whole file gives no light");
    }
    Random random(seed);
    std::uint64_t run = 0, lit = 0;
    const auto start = std::chrono::steady_clock::now();
    const auto elapsed = [&]
    { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
    for (; runs > 0 ? run < runs : elapsed() < seconds; ++run)
    {
        const std::string mutant =
            mutated(files[random() % files.size()], files[random() % files.size()], random);
        std::ofstream(path, std::ios::binary) << mutant;
        if (!tryFile(path))
            continue;
        ++lit;
        // What was damaged and passed is damaged further.
        if (mutant.size() < 8192)
        {
            if (files.size() < first + 200)
                files.push_back(mutant);
            else
                files[first + random() % 200] = mutant;
        }
    }
    std::cout << "environment_fuzz: seed " << seed << ", " << run << " files, " << lit
              << " gave light, " << elapsed() << " s, clean\n";
    return 0;
}
