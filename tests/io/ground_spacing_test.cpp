#include "io/GroundSpacing.h"

#include "io/DemReader.h"
#include "io/GdalErrors.h"
#include "support/DemHeights.h"
#include "support/MemoryRaster.h"

#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

// Ground distances of projected maps against the closed forms of Snyder, Map Projections, 1987.

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180.0;
constexpr double radius = 6371000.0;

double heightAt(const DemTile& tile, int column, int row)
{
    return static_cast<double>(tile.heightAt(column, row));
}

/// posts a side around a point of a map, a checkerboard of 0 and 100 m so that each post's factor
/// can be read.
MemoryRaster around(const std::string& crs, double x, double y, double cell, int posts)
{
    MemoryRaster raster;
    raster.crs = crs;
    raster.width = raster.height = posts;
    raster.transform = {x - 0.5 * posts * cell, cell, 0, y + 0.5 * posts * cell, 0, -cell};
    raster.values.clear();
    for (int row = 0; row < posts; ++row)
        for (int column = 0; column < posts; ++column)
            raster.values.push_back((row + column) % 2 ? 100.0 : 0.0);
    return raster;
}

DemFile read(const MemoryRaster& raster)
{
    const Result<DemFile> file = readDem(raster.write());
    EXPECT_TRUE(file) << (file ? "" : file.error().message);
    return file ? *file : DemFile();
}

std::string sphere(const std::string& projection)
{
    return projection + " +units=m +R=" + std::to_string(radius);
}

/// scale(x, y): map over ground at a place of the map, the same in all directions. Both spacings
/// are the map's over the scale of the middle; heights take the rest.
void expectConformal(const std::string& crs, double x, double y, double cell,
                     const std::function<double(double, double)>& scale)
{
    SCOPED_TRACE(crs);
    const int posts = 41;
    const DemFile file = read(around(crs, x, y, cell, posts));
    ASSERT_EQ(file.tile.width(), posts);
    const double middle = scale(x, y);
    EXPECT_NEAR(file.tile.northSpacing, cell / middle, 2e-6 * cell);
    for (const int row : {0, 7, 20, 33, 40})
        for (const int column : {0, 11, 20, 29, 40})
        {
            EXPECT_NEAR(file.tile.eastSpacing(row), cell / middle, 1e-5 * cell);
            // The origin of heights is 50 m, in the middle of the range.
            const double here = scale(x + (column - 20) * cell, y + (row - 20) * cell);
            EXPECT_NEAR(std::abs(heightAt(file.tile, column, row)), 50.0 * here / middle,
                        50.0 * 1e-5)
                << column << ", " << row;
        }
    EXPECT_TRUE(file.notes.empty()) << file.notes.front();
}
} // namespace

TEST(GroundSpacing, ConformalMapsAreExact)
{
    const auto mercator = [](double, double y) { return std::cosh(y / radius); }; // eq. 7-3
    for (const double latitude : {60.0, -45.0, 75.0})
        expectConformal(sphere("+proj=merc"), 1e6,
                        radius * std::log(std::tan(pi / 4.0 + latitude * degree / 2.0)), 500.0,
                        mercator);
    // Transverse, 1000 km from the central meridian: eq. 8-4 in terms of x.
    expectConformal(sphere("+proj=tmerc +lat_0=0 +lon_0=0 +k=1"), 1e6, 3e6, 800.0,
                    [](double x, double) { return std::cosh(x / radius); });
    // The same with the numbers of UTM's zone 31, which PROJ takes for UTM.
    expectConformal(
        sphere("+proj=tmerc +lat_0=0 +lon_0=3 +k=0.9996 +x_0=500000"), 1.5e6, 3e6, 800.0,
        [](double x, double) { return 0.9996 * std::cosh((x - 5e5) / (0.9996 * radius)); });
    // Polar stereographic, 3000 km from the pole: k = 1 + (r/2R)², eqs 21-4 and 21-14.
    expectConformal(sphere("+proj=stere +lat_0=-90 +k=1"), 1.8e6, 2.4e6, 700.0,
                    [](double x, double y)
                    { return 1.0 + (x * x + y * y) / (4.0 * radius * radius); });
    // Conic with one parallel, 1500 km north of it: eqs 15-1 to 15-4.
    const double parallel = 45.0 * degree;
    const double n = std::sin(parallel);
    const double f =
        std::cos(parallel) * std::pow(std::tan(pi / 4.0 + parallel / 2.0), n) / n * radius;
    const double from = radius / std::tan(parallel);
    expectConformal(sphere("+proj=lcc +lat_1=45 +lat_0=45 +lon_0=0"), 2e5, 1.5e6, 600.0,
                    [=](double x, double y)
                    {
                        const double rho = std::hypot(x, from - y);
                        const double latitude =
                            2.0 * std::atan(std::pow(f / rho, 1.0 / n)) - pi / 2.0;
                        return n * rho / (radius * std::cos(latitude));
                    });
}

