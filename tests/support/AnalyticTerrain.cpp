#include "support/AnalyticTerrain.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace osgTerrainLight::analytic
{

namespace
{
constexpr double pi = 3.14159265358979323846;

/// Square of the distance from a post [spacings²].
double squaredDistance(int column, int row, int centreColumn, int centreRow)
{
    const double x = column - centreColumn;
    const double y = row - centreRow;
    return x * x + y * y;
}
} // namespace

DemTile plane(int width, int height, double spacing, double heightOfPlane)
{
    return makeTile(width, height, spacing, [&](int, int) { return heightOfPlane; });
}

DemTile ramp(int width, int height, double spacing, double slopeEast, double slopeNorth)
{
    return makeTile(width, height, spacing,
                    [&](int column, int row)
                    { return spacing * (slopeEast * column + slopeNorth * row); });
}

double rampHorizon(double slopeEast, double slopeNorth, const MapDirection& direction)
{
    return slopeEast * direction.east + slopeNorth * direction.north;
}

// Uphill of a ramp of slope T = tan S the horizon's slope is T cos φ, φ from the steepest ascent;
// downhill the horizontal bounds the sky. So 1 − SVF is an integral over −π/2 … π/2:
//   solid angle: (1/2π) ∫ sin ω dφ, sin ω = T cos φ / √(1 + T² cos² φ). With s = sin φ it is
//                (1/2π) [asin(s sin S)] · 2 = S/π.
//   horizontal:  (1/2π) ∫ sin² ω dφ = ½ − (1/2π) ∫ dφ / (1 + T² cos² φ), and with τ = tan φ that is
//                ½ − (1/2π) [cos S · atan(τ cos S)] = ½ − ½ cos S.
//   surface:     light from the lune between the ramp and the horizontal's other side reaches the
//                ramp as it reaches the ground, mirrored in the plane between: the same.
SkyView rampSkyView(double slope)
{
    const double s = std::atan(slope);
    const double half = (1.0 + std::cos(s)) / 2.0;
    return {1.0 - s / pi, half, half};
}

DemTile wall(int width, int height, double spacing, int firstColumn, double rise)
{
    return makeTile(width, height, spacing,
                    [&](int column, int) { return column >= firstColumn ? rise : 0.0; });
}

// The ray meets the crest after distance / cos φ. Its face is a straight slope below the crest.
double wallHorizon(double rise, double distance, const MapDirection& direction)
{
    return std::max(0.0, rise * direction.east / distance);
}

// The integrals of the ramp with T = rise / distance, to ±atan(halfLength / distance) instead of
// ±π/2.
SkyView wallSkyView(double rise, double distance, double halfLength)
{
    const double s = std::atan(rise / distance);
    const double end = std::atan(halfLength / distance);
    const double level = 1.0 - end / pi + std::cos(s) / pi * std::atan(std::cos(s) * std::tan(end));
    return {1.0 - std::asin(std::sin(s) * std::sin(end)) / pi, level, level};
}

DemTile hillock(int width, int height, double spacing, int centreColumn, int centreRow,
                int footRadius, int topRadius)
{
    return makeTile(width, height, spacing,
                    [&](int column, int row)
                    {
                        const int away =
                            std::max(std::abs(column - centreColumn), std::abs(row - centreRow));
                        return spacing * std::clamp(footRadius - away, 0, footRadius - topRadius);
                    });
}

double hillockCornerHorizon()
{
    return std::sqrt(0.5);
}

DemTile cone(int width, int height, double spacing, int centreColumn, int centreRow, double rise,
             double radius)
{
    return makeTile(width, height, spacing,
                    [&](int column, int row)
                    {
                        const double r =
                            spacing *
                            std::sqrt(squaredDistance(column, row, centreColumn, centreRow));
                        return std::max(0.0, rise * (1.0 - r / radius));
                    });
}

// The silhouette is the two planes through the receiver that touch the cone along a generator. Such
// a plane has the gradient of the cone's side, rise / radius, and meets the apex at slope rise /
// distance; so its gradient has that component towards the axis and the rest beside it.
double coneHorizon(double rise, double radius, double distance, double offset)
{
    const double ahead = rise / distance;
    const double side = rise / radius;
    const double beside = std::sqrt(side * side - ahead * ahead);
    return std::cos(offset) <= 0.0
               ? 0.0
               : std::max(0.0, ahead * std::cos(offset) - beside * std::abs(std::sin(offset)));
}

DemTile valley(int width, int height, double spacing, int bottomColumn, double slope)
{
    return makeTile(width, height, spacing,
                    [&](int column, int)
                    { return spacing * slope * std::abs(column - bottomColumn); });
}

double valleyHorizon(double slope, const MapDirection& direction)
{
    return slope * std::abs(direction.east);
}

// Twice the ramp's integrals: both sides rise. The normal at the bottom is vertical by symmetry.
SkyView valleySkyView(double slope)
{
    const double s = std::atan(slope);
    return {1.0 - 2.0 * s / pi, std::cos(s), std::cos(s)};
}

DemTile pit(int width, int height, double spacing, int centreColumn, int centreRow, double radius)
{
    return makeTile(width, height, spacing,
                    [&](int column, int row)
                    {
                        const double r2 = spacing * spacing *
                                          squaredDistance(column, row, centreColumn, centreRow);
                        return -std::sqrt(std::max(0.0, radius * radius - r2));
                    });
}

SkyView pitBottomSkyView()
{
    return {1.0 - std::sqrt(0.5), 0.5, 0.5};
}

// Between two patches of one sphere cos cos / (π d²) is 1 / (4π R²) everywhere, so the part of the
// light that comes in by the opening is the part of the sphere that is missing: half. The opening
// lies above the horizontal of each point.
double pitWallSurfaceSkyView()
{
    return 0.5;
}

DemTile dome(int width, int height, double spacing, int centreColumn, int centreRow, double radius)
{
    return makeTile(width, height, spacing,
                    [&](int column, int row)
                    {
                        const double r2 = spacing * spacing *
                                          squaredDistance(column, row, centreColumn, centreRow);
                        return std::sqrt(std::max(0.0, radius * radius - r2));
                    });
}

// The vertical plane through the ray cuts the sphere in a circle of radius ρ, centre at the ground,
// distance cos(offset) ahead; the tangent to it has the sine ρ / that distance.
double domeHorizon(double radius, double distance, double offset)
{
    const double beside = distance * std::sin(offset);
    const double ahead = distance * std::cos(offset);
    const double squared = radius * radius - beside * beside;
    return ahead <= 0.0 || squared <= 0.0 ? 0.0 : std::sqrt(squared / (ahead * ahead - squared));
}

DemTile staircase(int width, int height, double spacing, int tread, double rise)
{
    return makeTile(width, height, spacing,
                    [&](int column, int) { return rise * (column / tread); });
}

// The n-th edge ahead is n·rise higher and n·tread − (column mod tread) columns away: the first is
// the steepest. From a tread's own edge all are equal.
double staircaseHorizon(double spacing, int tread, double rise, int column,
                        const MapDirection& direction)
{
    return rise * direction.east / (spacing * (tread - column % tread));
}

DemTile checkerboard(int width, int height, double spacing, double rise)
{
    return makeTile(width, height, spacing,
                    [&](int column, int row) { return (column + row) % 2 == 0 ? 0.0 : rise; });
}

// On the diagonal of a cell with corners 0, rise, rise, 0 the height is 2·rise·(u − u²), u the part
// of the diagonal √2·spacing.
double checkerboardDiagonalHorizon(double spacing, double rise)
{
    return std::sqrt(2.0) * rise / spacing;
}

} // namespace osgTerrainLight::analytic
