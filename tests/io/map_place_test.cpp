#include "io/MapPlace.h"
#include "support/MapTransform.h"

#include <gtest/gtest.h>

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <cmath>

using namespace osgTerrainLight;

namespace
{
constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;

std::string wkt(const std::string& definition)
{
    OGRSpatialReference crs;
    EXPECT_EQ(crs.SetFromUserInput(definition.c_str()), OGRERR_NONE) << definition;
    char* text = nullptr;
    const char* wkt2[] = {"FORMAT=WKT2_2019", nullptr};
    crs.exportToWkt(&text, wkt2);
    const std::string result = text;
    CPLFree(text);
    return result;
}

/// Map coordinates of a place.
std::pair<double, double> onMap(const std::string& definition, double longitude, double latitude)
{
    EXPECT_TRUE(transformation("EPSG:4326", definition)->Transform(1, &longitude, &latitude));
    return {longitude, latitude};
}
} // namespace

// Snyder, Map Projections, 1987, section 8: on the sphere tan(convergence) = tan(longitude from the
// central meridian) sin(latitude). The ellipsoid adds a term of about e'^2 times the cube of that
// longitude: 1e-6 rad at 3 degrees. The tolerance is for the digits of a measured bearing.
TEST(MapPlace, ConvergenceOfUtm)
{
    const struct
    {
        const char* crs;
        double centralMeridian, longitude, latitude;
    } cases[] = {{"EPSG:32633", 15.0, 17.9, 47.0},  {"EPSG:32633", 15.0, 12.1, 60.0},
                 {"EPSG:32633", 15.0, 15.0, 47.0},  {"EPSG:32633", 15.0, 18.0, 0.0},
                 {"EPSG:32733", 15.0, 17.9, -35.0}, {"EPSG:32612", -111.0, -108.1, 36.5}};
    for (const auto& c : cases)
    {
        const auto [x, y] = onMap(c.crs, c.longitude, c.latitude);
        const Result<EarthPlace> place = placeOnMap(wkt(c.crs), x, y);
        ASSERT_TRUE(place) << place.error().message;
        EXPECT_NEAR(place->longitude, c.longitude, 1e-8);
        EXPECT_NEAR(place->latitude, c.latitude, 1e-8);
        const double expected =
            std::atan(std::tan((c.longitude - c.centralMeridian) * radiansPerDegree) *
                      std::sin(c.latitude * radiansPerDegree)) /
            radiansPerDegree;
        EXPECT_NEAR(place->convergence, expected, 0.002) << c.crs << " at " << c.longitude;
    }
}

// North on a polar stereographic map of central meridian L points, at longitude l, along l − L.
TEST(MapPlace, ConvergenceOfAPolarMap)
{
    for (const double longitude : {-120.0, -45.0, 10.0, 100.0})
    {
        const auto [x, y] = onMap("EPSG:3413", longitude, 75.0); // central meridian −45°
        const Result<EarthPlace> place = placeOnMap(wkt("EPSG:3413"), x, y);
        ASSERT_TRUE(place) << place.error().message;
        EXPECT_NEAR(std::remainder(place->convergence - (longitude + 45.0), 360.0), 0.0, 1e-3);
    }
}

TEST(MapPlace, DegreesAreNotTurned)
{
    for (const char* crs : {"EPSG:4326", "EPSG:4258", "EPSG:4267", "EPSG:3857"})
    {
        const auto [x, y] = onMap(crs, -84.25, 36.59);
        const Result<EarthPlace> place = placeOnMap(wkt(crs), x, y);
        ASSERT_TRUE(place) << place.error().message;
        EXPECT_NEAR(place->longitude, -84.25, 1e-6);
        EXPECT_NEAR(place->latitude, 36.59, 1e-6);
        // NAD 27's datum shift turns it by 1e-4 at most.
        EXPECT_NEAR(place->convergence, 0.0, 1e-3) << crs;
    }
    const Result<EarthPlace> pole = placeOnMap(wkt("EPSG:4326"), 20.0, 90.0);
    ASSERT_TRUE(pole) << pole.error().message;
    EXPECT_EQ(pole->latitude, 90.0);
}

TEST(MapPlace, IsTheMiddleOfRasterAndTile)
{
    RasterFrame frame;
    frame.width = 40;
    frame.height = 20;
    frame.hasGeoTransform = true;
    frame.geoTransform = {10.0, 0.01, 0.0, 50.0, 0.0, -0.01};
    frame.crs = wkt("EPSG:4326");
    const Result<EarthPlace> raster = placeOf(frame);
    ASSERT_TRUE(raster) << raster.error().message;
    EXPECT_NEAR(raster->longitude, 10.2, 1e-12);
    EXPECT_NEAR(raster->latitude, 49.9, 1e-12);

    DemTile tile(40, 20, 1000.0);
    tile.crs = frame.crs;
    tile.mapOriginX = 10.005;
    tile.mapOriginY = 49.805;
    tile.mapStepX = tile.mapStepY = 0.01;
    const Result<EarthPlace> same = placeOf(tile);
    ASSERT_TRUE(same) << same.error().message;
    EXPECT_NEAR(same->longitude, 10.2, 1e-12);
    EXPECT_NEAR(same->latitude, 49.9, 1e-12);
}

