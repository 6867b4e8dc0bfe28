#pragma once

#include <osgTerrainLight/Export.h>

#include <chrono>
#include <string>

namespace osgTerrainLight
{

/// A moment of UTC, as Unix time: since 1970-01-01T00:00Z, every day of 86,400 seconds.
using UtcTime = std::chrono::time_point<std::chrono::system_clock, std::chrono::milliseconds>;

/// Reads ISO 8601 and what people write for it: YYYY-MM-DD, then T, t or blanks, then
/// hh:mm[:ss[.sss]], 00:00 … 24:00, then nothing, Z, UTC or GMT (in any case) for UTC, or the zone
/// as +hh:mm, +hhmm or +hh (or −). What is finer than a millisecond is cut off. The years are 1900
/// … 2100, in UTC, too, where the Earth's orbit is known to sunPosition(). Empty where it was read;
/// else a sentence with the text, what is needed and what is wrong, and time is unchanged.
OSGTERRAINLIGHT_EXPORT std::string readUtcTime(const std::string& text, UtcTime& time);

/// "2024-06-21T10:30:00Z"; with milliseconds where there are any.
OSGTERRAINLIGHT_EXPORT std::string toString(UtcTime time);

/// Where terrain lies on Earth, and how its map is turned there.
struct OSGTERRAINLIGHT_EXPORT EarthPlace
{
    /// Degrees east of Greenwich, −360 … 360, and geodetic, WGS 84, −90 … 90.
    double longitude = 0.0, latitude = 0.0;
    /// Meridian convergence: where the map's north, its y axis, points here, in degrees clockwise
    /// from true north. Azimuths of light count from the map's north.
    double convergence = 0.0;

    /// Empty where every value is legal; else a sentence that names the first that is not.
    std::string complaint() const;
};

/// Reads "longitude,latitude" in degrees; the convergence becomes 0. Empty where it was read, as
/// readUtcTime().
OSGTERRAINLIGHT_EXPORT std::string readEarthPlace(const std::string& text, EarthPlace& place);

/// "-84.2,36.6".
OSGTERRAINLIGHT_EXPORT std::string toString(const EarthPlace& place);

/// Where the middle of the sun's disc stands.
struct SunPosition
{
    /// Degrees clockwise from true north, 0 … 360.
    double azimuth = 0.0;
    /// Degrees above the plane that is perpendicular to the ellipsoid's normal, −90 … 90:
    /// geometric, without refraction, which lifts a sun on the horizon by about 0.5°.
    double elevation = 0.0;
};

/// The sun as seen from the ellipsoid's surface, topocentric, by ERFA, the library of the IAU's
/// Standards of Fundamental Astronomy: orbit of the Earth (Simon et al. 1994 with later
/// corrections), aberration, precession and nutation IAU 2006/2000B. UTC stands for UT1, which errs
/// by at most 0.9 s or 0.004°; years before 1960 and after ERFA's last leap second err by as much
/// per second that the Earth's rotation has drifted. Precondition: legal values, years 1900 … 2100.
OSGTERRAINLIGHT_EXPORT SunPosition sunPosition(UtcTime time, const EarthPlace& place);

} // namespace osgTerrainLight