// On the ellipsoid Mercator's scale is a / (N cos(latitude)), N the prime vertical radius: eq. 7-8.
TEST(GroundSpacing, MercatorOfTheEllipsoid)
{
    const double a = 6378137.0;
    const double e2 = 0.00669437999014;
    const double latitude = 60.0 * degree;
    const double sine = std::sin(latitude);
    const double e = std::sqrt(e2);
    const double y = a * (std::atanh(sine) - e * std::atanh(e * sine)); // eq. 7-7
    const DemFile file = read(around("EPSG:3395", 0.0, y, 100.0, 5));
    const double expected = 100.0 * std::cos(latitude) / std::sqrt(1.0 - e2 * sine * sine);
    EXPECT_NEAR(file.tile.northSpacing, expected, 1e-5);
    EXPECT_NEAR(file.tile.eastSpacing(2), expected, 1e-4);
}

TEST(GroundSpacing, CylindricalMapsAreExactByRow)
{
    // Equirectangular, true at 30 degrees: the north axis is true, a row is cos(30°)/cos too long.
    const double cell = 1000.0;
    const double middle = 55.0 * degree * radius;
    DemFile file = read(around(sphere("+proj=eqc +lat_ts=30"), 2e5, middle, cell, 201));
    EXPECT_NEAR(file.tile.northSpacing, cell, 1e-3);
    for (const int row : {0, 50, 100, 200})
    {
        const double latitude = (middle + (row - 100) * cell) / radius;
        EXPECT_NEAR(file.tile.eastSpacing(row), cell * std::cos(latitude) / std::cos(30.0 * degree),
                    1e-2);
        EXPECT_NEAR(std::abs(heightAt(file.tile, 0, row)), 50.0, 1e-3);
    }
    EXPECT_TRUE(file.notes.empty());

    // Equal-area, true at the equator: y = R sin(latitude); what rows are too long, columns are too
    // short. Heights carry the north axis, as a tile has one spacing of rows.
    const double start = std::sin(50.0 * degree) * radius;
    file = read(around(sphere("+proj=cea"), 0.0, start, cell, 201));
    EXPECT_NEAR(file.tile.northSpacing, cell / std::cos(50.0 * degree), 1e-2);
    for (const int row : {0, 100, 200})
    {
        const double sine = (start + (row - 100) * cell) / radius;
        const double cosine = std::sqrt(1.0 - sine * sine);
        const double factor = std::abs(heightAt(file.tile, 0, row)) / 50.0;
        EXPECT_NEAR(factor, cosine / std::cos(50.0 * degree), 1e-5);
        // Slopes east: height over spacing is as on the ground, where a column is cell · cos wide.
        EXPECT_NEAR(file.tile.eastSpacing(row) / factor, cell * cosine, 2e-2);
    }
    EXPECT_TRUE(file.notes.empty());
}

