// --time and --place of shadow and shade, and sunhours.
#include "ToolRun.h"
#include "support/MapTransform.h"

#include <osgTerrainLight/SunPosition.h>

#include <ogr_spatialref.h>

#include <cmath>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{

constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;

/// Declination of the sun, to 0.01° (Meeus, Astronomical Algorithms, 1998, chapter 25, low
/// accuracy). days: of UTC since 2000-01-01T12:00.
double declination(double days)
{
    const double t = days / 36525.0;
    const double anomaly = (357.52911 + 35999.05029 * t) * radiansPerDegree;
    const double longitude = 280.46646 + 36000.76983 * t + 1.914602 * std::sin(anomaly) +
                             0.019993 * std::sin(2.0 * anomaly) - 0.00569;
    return std::asin(std::sin(23.4393 * radiansPerDegree) * std::sin(longitude * radiansPerDegree));
}

/// Hours from sunrise to sunset of the disc's middle on a geometric horizon: cos(hour angle) =
/// −tan(latitude) tan(declination).
double dayLength(double latitude, double days)
{
    const double cosine = -std::tan(latitude * radiansPerDegree) * std::tan(declination(days));
    return 2.0 * std::acos(std::clamp(cosine, -1.0, 1.0)) / radiansPerDegree / 15.0;
}

