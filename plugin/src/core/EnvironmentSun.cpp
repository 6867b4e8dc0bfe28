#include "core/EnvironmentSun.h"

#include "core/Luminance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180.0;
/// Of the flux above the horizontal. What is less than a hundredth of the light may have a shadow
/// as wide as a slice of azimuth.
constexpr double leastShare = 0.01;
/// Of the source's mean radiance over that of the ring around it.
constexpr double leastContrast = 10.0;
constexpr double reach = 2.5 * degree;
/// The disc that SkyLight allows.
constexpr double leastRadius = 0.01 * degree;
constexpr double greatestRadius = 10.0 * degree;
/// Sources that are looked at, from the brightest texel on.
constexpr int mostCandidates = 16;

using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double luminanceOf(const Vector& c)
{
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

double solidAngleOfCap(double radius)
{
    const double sine = std::sin(0.5 * radius);
    return 4.0 * pi * sine * sine;
}

/// A picture's texels as directions.
class Texels
{
public:
    explicit Texels(const Environment& environment)
        : _columns(environment.columns), _rows(environment.rows)
    {
    }

    double width() const { return 2.0 * pi / _columns; }
    double height() const { return pi / _rows; }
    double elevation(int row) const { return height() * (row + 0.5) - 0.5 * pi; }
    /// Exact, about the row's middle, so that no digits are lost.
    double solidAngle(int row) const
    {
        return width() * 2.0 * std::sin(0.5 * height()) * std::cos(elevation(row));
    }
    Vector direction(int column, int row) const
    {
        const double azimuth = width() * (column + 0.5);
        const double along = std::cos(elevation(row));
        return {along * std::cos(azimuth), along * std::sin(azimuth), std::sin(elevation(row))};
    }

    /// f(column, row, direction) of each texel whose centre is within radius of a unit direction.
    template <class Function>
    void forCap(const Vector& centre, double radius, const Function& f) const
    {
        const double up = std::asin(std::clamp(centre[2], -1.0, 1.0));
        const double azimuth = std::atan2(centre[1], centre[0]);
        const double least = std::cos(radius);
        const int first = static_cast<int>(std::floor((up - radius + 0.5 * pi) / height()));
        const int last = static_cast<int>(std::ceil((up + radius + 0.5 * pi) / height()));
        for (int row = std::max(first, 0); row <= std::min(last, _rows - 1); ++row)
        {
            // Half the row's chord: all of it where the cap holds the pole.
            const double e = elevation(row);
            const double scale = std::cos(e) * std::cos(up);
            const double cosine = least - std::sin(e) * std::sin(up);
            if (cosine > scale)
                continue;
            const double half = cosine <= -scale ? pi : std::acos(cosine / scale);
            const int begin = static_cast<int>(std::ceil((azimuth - half) / width() - 0.5));
            const int end = static_cast<int>(std::floor((azimuth + half) / width() - 0.5));
            for (int k = begin; k < std::min(end + 1, begin + _columns); ++k)
            {
                const int column = (k % _columns + _columns) % _columns;
                f(column, row, direction(column, row));
            }
        }
    }

private:
    int _columns, _rows;
};

struct Source
{
    Vector centre = {};
    Vector surroundings = {}; ///< mean radiance of the ring
    Vector flux = {};         ///< of what exceeds them
    double radius = 0.0;      ///< of the disc of the same second moment
};

/// What is within a cap about a first guess of its centre.
Source measured(const Environment& environment, const Texels& texels, Vector centre, double cap)
{
    Source source;
    for (int turn = 0; turn < 4; ++turn)
    {
        source = {};
        source.centre = centre;
        double ring = 0.0;
        texels.forCap(centre, 1.5 * cap,
                      [&](int column, int row, const Vector& direction)
                      {
                          if (direction[2] <= 0.0 || dot(direction, centre) >= std::cos(cap))
                              return;
                          ring += texels.solidAngle(row);
                          for (std::size_t c = 0; c < 3; ++c)
                              source.surroundings[c] +=
                                  texels.solidAngle(row) *
                                  static_cast<double>(environment.at(column, row)[c]);
                      });
        for (double& channel : source.surroundings)
            channel /= std::max(ring, 1e-30);
        Vector sum = {};
        double moment = 0.0;
        texels.forCap(centre, cap,
                      [&](int column, int row, const Vector& direction)
                      {
                          Vector excess = {};
                          for (std::size_t c = 0; c < 3; ++c)
                          {
                              excess[c] =
                                  texels.solidAngle(row) *
                                  std::max(static_cast<double>(environment.at(column, row)[c]) -
                                               source.surroundings[c],
                                           0.0);
                              source.flux[c] += excess[c];
                          }
                          const double weight = luminanceOf(excess);
                          for (std::size_t c = 0; c < 3; ++c)
                              sum[c] += weight * direction[c];
                          const double across = texels.width() * std::cos(texels.elevation(row));
                          moment +=
                              weight * (across * across + texels.height() * texels.height()) / 12.0;
                      });
        const double weight = luminanceOf(source.flux);
        const double length = std::sqrt(dot(sum, sum));
        if (!(length > 0.0))
            return source;
        for (std::size_t c = 0; c < 3; ++c)
            centre[c] = sum[c] / length;
        source.centre = centre;
        // The mean square distance from the centroid is 2 (1 - |mean direction|) for small ones;
        // a disc's is half its radius squared.
        moment = moment / weight + 2.0 * std::max(0.0, 1.0 - length / weight);
        source.radius = std::clamp(std::sqrt(2.0 * moment), leastRadius, greatestRadius);
    }
    return source;
}
} // namespace

