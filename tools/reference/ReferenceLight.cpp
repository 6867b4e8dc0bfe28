#include "reference/ReferenceLight.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace osgTerrainLight::reference
{

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180.0;

/// Integral over a … b of a smooth function: Gauss-Legendre with 8 nodes on each of 4 panels.
template <class Function>
double integrate(double a, double b, const Function& f)
{
    constexpr double nodes[] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                0.9602898564975363};
    constexpr double weights[] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                  0.1012285362903763};
    constexpr int panels = 4;
    const double half = (b - a) / (2 * panels);
    double sum = 0.0;
    for (int panel = 0; panel < panels; ++panel)
    {
        const double middle = a + (2 * panel + 1) * half;
        for (int i = 0; i < 4; ++i)
            sum += weights[i] * (f(middle - half * nodes[i]) + f(middle + half * nodes[i]));
    }
    return sum * half;
}

/// Irradiance through one slice, per radian of azimuth, of a sky of radiance 1 above `lowest`.
double sliceIrradiance(double lowest, double azimuth, const Vector3& normal)
{
    const auto cosine = [&](double elevation)
    {
        const double c = std::cos(elevation);
        return normal[0] * c * std::cos(azimuth) + normal[1] * c * std::sin(azimuth) +
               normal[2] * std::sin(elevation);
    };
    // From where N·e is negative it rises through 0 once; bisection finds the place.
    double from = lowest;
    if (cosine(lowest) < 0.0)
    {
        double positive = pi / 2.0;
        for (int i = 0; i < 60; ++i)
        {
            const double middle = 0.5 * (from + positive);
            (cosine(middle) < 0.0 ? from : positive) = middle;
        }
    }
    return integrate(from, pi / 2.0, [&](double e) { return cosine(e) * std::cos(e); });
}
} // namespace

Vector3 surfaceNormal(const DemTile& tile, int column, int row)
{
    const double eastStep = tile.eastSpacing(row);
    const double northStep = tile.northSpacing;
    const auto valid = [&](int c, int r)
    { return c >= 0 && r >= 0 && c < tile.width() && r < tile.height() && tile.isValid(c, r); };
    const auto heightAt = [&](int c, int r) { return double(tile.heightAt(c, r)); };
    Vector3 sum = {0.0, 0.0, 0.0};
    for (int dy : {-1, 1})
        for (int dx : {-1, 1})
            if (valid(column, row) && valid(column + dx, row) && valid(column, row + dy) &&
                valid(column + dx, row + dy))
            {
                const double here = heightAt(column, row);
                // Cross product of the edges (eastStep, 0, a) and (0, northStep, b).
                const double a = dx * (heightAt(column + dx, row) - here);
                const double b = dy * (heightAt(column, row + dy) - here);
                sum[0] -= a * northStep;
                sum[1] -= b * eastStep;
                sum[2] += eastStep * northStep;
            }
    const double length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    if (length == 0.0)
        return {0.0, 0.0, 1.0};
    return {sum[0] / length, sum[1] / length, sum[2] / length};
}

double HorizonRing::azimuth(std::size_t index) const
{
    return 2.0 * pi * (static_cast<double>(index) + offset) / static_cast<double>(slopes.size());
}

HorizonRing horizonRing(const DemTile& tile, int column, int row, int count, double offset,
                        const HorizonOptions& options)
{
    assert(count > 0);
    HorizonRing ring;
    ring.offset = offset;
    for (int k = 0; k < count; ++k)
    {
        const MapDirection direction = directionOfCompass(90.0 - 360.0 * (k + offset) / count);
        ring.slopes.push_back(exhaustiveHorizon(tile, column, row, direction, options).slope);
    }
    return ring;
}

double skyViewFactor(const HorizonRing& ring, SkyViewDefinition definition, const Vector3& normal,
                     SkyExtent extent)
{
    double sum = 0.0;
    for (std::size_t k = 0; k < ring.slopes.size(); ++k)
    {
        const double elevation = std::atan(ring.slopes[k]);
        const double lowest = std::max(elevation, 0.0);
        switch (definition)
        {
        case SkyViewDefinition::SolidAngle: // per slice ∫ cos ω dω
            sum += integrate(lowest, pi / 2.0, [](double e) { return std::cos(e); });
            break;
        case SkyViewDefinition::Horizontal: // (1/π) ∫∫ sin ω cos ω dω dφ
            sum += 2.0 * sliceIrradiance(lowest, ring.azimuth(k), {0.0, 0.0, 1.0});
            break;
        case SkyViewDefinition::Surface:
            sum += 2.0 * sliceIrradiance(extent == SkyExtent::DownToHorizon ? elevation : lowest,
                                         ring.azimuth(k), normal);
            break;
        }
    }
    return sum / static_cast<double>(ring.slopes.size());
}

double sunFraction(const DemTile& tile, int column, int row, const Sun& sun, int strips,
                   SkyExtent extent, const HorizonOptions& options)
{
    assert(strips > 0);
    const double elevation = sun.elevation * degree;
    const double radius = sun.angularRadius * degree;
    // The disc reaches this far in azimuth; all around where the zenith is in it.
    const double sine = std::sin(radius) / std::cos(elevation);
    const double reach = sine >= 0.0 && sine < 1.0 ? std::asin(sine) : pi;
    double visible = 0.0;
    double total = 0.0;
    for (int i = 0; i < strips; ++i)
    {
        // Strips crowd towards the disc's ends, where its height goes as a square root.
        const double place = pi * ((i + 0.5) / strips - 0.5);
        const double offset = reach * std::sin(place);
        // Directions at this azimuth within the radius of the centre:
        // sin h sin e + cos h cos e cos(offset) = scale · cos(e − middle) ≥ cos(radius).
        const double up = std::sin(elevation);
        const double along = std::cos(elevation) * std::cos(offset);
        const double scale = std::hypot(up, along);
        if (scale <= std::cos(radius))
            continue;
        const double middle = std::atan2(up, along);
        const double half = std::acos(std::min(1.0, std::cos(radius) / scale));
        const double low = std::clamp(middle - half, -pi / 2.0, pi / 2.0);
        const double high = std::clamp(middle + half, -pi / 2.0, pi / 2.0);
        const MapDirection direction = directionOfCompass(sun.azimuth + offset / degree);
        double horizon = std::atan(exhaustiveHorizon(tile, column, row, direction, options).slope);
        if (extent == SkyExtent::AboveHorizontal)
            horizon = std::max(horizon, 0.0);
        const double weight = std::cos(place);
        total += weight * (std::sin(high) - std::sin(low));
        visible += weight * (std::sin(high) - std::sin(std::clamp(horizon, low, high)));
    }
    return visible / total;
}

double segmentFraction(double sunElevation, double horizonElevation, double angularRadius)
{
    const double x = std::clamp((sunElevation - horizonElevation) / angularRadius, -1.0, 1.0);
    return (std::acos(-x) + x * std::sqrt(1.0 - x * x)) / pi;
}

} // namespace osgTerrainLight::reference