// Azimuthal maps at an arc c from their centre, along x: scales by Snyder 1987, eqs 20-4 and 20-5
// (orthographic: cos c and 1), 22-1 and 22-2 (gnomonic: 1/cos² c and 1/cos c), 24-1a (equal-area:
// cos(c/2) and its inverse). East over north differs along a row, so no row has one of its own.
TEST(GroundSpacing, TheMiddleOfAnAzimuthalMapIsExact)
{
    const double moon = 1737400.0;
    const struct
    {
        const char* crs;
        double x, cell;
        std::function<std::pair<double, double>(double)> scales; // by x/R: along and across
    } maps[] = {{"+proj=ortho +lat_0=0 +R=1737400 +units=m", 0.0, 80000.0,
                 [](double s) { return std::pair(std::sqrt(1.0 - s * s), 1.0); }},
                {"+proj=ortho +lat_0=0 +R=1737400 +units=m", 6e5, 40000.0,
                 [](double s) { return std::pair(std::sqrt(1.0 - s * s), 1.0); }},
                {"+proj=gnom +lat_0=90 +R=1737400 +units=m", 0.0, 40000.0,
                 [](double s) { return std::pair(1.0 + s * s, std::sqrt(1.0 + s * s)); }},
                {"+proj=gnom +lat_0=90 +R=1737400 +units=m", 9e5, 40000.0,
                 [](double s) { return std::pair(1.0 + s * s, std::sqrt(1.0 + s * s)); }},
                {"+proj=laea +lat_0=90 +R=1737400 +units=m", 5e5, 40000.0,
                 [](double s)
                 {
                     const double cosine = std::sqrt(1.0 - s * s / 4.0);
                     return std::pair(cosine, 1.0 / cosine);
                 }}};
    for (const auto& map : maps)
    {
        SCOPED_TRACE(map.crs);
        const DemFile file = read(around(map.crs, map.x, 0.0, map.cell, 41));
        ASSERT_EQ(file.tile.width(), 41);
        const auto [along, across] = map.scales(map.x / moon);
        EXPECT_NEAR(file.tile.northSpacing, map.cell / across, 1e-6 * map.cell);
        for (const int row : {0, 20, 40})
            EXPECT_NEAR(file.tile.eastSpacing(row), map.cell / along, 1e-6 * map.cell);
        EXPECT_NEAR(std::abs(heightAt(file.tile, 20, 20)), 50.0, 1e-3);
        EXPECT_NE(noteWith(file, "differs by direction"), "");
    }
}

TEST(GroundSpacing, AWholePlanetHasPositiveSpacings)
{
    MemoryRaster raster;
    raster.crs = "+proj=eqc +R=1737400 +units=m";
    raster.width = 36;
    raster.height = 18;
    const double cell = 10.0 * degree * 1737400.0;
    raster.transform = {-18 * cell, cell, 0, 9 * cell, 0, -cell};
    raster.values.assign(36 * 18, 5.0);
    const DemFile file = read(raster);
    EXPECT_EQ(file.tile.validCount(), 36u * 18u);
    for (int row = 0; row < 18; ++row)
        EXPECT_NEAR(file.tile.eastSpacing(row), cell * std::cos((row * 10 - 85) * degree), 1.0)
            << row;
}

TEST(GroundSpacing, MapsThatAreTrueKeepTheirOwn)
{
    for (const char* crs : {"EPSG:32633", "EPSG:2154", "EPSG:27700"})
    {
        const double x = std::string(crs) == "EPSG:27700" ? 4e5 : 6e5;
        const double y = std::string(crs) == "EPSG:27700" ? 4e5 : 6.5e6;
        const DemFile file = read(around(crs, x, y, 25.0, 5));
        EXPECT_EQ(file.tile.northSpacing, 25.0) << crs;
        EXPECT_EQ(file.tile.eastSpacings, std::vector<double>{25.0}) << crs;
        EXPECT_EQ(heightAt(file.tile, 0, 0), -50.0) << crs;
    }
    // A polar map with the pole beside, on and off its middle.
    for (const double shift : {0.0, 2.5, 200.0})
        EXPECT_EQ(read(around("+proj=stere +lat_0=-90 +R=1737400", shift, -shift, 5.0, 9))
                      .tile.northSpacing,
                  5.0);
}

