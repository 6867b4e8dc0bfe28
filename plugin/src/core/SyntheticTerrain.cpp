#include "core/SyntheticTerrain.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace osgTerrainLight
{

namespace
{

/// Well-mixed 32 bits of three integers; the finaliser of MurmurHash3 after each.
std::uint32_t hash(std::int64_t x, std::int64_t y, std::uint32_t seed)
{
    const auto mix = [](std::uint32_t h)
    {
        h ^= h >> 16;
        h *= 0x85ebca6bu;
        h ^= h >> 13;
        h *= 0xc2b2ae35u;
        return h ^ (h >> 16);
    };
    std::uint32_t h = mix(seed + 0x9e3779b9u);
    h = mix(h ^ static_cast<std::uint32_t>(static_cast<std::uint64_t>(x)));
    return mix((h + 0x7f4a7c15u) ^ static_cast<std::uint32_t>(static_cast<std::uint64_t>(y)));
}

/// 0 … 1 from bits [first, first + 8) of a hash.
double unitByte(std::uint32_t bits, int first)
{
    return static_cast<double>((bits >> first) & 255u) / 255.0;
}

/// Gradient noise with lattice cells of size 1: smooth, mean 0, about −1 … 1.
double gradientNoise(double x, double y, std::uint32_t seed)
{
    const double fx = std::floor(x);
    const double fy = std::floor(y);
    const double u = x - fx;
    const double v = y - fy;
    const auto corner = [&](int dx, int dy)
    {
        const std::uint32_t bits =
            hash(static_cast<std::int64_t>(fx) + dx, static_cast<std::int64_t>(fy) + dy, seed);
        const double gx = static_cast<double>(bits & 0xffffu) / 32767.5 - 1.0;
        const double gy = static_cast<double>(bits >> 16) / 32767.5 - 1.0;
        return gx * (u - dx) + gy * (v - dy);
    };
    const auto fade = [](double s) { return s * s * s * (s * (s * 6.0 - 15.0) + 10.0); };
    const double south = corner(0, 0) + fade(u) * (corner(1, 0) - corner(0, 0));
    const double north = corner(0, 1) + fade(u) * (corner(1, 1) - corner(0, 1));
    return south + fade(v) * (north - south);
}

/// Self-affine terrain in units of the spacing: octaves of gradient noise from 2.6 posts up to 600,
/// each turned by the 3-4-5 angle against the last, so that no lattice shows.
double fractal(int column, int row, std::uint32_t seed)
{
    // Per octave the amplitude grows by 1.8 where the wavelength doubles: Hurst exponent 0.85. The
    // first amplitude is set so that the median slope is 22° (a test holds it).
    double amplitude = 0.88;
    double wavelength = 2.6;
    double x = column;
    double y = row;
    double sum = 0.0;
    for (std::uint32_t octave = 0; octave < 9; ++octave)
    {
        sum += amplitude * gradientNoise(x / wavelength, y / wavelength, seed * 31u + octave);
        const double turned = 0.8 * x - 0.6 * y;
        y = 0.6 * x + 0.8 * y + 0.37 * wavelength;
        x = turned + 0.61 * wavelength;
        amplitude *= 1.8;
        wavelength *= 2.0;
    }
    return sum;
}

/// A bowl as deep as 0.4 of its radius with a rim, the steepest slope about 43°, on ground that
/// rises by 2 % to the north-east.
double crater(int column, int row, int width, int height, std::uint32_t seed)
{
    // Seeds move the centre by up to a tenth of the tile.
    const std::uint32_t bits = hash(0, 0, seed);
    const double x = column - (width - 1) * (0.4 + 0.2 * unitByte(bits, 0));
    const double y = row - (height - 1) * (0.4 + 0.2 * unitByte(bits, 8));
    const double radius = std::max(1.0, 0.25 * std::max(width, height));
    const double r = std::sqrt(x * x + y * y) / radius;
    const double inside = std::max(0.0, 1.0 - r * r);
    const double fromRim = (r - 1.0) / 0.4;
    const double rim = std::max(0.0, 1.0 - fromRim * fromRim);
    return radius * (0.1 * rim * rim - 0.4 * inside * inside) + 0.02 * x + 0.01 * y;
}

double spike(int column, int row, std::uint32_t seed, std::uint32_t oneIn)
{
    const std::uint32_t bits = hash(column, row, seed ^ 0x51b1ceu);
    if ((bits & 0xffffu) >= 65536u / oneIn)
        return 0.0;
    const double size = 1.0 + 9.0 * unitByte(bits, 16);
    return (bits >> 24) < 64u ? -size : size; // one in four is a pit
}

/// Height of the wall that crosses this post, or 0: one wall in each block of 48 × 48 posts.
double wall(int column, int row, std::uint32_t seed)
{
    constexpr int block = 48;
    const std::uint32_t bits = hash(column / block, row / block, seed ^ 0x3a11u);
    const bool runsNorth = (bits & 1u) != 0;
    const int along = (runsNorth ? row : column) % block;
    const int across = (runsNorth ? column : row) % block;
    const int place = static_cast<int>((bits >> 1) % block);
    const int start = static_cast<int>((bits >> 8) % 24u);
    const int length = 8 + static_cast<int>((bits >> 16) % 32u);
    const bool hit = across == place && along >= start && along < start + length;
    return hit ? 1.0 + 5.0 * unitByte(bits, 24) : 0.0;
}

double cliffs(int column, int row, std::uint32_t seed)
{
    // Terraces three posts high; a twelfth of the height range becomes the cliff between two.
    constexpr double step = 3.0;
    const double level = fractal(column, row, seed) / step;
    const double base = std::floor(level);
    const double rest = std::clamp((level - base - 0.5) * 12.0 + 0.5, 0.0, 1.0);
    const double ground = step * (base + rest) + 0.15 * (level - base);
    return ground + wall(column, row, seed) + spike(column, row, seed, 500);
}

} // namespace

const char* toString(TerrainKind kind)
{
    switch (kind)
    {
    case TerrainKind::Crater:
        return "crater";
    case TerrainKind::Cliffs:
        return "cliffs";
    case TerrainKind::Spikes:
        return "spikes";
    default:
        return "fractal";
    }
}

const std::vector<TerrainKind>& allTerrainKinds()
{
    static const std::vector<TerrainKind> kinds = {TerrainKind::Fractal, TerrainKind::Crater,
                                                   TerrainKind::Cliffs, TerrainKind::Spikes};
    return kinds;
}

bool fromString(const std::string& text, TerrainKind& kind)
{
    for (TerrainKind candidate : allTerrainKinds())
        if (text == toString(candidate))
        {
            kind = candidate;
            return true;
        }
    return false;
}

Result<DemTile> generateTerrain(TerrainKind kind, int width, int height, double spacing,
                                std::uint32_t seed)
{
    constexpr std::int64_t mostPosts = std::int64_t(1) << 30;
    if (width < 1 || height < 1 || std::int64_t(width) * height > mostPosts ||
        !(spacing >= 0.001 && spacing <= 10000.0))
    {
        std::ostringstream text;
        text << "generated terrain of " << width << " x " << height << " posts, spacing " << spacing
             << " m: needs 1 x 1 ... 2^30 posts and 0.001 ... 10000 m";
        return Error{ErrorCode::Invalid, text.str()};
    }
    DemTile tile(width, height, spacing);
    tile.mapStepX = tile.mapStepY = spacing;
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
        {
            double h = 0.0;
            switch (kind)
            {
            case TerrainKind::Fractal:
                h = fractal(column, row, seed);
                break;
            case TerrainKind::Crater:
                h = crater(column, row, width, height, seed);
                break;
            case TerrainKind::Cliffs:
                h = cliffs(column, row, seed);
                break;
            case TerrainKind::Spikes:
                h = spike(column, row, seed, 100);
                break;
            }
            tile.setHeight(column, row, static_cast<float>(h * spacing));
        }
    return tile;
}

} // namespace osgTerrainLight
