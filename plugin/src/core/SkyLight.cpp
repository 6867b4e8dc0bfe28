#include <osgTerrainLight/SkyLight.h>

#include "core/AzimuthSet.h"
#include "core/EnumNames.h"
#include <osgTerrainLight/Environment.h>

#include <cmath>
#include <utility>

namespace osgTerrainLight
{

const char* toString(SkyModel model)
{
    return nameOf(model);
}

bool fromString(const std::string& text, SkyModel& model)
{
    return readName(text, model);
}

void SkyLight::setEnvironment(std::shared_ptr<const Environment> from, double heading, double gain)
{
    environment = std::move(from);
    environmentHeading = heading;
    environmentGain = gain;
    sunEnabled = environment && environment->hasSun;
    if (!sunEnabled)
        return;
    sunAzimuth = std::fmod(std::fmod(environment->sunAzimuth + heading, 360.0) + 360.0, 360.0);
    sunElevation = environment->sunElevation;
    sunAngularRadius = environment->sunAngularRadius;
    for (std::size_t c = 0; c < 3; ++c)
        sunIrradiance[c] =
            static_cast<float>(gain * static_cast<double>(environment->sunIrradiance[c]));
}

void SkyLight::setSunAt(UtcTime time, const EarthPlace& place)
{
    const SunPosition sun = sunPosition(time, place);
    sunAzimuth = std::fmod(sun.azimuth - place.convergence + 720.0, 360.0);
    sunElevation = sun.elevation;
}

std::array<double, 3> SkyLight::sunDirection() const
{
    const MapDirection d = directionOfCompass(sunAzimuth);
    const MapDirection e = directionOfCompass(90.0 - sunElevation); // east = cos, north = sin
    return {d.east * e.east, d.north * e.east, e.north};
}

} // namespace osgTerrainLight