TEST(GroundSpacing, AScaleThatDiffersByDirectionIsTold)
{
    // Sinusoidal, far from its central meridian: sheared.
    const double y = 50.0 * degree * radius;
    const DemFile sheared = read(around(sphere("+proj=sinu"), 3e6, y, 500.0, 9));
    ASSERT_EQ(sheared.notes.size(), 1u);
    // Snyder section 30: the axes' ratio by tan(w/2) = ½ tan... of the shear s = λ sin(latitude):
    // singular values of (1, s; 0, 1) multiply to 1 and their squares add up to 2 + s².
    const double s = 3e6 / (radius * std::cos(50.0 * degree)) * std::sin(50.0 * degree);
    const double ratio = std::pow(std::sqrt(1.0 + s * s / 4.0) + s / 2.0, 2.0);
    EXPECT_NE(sheared.notes.front().find("by a factor of up to"), std::string::npos);
    const double told =
        std::stod(sheared.notes.front().substr(sheared.notes.front().find("up to ") + 6));
    EXPECT_NEAR(told, ratio, 0.1);
    EXPECT_NE(sheared.notes.front().find("UTM"), std::string::npos);
    const DemFile moon = read(around("+proj=sinu +R=1737400 +units=m", 1e6, 1e6, 100.0, 9));
    ASSERT_EQ(moon.notes.size(), 1u);
    EXPECT_EQ(moon.notes.front().find("UTM"), std::string::npos) << "there is none of the Moon";
    EXPECT_NE(moon.notes.front().find("stereographic"), std::string::npos);
}

// The claim of HeightFactors: between any two posts the tangent is the height's difference over
// the ground's distance, but for |gradient of ln(scale)| · greatest height above the origin. What
// remains is of second order: the mean of the scale along the way against that of its ends, d²/12
// of its relative curvature (1 + 2 tan²)/R², and the way's own curve, (d tan/R)²/24.
TEST(GroundSpacing, TangentsAcrossAMercatorMapAgainstGreatCircles)
{
    const int posts = 201;
    const double cell = 2000.0; // about 1 km on the ground
    const double y = radius * std::log(std::tan(pi / 4.0 + 60.0 * degree / 2.0));
    MemoryRaster raster = around(sphere("+proj=merc"), 0.0, y, cell, posts);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> height(0.0, 4000.0);
    for (double& value : raster.values)
        value = std::floor(height(random));
    const DemFile file = read(raster);
    const auto latitudeOf = [&](int row)
    { return std::atan(std::sinh((y + (row - posts / 2) * cell) / radius)); };
    std::uniform_int_distribution<int> post(0, posts - 1);
    double greatest = 0.0;
    for (int i = 0; i < 20000; ++i)
    {
        const int c0 = post(random), r0 = post(random), c1 = post(random), r1 = post(random);
        if (c0 == c1 && r0 == r1)
            continue;
        const double lat0 = latitudeOf(r0), lat1 = latitudeOf(r1);
        const double hav = std::pow(std::sin((lat1 - lat0) / 2.0), 2.0) +
                           std::cos(lat0) * std::cos(lat1) *
                               std::pow(std::sin((c1 - c0) * cell / radius / 2.0), 2.0);
        const double distance = 2.0 * radius * std::asin(std::sqrt(hav));
        const auto stored = [&](int column, int row)
        { return raster.values[static_cast<std::size_t>((posts - 1 - row) * posts + column)]; };
        const double truth = (stored(c1, r1) - stored(c0, r0)) / distance;
        const double found =
            (heightAt(file.tile, c1, r1) - heightAt(file.tile, c0, r0)) /
            std::hypot((c1 - c0) * file.tile.eastSpacing(0), (r1 - r0) * file.tile.northSpacing);
        const double tangent = std::tan(std::max(lat0, lat1));
        const double way = distance / radius;
        const double bound =
            tangent / radius * 2000.0 +
            std::abs(truth) * way * way *
                ((1.0 + 2.0 * tangent * tangent) / 12.0 + tangent * tangent / 24.0);
        // 2e-5 of interpolation and of float heights.
        ASSERT_NEAR(found, truth, bound + 2e-5 * std::abs(truth) + 1e-3 / distance)
            << c0 << ", " << r0 << " to " << c1 << ", " << r1;
        greatest = std::max(greatest, std::abs(found - truth));
    }
    EXPECT_GT(greatest, 0.0);
}

