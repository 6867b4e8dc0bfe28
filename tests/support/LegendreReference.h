#pragma once

// The scheme of Nowrouzezahrai and Snyder 2009 in double, for tests. It shares nothing with the
// passes: Legendre polynomials are the standard library's, pyramids, normals and scans are written
// again.

#include <osgTerrainLight/DemTile.h>

#include "core/Raster.h"
#include "core/SyntheticTerrain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

namespace osgTerrainLight::testing::legendre
{

constexpr double pi = 3.14159265358979323846;
using Vec3 = std::array<double, 3>;
using Slice = std::array<double, 4>;
using Colours = Raster<std::array<float, 3>>;

/// (value times weight, weight), per post or texel of a level.
struct Level
{
    int width = 0, height = 0;
    std::vector<double> value, weight;

    std::array<double, 2> texel(int x, int y) const
    {
        if (x < 0 || y < 0 || x >= width || y >= height)
            return {0.0, 0.0};
        const auto i = static_cast<std::size_t>(y * width + x);
        return {value[i], weight[i]};
    }

    /// Bilinear, coordinates in its own texels.
    std::array<double, 2> at(double x, double y) const
    {
        const int x0 = std::min(static_cast<int>(x), std::max(width - 2, 0));
        const int y0 = std::min(static_cast<int>(y), std::max(height - 2, 0));
        const double u = x - x0;
        const double v = y - y0;
        std::array<double, 2> sum = {};
        for (std::size_t c = 0; c < 2; ++c)
            sum[c] = (1.0 - v) * ((1.0 - u) * texel(x0, y0)[c] + u * texel(x0 + 1, y0)[c]) +
                     v * ((1.0 - u) * texel(x0, y0 + 1)[c] + u * texel(x0 + 1, y0 + 1)[c]);
        return sum;
    }
};

inline std::vector<Level> pyramidOf(Level finest)
{
    std::vector<Level> levels = {std::move(finest)};
    while (levels.back().width > 2 || levels.back().height > 2)
    {
        const Level& finer = levels.back();
        Level level;
        level.width = finer.width / 2 + 1;
        level.height = finer.height / 2 + 1;
        for (int y = 0; y < level.height; ++y)
            for (int x = 0; x < level.width; ++x)
            {
                double value = 0.0;
                double weight = 0.0;
                for (int i = -1; i <= 1; ++i)
                    for (int j = -1; j <= 1; ++j)
                    {
                        const double share = (2 - std::abs(i)) * (2 - std::abs(j)) / 16.0;
                        value += share * finer.texel(2 * x + i, 2 * y + j)[0];
                        weight += share * finer.texel(2 * x + i, 2 * y + j)[1];
                    }
                level.value.push_back(value);
                level.weight.push_back(weight);
            }
        levels.push_back(std::move(level));
    }
    return levels;
}

/// Orthonormal on −1 … 1.
inline double polynomial(unsigned c, double z)
{
    return std::sqrt(c + 0.5) * std::legendre(c, z);
}

/// Its integral from −1: Bonnet's formula.
inline double polynomialIntegral(unsigned c, double z)
{
    return c == 0 ? std::sqrt(0.5) * (z + 1.0)
                  : std::sqrt(c + 0.5) / (2.0 * c + 1.0) *
                        (std::legendre(c + 1, z) - std::legendre(c - 1, z));
}

inline double elevationPart(int l, int m, double z)
{
    return std::sqrt((m == 0 ? 1.0 : 2.0) * (2 * l + 1) / (4.0 * pi) * std::tgamma(l - m + 1) /
                     std::tgamma(l + m + 1)) *
           std::assoc_legendre(static_cast<unsigned>(l), static_cast<unsigned>(m), z);
}

/// Of (l, m) and polynomial c, by the midpoint rule in elevation.
inline double overlap(int l, int m, unsigned c)
{
    constexpr int steps = 4000;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i)
    {
        const double t = pi * ((i + 0.5) / steps - 0.5);
        sum += elevationPart(l, m, std::sin(t)) * polynomial(c, std::sin(t)) * std::cos(t);
    }
    return sum * pi / steps;
}

/// Eigenvalues of the clamped cosine.
inline constexpr std::array<double, 3> cosineBands = {pi, 2.0 * pi / 3.0, pi / 4.0};

/// What the clamped cosine about a normal takes of order `m` of a slice at an azimuth, per band.
inline std::array<double, 3> kernelOf(int m, const Vec3& normal, double azimuth)
{
    const double side = std::atan2(normal[1], normal[0]) - azimuth;
    std::array<double, 3> bands = {};
    for (int l = m; l < 3; ++l)
        bands[static_cast<std::size_t>(l)] = cosineBands[static_cast<std::size_t>(l)] *
                                             elevationPart(l, m, normal[2]) * std::cos(m * side);
    return bands;
}

/// A way to receive light: what a normal makes of unit light from the nadir up to an elevation, at
/// an azimuth. The difference of two values is what lies between.
using Receiver = std::function<double(double sine)>;

