#pragma once

#include <osgTerrainLight/Export.h>

#include <array>

namespace osgTerrainLight
{

/// Linear red, green, blue.
using Rgb = std::array<float, 3>;

/// The light above the terrain: a sky and a sun. Scene-linear, in units of the user's choice; the
/// defaults make a sunlit white surface about 1.
struct OSGTERRAINLIGHT_EXPORT SkyLight
{
    bool skyEnabled = true;
    /// Radiance of the uniform sky [W m⁻² sr⁻¹ or relative], each ≥ 0.
    Rgb skyRadiance = {0.21f, 0.26f, 0.35f};

    bool sunEnabled = true;
    /// Degrees clockwise from north, any finite value (taken modulo 360).
    double sunAzimuth = 315.0;
    /// Degrees above the horizontal, −90 … 90, geometric (no refraction).
    double sunElevation = 35.0;
    /// Irradiance on a surface that faces the unoccluded sun [W m⁻² or relative], each ≥ 0.
    Rgb sunIrradiance = {3.0f, 2.85f, 2.6f};
    /// Angular radius of the disc [degrees], 0.01 … 10. The sun's is 0.2666.
    double sunAngularRadius = 0.2666;

    /// Unit vector towards the sun: x east, y north, z up.
    std::array<double, 3> sunDirection() const;
};

} // namespace osgTerrainLight