void takeSun(Environment& environment)
{
    const Texels texels(environment);
    const double cap = std::max(reach, 1.5 * std::max(texels.width(), texels.height()));
    if (cap > greatestRadius)
        return;
    double flux = 0.0;
    const auto isAbove = [&](int row) { return 2 * row + 1 > environment.rows; };
    for (int row = 0; row < environment.rows; ++row)
        for (int column = 0; isAbove(row) && column < environment.columns; ++column)
            flux += texels.solidAngle(row) * luminance(environment.at(column, row));

    // A source of that share has a texel that is brighter than its mean.
    struct Bright
    {
        double luminance;
        int column, row;
    };
    std::vector<Bright> bright;
    const double threshold = leastShare * flux / solidAngleOfCap(cap);
    for (int row = 0; row < environment.rows; ++row)
        for (int column = 0; isAbove(row) && column < environment.columns; ++column)
            if (const double value = luminance(environment.at(column, row)); value > threshold)
                bright.push_back({value, column, row});
    std::sort(bright.begin(), bright.end(),
              [](const Bright& a, const Bright& b) { return a.luminance > b.luminance; });

    Source best;
    double most = leastShare * flux;
    std::vector<Vector> seen;
    for (const Bright& texel : bright)
    {
        const Vector direction = texels.direction(texel.column, texel.row);
        if (std::any_of(seen.begin(), seen.end(),
                        [&](const Vector& other) { return dot(other, direction) > std::cos(cap); }))
            continue;
        seen.push_back(direction);
        const Source source = measured(environment, texels, direction, cap);
        const double found = luminanceOf(source.flux);
        if (source.centre[2] > 0.0 && found > most &&
            found >=
                leastContrast * luminanceOf(source.surroundings) * solidAngleOfCap(source.radius))
        {
            best = source;
            most = found;
        }
        if (seen.size() == mostCandidates)
            break;
    }
    if (best.radius == 0.0)
        return;

    Vector taken = {};
    texels.forCap(best.centre, cap,
                  [&](int column, int row, const Vector&)
                  {
                      Rgb& texel =
                          environment.radiance[static_cast<std::size_t>(row) *
                                                   static_cast<std::size_t>(environment.columns) +
                                               static_cast<std::size_t>(column)];
                      for (std::size_t c = 0; c < 3; ++c)
                      {
                          const float rest = static_cast<float>(best.surroundings[c]);
                          if (texel[c] <= rest)
                              continue;
                          taken[c] += texels.solidAngle(row) *
                                      (static_cast<double>(texel[c]) - static_cast<double>(rest));
                          texel[c] = rest;
                      }
                  });
    environment.hasSun = true;
    environment.sunAzimuth =
        std::fmod(450.0 - std::atan2(best.centre[1], best.centre[0]) / degree, 360.0);
    environment.sunElevation = std::asin(std::clamp(best.centre[2], -1.0, 1.0)) / degree;
    environment.sunAngularRadius = best.radius / degree;
    // A disc's flux over its irradiance on a surface that faces it is 2 (1 - cos r) / sin^2 r.
    for (std::size_t c = 0; c < 3; ++c)
        environment.sunIrradiance[c] =
            static_cast<float>(taken[c] * 0.5 * (1.0 + std::cos(best.radius)));
}

} // namespace osgTerrainLight
