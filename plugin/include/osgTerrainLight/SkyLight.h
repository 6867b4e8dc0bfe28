#pragma once

#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/SunPosition.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace osgTerrainLight
{
struct Environment;

/// Linear red, green, blue.
using Rgb = std::array<float, 3>;

/// An area light at infinity of restricted azimuth and elevation, of one radiance (Nowrouzezahrai
/// and Snyder 2009, sections 6 and 7). What of it is below the horizontal gives no light.
struct OSGTERRAINLIGHT_EXPORT KeyLight
{
    /// Of its middle, degrees clockwise from north, any finite value.
    double azimuth = 0.0;
    /// Degrees of azimuth, 0.1 … 360.
    double width = 30.0;
    /// Degrees above the horizontal, −90 … 90, lowest < highest.
    double lowest = 20.0, highest = 50.0;
    /// [W m⁻² sr⁻¹ or relative], each ≥ 0.
    Rgb radiance = {1.0f, 1.0f, 1.0f};
};

OSGTERRAINLIGHT_EXPORT bool operator==(const KeyLight& a, const KeyLight& b);
inline bool operator!=(const KeyLight& a, const KeyLight& b)
{
    return !(a == b);
}

/// How a sky without environment and harmonics is spread over the directions.
enum class SkyModel
{
    Uniform,  ///< skyRadiance everywhere
    Overcast, ///< CIE overcast: skyRadiance at the zenith, a third of it at the horizontal
    Clear     ///< by the sun's place and turbidity; sunIrradiance gives the strength
};

OSGTERRAINLIGHT_EXPORT const char* toString(SkyModel model);
/// False where the text is none of uniform, overcast, clear; model is then unchanged.
OSGTERRAINLIGHT_EXPORT bool fromString(const std::string& text, SkyModel& model);

/// The light above the terrain: a sky, a sun and key lights. Scene-linear, in units of the user's
/// choice; the defaults make a sunlit white surface about 1.
struct OSGTERRAINLIGHT_EXPORT SkyLight
{
    bool skyEnabled = true;
    /// Of the sky where there is neither an environment nor harmonics.
    SkyModel skyModel = SkyModel::Uniform;
    /// Radiance of the uniform sky, or of the overcast one at the zenith [W m⁻² sr⁻¹ or relative],
    /// each ≥ 0.
    Rgb skyRadiance = {0.21f, 0.26f, 0.35f};
    /// Of SkyModel::Clear: 2 … 10, from very clear air to haze. That sky is as bright as its sun,
    /// which makes it whether sunEnabled or not: sunIrradiance is then the sun's outside the air,
    /// and what reaches the ground is less and redder, without skyEnabled, too. A sun at night
    /// makes twilight.
    double turbidity = 3.0;

    /// Where not null: the sky's radiance, instead of model and harmonics. setEnvironment() sets
    /// the sun with it.
    std::shared_ptr<const Environment> environment;
    /// Degrees by which the environment is turned clockwise, seen from above, −360 … 720.
    double environmentHeading = 0.0;
    /// What its radiance is multiplied by, ≥ 0.
    double environmentGain = 1.0;

    /// Where not empty: radiance of the sky instead of skyRadiance, in 1, 4, 9 or 16 coefficients
    /// of real spherical harmonics, (l, m) at l (l + 1) + m, x east, y north, z up; Y(1, −1 … 1)
    /// are 0.4886 times y, z, x (docs/CONVENTIONS.md). Any finite values; radiance below 0 counts
    /// as it is. The sky ends at the horizontal.
    std::vector<Rgb> skyHarmonics;

    /// At most 8.
    std::vector<KeyLight> keyLights;

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

    /// Azimuth, from the map's north, and elevation of the sun by time and place.
    void setSunAt(UtcTime time, const EarthPlace& place);

    /// Sky and sun of an environment, turned and multiplied: the sun is the one that was found in
    /// it, and off where there was none, or where `from` is null. Heading and gain that are set
    /// later without this function move the sky and leave the sun.
    void setEnvironment(std::shared_ptr<const Environment> from, double heading = 0.0,
                        double gain = 1.0);
};

/// Environments are the same where they are one object.
OSGTERRAINLIGHT_EXPORT bool operator==(const SkyLight& a, const SkyLight& b);
inline bool operator!=(const SkyLight& a, const SkyLight& b)
{
    return !(a == b);
}

} // namespace osgTerrainLight
