#include "io/MapPlace.h"

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
    OGRSpatialReference crs, wgs84;
    crs.SetFromUserInput(definition.c_str());
    wgs84.SetWellKnownGeogCS("WGS84");
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRCoordinateTransformation> transform(
        OGRCreateCoordinateTransformation(&wgs84, &crs));
    EXPECT_TRUE(transform->Transform(1, &longitude, &latitude));
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

TEST(MapPlace, AGivenPlaceKeepsTheMapsNorth)
{
    const EarthPlace given{10.0, 60.0, 0.0};
    const Result<EarthPlace> own = EarthPlace{9.0, 50.0, 1.5};
    EXPECT_EQ(placeInstead(given, own)->latitude, 60.0);
    EXPECT_EQ(placeInstead(given, own)->convergence, 1.5);
    EXPECT_EQ(placeInstead(std::nullopt, own)->latitude, 50.0);
    const Result<EarthPlace> none = placeOnMap("", 0.0, 0.0);
    EXPECT_EQ(placeInstead(given, none)->latitude, 60.0);
    EXPECT_FALSE(placeInstead(std::nullopt, none));
    const Result<EarthPlace> moon = placeOnMap(wkt("+proj=longlat +R=1737400"), 0.0, 0.0);
    EXPECT_FALSE(placeInstead(given, moon)) << "time means nothing there";
}
