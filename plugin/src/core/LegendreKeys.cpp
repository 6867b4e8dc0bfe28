#include "core/LegendreKeys.h"

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double radiansPerDegree = pi / 180.0;

void append(std::vector<LegendreKey>& slices, const KeyLight& light, double perSun)
{
    const int intervals = std::max(2, static_cast<int>(std::ceil(light.width / 45.0 - 1e-9)));
    const double spacing = light.width / intervals; // degrees
    const WedgeMatrices wedges(spacing * radiansPerDegree);
    for (int i = 0; i <= intervals; ++i)
    {
        LegendreKey slice;
        // Counter-clockwise, as the weights count.
        slice.direction = directionOfCompass(light.azimuth + 0.5 * light.width - i * spacing);
        slice.weights = i == 0           ? wedges.firstWeights()
                        : i == intervals ? wedges.lastWeights()
                                         : wedges.weights(AzimuthBlend::Linear);
        slice.lowest = light.lowest * radiansPerDegree;
        slice.highest = light.highest * radiansPerDegree;
        slice.radiance = light.radiance;
        slice.perSun = perSun;
        slices.push_back(slice);
    }
}

void appendSun(std::vector<LegendreKey>& slices, const SkyLight& sky)
{
    KeyLight light;
    light.azimuth = sky.sunAzimuth;
    double radius = std::max(sky.sunAngularRadius, 0.1);
    const bool zenithal = sky.sunElevation + radius >= 90.0;
    radius = std::max(radius, zenithal ? 1.0 : 0.0);
    light.lowest = std::max(sky.sunElevation - radius, -90.0);
    light.highest = std::min(sky.sunElevation + radius, 90.0);
    const double elevation = sky.sunElevation * radiansPerDegree;
    light.width =
        zenithal ? 360.0
                 : 2.0 / radiansPerDegree *
                       std::asin(std::min(std::sin(radius * radiansPerDegree) / std::cos(elevation),
                                          1.0));
    const double side = 0.5 * light.width * radiansPerDegree;
    const double low = light.lowest * radiansPerDegree;
    const double high = light.highest * radiansPerDegree;
    const double sines = std::sin(high) - std::sin(low);
    // Of radiance 1, on a surface that faces the disc's middle: the integral of the cosine,
    // cos e cos ω cos φ + sin e sin ω, over the rectangle.
    const double facing = 2.0 * std::sin(side) * std::cos(elevation) * 0.5 *
                              (high - low + 0.5 * (std::sin(2.0 * high) - std::sin(2.0 * low))) +
                          2.0 * side * std::sin(elevation) * 0.5 *
                              (std::sin(high) * std::sin(high) - std::sin(low) * std::sin(low));
    for (std::size_t c = 0; c < 3; ++c)
        light.radiance[c] = static_cast<float>(static_cast<double>(sky.sunIrradiance[c]) / facing);
    append(slices, light, 1.0 / (std::sqrt(0.25 / pi) * 2.0 * side * sines));
}
} // namespace

std::vector<LegendreKey> legendreKeys(const SkyLight& sky)
{
    std::vector<LegendreKey> slices;
    for (const KeyLight& light : sky.keyLights)
        if (light.highest > 0.0)
            append(slices, light, 0.0);
    if (sky.sunEnabled && sky.sunElevation + sky.sunAngularRadius > 0.0)
        appendSun(slices, sky);
    return slices;
}

} // namespace osgTerrainLight
