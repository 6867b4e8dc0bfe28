#pragma once

#include "io/RasterBand.h"

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Stored values that stand for voids by custom, whether or not a raster declares another nodata
/// value: −32768 and −32767, the lowest 16-bit numbers, −99999, ESRI's, and −9999. One that would
/// lie deeper than any terrain is always void; one that could be a height (−9999 m is the bottom of
/// a trench, −32768 cm a shore) is void where no other value lies within 1000 of it.
class CustomaryVoids
{
public:
    explicit CustomaryVoids(const BandFacts& facts);

    /// True where the stored value is one of them, which is then counted. All other values that are
    /// neither nodata nor masked are to be shown as well, before voids() is asked.
    bool take(double stored) { return stored <= highest && takeLow(stored); }

    /// Values that are void.
    std::vector<double> voids() const;

    /// Values that are counted and are heights, one for each.
    std::vector<double> heights() const;

    /// What is void and what is a height after all, with counts.
    std::vector<std::string> notes() const;

private:
    struct Entry
    {
        double value = 0.0;
        bool always = false;
        std::size_t count = 0;
        double nearest = std::numeric_limits<double>::infinity(); ///< distance of another value
    };
    static constexpr double near = 1000.0;
    static constexpr double highest = -9999.0 + near;

    bool takeLow(double stored);
    static bool isVoid(const Entry& entry);

    std::array<Entry, 4> _entries;
};

} // namespace osgTerrainLight