TEST(MapPlace, SaysWhyThereIsNone)
{
    const auto messageOf = [](const std::string& crs)
    {
        const Result<EarthPlace> place = placeOnMap(crs, 100.0, 200.0);
        EXPECT_FALSE(place);
        return place ? "" : place.error().message;
    };
    EXPECT_EQ(messageOf(""), "the raster has no CRS that tells its place");
    EXPECT_NE(messageOf("nonsense").find("its CRS cannot be read"), std::string::npos);
    EXPECT_NE(messageOf("LOCAL_CS[\"site\",UNIT[\"metre\",1]]").find("does not tell where"),
              std::string::npos);
    const std::string moon = messageOf(wkt("+proj=eqc +R=1737400 +units=m"));
    EXPECT_NE(moon.find("is of a body of 1737.4 km radius; the sun is known by time for the Earth"),
              std::string::npos)
        << moon;
    // The Earth as a sphere is the Earth.
    EXPECT_TRUE(placeOnMap(wkt("+proj=eqc +R=6371007 +units=m"), 1e5, 2e6));
}

namespace
{
/// Convergence of a given place on a map whose middle is elsewhere.
double convergenceOf(const std::string& crs, double longitude, double latitude)
{
    const Result<EarthPlace> place =
        placeInstead(EarthPlace{longitude, latitude, 0.0}, wkt(crs), EarthPlace{1.0, 2.0, 33.0});
    EXPECT_TRUE(place) << (place ? "" : place.error().message);
    if (!place)
        return std::nan("");
    EXPECT_EQ(place->longitude, longitude);
    EXPECT_EQ(place->latitude, latitude);
    return place->convergence;
}

double turned(double degrees)
{
    return std::remainder(degrees, 360.0);
}
} // namespace

// Convergence is that of the given place: UTM as above (its ellipsoid adds 1e-3 degrees), a conic
// map's cone constant times the longitude from its central meridian (Snyder 1987, section 15), and
// the longitude itself on polar maps.
TEST(MapPlace, AGivenPlaceHasTheConvergenceThere)
{
    const auto utm = [](double east, double latitude)
    {
        return std::atan(std::tan(east * radiansPerDegree) *
                         std::sin(latitude * radiansPerDegree)) /
               radiansPerDegree;
    };
    EXPECT_NEAR(convergenceOf("EPSG:32633", 18.0, 60.0), utm(3.0, 60.0), 0.002);
    EXPECT_NEAR(convergenceOf("EPSG:32733", 12.5, -41.0), utm(-2.5, -41.0), 0.002);
    const std::string conic = "+proj=lcc +lat_1=45 +lat_0=45 +lon_0=10 +ellps=WGS84 +units=m";
    for (const double longitude : {-20.0, 10.0, 35.0})
        EXPECT_NEAR(convergenceOf(conic, longitude, 52.0),
                    (longitude - 10.0) * std::sin(45.0 * radiansPerDegree), 1e-5);
    for (const double longitude : {-70.0, -20.0, 130.0})
    {
        EXPECT_NEAR(turned(convergenceOf("EPSG:3413", longitude, 71.0) - (longitude + 45.0)), 0.0,
                    1e-5);
        EXPECT_NEAR(turned(convergenceOf("EPSG:3031", longitude, -82.0) + longitude), 0.0, 1e-5);
    }
    EXPECT_EQ(placeInstead(EarthPlace{10.0, 60.0, 0.0}, "", placeOnMap("", 0.0, 0.0))->convergence,
              0.0)
        << "without a CRS rows run from west to east";
    EXPECT_FALSE(placeInstead(std::nullopt, "", placeOnMap("", 0.0, 0.0)));
    EXPECT_EQ(placeInstead(std::nullopt, "", EarthPlace{9.0, 50.0, 1.5})->convergence, 1.5);
}