class SunByTime : public GlToolTest
{
protected:
    void placeRaster(const std::string& name, const char* crs) const
    {
        GDALDatasetUniquePtr dataset(
            GDALDataset::Open(path(name).c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
        OGRSpatialReference reference;
        reference.SetFromUserInput(crs);
        ASSERT_EQ(dataset->SetSpatialRef(&reference), CE_None);
    }
};

TEST_F(SunByTime, HoursOfAPlainAreTheDaysLength)
{
    writeRaster("plain.tif", 3, 2, std::vector<float>(6, 7.0f), {0, 10, 0, 0, 0, -10});
    const struct
    {
        const char* date;
        const char* next;
        double days; // noon
    } dates[] = {{"2024-03-20", "2024-03-21", 8845.0},
                 {"2024-06-20", "2024-06-21", 8937.0},
                 {"2024-12-21", "2024-12-22", 9121.0}};
    for (const auto& date : dates)
        for (const double latitude : {0.0, 60.0})
        {
            const ToolRun result =
                run(std::string("sunhours plain.tif h.tif -q --step 1 --quality draft --from ") +
                    date.date + "T00:00 --to " + date.next + "T00:00 --place 0," +
                    std::to_string(latitude));
            ASSERT_EQ(result.status, 0) << result.err;
            const ReadRaster raster(path("h.tif"));
            const double hours = static_cast<double>(raster.at(1, 1, 1));
            const double expected = dayLength(latitude, date.days);
            std::cout << date.date << " at " << latitude << " N: " << hours << " h, expected "
                      << expected << " h, " << 60.0 * (hours - expected) << " min\n";
            EXPECT_NEAR(hours, expected, 2.0 / 60.0) << date.date << " at " << latitude;
            for (const float value : raster.bands[0])
                EXPECT_EQ(value, raster.bands[0][0]);
        }
}

// The midpoint rule, the last step shorter, on terrain with shadows and voids.
TEST_F(SunByTime, HoursAreTheSumOfShadows)
{
    ASSERT_EQ(run("generate crater c.tif --size 40,31 --spacing 30 -q").status, 0);
    {
        const ReadRaster crater(path("c.tif"));
        std::vector<float> heights = crater.bands[0];
        heights[17] = heights[500] = -9999.0f;
        writeRaster("v.tif", 40, 31, heights, {0, 30, 0, 0, 0, -30});
    }
    const std::string place = " --place 11.5,47 -q";
    ASSERT_EQ(run("sunhours v.tif h.tif --from 2024-12-21T07:00Z --to 2024-12-21T10:30Z --step 60" +
                  place)
                  .status,
              0);
    const ReadRaster hours(path("h.tif"));
    expectSamePlace(hours, ReadRaster(path("v.tif")));
    std::vector<double> sum(hours.bands[0].size(), 0.0);
    const std::pair<const char*, double> parts[] = {{"2024-12-21T08:30+01:00", 1.0},
                                                    {"2024-12-21T08:30", 1.0},
                                                    {"2024-12-21T09:30Z", 1.0},
                                                    {"2024-12-21T10:15:00Z", 0.5}};
    for (const auto& [time, weight] : parts)
    {
        const ToolRun result = run("shadow v.tif s.tif --time " + std::string(time) + place);
        ASSERT_EQ(result.status, 0) << result.err;
        const ReadRaster shadow(path("s.tif"));
        for (std::size_t i = 0; i < sum.size(); ++i)
            sum[i] += weight * static_cast<double>(shadow.bands[0][i]);
    }
    int partly = 0;
    for (std::size_t i = 0; i < sum.size(); ++i)
    {
        if (i == 17 || i == 500)
        {
            EXPECT_EQ(hours.bands[0][i], -9999.0f);
            continue;
        }
        EXPECT_NEAR(static_cast<double>(hours.bands[0][i]), sum[i], 1e-6);
        partly += sum[i] > 0.1 && sum[i] < 3.3;
    }
    EXPECT_GT(partly, 50) << "the test needs shadows";
    EXPECT_STREQ(hours.dataset->GetRasterBand(1)->GetUnitType(), "h");
    EXPECT_EQ(hours.description(1),
              "hours of direct sun from 2024-12-21T07:00:00Z to 2024-12-21T10:30:00Z");
    EXPECT_EQ(hours.metadata("TERRAINLIGHT_MODE"), "sunhours");
    EXPECT_EQ(hours.metadata("TERRAINLIGHT_FROM"), "2024-12-21T07:00:00Z");
    EXPECT_EQ(hours.metadata("TERRAINLIGHT_TO"), "2024-12-21T10:30:00Z");
    EXPECT_EQ(hours.metadata("TERRAINLIGHT_STEP_MINUTES"), "60");
    EXPECT_EQ(hours.metadata("TERRAINLIGHT_PLACE"), "11.5,47");
}

TEST_F(SunByTime, NightHasNoHours)
{
    writeRaster("plain.tif", 3, 2, std::vector<float>(6, 7.0f), {0, 10, 0, 0, 0, -10});
    const ToolRun result = run("sunhours plain.tif h.tif --place 0,80 --from 2024-12-01T00:00 "
                               "--to 2024-12-02T00:00 --step 60");
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("sunhours: 6 posts, 24 steps, 0 with the sun up, "),
              std::string::npos)
        << result.out;
    EXPECT_EQ(result.out.substr(0, result.out.find('\n')),
              "0...10...20...30...40...50...60...70...80...90...100 - done.");
    EXPECT_EQ(ReadRaster(path("h.tif")).bands[0], std::vector<float>(6, 0.0f));
}

TEST_F(SunByTime, PlaceComesFromTheRaster)
{
    const std::string time = "2024-06-21T09:00:00Z";
    UtcTime utc;
    ASSERT_EQ(readUtcTime(time, utc), "");
    const auto number = [](const ReadRaster& raster, const char* name)
    { return std::stod(raster.metadata(name)); };

    // In degrees: the middle of the raster, and azimuths from true north.
    writeRaster("degrees.tif", 20, 10, std::vector<float>(200, 7.0f), {10, .01, 0, 48.05, 0, -.01});
    placeRaster("degrees.tif", "EPSG:4326");
    for (const std::string mode : {"shadow", "shade"})
    {
        ASSERT_EQ(run(mode + " degrees.tif s.tif -q --time " + time).status, 0);
        const ReadRaster raster(path("s.tif"));
        EXPECT_EQ(raster.metadata("TERRAINLIGHT_TIME"), time);
        EXPECT_EQ(raster.metadata("TERRAINLIGHT_PLACE"), "10.1,48");
        EXPECT_EQ(number(raster, "TERRAINLIGHT_CONVERGENCE"), 0.0);
        const SunPosition sun = sunPosition(utc, {10.1, 48.0, 0.0});
        EXPECT_NEAR(number(raster, "TERRAINLIGHT_SUN_AZIMUTH"), sun.azimuth, 1e-6);
        EXPECT_NEAR(number(raster, "TERRAINLIGHT_SUN_ELEVATION"), sun.elevation, 1e-6);
    }

    // UTM zone 33, 2.9° east of its central meridian: grid north points 2.12° east of north there,
    // atan(tan 2.9° sin 47°), so azimuths from it are less by as much.
    writeRaster("utm.tif", 20, 10, std::vector<float>(200, 7.0f), {0, 10, 0, 0, 0, -10});
    placeRaster("utm.tif", "EPSG:32633");
    {
        const auto to = transformation("EPSG:4326", "EPSG:32633");
        double x = 17.9, y = 47.0;
        ASSERT_TRUE(to->Transform(1, &x, &y));
        GDALDatasetUniquePtr dataset(
            GDALDataset::Open(path("utm.tif").c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
        double transform[6] = {x - 100.0, 10, 0, y + 50.0, 0, -10};
        dataset->SetGeoTransform(transform);
    }
    const double convergence =
        std::atan(std::tan(2.9 * radiansPerDegree) * std::sin(47.0 * radiansPerDegree)) /
        radiansPerDegree;
    ASSERT_EQ(run("shadow utm.tif s.tif -q --time " + time).status, 0);
    const ReadRaster raster(path("s.tif"));
    const SunPosition sun = sunPosition(utc, {17.9, 47.0, 0.0});
    EXPECT_NEAR(number(raster, "TERRAINLIGHT_CONVERGENCE"), convergence, 0.002);
    EXPECT_NEAR(number(raster, "TERRAINLIGHT_SUN_AZIMUTH"), sun.azimuth - convergence, 0.002);
    EXPECT_NEAR(number(raster, "TERRAINLIGHT_SUN_ELEVATION"), sun.elevation, 1e-5);
    // A given place takes the raster's stead; the convergence is the one at that place.
    ASSERT_EQ(run("shadow utm.tif s.tif -q --place 15.5,47.2 --time 2024-06-21T15:00Z").status, 0);
    const double there =
        std::atan(std::tan(0.5 * radiansPerDegree) * std::sin(47.2 * radiansPerDegree)) /
        radiansPerDegree;
    EXPECT_NEAR(number(ReadRaster(path("s.tif")), "TERRAINLIGHT_CONVERGENCE"), there, 0.002);
}

// Expected: the sun's true azimuth at the place less the bearing of the map's y axis there: the
// longitude from the map's own in the north, its negative in the south (Snyder 1987, section 21).
TEST_F(SunByTime, RastersWithAPoleInside)
{
    const struct
    {
        const char* crs;
        int width, height;    // odd: the pole is a post
        double east, north;   // of the middle, from the pole [m]
        const char* place;    // or empty
        double sign, central; // of the rule
        const char* time;
    } maps[] = {{"EPSG:3995", 9, 7, 0, 0, "", 1, 0, "2024-06-21T03:00:00Z"},
                {"EPSG:3413", 8, 8, 0, 0, "--place=-120,90", 1, -45, "2024-06-21T03:00:00Z"},
                {"EPSG:3031", 8, 6, 0, 0, "", -1, 0, "2024-12-21T17:00:00Z"},
                {"EPSG:3031", 7, 7, 100, -200, "--place 80,-89.99", -1, 0, "2024-12-21T17:00:00Z"},
                {"EPSG:3408", 10, 9, -300, 200, "", 1, 0, "2024-05-01T21:00:00Z"}};
    for (const auto& map : maps)
    {
        SCOPED_TRACE(map.crs);
        writeRaster("pole.tif", map.width, map.height,
                    std::vector<float>(static_cast<std::size_t>(map.width * map.height), 7.0f),
                    {map.east - 50.0 * map.width, 100, 0, map.north + 50.0 * map.height, 0, -100});
        placeRaster("pole.tif", map.crs);
        const ToolRun result =
            run("shadow pole.tif s.tif -q --time " + std::string(map.time) + " " + map.place);
        ASSERT_EQ(result.status, 0) << result.err;
        const ReadRaster raster(path("s.tif"));
        EarthPlace place;
        ASSERT_EQ(readEarthPlace(raster.metadata("TERRAINLIGHT_PLACE"), place), "");
        UtcTime utc;
        ASSERT_EQ(readUtcTime(map.time, utc), "");
        const double expected =
            sunPosition(utc, place).azimuth - map.sign * (place.longitude - map.central);
        const double found = std::stod(raster.metadata("TERRAINLIGHT_SUN_AZIMUTH"));
        EXPECT_NEAR(std::remainder(found - expected, 360.0), 0.0, 1e-3);
    }
}

TEST_F(SunByTime, WarnsOfNight)
{
    ASSERT_EQ(run("generate crater c.tif --size 9 -q").status, 0);
    const ToolRun result = run("shadow c.tif s.tif -q --time 2024-12-21T00:00 --place 0,50");
    EXPECT_EQ(result.status, 0);
    EXPECT_TRUE(result.complains("warning: the sun is 63.4")) << result.err;
    EXPECT_TRUE(result.complains(" degrees below the horizontal at 2024-12-21T00:00:00Z"))
        << result.err;
}

using SunByTimeRefused = ToolTest;

TEST_F(SunByTimeRefused, WithWhatIsNeeded)
{
    ASSERT_EQ(run("generate crater c.tif --size 9 -q").status, 0);
    const std::string hours = "sunhours c.tif o.tif --place 1,2 ";
    const std::string day = "--from 2024-01-01T00:00 --to 2024-01-02T00:00";
    const struct
    {
        std::string arguments;
        int status;
        const char* message;
    } cases[] = {
        {"shadow c.tif o.tif --time 2024-06-21T09:00", 1,
         "c.tif: the raster has no CRS that tells its place: needs --place LON,LAT"},
        {"sunhours c.tif o.tif " + day, 1, "needs --place LON,LAT"},
        {"shadow c.tif o.tif --time 2024-06-21T09:00 --sun 1,2", 2, "--sun excludes --time"},
        {"shade c.tif o.tif --place 1,2", 2, "--place requires --time"},
        {"render c.tif o.png --time 2024-06-21T09:00 --sun 1,2", 2, "--sun excludes --time"},
        {"shade c.tif o.tif --no-sun --place 1,2 --time 2024-06-21T09:00", 2,
         "--time: needs a sun: leave out --no-sun"},
        {"shadow c.tif o.tif --place 1,2 --time 2024-06-21", 2,
         "--time: \"2024-06-21\": needs a time YYYY-MM-DDThh:mm"},
        {"shadow c.tif o.tif --time 2024-06-21T09:00 --place 1,95", 2,
         "--place: \"1,95\": latitude = 95 degrees: needs -90 ... 90"},
        {hours, 2, "--from is required"},
        {hours + "--from 2024-01-02T00:00 --to 2024-01-01T00:00", 2,
         "--to: 2024-01-01T00:00:00Z is not after --from 2024-01-02T00:00:00Z"},
        {hours + day + " --step 0", 2, "step = 0: needs 0.1 ... 1440"},
        {hours + "--from 1900-01-01T00:00 --to 2024-01-01T00:00 --step 0.1", 2,
         "--step: 652176000 steps: needs at most 1000000"}};
    for (const auto& c : cases)
    {
        const ToolRun result = run(c.arguments);
        EXPECT_EQ(result.status, c.status) << c.arguments << ": " << result.err;
        EXPECT_TRUE(result.complains(c.message)) << c.arguments << ": " << result.err;
    }
    EXPECT_EQ(left(), std::set<std::string>{"c.tif"});
}

} // namespace
