#pragma once

#include <osgTerrainLight/SkyLight.h>

#include "glsl_host.h"

#include <array>

namespace osgTerrainLight
{

// Air that is clear but for haze, over the sea: what it takes from the sun, and the sky that it
// makes. elevation: of the sun's centre [degrees above the horizontal, -90 ... 90], geometric.
// Linear red, green, blue of Rec. 709.

/// Air between the ground and the sun, over that up to the zenith (Kasten and Young 1989, Eq. 3).
/// Below the horizontal that of the horizontal.
double relativeAirMass(double elevation);

/// Vertical optical depth of the air's molecules at a wavelength [micrometres, 0.3 ... 1] (Hansen
/// and Travis 1974, Eq. 2.30).
double rayleighDepth(double wavelength);

/// Illuminance of a surface that faces the sun at its mean distance, outside the air [klx].
double solarIlluminance();

/// Irradiance of a surface that faces the sun, and of level ground by the sky alone; both over that
/// of a surface that faces the sun outside the air, each >= 0.
struct Daylight
{
    std::array<double, 3> sun;
    std::array<double, 3> sky;
};

/// Of turbidity 2 ... 10: Bird and Riordan 1986 in 37 bands, over black ground, with 300 Dobson
/// units of ozone; twilight by Janiczek and DeYoung 1987.
Daylight daylightOf(double turbidity, double elevation);

/// The sky of SkyModel::Clear: its picture by Preetham, Shirley and Smits 1999, as bright as
/// daylightOf() says.
Glsl<double>::ClearSky clearSky(const SkyLight& light);

} // namespace osgTerrainLight