// Slopes are wrong by |gradient of ln(scale)| on the ground times half the range of heights: in
// Mercator tan(latitude)/R; on a stereographic map at a distance r from the pole, where k = 1 +
// (r/2R)², it is r/2R² along the meridian; on a transverse Mercator map sinh(x/R)/R.
TEST(GroundSpacing, AScaleThatChangesTooFastIsTold)
{
    const double moon = 1737400.0;
    const auto mercatorY = [](double latitude, double r)
    { return r * std::log(std::tan(pi / 4.0 + latitude * degree / 2.0)); };
    const struct
    {
        std::string crs;
        double x, y;
        double halfRange; // of heights [m]
        double gradient;  // [1/m]
    } maps[] = {
        {sphere("+proj=merc"), 0, mercatorY(80, radius), 4000, std::tan(80 * degree) / radius},
        {sphere("+proj=merc"), 0, mercatorY(60, radius), 4000, std::tan(60 * degree) / radius},
        {"+proj=merc +R=1737400 +units=m", 0, mercatorY(-60, moon), 9000,
         std::tan(60 * degree) / moon},
        {"+proj=stere +lat_0=90 +R=1737400 +units=m", 2 * moon, 0, 9000, 1 / moon},
        {"+proj=stere +lat_0=90 +R=1737400 +units=m", moon, -moon, 9000,
         std::sqrt(0.5) / moon}, // the same along a diagonal of the map
        {"+proj=tmerc +R=1737400 +units=m", 0.3 * moon, 0, 9000, std::sinh(0.3) / moon}};
    for (const auto& map : maps)
    {
        SCOPED_TRACE(map.crs);
        MemoryRaster raster = around(map.crs, map.x, map.y, 300.0, 9);
        for (double& value : raster.values)
            value *= map.halfRange / 50.0;
        const DemFile file = read(raster);
        const double wrong = std::atan(map.gradient * map.halfRange) / degree;
        ASSERT_EQ(file.notes.size(), wrong > 0.1 ? 1u : 0u) << wrong;
        if (file.notes.empty())
            continue;
        const std::size_t at = file.notes[0].find("wrong by up to ");
        ASSERT_NE(at, std::string::npos) << file.notes[0];
        EXPECT_NEAR(std::stod(file.notes[0].substr(at + 15)), wrong, 0.051) << "one digit is told";
    }
    // Cells that are not square: the gradient is that on the ground.
    const HeightFactors factors(3, 3, 2, 2, {1.0, std::exp(0.06), std::exp(0.08), std::exp(0.14)});
    EXPECT_NEAR(factors.steepest(10.0, 20.0), std::hypot(0.06 / 20.0, 0.08 / 40.0), 1e-12);
}

