#include <osgTerrainLight/SkyLight.h>
#include <osgTerrainLight/SunPosition.h>

#include <gtest/gtest.h>

#include <libnova/dynamical_time.h>
#include <libnova/julian_day.h>
#include <libnova/precession.h>
#include <libnova/solar.h>
#include <libnova/transform.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

using namespace osgTerrainLight;

namespace
{
constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;

UtcTime at(const std::string& text)
{
    UtcTime time;
    EXPECT_EQ(readUtcTime(text, time), "");
    return time;
}

/// Degrees between two directions.
double between(const SunPosition& a, const SunPosition& b)
{
    const double e = (a.elevation - b.elevation) * radiansPerDegree;
    const double z = (a.azimuth - b.azimuth) * radiansPerDegree;
    const double haversine =
        std::pow(std::sin(0.5 * e), 2) + std::cos(a.elevation * radiansPerDegree) *
                                             std::cos(b.elevation * radiansPerDegree) *
                                             std::pow(std::sin(0.5 * z), 2);
    return 2.0 * std::asin(std::sqrt(haversine)) / radiansPerDegree;
}

/// libnova: VSOP87 and formulae after Meeus, Astronomical Algorithms; geocentric, so that the sun's
/// parallax of 0.0024° is left. Its VSOP87 series are those for the equinox of 2000, so precession
/// to the date comes on top.
SunPosition byLibnova(UtcTime time, const EarthPlace& place)
{
    const double utc = static_cast<double>(time.time_since_epoch().count()) / 86.4e6 + 2440587.5;
    ln_equ_posn equatorial;
    ln_equ_posn of2000;
    ln_get_solar_equ_coords(ln_get_jde(utc), &of2000);
    ln_get_equ_prec(&of2000, utc, &equatorial);
    ln_lnlat_posn observer = {place.longitude, place.latitude};
    ln_hrz_posn horizontal;
    ln_get_hrz_from_equ(&equatorial, &observer, utc, &horizontal); // azimuth from the south
    return {std::fmod(horizontal.az + 180.0, 360.0), horizontal.alt};
}
} // namespace

TEST(SunPosition, ThousandTimesAndPlacesAgreeWithLibnova)
{
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double first = static_cast<double>(at("1960-01-01T00:00").time_since_epoch().count());
    const double last = static_cast<double>(at("2050-01-01T00:00").time_since_epoch().count());
    double worst = 0.0, sum = 0.0;
    for (int i = 0; i < 1000; ++i)
    {
        const UtcTime time{
            std::chrono::milliseconds(std::llround(first + (last - first) * unit(random)))};
        // Even over the sphere; poles and the date line among them.
        const double latitude = i < 20 ? (i % 2 ? 90.0 : -90.0)
                                       : std::asin(2.0 * unit(random) - 1.0) / radiansPerDegree;
        const EarthPlace place{i % 50 == 25 ? 180.0 : 360.0 * unit(random) - 180.0, latitude, 0.0};
        const SunPosition mine = sunPosition(time, place);
        EXPECT_GE(mine.azimuth, 0.0);
        EXPECT_LE(mine.azimuth, 360.0);
        const double difference = between(mine, byLibnova(time, place));
        // The need; the parallax that libnova leaves out is 0.0024° of it.
        EXPECT_LE(difference, 0.05) << toString(time) << " at " << toString(place);
        worst = std::max(worst, difference);
        sum += difference;
    }
    std::cout << "sun against libnova: mean " << sum / 1000.0 << ", worst " << worst
              << " degrees\n";
}

// Reda and Andreas, Solar Position Algorithm for Solar Radiation Applications, NREL/TP-560-34302
// (revised 2008), table A5.1: topocentric azimuth 194.34024°, zenith 50.11162° with refraction at
// 820 mbar and 11 °C, which its equation 42 takes out again: 0.01633°.
TEST(SunPosition, ExampleOfTheSolarPositionAlgorithm)
{
    const SunPosition sun =
        sunPosition(at("2003-10-17T12:30:30-07:00"), {-105.1786, 39.742476, 0.0});
    // Its UT1 is UTC, too. Measured: 0.00002°.
    EXPECT_NEAR(sun.azimuth, 194.34024, 0.0005);
    EXPECT_NEAR(sun.elevation, 90.0 - 50.11162 - 0.01633, 0.0005);
}

