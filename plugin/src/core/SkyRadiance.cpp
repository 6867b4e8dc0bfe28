#include "core/SkyRadiance.h"

#include "core/ClearSky.h"
#include "core/Quadrature.h"
#include <osgTerrainLight/Environment.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace osgTerrainLight
{

namespace
{
constexpr double pi = 3.14159265358979323846;

/// A function turned clockwise about the vertical: m and −m of a band mix.
std::vector<Rgb> turned(const std::vector<Rgb>& harmonics, double clockwise, double gain)
{
    std::vector<Rgb> result(16);
    for (int l = 0; l < 4; ++l)
        for (int m = 0; m <= l; ++m)
        {
            const auto plus = static_cast<std::size_t>(l * (l + 1) + m);
            const auto minus = static_cast<std::size_t>(l * (l + 1) - m);
            const double cosine = std::cos(m * clockwise), sine = std::sin(m * clockwise);
            for (std::size_t c = 0; c < 3; ++c)
            {
                const double even = gain * static_cast<double>(harmonics[plus][c]);
                const double odd = gain * static_cast<double>(harmonics[minus][c]);
                result[plus][c] = static_cast<float>(m == 0 ? even : cosine * even + sine * odd);
                if (m > 0)
                    result[minus][c] = static_cast<float>(cosine * odd - sine * even);
            }
        }
    return result;
}

using Direction = std::array<double, 3>;

/// The model's radiance by direction; what is the same for all directions is done once.
std::function<std::array<double, 3>(const Direction&)> radianceOf(const SkyLight& sky)
{
    if (sky.skyModel == SkyModel::Clear)
        return [model = clearSky(sky)](const Direction& d) -> std::array<double, 3>
        {
            const auto radiance = Glsl<double>().clearSkyRadiance(model, {d[0], d[1], d[2]});
            return {radiance.x, radiance.y, radiance.z};
        };
    return [&sky](const Direction& d)
    {
        const double factor =
            sky.skyModel == SkyModel::Overcast ? Glsl<double>().overcastGradation(d[2]) : 1.0;
        std::array<double, 3> radiance = {};
        for (std::size_t c = 0; c < 3; ++c)
            radiance[c] = factor * static_cast<double>(sky.skyRadiance[c]);
        return radiance;
    };
}

/// Of the upper hemisphere, below which a model has no light.
std::vector<Rgb> projectedModel(const SkyLight& sky)
{
    const auto model = radianceOf(sky);
    constexpr int turns = 64;
    std::array<std::array<double, 3>, 16> sum = {};
    const GaussRule& rule = gaussRule();
    constexpr int parts = 8; // of z, finer towards the horizontal, where skies change most
    for (int part = 0; part < parts; ++part)
    {
        const double bottom = std::pow(double(part) / parts, 2.0);
        const double height = std::pow(double(part + 1) / parts, 2.0) - bottom;
        for (std::size_t node = 0; node < rule.places.size(); ++node)
            for (int turn = 0; turn < turns; ++turn)
            {
                const double z = bottom + height * rule.places[node];
                const double side = std::sqrt(1.0 - z * z);
                const double azimuth = 2.0 * pi * (turn + 0.5) / turns;
                const Direction towards = {side * std::cos(azimuth), side * std::sin(azimuth), z};
                const auto radiance = model(towards);
                const auto sh = Glsl<double>().shBasis({towards[0], towards[1], towards[2]});
                const double weight = height * rule.weights[node] * 2.0 * pi / turns;
                for (std::size_t i = 0; i < 16; ++i)
                    for (std::size_t c = 0; c < 3; ++c)
                        sum[i][c] += weight * radiance[c] * sh.c[i / 4][static_cast<int>(i % 4)];
            }
    }
    std::vector<Rgb> harmonics(16);
    for (std::size_t i = 0; i < 16; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            harmonics[i][c] = static_cast<float>(sum[i][c]);
    return harmonics;
}
} // namespace

bool skyHasTable(const SkyLight& sky)
{
    return sky.skyEnabled &&
           (sky.environment || !sky.skyHarmonics.empty() || sky.skyModel != SkyModel::Uniform);
}

std::array<double, 3> modelRadiance(const SkyLight& sky, const std::array<double, 3>& direction)
{
    return radianceOf(sky)(direction);
}

Raster<Rgb> skyPicture(const SkyLight& sky, int n, const Rgb& albedo, const Rgb& sun)
{
    const auto model = radianceOf(sky);
    const auto radianceAt = [&](const Direction& d)
    {
        if (sky.skyHarmonics.empty())
            return model(d);
        std::array<double, 3> radiance = {};
        const auto sh = Glsl<double>().shBasis({d[0], d[1], d[2]});
        for (std::size_t i = 0; i < sky.skyHarmonics.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                radiance[c] += static_cast<double>(sky.skyHarmonics[i][c]) *
                               sh.c[i / 4][static_cast<int>(i % 4)];
        return radiance;
    };
    const double step = pi / n;
    const auto elevationOf = [&](int row) { return step * (row + 0.5) - 0.5 * pi; };
    Raster<Rgb> picture(2 * n, n);
    std::array<double, 3> irradiance = {};
    for (std::size_t c = 0; c < 3; ++c)
        irradiance[c] = std::max(0.0, sky.sunDirection()[2]) * static_cast<double>(sun[c]);
    for (int row = n / 2; row < n; ++row)
        for (int column = 0; column < 2 * n; ++column)
        {
            const double up = std::sin(elevationOf(row)), side = std::cos(elevationOf(row));
            const double azimuth = step * (column + 0.5);
            const auto radiance =
                radianceAt({side * std::cos(azimuth), side * std::sin(azimuth), up});
            for (std::size_t c = 0; c < 3; ++c)
            {
                picture.at(column, row)[c] = static_cast<float>(std::max(0.0, radiance[c]));
                irradiance[c] += std::max(0.0, radiance[c]) * up * side * step * step;
            }
        }
    for (int row = 0; row < n / 2; ++row)
    {
        const double below = std::min(1.0, -elevationOf(row) / (pi / 18.0));
        const auto clear = static_cast<float>(below * below * (3.0 - 2.0 * below));
        for (int column = 0; column < 2 * n; ++column)
            for (std::size_t c = 0; c < 3; ++c)
                picture.at(column, row)[c] =
                    (1.0f - clear) * picture.at(column, n / 2)[c] +
                    clear * albedo[c] * static_cast<float>(irradiance[c] / pi);
    }
    return picture;
}

std::vector<Rgb> harmonicsOf(const SkyLight& sky)
{
    if (sky.environment)
        return turned(sky.environment->harmonics, sky.environmentHeading * pi / 180.0,
                      sky.environmentGain);
    std::vector<Rgb> harmonics = sky.skyHarmonics.empty() ? projectedModel(sky) : sky.skyHarmonics;
    harmonics.resize(16);
    return harmonics;
}

Rgb sunAtGround(const SkyLight& sky)
{
    if (sky.environment || !sky.skyHarmonics.empty() || sky.skyModel != SkyModel::Clear)
        return sky.sunIrradiance;
    // What a horizon leaves of the disc is others' business. It is gone where the disc is.
    const double risen = std::clamp(1.0 + sky.sunElevation / sky.sunAngularRadius, 0.0, 1.0);
    const double rising = risen * risen * (3.0 - 2.0 * risen);
    const Daylight light = daylightOf(sky.turbidity, sky.sunElevation);
    Rgb found = {};
    for (std::size_t c = 0; c < 3; ++c)
        found[c] =
            static_cast<float>(rising * light.sun[c] * static_cast<double>(sky.sunIrradiance[c]));
    return found;
}

} // namespace osgTerrainLight
