#include "io/EnvironmentFile.h"

#include "io/ExrEnvironment.h"
#include "io/ExrGuard.h"
#include "io/RadianceFile.h"

#include <array>
#include <cmath>
#include <fstream>

namespace osgTerrainLight
{

EnvironmentPicture fromLatitudeLongitude(int width, int height, const std::vector<Rgb>& pixels)
{
    EnvironmentPicture result;
    result.columns = width;
    result.rows = height;
    result.radiance.resize(pixels.size());
    // East is three quarters along; azimuths inside run the other way.
    const int east = static_cast<int>(std::lround(0.75 * width));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
        {
            const int column = ((east - 1 - x) % width + width) % width;
            const auto at = [&](int row, int place)
            {
                return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                       static_cast<std::size_t>(place);
            };
            result.radiance[at(height - 1 - y, column)] = pixels[at(y, x)];
        }
    return result;
}

std::string makeUsable(std::vector<Rgb>& pixels)
{
    constexpr float greatest = 1e30f;
    constexpr float overflow = 65504.0f;
    std::size_t notNumbers = 0, infinite = 0;
    for (Rgb& pixel : pixels)
        for (float& value : pixel)
        {
            notNumbers += std::isnan(value);
            infinite += std::isinf(value) || std::abs(value) > greatest;
            value = !(value > 0.0f) ? 0.0f : value > greatest ? overflow : value;
        }
    if (notNumbers + infinite == 0)
        return {};
    return std::to_string(notNumbers) + " values are no number and taken as 0, " +
           std::to_string(infinite) + " are infinite and taken as 65504 (or 0 where negative)";
}

PictureFormat formatOf(const std::string& path)
{
    std::array<char, 4> start = {};
    std::ifstream(path, std::ios::binary).read(start.data(), start.size());
    if (start == std::array<char, 4>{0x76, 0x2f, 0x31, 0x01})
        return PictureFormat::OpenExr;
    return start[0] == '#' && start[1] == '?' ? PictureFormat::Radiance : PictureFormat::Other;
}

Result<EnvironmentPicture> readEnvironmentFile(const std::string& path, std::size_t maxPixels)
{
    if (formatOf(path) == PictureFormat::Radiance)
        return readRadianceFile(path, maxPixels);
    return readGuarded(path, [&] { return readExrEnvironment(path, maxPixels); });
}

} // namespace osgTerrainLight
