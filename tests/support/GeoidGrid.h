#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace osgTerrainLight
{

/// A grid of a geoid as a file that PROJ reads (NOAA's GTX: numbers with the high byte first, rows
/// from the south), of columns × rows nodes one step apart. at(longitude, latitude): [m].
template <class At>
void writeGeoidGrid(const std::filesystem::path& path, double west, double south, double step,
                    int columns, int rows, const At& at)
{
    std::ofstream file(path, std::ios::binary);
    const auto put = [&file](auto value)
    {
        char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        for (std::size_t i = sizeof value; i-- > 0;)
            file.put(bytes[i]);
    };
    for (const double value : {south, west, step, step})
        put(value);
    put(static_cast<std::int32_t>(rows));
    put(static_cast<std::int32_t>(columns));
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
            put(static_cast<float>(at(west + column * step, south + row * step)));
}

} // namespace osgTerrainLight
