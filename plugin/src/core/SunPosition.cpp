#include <osgTerrainLight/SunPosition.h>

#include <erfa.h>
#include <erfam.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

namespace osgTerrainLight
{

namespace
{
constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;
constexpr std::int64_t millisecondsPerDay = 86'400'000;
/// Modified Julian Date of 1970-01-01, and what is added to such a date for a Julian one.
constexpr int unixEpoch = 40587;
constexpr double julianOfModified = 2'400'000.5;

/// Whole days since the epoch and milliseconds into the day.
std::pair<std::int64_t, std::int64_t> split(UtcTime time)
{
    const std::int64_t all = time.time_since_epoch().count();
    std::int64_t days = all / millisecondsPerDay;
    if (all < days * millisecondsPerDay)
        --days;
    return {days, all - days * millisecondsPerDay};
}

std::string text(double value)
{
    std::array<char, 32> digits{};
    return {digits.begin(), std::to_chars(digits.begin(), digits.end(), value).ptr};
}

std::optional<double> number(std::string_view text)
{
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        return std::nullopt;
    return value;
}
} // namespace

std::string EarthPlace::complaint() const
{
    const bool east = std::abs(longitude) <= 360.0; // false for NaN
    if (!east || !(std::abs(latitude) <= 90.0))
        return (east ? "latitude = " + text(latitude) + " degrees: needs -90 ... 90"
                     : "longitude = " + text(longitude) + " degrees: needs -360 ... 360");
    if (!(std::abs(convergence) <= 360.0))
        return "convergence = " + text(convergence) + " degrees: needs -360 ... 360";
    return {};
}

std::string readEarthPlace(const std::string& given, EarthPlace& place)
{
    const std::size_t comma = std::min(given.find(','), given.size());
    const std::optional<double> longitude = number(std::string_view(given).substr(0, comma));
    const std::optional<double> latitude =
        comma < given.size() ? number(std::string_view(given).substr(comma + 1)) : std::nullopt;
    if (!longitude || !latitude)
        return "\"" + given +
               "\": needs longitude,latitude in degrees east and north, such as 11.5,48.1";
    const EarthPlace read = {*longitude, *latitude, 0.0};
    if (const std::string wrong = read.complaint(); !wrong.empty())
        return "\"" + given + "\": " + wrong;
    place = read;
    return {};
}

std::string toString(const EarthPlace& place)
{
    return text(place.longitude) + "," + text(place.latitude);
}

SunPosition sunPosition(UtcTime time, const EarthPlace& place)
{
    const auto [days, milliseconds] = split(time);
    const double date = julianOfModified + static_cast<double>(unixEpoch + days);
    const double fraction =
        static_cast<double>(milliseconds) / static_cast<double>(millisecondsPerDay);
    double tai[2], tt[2];
    eraUtctai(date, fraction, &tai[0], &tai[1]);
    eraTaitt(tai[0], tai[1], &tt[0], &tt[1]);

    // From the Earth's centre to the sun, as the moving Earth sees it [au].
    double heliocentric[2][3], barycentric[2][3];
    eraEpv00(tt[0], tt[1], heliocentric, barycentric);
    double towards[3], distance = 0.0;
    eraPn(heliocentric[0], &distance, towards);
    double velocity[3], speed = 0.0;
    for (int i = 0; i < 3; ++i)
    {
        towards[i] = -towards[i];
        velocity[i] = barycentric[1][i] / ERFA_DC;
        speed += velocity[i] * velocity[i];
    }
    double seen[3];
    eraAb(towards, velocity, distance, std::sqrt(1.0 - speed), seen);

    // Turned to the Earth's axes, from its surface.
    double turned[3][3], sun[3], here[3];
    eraC2t00b(tt[0], tt[1], date, fraction, 0.0, 0.0, turned);
    eraRxp(turned, seen, sun);
    const double longitude = place.longitude * radiansPerDegree;
    const double latitude = place.latitude * radiansPerDegree;
    eraGd2gc(ERFA_WGS84, longitude, latitude, 0.0, here);
    for (int i = 0; i < 3; ++i)
        sun[i] = sun[i] * distance - here[i] / ERFA_DAU;

    const double outward = std::cos(longitude) * sun[0] + std::sin(longitude) * sun[1];
    const double east = std::cos(longitude) * sun[1] - std::sin(longitude) * sun[0];
    const double north = std::cos(latitude) * sun[2] - std::sin(latitude) * outward;
    const double up = std::sin(latitude) * sun[2] + std::cos(latitude) * outward;
    const double azimuth = std::atan2(east, north) / radiansPerDegree;
    return {azimuth < 0.0 ? azimuth + 360.0 : azimuth,
            std::atan2(up, std::hypot(east, north)) / radiansPerDegree};
}

} // namespace osgTerrainLight
