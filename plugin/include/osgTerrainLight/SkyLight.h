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

/// An area light at infinity with limits in azimuth and elevation and with one radiance
/// (Nowrouzezahrai and Snyder 2009, sections 6 and 7). Its part below the horizontal gives no
/// light.
struct OSGTERRAINLIGHT_EXPORT KeyLight
{
    /// Azimuth of the middle, degrees clockwise from north, −360 … 720.
    double azimuth = 0.0;
    /// Extent in azimuth, 0.1 … 360 degrees.
    double width = 30.0;
    /// Elevations of the edges, −90 … 90 degrees above the horizontal, lowest < highest.
    double lowest = 20.0, highest = 50.0;
    /// Radiance [W m⁻² sr⁻¹ or relative], each channel 0 … 1e6.
    Rgb radiance = {1.0f, 1.0f, 1.0f};
};

OSGTERRAINLIGHT_EXPORT bool operator==(const KeyLight& a, const KeyLight& b);
inline bool operator!=(const KeyLight& a, const KeyLight& b)
{
    return !(a == b);
}

/// How the light of a sky without environment and harmonics depends on the direction.
enum class SkyModel
{
    Uniform,  ///< It is skyRadiance everywhere.
    Overcast, ///< CIE overcast: it is skyRadiance at the zenith and a third of it at the horizon.
    Clear     ///< It follows the sun's place and the turbidity; sunIrradiance gives the strength.
};

OSGTERRAINLIGHT_EXPORT const char* toString(SkyModel model);
/// False where the text is none of uniform, overcast, clear; model is then unchanged.
OSGTERRAINLIGHT_EXPORT bool fromString(const std::string& text, SkyModel& model);

/// The light above the terrain: a sky, a sun and key lights. Its values are scene-linear, in units
/// of the user's choice. With the defaults a sunlit white surface is about 1.
struct OSGTERRAINLIGHT_EXPORT SkyLight
{
    bool skyEnabled = true;
    /// The sky where there is neither an environment nor harmonics.
    SkyModel skyModel = SkyModel::Uniform;
    /// Radiance of the uniform sky, or of the overcast sky at the zenith [W m⁻² sr⁻¹ or relative],
    /// each channel 0 … 1e6.
    Rgb skyRadiance = {0.21f, 0.26f, 0.35f};
    /// Turbidity of the air of SkyModel::Clear: 2 is very clear air, 10 is haze. The sun makes this
    /// sky, also where sunEnabled is false, and a sun below the horizon makes twilight.
    /// sunIrradiance is then that of the sun outside the air; the sun at the ground is weaker and
    /// redder, also where skyEnabled is false.
    double turbidity = 3.0;

    /// Where it is not null, it gives the radiance of the sky, instead of the model and the
    /// harmonics. setEnvironment() sets the sun with it.
    std::shared_ptr<const Environment> environment;
    /// Turns the environment clockwise as seen from above, −360 … 720 degrees.
    double environmentHeading = 0.0;
    /// Multiplies the radiance of the environment, 0 … 1e6.
    double environmentGain = 1.0;

    /// Where it is not empty, it gives the radiance of the sky, instead of the model, in 1, 4, 9 or
    /// 16 coefficients of real spherical harmonics. (l, m) stands at l (l + 1) + m; x is east, y is
    /// north and z is up; Y(1, −1 … 1) are 0.4886 times y, z, x (docs/CONVENTIONS.md). Values are
    /// finite; radiance below 0 counts as it is. The sky ends at the horizontal.
    std::vector<Rgb> skyHarmonics;

    /// The key lights, at most 8.
    std::vector<KeyLight> keyLights;

    bool sunEnabled = true;
    /// Azimuth of the sun, degrees clockwise from north, −360 … 720.
    double sunAzimuth = 315.0;
    /// Elevation of the sun, −90 … 90 degrees above the horizontal, without refraction.
    double sunElevation = 35.0;
    /// Irradiance on a surface that faces the unoccluded sun [W m⁻² or relative], each channel
    /// 0 … 1e6.
    Rgb sunIrradiance = {3.0f, 2.85f, 2.6f};
    /// Angular radius of the sun's disc, 0.01 … 10 degrees. That of the real sun is 0.2666.
    double sunAngularRadius = 0.2666;

    /// The unit vector towards the sun: x east, y north, z up.
    std::array<double, 3> sunDirection() const;

    /// Sets the azimuth of the sun, from the map's north, and its elevation by time and place.
    void setSunAt(UtcTime time, const EarthPlace& place);

    /// Takes sky and sun from an environment, turned and multiplied. The sun is the one that was
    /// found in the environment; it is off where none was found, or where `from` is null. If you
    /// change the heading or the gain later without this function, the sun stays as it is.
    void setEnvironment(std::shared_ptr<const Environment> from, double heading = 0.0,
                        double gain = 1.0);
};

/// Two environments count as the same where they are one object.
OSGTERRAINLIGHT_EXPORT bool operator==(const SkyLight& a, const SkyLight& b);
inline bool operator!=(const SkyLight& a, const SkyLight& b)
{
    return !(a == b);
}

} // namespace osgTerrainLight
