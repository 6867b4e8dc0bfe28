#pragma once

#include "reference/ExhaustiveHorizon.h"

#include <array>
#include <vector>

/// Light from exhaustive horizons, in double, by numerical quadrature: nothing here shares algebra
/// with the code under test.
namespace osgTerrainLight::reference
{

/// x east, y north, z up.
using Vector3 = std::array<double, 3>;

/// Unit normal at a post: the sum of the unnormalised normals, at the post, of the up to four
/// adjacent bilinear cells that have all their corners (TW10 §7). With all four it is the normal of
/// central differences. (0, 0, 1) where no cell is complete.
Vector3 surfaceNormal(const DemTile& tile, int column, int row);

/// Horizons of one post at equally spaced azimuths.
struct HorizonRing
{
    /// Tangents; that of index k looks towards 2π(k + offset)/size, counter-clockwise from east.
    std::vector<double> slopes;
    double offset = 0.5;

    double azimuth(std::size_t index) const; ///< radians, counter-clockwise from east
};

/// offset 0.5: midpoints, so that no azimuth of a small ring lies on a grid axis.
HorizonRing horizonRing(const DemTile& tile, int column, int row, int count = 720,
                        double offset = 0.5, const HorizonOptions& options = {});

/// The three sky-view factors in use; of the sky above the horizontal 1 where nothing rises, on
/// level ground.
enum class SkyViewDefinition
{
    SolidAngle, ///< visible part of the upper hemisphere's solid angle; 0.75 on a 45° ramp
    Horizontal, ///< weighed by the cosine to the zenith
    Surface     ///< weighed by the cosine to the normal; (1 + cos S)/2 on a ramp of angle S
};

/// Where a horizon lies below the horizontal, is there sky between?
enum class SkyExtent
{
    AboveHorizontal, ///< no: what DESIGN's three definitions say
    DownToHorizon    ///< yes: a sky all around; Surface only (the others stop at the horizontal)
};

/// Sky-view factor, 0 … 1. `Surface` is also the irradiance / π by a uniform sky of radiance 1.
double skyViewFactor(const HorizonRing& ring, SkyViewDefinition definition, const Vector3& normal,
                     SkyExtent extent = SkyExtent::AboveHorizontal);

/// The sun's disc. Degrees; azimuth clockwise from north.
struct Sun
{
    double azimuth = 315.0;
    double elevation = 35.0;
    double angularRadius = 0.2666;
};

/// Visible part of the disc's solid angle, 0 … 1, from horizons at `strips` azimuths across the
/// disc, each strip exact in elevation. The surface's own facing is not in it, its own rise is.
double sunFraction(const DemTile& tile, int column, int row, const Sun& sun, int strips = 33,
                   SkyExtent extent = SkyExtent::AboveHorizontal,
                   const HorizonOptions& options = {});

/// Visible part of a flat disc above a straight horizon: a circular segment. Degrees.
double segmentFraction(double sunElevation, double horizonElevation, double angularRadius);

} // namespace osgTerrainLight::reference
