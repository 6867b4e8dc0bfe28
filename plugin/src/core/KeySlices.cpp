#include "core/KeySlices.h"

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{

std::vector<KeySlices> keySlices(const SkyLight& sky, int azimuths)
{
    std::vector<KeySlices> lights;
    for (const KeyLight& key : sky.keyLights)
    {
        const bool black = std::all_of(key.radiance.begin(), key.radiance.end(),
                                       [](float channel) { return channel <= 0.0f; });
        const double lowest = std::max(key.lowest, 0.0);
        if (black || key.highest <= lowest)
            continue;
        KeySlices light;
        // A width that is a whole number of the map's slices is not to gain one by rounding.
        light.count = std::max(3, static_cast<int>(std::ceil(key.width * azimuths / 360.0 - 1e-9)));
        light.count = std::min(light.count, 256 / static_cast<int>(sky.keyLights.size()));
        light.width = key.width / light.count;
        light.first = key.azimuth - 0.5 * key.width + 0.5 * light.width;
        light.lowest = lowest;
        light.highest = key.highest;
        light.radiance = key.radiance;
        lights.push_back(light);
    }
    return lights;
}

std::vector<MapDirection> directionsOf(const std::vector<KeySlices>& lights)
{
    std::vector<MapDirection> directions;
    for (const KeySlices& light : lights)
        for (int i = 0; i < light.count; ++i)
            directions.push_back(directionOfCompass(light.first + i * light.width));
    return directions;
}

} // namespace osgTerrainLight