// At a pole each longitude has a north of its own, and the rule of polar maps holds for it. The
// tolerance is that of 1e-4 of the radius between the points of a difference.
TEST(MapPlace, APoleIsAPlaceAsAnyOther)
{
    const struct
    {
        const char* crs;
        double latitude, sign, central;
    } maps[] = {{"EPSG:3413", 90.0, 1.0, -45.0},
                {"EPSG:3995", 90.0, 1.0, 0.0},
                {"EPSG:3031", -90.0, -1.0, 0.0},
                {"EPSG:3976", -90.0, -1.0, 0.0},
                {"+proj=laea +lat_0=90 +lon_0=20 +ellps=WGS84", 90.0, 1.0, 20.0}};
    for (const auto& map : maps)
    {
        SCOPED_TRACE(map.crs);
        const Result<EarthPlace> middle = placeOnMap(wkt(map.crs), 0.0, 0.0);
        ASSERT_TRUE(middle) << middle.error().message;
        EXPECT_NEAR(middle->latitude, map.latitude, 1e-9);
        const auto expected = [&](double longitude)
        { return map.sign * (longitude - map.central); };
        EXPECT_NEAR(turned(middle->convergence - expected(middle->longitude)), 0.0, 1e-4);
        for (const double longitude : {0.0, 30.0, -120.0, 180.0, 190.0})
            EXPECT_NEAR(
                turned(convergenceOf(map.crs, longitude, map.latitude) - expected(longitude)), 0.0,
                1e-4)
                << longitude;
        // A kilometre beside it, where a difference along the axis passes the pole closely.
        const Result<EarthPlace> beside = placeOnMap(wkt(map.crs), 300.0, -400.0);
        EXPECT_NEAR(turned(beside->convergence - expected(beside->longitude)), 0.0, 1e-4);
    }
}

// The place used is the middle of the raster, or the one given, wherever the pole lies in it:
// beside the middle, between the four posts of the middle or on one. The y axis of a polar map
// points, as seen at longitude l, along l − l0 in the north and l0 − l in the south.
TEST(MapPlace, RastersWithAPoleInside)
{
    const struct
    {
        const char* crs;
        double sign, central;
        int width, height; // even: the pole is no post
        double poleColumn, poleRow;
    } rasters[] = {
        {"EPSG:3413", 1.0, -45.0, 8, 6, 4, 3},       {"EPSG:3413", 1.0, -45.0, 9, 7, 4.5, 3.5},
        {"EPSG:5041", 1.0, 0.0, 9, 6, 4.5, 3},       {"EPSG:3031", -1.0, 0.0, 10, 10, 5, 5},
        {"EPSG:5042", -1.0, 0.0, 11, 11, 3.25, 6.5}, {"EPSG:3995", 1.0, 0.0, 12, 12, 0.5, 11.5},
        {"EPSG:3408", 1.0, 0.0, 12, 9, 5, 5}}; // equal-area
    for (const auto& raster : rasters)
    {
        SCOPED_TRACE(raster.crs);
        RasterFrame frame;
        frame.width = raster.width;
        frame.height = raster.height;
        frame.hasGeoTransform = true;
        frame.crs = wkt(raster.crs);
        const double cell = 100.0;
        const auto [poleX, poleY] = onMap(raster.crs, 0.0, raster.sign * 90.0);
        frame.geoTransform = {poleX - raster.poleColumn * cell, cell, 0.0,
                              poleY + raster.poleRow * cell,    0.0,  -cell};
        const Result<EarthPlace> middle = placeOf(frame);
        ASSERT_TRUE(middle) << middle.error().message;
        EXPECT_NEAR(middle->latitude, raster.sign * 90.0, 0.01);
        const auto expected = [&](double longitude)
        { return raster.sign * (longitude - raster.central); };
        EXPECT_NEAR(turned(middle->convergence - expected(middle->longitude)), 0.0, 1e-4);
        for (const double longitude : {-100.0, 5.0, 150.0})
            for (const double colatitude : {0.0, 0.002})
            {
                const EarthPlace given{longitude, raster.sign * (90.0 - colatitude), 0.0};
                const Result<EarthPlace> place = placeInstead(given, frame.crs, middle);
                ASSERT_TRUE(place) << place.error().message;
                EXPECT_NEAR(turned(place->convergence - expected(longitude)), 0.0, 1e-4);
            }
    }
}

TEST(MapPlace, AGivenPlaceThatTheMapDoesNotShowIsRefused)
{
    const EarthPlace given{10.0, 60.0, 0.0};
    const Result<EarthPlace> moon = placeInstead(given, wkt("+proj=longlat +R=1737400"), given);
    EXPECT_FALSE(moon) << "time means nothing there";
    const std::string crs = wkt("+proj=ortho +lat_0=0 +lon_0=180 +ellps=WGS84");
    const Result<EarthPlace> behind = placeInstead(given, crs, given);
    ASSERT_FALSE(behind);
    EXPECT_NE(behind.error().message.find("place 10, 60 does not lie on the map"),
              std::string::npos)
        << behind.error().message;
    EXPECT_TRUE(placeInstead(EarthPlace{-170.0, 20.0, 0.0}, crs, given));
    for (const auto& [map, pole] : std::vector<std::pair<std::string, double>>{
             {"EPSG:3413", -90.0}, {"EPSG:3031", 90.0}, {"EPSG:32661", -90.0}})
        EXPECT_FALSE(placeInstead(EarthPlace{10.0, pole, 0.0}, wkt(map), given)) << map;
}
