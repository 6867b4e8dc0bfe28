// Damaged panoramas (OpenEXR, Radiance, and PNG, BMP and TIFF through GDAL) through the readers and
// on to an environment: whatever comes in, what comes out is an error that names the file, or
// light. Plain mutation of files of every layout, no guidance by coverage, so that any compiler
// will do; meant for the build with sanitizers.
// Usage: environment_fuzz [--seed N] [--runs N | --seconds N] [--keep]
// The file at hand is input.exr, .hdr or .dat, in a folder that the first line names. It is there
// after a crash, and after a clean run with --keep.
#include "Mutation.h"
#include "io/EnvironmentFile.h"
#include "io/ExrFile.h"
#include "io/GdalErrors.h"

#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>
#include <gdal_priv.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

using namespace osgTerrainLight;

namespace
{

/// Small, so that headers are a good part of a file, and light from a mutant is light again.
constexpr std::size_t maxPixels = 1 << 16;

/// Pictures of Radiance in each coding, with every variable that is read.
std::vector<std::string> radiancePictures()
{
    const std::string head = "#?RADIANCE\n";
    const std::string pixel = "\x80\x40\x20\x82", other = "\x10\xff\x01\x8f";
    std::string flat, old, coded;
    for (int row = 0; row < 8; ++row)
    {
        for (int i = 0; i < 8; ++i)
            flat += pixel + other;
        old += pixel + other + "\x01\x01\x01\x0e";
        coded += std::string("\x02\x02\x00\x10", 4);
        for (std::size_t c = 0; c < 4; ++c)
            coded += std::string("\x8e") + pixel[c] + "\x02" + other[c] + pixel[c];
    }
    return {head + "FORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n" + flat,
            head + "FORMAT=32-bit_rle_rgbe\nEXPOSURE=0.5\nCOLORCORR= 1 2 3\n\n+X 16 -Y 8\n" + flat,
            head + "FORMAT=32-bit_rle_xyze\nEXPOSURE=1e-3\n\n+Y 8 -X 16\n" + old,
            head +
                "PRIMARIES=.708 .292 .17 .797 .131 .046 .3127 .329\nVIEW= -vtv\nPIXASPECT=1\n\n"
                "-Y 8 +X 16\n" +
                coded};
}

/// A picture of another format, 16 x 8; of one band, with a palette where it is of bytes.
std::string rasterPicture(const std::string& path, const char* format, GDALDataType type, int bands)
{
    GDALDriverManager& drivers = *GetGDALDriverManager();
    const std::unique_ptr<GDALDataset> memory(
        drivers.GetDriverByName("MEM")->Create("", 16, 8, bands, type, nullptr));
    std::vector<float> values(16 * 8);
    for (int number = 1; number <= bands; ++number)
    {
        GDALRasterBand& band = *memory->GetRasterBand(number);
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<float>((i * 7 + static_cast<std::size_t>(number)) % 13);
        require(band.RasterIO(GF_Write, 0, 0, 16, 8, values.data(), 16, 8, GDT_Float32, 0, 0,
                              nullptr) == CE_None,
                "no picture");
        if (bands > 1 || type != GDT_Byte)
            continue;
        GDALColorTable palette;
        for (short i = 0; i < 13; ++i)
        {
            const GDALColorEntry entry = {i, 200, 100, 255};
            palette.SetColorEntry(i, &entry);
        }
        band.SetColorTable(&palette);
    }
    {
        const std::unique_ptr<GDALDataset> written(drivers.GetDriverByName(format)->CreateCopy(
            path.c_str(), memory.get(), FALSE, nullptr, nullptr, nullptr));
        require(written != nullptr, "no picture");
    }
    return bytesOf(path);
}

std::vector<std::string> rasterPictures(const std::string& path)
{
    std::vector<std::string> found;
    for (const auto& [format, type, bands] :
         std::vector<std::tuple<const char*, GDALDataType, int>>{{"PNG", GDT_Byte, 3},
                                                                 {"PNG", GDT_Byte, 1},
                                                                 {"PNG", GDT_UInt16, 1},
                                                                 {"BMP", GDT_Byte, 3},
                                                                 {"BMP", GDT_Byte, 1},
                                                                 {"GTiff", GDT_Float32, 3}})
        found.push_back(rasterPicture(path, format, type, bands));
    return found;
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
    for (const std::string& picture : radiancePictures())
        found.push_back(picture);
    return found;
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
    const FuzzOptions options(count, arguments, "environment_fuzz");
    GDALAllRegister();
    CPLSetConfigOption("GDAL_PAM_ENABLED", "NO"); // no files beside the one at hand
    const GdalErrors quiet;
    std::vector<std::string> files = seeds(options.file("input.exr"));
    for (const std::string& picture : rasterPictures(options.file("input.dat")))
        files.push_back(picture);
    // By its first bytes, which are what the reader goes by where the name says nothing.
    const auto nameOf = [](const std::string& bytes)
    {
        return bytes.rfind("\x76\x2f\x31\x01", 0) == 0 ? "input.exr"
               : bytes.rfind("#?", 0) == 0             ? "input.hdr"
                                                       : "input.dat";
    };
    return fuzz(options, files,
                [&](const std::string& bytes)
                {
                    const std::string path = options.file(nameOf(bytes));
                    std::ofstream(path, std::ios::binary) << bytes;
                    return tryFile(path);
                });
}
