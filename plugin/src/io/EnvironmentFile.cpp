#include "io/EnvironmentFile.h"

#include "io/ExrEnvironment.h"
#include "io/ExrGuard.h"
#include "io/InputFiles.h"
#include "io/RadianceFile.h"
#include "io/RasterEnvironment.h"

#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <system_error>

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

std::string joined(std::initializer_list<std::string> sentences)
{
    std::string all;
    for (const std::string& sentence : sentences)
        all += (all.empty() || sentence.empty() ? "" : "; ") + sentence;
    return all;
}

namespace
{
bool exists(const std::string& path)
{
    std::error_code failure;
    return std::filesystem::exists(path, failure);
}
} // namespace

// Damaged files never reach a reader that trusts them: what claims to be of a kind that we read
// ourselves, by its content or its name, is read so.
Result<EnvironmentPicture> readEnvironmentFile(const std::string& path, std::size_t maxPixels)
{
    if (const std::string wrong = complaintOfFile(path); !wrong.empty())
        return Error{ErrorCode::Invalid, path + ": " + wrong};
    std::array<char, 4> start = {};
    std::ifstream(path, std::ios::binary).read(start.data(), start.size());
    std::string extension = std::filesystem::path(path).extension().string();
    for (char& c : extension)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (start[0] == '#' && start[1] == '?')
        return readRadianceFile(path, maxPixels);
    if (start == std::array<char, 4>{0x76, 0x2f, 0x31, 0x01} || extension == ".exr")
        return readGuarded(path, [&] { return readExrEnvironment(path, maxPixels); });
    if (extension != ".hdr" && extension != ".pic")
        return readRasterEnvironment(path, maxPixels);
    if (!exists(path))
        return Error{ErrorCode::NotFound, path + ": no such file"};
    return Error{ErrorCode::Invalid,
                 path + ": does not begin with #?; needed a picture of Radiance"};
}

} // namespace osgTerrainLight
