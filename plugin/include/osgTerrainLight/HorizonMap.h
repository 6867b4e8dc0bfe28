#pragma once

#include <osgTerrainLight/Export.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace osgTerrainLight
{

/// The elevation of the horizon per post and azimuth, on the CPU.
///
/// Azimuth k of m looks towards φ_k = 2πk/m, counter-clockwise from east. m is a multiple of 4, so
/// that the same azimuths can be numbered clockwise from north. The elevation is the angle above
/// the horizontal, −90° … 90°, in 16 bits: code 32768 is exactly 0°, one step is 90°/32767 =
/// 0.0027°, and code 0 marks a void post. The GPU has the same codes, as R16 unorm.
class OSGTERRAINLIGHT_EXPORT HorizonMap
{
public:
    HorizonMap() = default;
    HorizonMap(int width, int height, int azimuthCount);

    int width() const { return _width; }
    int height() const { return _height; }
    int azimuthCount() const { return _azimuthCount; }

    std::uint16_t codeAt(int column, int row, int azimuth) const
    {
        return _codes[index(column, row, azimuth)];
    }
    bool isValid(int column, int row) const { return codeAt(column, row, 0) != voidCode; }

    /// The elevation of the horizon at a post that is not void [degrees].
    double elevationAt(int column, int row, int azimuth) const
    {
        return decode(codeAt(column, row, azimuth));
    }

    /// All codes: azimuth by azimuth, and in each row by row from the south.
    std::vector<std::uint16_t>& codes() { return _codes; }
    const std::vector<std::uint16_t>& codes() const { return _codes; }

    static constexpr std::uint16_t voidCode = 0;
    static constexpr std::uint16_t levelCode = 32768;
    static double decode(std::uint16_t code) { return (code - 32768.0) * (90.0 / 32767.0); }
    static std::uint16_t encode(double elevationDegrees);

private:
    std::size_t index(int column, int row, int azimuth) const
    {
        return (static_cast<std::size_t>(azimuth) * static_cast<std::size_t>(_height) +
                static_cast<std::size_t>(row)) *
                   static_cast<std::size_t>(_width) +
               static_cast<std::size_t>(column);
    }

    int _width = 0;
    int _height = 0;
    int _azimuthCount = 0;
    std::vector<std::uint16_t> _codes;
};

} // namespace osgTerrainLight
