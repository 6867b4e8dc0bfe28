#pragma once

#include <osgTerrainLight/Export.h>

#include <chrono>
#include <string>

namespace osgTerrainLight
{

/// A time of UTC as Unix time: milliseconds since 1970-01-01T00:00Z, where every day has 86,400
/// seconds.
using UtcTime = std::chrono::time_point<std::chrono::system_clock, std::chrono::milliseconds>;

/// Reads a time as ISO 8601 has it, or as people write it: YYYY-MM-DD, then T, t or blanks, then
/// hh:mm[:ss[.sss]], 00:00 … 24:00, then the zone: nothing, Z, UTC or GMT (in any case) for UTC, or
/// +hh:mm, +hhmm or +hh (or with −). Digits beyond milliseconds are cut off. The year is 1900 …
/// 2100, also in UTC, since sunPosition() knows the Earth's orbit for these years. Returns an empty
/// text where the time was read; else a sentence with the text, what is needed and what is wrong.
/// The time is then unchanged.
OSGTERRAINLIGHT_EXPORT std::string readUtcTime(const std::string& text, UtcTime& time);

/// A text such as "2024-06-21T10:30:00Z", with milliseconds where there are any.
OSGTERRAINLIGHT_EXPORT std::string toString(UtcTime time);

/// Where terrain lies on Earth, and by how much its map is turned there.
struct OSGTERRAINLIGHT_EXPORT EarthPlace
{
    /// Longitude, −360 … 360 degrees east of Greenwich, and geodetic latitude (WGS 84), −90 … 90
    /// degrees.
    double longitude = 0.0, latitude = 0.0;
    /// Meridian convergence: the direction of the map's north, its y axis, in degrees clockwise
    /// from true north. Azimuths of light count from the map's north.
    double convergence = 0.0;

    /// Empty where every value is legal; else a sentence that names the first that is not.
    std::string complaint() const;
};

/// Reads "longitude,latitude" in degrees; the convergence becomes 0. It returns what readUtcTime()
/// returns.
OSGTERRAINLIGHT_EXPORT std::string readEarthPlace(const std::string& text, EarthPlace& place);

/// A text such as "-84.2,36.6".
OSGTERRAINLIGHT_EXPORT std::string toString(const EarthPlace& place);

/// The place of the middle of the sun's disc in the sky.
struct SunPosition
{
    /// Azimuth, 0 … 360 degrees clockwise from true north.
    double azimuth = 0.0;
    /// Elevation, −90 … 90 degrees above the plane that is perpendicular to the ellipsoid's normal.
    /// It is without refraction, which lifts a sun on the horizon by about 0.5°.
    double elevation = 0.0;
};

/// Computes the sun as seen from the ellipsoid's surface. ERFA, the library of the IAU's Standards
/// of Fundamental Astronomy, gives the orbit of the Earth (Simon et al. 1994 with later
/// corrections), aberration, and precession and nutation IAU 2006/2000B. UTC is used for UT1, which
/// is wrong by at most 0.9 s or 0.004°. Years before 1960 and after ERFA's last leap second are
/// wrong by 0.004° more per second by which the Earth's rotation has drifted. Precondition: legal
/// values, years 1900 … 2100.
OSGTERRAINLIGHT_EXPORT SunPosition sunPosition(UtcTime time, const EarthPlace& place);

} // namespace osgTerrainLight
