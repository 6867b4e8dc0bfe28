#include "Picture.h"

#include "Console.h"
#include "io/ExrFile.h"

#include <cpl_conv.h>
#include <cpl_string.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace osgTerrainLight::tool
{
namespace
{

/// 8 bits of a linear value in 0 … 1, encoded as IEC 61966-2-1 has it.
std::uint8_t srgb8(double linear)
{
    const double value = std::clamp(linear, 0.0, 1.0);
    const double encoded =
        value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(255.0 * encoded));
}

} // namespace

bool isPicture(const OutputOptions& output)
{
    const std::string kind =
        output.format.empty() ? CPLGetExtension(output.path.c_str()) : output.format;
    for (const char* picture : {"png", "jpg", "jpeg", "webp"})
        if (EQUAL(kind.c_str(), picture))
            return true;
    return false;
}

Status writePicture(const OutputOptions& output, const RasterFrame& frame, bool hasVoids,
                    double gain, const Metadata& metadata, const LightRows& rows,
                    const std::string& scratchFolder)
{
    const bool hasAlpha = hasVoids && !EQUAL(output.format.c_str(), "JPEG") &&
                          !EQUAL(CPLGetExtension(output.path.c_str()), "jpg") &&
                          !EQUAL(CPLGetExtension(output.path.c_str()), "jpeg");
    const std::size_t width = static_cast<std::size_t>(frame.width);
    std::vector<float> light;
    const auto pixels = [&](int row, std::vector<std::uint8_t>& line) -> Status
    {
        if (Status going = DeferredSignals::check(); !going)
            return going;
        if (Status read = rows(row, light); !read)
            return read;
        line.clear();
        for (std::size_t i = 0; i < width; ++i)
        {
            const bool isVoid = std::isnan(light[i]);
            for (std::size_t c = 0; c < 3; ++c)
                line.push_back(isVoid ? 0
                                      : srgb8(gain * static_cast<double>(light[c * width + i])));
            if (hasAlpha)
                line.push_back(isVoid ? 0 : 255);
        }
        return Nothing{};
    };
    const DeferredSignals deferred;
    RasterWriteOptions options = writeOptions(output, metadata);
    options.scratchFolder = scratchFolder;
    return writeRgb8(output.path, frame, hasAlpha ? 4 : 3, pixels, options);
}

Status writeLightExr(const OutputOptions& output, const RasterFrame& frame,
                     const Metadata& metadata, const LightRows& rows)
{
    ExrImage image;
    image.width = frame.width;
    image.height = frame.height;
    image.text.insert(metadata.begin(), metadata.end());
    if (!frame.crs.empty())
        image.text["TERRAINLIGHT_CRS"] = frame.crs;
    if (frame.coordinateEpoch > 0.0)
        image.text["TERRAINLIGHT_COORDINATE_EPOCH"] = text(frame.coordinateEpoch);
    for (unsigned c = 0; c < 4; ++c)
        image.channels.push_back({std::string(1, "RGBA"[c]), {}});
    const std::size_t width = static_cast<std::size_t>(frame.width);
    std::vector<float> light;
    for (int row = 0; row < frame.height; ++row)
    {
        if (Status read = rows(row, light); !read)
            return read;
        for (std::size_t c = 0; c < 4; ++c)
            for (std::size_t i = 0; i < width; ++i)
                image.channels[c].values.push_back(std::isnan(light[i]) ? 0.0f
                                                                        : light[c * width + i]);
    }
    const DeferredSignals deferred;
    return writeExr(output.path, image);
}

} // namespace osgTerrainLight::tool