/// One tile in double, with what its posts send out.
class Scene
{
public:
    Scene(const DemTile& tile, const Colours& sent) : _tile(tile)
    {
        Level heights;
        Level light;
        heights.width = light.width = tile.width();
        heights.height = light.height = tile.height();
        for (int y = 0; y < tile.height(); ++y)
            for (int x = 0; x < tile.width(); ++x)
            {
                const bool valid = tile.isValid(x, y);
                heights.value.push_back(valid ? static_cast<double>(tile.heightAt(x, y)) : 0.0);
                heights.weight.push_back(valid ? 1.0 : 0.0);
                light.value.push_back(valid ? static_cast<double>(sent.at(x, y)[0]) : 0.0);
                light.weight.push_back(valid ? 1.0 : 0.0);
            }
        _heights = pyramidOf(heights);
        _light = pyramidOf(light);
    }

    Vec3 normal(int x, int y) const
    {
        const double dx = _tile.eastSpacing(y);
        const double dy = _tile.northSpacing;
        Vec3 sum = {};
        const auto height = [&](int i, int j) { return _heights[0].texel(i, j); };
        for (const int i : {-1, 1})
            for (const int j : {-1, 1})
                if (height(x + i, y)[1] > 0.0 && height(x, y + j)[1] > 0.0 &&
                    height(x + i, y + j)[1] > 0.0)
                {
                    const double riseX = height(x + i, y)[0] - height(x, y)[0];
                    const double riseY = height(x, y + j)[0] - height(x, y)[0];
                    // (i dx, 0, riseX) × (0, j dy, riseY), upwards.
                    sum[0] -= i * riseX * dy;
                    sum[1] -= j * riseY * dx;
                    sum[2] += dx * dy;
                }
        const double length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
        return length > 0.0 ? Vec3{sum[0] / length, sum[1] / length, sum[2] / length}
                            : Vec3{0.0, 0.0, 1.0};
    }

    /// Light of one azimuth: samples at `distances` [posts along the axis crossed faster], from
    /// levels log2(distance) − offset.
    double received(int x, int y, double azimuth, const Vec3& normal,
                    const std::vector<double>& distances, double offset,
                    const Receiver& receiver) const
    {
        // Azimuths are laid out on the ground with the tile's nominal spacing.
        double stepX = std::cos(azimuth) / _tile.nominalEastSpacing();
        double stepY = std::sin(azimuth) / _tile.northSpacing;
        const double faster = std::max(std::abs(stepX), std::abs(stepY));
        stepX = std::abs(stepX) < 1e-12 * faster ? 0.0 : stepX / faster;
        stepY = std::abs(stepY) < 1e-12 * faster ? 0.0 : stepY / faster;
        const double length = std::hypot(stepX * _tile.eastSpacing(y), stepY * _tile.northSpacing);
        const double here = _heights[0].texel(x, y)[0];
        double highest =
            std::atan(-(normal[0] * std::cos(azimuth) + normal[1] * std::sin(azimuth)) / normal[2]);
        double below = receiver(std::sin(highest));
        double sum = 0.0;
        for (const double distance : distances)
        {
            double px = x + distance * stepX;
            double py = y + distance * stepY;
            if (px < -1e-9 || py < -1e-9 || px > _tile.width() - 1 + 1e-9 ||
                py > _tile.height() - 1 + 1e-9)
                break;
            px = std::clamp(px, 0.0, _tile.width() - 1.0);
            py = std::clamp(py, 0.0, _tile.height() - 1.0);
            const auto number =
                static_cast<std::size_t>(std::clamp(std::lround(std::log2(distance) - offset), 0L,
                                                    static_cast<long>(_heights.size()) - 1));
            const double size = std::exp2(static_cast<double>(number));
            const auto height = _heights[number].at(px / size, py / size);
            if (height[1] <= 0.5)
                continue;
            const double elevation =
                std::atan((height[0] / height[1] - here) / (distance * length));
            if (elevation <= highest)
                continue;
            const auto light = _light[number].at(px / size, py / size);
            const double above = receiver(std::sin(elevation));
            sum += light[0] / light[1] * (above - below);
            highest = elevation;
            below = above;
        }
        return sum;
    }

    int width() const { return _tile.width(); }
    int height() const { return _tile.height(); }

private:
    DemTile _tile;
    std::vector<Level> _heights, _light;
};

/// Smooth ground: fractal mountains, blurred.
inline DemTile smoothMountains(int size, int blurs)
{
    DemTile tile = generateTerrain(TerrainKind::Fractal, size, size, 30.0, 1).value();
    for (int pass = 0; pass < blurs; ++pass)
    {
        const DemTile before = tile;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
            {
                float sum = 0.0f;
                for (int i = -1; i <= 1; ++i)
                    for (int j = -1; j <= 1; ++j)
                        sum += static_cast<float>((2 - std::abs(i)) * (2 - std::abs(j))) / 16.0f *
                               before.heightAt(std::clamp(x + i, 0, size - 1),
                                               std::clamp(y + j, 0, size - 1));
                tile.setHeight(x, y, sum);
            }
    }
    return tile;
}

struct Relative
{
    double squares = 0.0, reference = 0.0;
    void add(double found, double expected)
    {
        squares += (found - expected) * (found - expected);
        reference += expected * expected;
    }
    double rms() const { return std::sqrt(squares / reference); }
};

} // namespace osgTerrainLight::testing::legendre
