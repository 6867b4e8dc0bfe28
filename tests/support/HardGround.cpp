#include "support/HardGround.h"

#include "core/SyntheticTerrain.h"
#include "support/AnalyticTerrain.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace osgTerrainLight::hard
{

namespace
{
constexpr double pi = 3.14159265358979323846;

/// min … max, the same on every machine.
double between(std::mt19937& random, double min, double max)
{
    return min + (max - min) * static_cast<double>(random()) / 4294967295.0;
}

struct Wave
{
    double east, north, phase; // [rad per post], [rad]
    double at(int column, int row) const { return std::sin(east * column + north * row + phase); }
};

Wave wave(std::mt19937& random, double shortest, double longest)
{
    const double number = 2.0 * pi / between(random, shortest, longest);
    const double turned = between(random, 0.0, 2.0 * pi);
    return {number * std::cos(turned), number * std::sin(turned), between(random, 0.0, 2.0 * pi)};
}
} // namespace

DemTile town(int side, std::uint32_t seed)
{
    std::mt19937 random(seed);
    // Where streets and blocks begin and end, along both axes.
    const auto cuts = [&]
    {
        std::vector<int> edges = {static_cast<int>(between(random, 2.0, 8.0))};
        while (edges.back() < side)
            edges.push_back(edges.back() + static_cast<int>(edges.size() % 2 == 1
                                                                ? between(random, 8.0, 22.0)
                                                                : between(random, 5.0, 12.99)));
        return edges;
    };
    const std::vector<int> east = cuts(), north = cuts();
    DemTile tile(side, side, 1.0);
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column)
            tile.setHeight(column, row, 0.0f);
    for (std::size_t y = 0; y + 1 < north.size(); y += 2)
        for (std::size_t x = 0; x + 1 < east.size(); x += 2)
        {
            const float roof = static_cast<float>(between(random, 4.0, 16.0));
            for (int row = north[y]; row < std::min(north[y + 1], side); ++row)
                for (int column = east[x]; column < std::min(east[x + 1], side); ++column)
                    tile.setHeight(column, row, roof);
        }
    return tile;
}

DemTile mine(int side, std::uint32_t seed)
{
    std::mt19937 random(seed);
    const Wave one = wave(random, 40.0, 80.0), other = wave(random, 60.0, 120.0);
    const double middle = (side - 1) / 2.0;
    return analytic::makeTile(side, side, 5.0,
                              [&](int column, int row)
                              {
                                  // A bench is 5 posts wide, 25 m for 12 m of depth.
                                  const double away =
                                      std::hypot(column - middle, row - middle) / middle;
                                  const double benches = std::max(0.0, 1.0 - away) * middle / 5.0 +
                                                         0.8 * one.at(column, row) +
                                                         0.8 * other.at(column, row);
                                  return -12.0 * std::floor(std::max(0.0, benches));
                              });
}

DemTile dunes(int side, std::uint32_t seed)
{
    std::mt19937 random(seed);
    const Wave bend = wave(random, 60.0, 90.0), height = wave(random, 50.0, 70.0);
    const double phase = between(random, 0.0, 1.0);
    return analytic::makeTile(
        side, side, 2.0,
        [&](int column, int row)
        {
            const double along = column / 36.0 + phase + 0.25 * bend.at(column, row);
            const double place = along - std::floor(along);
            // Windward over 0.72 of a wave, leeward over 0.28: 6.3 m over 10
            // posts are 32 degrees.
            const double profile =
                place < 0.72 ? 0.5 - 0.5 * std::cos(pi * place / 0.72) : (1.0 - place) / 0.28;
            return 12.6 * profile * (0.8 + 0.2 * height.at(column, row));
        });
}

DemTile sinkholes(int side, std::uint32_t seed)
{
    std::mt19937 random(seed);
    struct Hole
    {
        double column, row, radius, depth;
    };
    std::vector<Hole> holes;
    for (int i = 0; i < side * side / 500; ++i)
    {
        const double radius = between(random, 4.0, 14.0);
        holes.push_back({between(random, 0.0, side), between(random, 0.0, side), radius,
                         between(random, 0.5, 1.2) * radius * 2.0});
    }
    const Wave swell = wave(random, 60.0, 100.0);
    return analytic::makeTile(
        side, side, 2.0,
        [&](int column, int row)
        {
            double depth = 0.0;
            for (const Hole& hole : holes)
            {
                const double r = std::hypot(column - hole.column, row - hole.row) / hole.radius;
                depth = std::max(depth, hole.depth * std::sqrt(std::max(0.0, 1.0 - r * r)));
            }
            return 2.0 * swell.at(column, row) - depth;
        });
}

DemTile corrugation(int width, int height, double sidePosts, double tangent, double turned,
                    double up)
{
    const double cosine = std::cos(turned * pi / 180.0);
    const double sine = std::sin(turned * pi / 180.0);
    return analytic::makeTile(
        width, height, 1.0,
        [&](int column, int row)
        {
            const double along = (column - width / 2) * cosine + (row - height / 2) * sine - up;
            const double place = along - 2.0 * sidePosts * std::floor(along / (2.0 * sidePosts));
            return std::min(place, 2.0 * sidePosts - place) * tangent;
        });
}

double corrugationBounce(double sidePosts, double tangent, double elevation, double up)
{
    const double slope = std::atan(tangent);
    const double sun = elevation * pi / 180.0;
    // Over the bottom at 0 the other side rises as x · tangent; the ray that grazes the crest at
    // -sidePosts meets it here.
    const double edge = sidePosts * (tangent - std::tan(sun)) / (tangent + std::tan(sun));
    const double radiance = std::sin(slope + sun) / pi;
    // Sine of the angle from the receiver's normal at which a place of the other side is seen.
    const auto sine = [&](double x)
    {
        const double east = x + up;
        const double high = (x - up) * tangent;
        return (high * std::sin(slope) - east * std::cos(slope)) / std::hypot(east, high);
    };
    return radiance * (sine(sidePosts) - sine(edge)) / 2.0;
}

} // namespace osgTerrainLight::hard
