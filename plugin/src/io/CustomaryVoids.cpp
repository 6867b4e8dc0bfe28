#include "io/CustomaryVoids.h"

#include <cpl_string.h>

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{
namespace
{
/// Deeper than any sea of the Earth, 10.9 km, and any basin of Moon and Mars, 9.1 km.
constexpr double deepest = -12000.0; // [m]
} // namespace

CustomaryVoids::CustomaryVoids(const BandFacts& facts)
{
    constexpr std::array<double, 4> values = {-32768.0, -32767.0, -99999.0, -9999.0};
    for (std::size_t i = 0; i < values.size(); ++i)
    {
        _entries[i].value = values[i];
        // Without the offset, which may be a body's radius.
        _entries[i].always =
            values[i] * std::abs(facts.scale) * facts.metresPerHeightUnit < deepest;
    }
}

bool CustomaryVoids::takeLow(double stored)
{
    bool taken = false;
    for (Entry& entry : _entries)
        if (stored == entry.value)
        {
            ++entry.count;
            taken = true;
        }
    // Two of them are neighbours: neither speaks for the other.
    if (!taken)
        for (Entry& entry : _entries)
            entry.nearest = std::min(entry.nearest, std::abs(stored - entry.value));
    return taken;
}

bool CustomaryVoids::isVoid(const Entry& entry)
{
    return entry.always || entry.nearest > near;
}

std::vector<double> CustomaryVoids::voids() const
{
    std::vector<double> result;
    for (const Entry& entry : _entries)
        if (entry.count > 0 && isVoid(entry))
            result.push_back(entry.value);
    return result;
}

std::vector<double> CustomaryVoids::heights() const
{
    std::vector<double> result;
    for (const Entry& entry : _entries)
        if (entry.count > 0 && !isVoid(entry))
            result.push_back(entry.value);
    return result;
}

std::vector<std::string> CustomaryVoids::notes() const
{
    std::vector<std::string> result;
    for (const Entry& entry : _entries)
        if (entry.count > 0)
            result.push_back(
                std::to_string(entry.count) + (entry.count == 1 ? " post of " : " posts of ") +
                CPLSPrintf("%.0f", entry.value) +
                (isVoid(entry) ? ", which is no declared nodata value: taken as void"
                               : ", which often stands for voids, beside heights like it: taken as "
                                 "heights"));
    return result;
}

} // namespace osgTerrainLight