// Asked directly, since GeoTIFF keeps not all of them.
TEST(GroundSpacing, OfOtherKindsOfCrs)
{
    const std::string rotated = // as climate models have it
        "+proj=ob_tran +o_proj=longlat +o_lon_p=-162 +o_lat_p=39.25 +lon_0=180 +R=6371229 "
        "+to_meter=0.0174532925199433";
    const struct
    {
        std::string crs;
        const char* said; // part of the one note, or of the error where there is no spacing
        double north;     // of 0.1 units [m]
    } kinds[] = {{"EPSG:4978", "is geocentric", 0.0},
                 {"EPSG:4936", "is geocentric", 0.0}, // ETRS89
                 {"EPSG:7656", "is geocentric", 0.0}, // WGS 84 (G730)
                 {"EPSG:5773", "has no horizontal part", 0.1},
                 {"EPSG:5703", "has no horizontal part", 0.1},
                 {"EPSG:8228", "has no horizontal part", 0.1},
                 {"LOCAL_CS[\"pit\",UNIT[\"metre\",1]]", "one unit is taken as 1 m", 0.1},
                 {"LOCAL_CS[\"mine\",UNIT[\"US survey foot\",0.304800609601219]]",
                  "one unit is taken as 0.3048006096 m", 120.0 / 3937.0},
                 {"LOCAL_CS[\"ship\",UNIT[\"kilometre\",1000]]", "is taken as 1000 m", 100.0},
                 {rotated, "a pole of its own", 0.1 * degree * 6371229.0}};
    const GdalErrors quiet;
    for (const auto& kind : kinds)
    {
        SCOPED_TRACE(kind.crs);
        OGRSpatialReference crs;
        ASSERT_EQ(crs.SetFromUserInput(kind.crs.c_str()), OGRERR_NONE);
        RasterFrame frame;
        frame.width = frame.height = 10;
        frame.hasGeoTransform = true;
        frame.geoTransform = {5.0, 0.1, 0.0, 1.0, 0.0, -0.1};
        const Result<GroundSpacing> ground = measureGround("a.tif", &crs, frame);
        ASSERT_EQ(ground.ok(), kind.north > 0.0);
        if (!ground)
        {
            EXPECT_NE(ground.error().message.find(kind.said), std::string::npos);
            continue;
        }
        ASSERT_EQ(ground->notes.size(), 1u);
        EXPECT_NE(ground->notes[0].find(kind.said), std::string::npos) << ground->notes[0];
        EXPECT_NEAR(ground->north, kind.north, 1e-9 * kind.north);
        EXPECT_EQ(ground->geographic, kind.crs == rotated);
    }
}

// A light's azimuth counts clockwise from north, which holds where x runs east and y north. The
// right-handed pair (x, y) is turned by as much as its y axis; of the other hand it is mirrored.
TEST(GroundSpacing, AxesThatPointElsewhereAreTold)
{
    RasterFrame frame;
    frame.width = frame.height = 5;
    frame.hasGeoTransform = true;
    const auto notesOf = [&](const char* name)
    {
        OGRSpatialReference crs;
        EXPECT_EQ(crs.SetFromUserInput(name), OGRERR_NONE) << name;
        crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        const bool inDegrees = crs.IsGeographic() != FALSE;
        frame.geoTransform = {inDegrees ? 20.0 : 2000000.0,
                              inDegrees ? 0.001 : 30.0,
                              0.0,
                              inDegrees ? 10.0 : 2000000.0,
                              0.0,
                              inDegrees ? -0.001 : -30.0};
        const Result<GroundSpacing> ground = measureGround("a.tif", &crs, frame);
        EXPECT_TRUE(ground) << name;
        std::string found;
        for (const std::string& note : ground ? ground->notes : std::vector<std::string>())
            if (note.find("axes point") != std::string::npos)
                found += note;
        return found;
    };
    for (const auto& [crs, axes, effect] : std::vector<std::array<const char*, 3>>{
             {"EPSG:2048", "west and south", "azimuths count from the south"}, // South Africa
             {"EPSG:2065", "south and west", "mirrored"},                      // Krovak, Ferro
             {"IAU_2015:49901", "west and north", "mirrored"}, // Mars, planetographic
             {"IAU_2015:49911", "west and north", "mirrored"},
             {"EPSG:2048+5703", "west and south", "azimuths count from the south"}})
    {
        const std::string note = notesOf(crs);
        EXPECT_NE(note.find(axes), std::string::npos) << crs << ": " << note;
        EXPECT_NE(note.find(effect), std::string::npos) << crs << ": " << note;
    }
    // In degrees, in Poland, where the CRS has the north first, and about both poles.
    for (const char* crs : {"EPSG:4326", "IAU_2015:49900", "EPSG:2180", "EPSG:5514", "EPSG:3031",
                            "EPSG:3995", "EPSG:32661", "EPSG:5042", "EPSG:32633+5773"})
        EXPECT_EQ(notesOf(crs), "") << crs;
}
