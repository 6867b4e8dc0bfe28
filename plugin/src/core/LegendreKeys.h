#pragma once

#include <osgTerrainLight/SkyLight.h>

#include "core/AzimuthSet.h"
#include "core/WedgeMatrices.h"

#include <vector>

namespace osgTerrainLight
{

/// One azimuth of a key light, for the scheme of NS09 (section 6): a light's azimuths reach from
/// one end of its range to the other, and the first and last take part in one wedge only.
struct LegendreKey
{
    MapDirection direction;
    AzimuthWeights weights;             ///< with which the slice enters the harmonics
    double lowest = 0.0, highest = 0.0; ///< elevations between which the light shines [rad]
    Rgb radiance = {};
    /// Of the sun's slices: 1 / coefficient (0, 0) of the whole unoccluded sun. Else 0.
    double perSun = 0.0;
};

/// Slices of a light: the paper's 3, more where they would be more than 45° apart; at most 9.
constexpr int maxRaysPerKeyLight = 9;

/// Of all key lights with something above the horizontal, then of the sun, if it is on and above
/// it.
///
/// The sun is a key light too: the rectangle in azimuth and elevation about its disc, of the
/// radiance that gives a surface that faces the middle of the disc sunIrradiance. Harmonics of
/// order 4 know no smaller light than that, so its radius is at least 0.1°, and 1° where the disc
/// holds the zenith (and the light is all around it): less would be lost to float rounding.
std::vector<LegendreKey> legendreKeys(const SkyLight& sky);

} // namespace osgTerrainLight