// Seasons of 2024 by the US Naval Observatory: equinox March 20, 03:06, and solstice June 20,
// 20:51. At a pole the sun stands as high as its declination, less the parallax of 0.0024°.
TEST(SunPosition, SeasonsAtThePole)
{
    EXPECT_NEAR(sunPosition(at("2024-03-20T03:06Z"), {0.0, 90.0, 0.0}).elevation, -0.0024, 0.0005);
    const double top = sunPosition(at("2024-06-20T20:51Z"), {0.0, 90.0, 0.0}).elevation;
    EXPECT_NEAR(top, 23.436 - 0.0022,
                0.003); // obliquity of the date 23.4361°, nutation below 0.003°
    EXPECT_LT(sunPosition(at("2024-06-19T20:51Z"), {0.0, 90.0, 0.0}).elevation, top);
    EXPECT_LT(sunPosition(at("2024-06-21T20:51Z"), {0.0, 90.0, 0.0}).elevation, top);
}

TEST(SunPosition, RisesInTheEastAndStandsInTheSouthAtNoon)
{
    const UtcTime equinox = at("2024-03-20T00:00Z");
    using std::chrono::hours;
    const EarthPlace greenwich{0.0, 50.0, 0.0};
    EXPECT_NEAR(sunPosition(equinox + hours(6), greenwich).azimuth, 90.0, 3.0);
    EXPECT_NEAR(sunPosition(equinox + hours(12), greenwich).azimuth, 180.0, 3.0);
    EXPECT_NEAR(sunPosition(equinox + hours(12), greenwich).elevation, 40.0, 0.5);
    EXPECT_NEAR(sunPosition(equinox + hours(18), greenwich).azimuth, 270.0, 3.0);
    EXPECT_GT(
        std::cos(sunPosition(equinox + hours(12), {0.0, -50.0, 0.0}).azimuth * radiansPerDegree),
        0.99)
        << "south of the equator it stands in the north";
    // 90° east it is six hours later.
    EXPECT_NEAR(sunPosition(equinox + hours(6), {90.0, 50.0, 0.0}).azimuth, 180.0, 3.0);
    EXPECT_NEAR(sunPosition(equinox + hours(6), {450.0 - 360.0, 50.0, 0.0}).elevation,
                sunPosition(equinox + hours(6), {-270.0, 50.0, 0.0}).elevation, 1e-9);
}

TEST(SkyLight, SunAtATimeCountsFromTheMapsNorth)
{
    const UtcTime time = at("2024-06-21T10:30Z");
    const SunPosition sun = sunPosition(time, {11.5, 48.1, 0.0});
    SkyLight sky;
    sky.setSunAt(time, {11.5, 48.1, 0.0});
    EXPECT_NEAR(sky.sunAzimuth, sun.azimuth, 1e-12);
    EXPECT_EQ(sky.sunElevation, sun.elevation);
    // The map's y axis points 2° east of north, so the sun stands 2° less from it.
    sky.setSunAt(time, {11.5, 48.1, 2.0});
    EXPECT_NEAR(sky.sunAzimuth, sun.azimuth - 2.0, 1e-12);
    sky.setSunAt(time, {11.5, 48.1, 350.0});
    EXPECT_NEAR(sky.sunAzimuth, sun.azimuth + 10.0, 1e-12);
}

TEST(EarthPlace, ReadsLongitudeAndLatitude)
{
    EarthPlace place{0.0, 0.0, 5.0};
    EXPECT_EQ(readEarthPlace("-105.1786,39.742476", place), "");
    EXPECT_EQ(place.longitude, -105.1786);
    EXPECT_EQ(place.latitude, 39.742476);
    EXPECT_EQ(place.convergence, 0.0);
    EXPECT_EQ(toString(place), "-105.1786,39.742476");
    const std::pair<const char*, const char*> bad[] = {
        {"", "needs longitude,latitude"},
        {"11.5", "needs longitude,latitude"},
        {"11.5,", "needs longitude,latitude"},
        {"11.5,48.1,3", "needs longitude,latitude"},
        {"a,b", "needs longitude,latitude"},
        {"11.5;48.1", "needs longitude,latitude"},
        {"11.5,91", "latitude = 91 degrees: needs -90 ... 90"},
        {"-361,0", "longitude = -361 degrees: needs -360 ... 360"},
        {"nan,0", "longitude = nan"},
        {"0,nan", "latitude = nan"}};
    for (const auto& [text, message] : bad)
    {
        EXPECT_NE(readEarthPlace(text, place).find(message), std::string::npos) << text;
        EXPECT_EQ(place.longitude, -105.1786);
    }
}
