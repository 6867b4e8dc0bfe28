// Scale and convergence of maps against the factors that PROJ differentiates itself (proj_factors),
// and Web Mercator against the radii of curvature.
#include "io/DemReader.h"
#include "io/MapPlace.h"

#include "support/MemoryRaster.h"

#include <gtest/gtest.h>
#include <ogr_spatialref.h>
#include <proj.h>

#include <cmath>
#include <memory>

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180.0;

struct Place
{
    double longitude, latitude; ///< [rad]
};

/// A projected CRS, its map coordinates by GDAL and its factors by PROJ.
class Projection
{
public:
    explicit Projection(const std::string& definition)
        : _context(proj_context_create(), proj_context_destroy), _proj(nullptr, proj_destroy)
    {
        EXPECT_EQ(_crs.SetFromUserInput(definition.c_str()), OGRERR_NONE);
        _crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        std::unique_ptr<OGRSpatialReference> base(_crs.CloneGeogCS());
        base->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        _toMap.reset(OGRCreateCoordinateTransformation(base.get(), &_crs));
        _toGround.reset(OGRCreateCoordinateTransformation(&_crs, base.get()));
        // As PROJ's own text: x is then east, and a scale is 1 where the map is true, in any unit.
        char* text = nullptr;
        _crs.exportToProj4(&text);
        _proj.reset(proj_create(_context.get(), text));
        CPLFree(text);
        EXPECT_TRUE(_proj) << definition;
    }

    std::string wkt() const
    {
        char* text = nullptr;
        const char* wkt2[] = {"FORMAT=WKT2_2019", nullptr};
        _crs.exportToWkt(&text, wkt2);
        const std::string result = text;
        CPLFree(text);
        return result;
    }
    double metresPerUnit() const { return _crs.GetLinearUnits(); }

    std::pair<double, double> toMap(const Place& place) const
    {
        double x = place.longitude / degree, y = place.latitude / degree;
        EXPECT_TRUE(_toMap->Transform(1, &x, &y));
        return {x, y};
    }
    Place toGround(double x, double y) const
    {
        EXPECT_TRUE(_toGround->Transform(1, &x, &y));
        return {x * degree, y * degree};
    }

    PJ_FACTORS factorsAt(const Place& place) const
    {
        return proj_factors(_proj.get(), proj_coord(place.longitude, place.latitude, 0, 0));
    }

private:
    OGRSpatialReference _crs;
    std::unique_ptr<OGRCoordinateTransformation> _toMap, _toGround;
    std::unique_ptr<PJ_CONTEXT, decltype(&proj_context_destroy)> _context;
    std::unique_ptr<PJ, decltype(&proj_destroy)> _proj;
};

/// Of 9 posts a side about a place, a checkerboard of 0 and 100 m: the height of a post tells its
/// factor.
DemFile readAround(const std::string& crs, double x, double y, double cell)
{
    constexpr int posts = 9;
    MemoryRaster raster;
    raster.crs = crs;
    raster.unit = "m";
    raster.width = raster.height = posts;
    raster.transform = {x - 0.5 * posts * cell, cell, 0, y + 0.5 * posts * cell, 0, -cell};
    raster.values.clear();
    for (int i = 0; i < posts * posts; ++i)
        raster.values.push_back(100.0 * (i % 2));
    const Result<DemFile> file = readDem(raster.write());
    EXPECT_TRUE(file) << (file ? "" : file.error().message);
    return file ? *file : DemFile();
}

double halfRange(const DemFile& file, int column, int row)
{
    return std::abs(static_cast<double>(file.tile.heightAt(column, row)));
}

struct Conformal
{
    const char* crs;
    double longitude, latitude; ///< [degrees]
    double cell;                ///< [map units]
};

// None of them is true within 0.2 % at its place, where the map's own distances would be kept.
const Conformal conformal[] = {
    {"EPSG:3395", 20, 63, 300},    // World Mercator
    {"EPSG:3994", 170, -15, 400},  // Mercator, true at 41 degrees south
    {"EPSG:3034", 30, 70, 500},    // conic, Europe
    {"EPSG:3413", -120, 55, 600},  // stereographic, true at 70 degrees north
    {"EPSG:3031", 100, -45, 700},  // the same of Antarctica
    {"EPSG:5041", 33, 88, 250},    // UPS: 0.994 at the pole
    {"EPSG:32633", 30, 60, 200},   // UTM, two zones off
    {"EPSG:2226", -100, 45, 1000}, // conic in US survey feet, far from California
    {"EPSG:3375", 125, 10, 900},   // oblique Mercator, far from Malaysia
    {"+proj=stere +lat_0=40 +lon_0=10 +ellps=WGS84 +units=m", 40, 60, 800}, // oblique
    {"+proj=lcc +lat_1=20 +lat_2=40 +lat_0=30 +a=3396190 +b=3376200 +units=m", 15, -10,
     300},                                                              // Mars
    {"+proj=stere +lat_0=-90 +R=1737400 +units=m", 77, -40, 150},       // Moon
    {"+proj=merc +lat_ts=15 +R=2575000 +units=m", 200, 70, 100},        // Titan
    {"+proj=tmerc +lat_0=0 +lon_0=0 +R=2439400 +units=m", 25, 15, 120}, // Mercury
};
} // namespace

// A conformal map's scale h is the same in all directions (Snyder 1987, section 4): the tile has
// the map's distances over the scale of its middle, and its heights are multiplied by the scale of
// their post over that. Tolerances: PROJ's differences are 1e-5 rad apart, ours 1e-4 of the radius,
// and a central difference is wrong by the square of that.
TEST(MapScale, OfConformalMapsIsThatOfProj)
{
    for (const Conformal& map : conformal)
    {
        SCOPED_TRACE(map.crs);
        const Projection projection(map.crs);
        const auto [x, y] = projection.toMap({map.longitude * degree, map.latitude * degree});
        const double middle =
            projection.factorsAt({map.longitude * degree, map.latitude * degree}).meridional_scale;
        ASSERT_GT(std::abs(middle - 1.0), 0.002) << "a test of nothing";
        const DemFile file = readAround(map.crs, x, y, map.cell);
        ASSERT_EQ(file.tile.width(), 9);
        const double metres = map.cell * projection.metresPerUnit();
        EXPECT_NEAR(file.tile.northSpacing, metres / middle, 1e-6 * metres);
        for (int row = 0; row < 9; row += 4)
            for (int column = 0; column < 9; column += 4)
            {
                const PJ_FACTORS here = projection.factorsAt(
                    projection.toGround(x + (column - 4) * map.cell, y + (row - 4) * map.cell));
                EXPECT_NEAR(here.meridional_scale, here.parallel_scale, 1e-6) << "conformal";
                EXPECT_NEAR(halfRange(file, column, row) / 50.0, here.meridional_scale / middle,
                            2e-6);
                EXPECT_NEAR(file.tile.eastSpacing(row), metres / middle, 1e-5 * metres);
            }
        EXPECT_TRUE(file.notes.empty()) << file.notes.front();
    }
}

// x = a λ, y = a ln tan(π/4 + φ/2) of the geodetic latitude: on the ground a step of x is
// N cos φ/a long, one of y M cos φ/a, N and M being the radii of curvature (Snyder 1987, 4-18 and
// 4-20). They differ by up to 0.7 %, which the row's spacing takes.
TEST(MapScale, OfWebMercatorIsThatOfTheEllipsoid)
{
    const double a = 6378137.0;
    const double e2 = 0.00669437999014;
    for (const double latitude : {60.0, 10.0, -33.0, 80.0})
    {
        SCOPED_TRACE(latitude);
        const double cell = 200.0;
        const double y = a * std::log(std::tan(pi / 4.0 + latitude * degree / 2.0));
        const DemFile file = readAround("EPSG:3857", -3e6, y, cell);
        const auto metres = [&](int row)
        {
            const double phi = 2.0 * std::atan(std::exp((y + (row - 4) * cell) / a)) - pi / 2.0;
            const double w2 = 1.0 - e2 * std::pow(std::sin(phi), 2.0);
            const double n = a / std::sqrt(w2);
            const double m = n * (1.0 - e2) / w2;
            return std::pair(cell * n * std::cos(phi) / a, cell * m * std::cos(phi) / a);
        };
        EXPECT_NEAR(file.tile.northSpacing, metres(4).second, 1e-6 * cell);
        for (const int row : {0, 2, 4, 8})
        {
            const double factor = metres(4).second / metres(row).second;
            EXPECT_NEAR(halfRange(file, 0, row), 50.0 * factor, 50.0 * 2e-6);
            EXPECT_NEAR(file.tile.eastSpacing(row) / factor, metres(row).first, 2e-6 * cell);
        }
        EXPECT_TRUE(file.notes.empty()) << file.notes.front();
    }
}

// North on the map is the way that x and y take with the latitude; the y axis lies as far to the
// other side of it.
TEST(MapScale, ConvergenceIsThatOfProj)
{
    int compared = 0;
    for (const Conformal& map : conformal)
    {
        SCOPED_TRACE(map.crs);
        const Projection projection(map.crs);
        const Place place = {map.longitude * degree, map.latitude * degree};
        const auto [x, y] = projection.toMap(place);
        const Result<EarthPlace> found = placeOnMap(projection.wkt(), x, y);
        if (!found)
        {
            EXPECT_NE(found.error().message.find("for the Earth only"), std::string::npos);
            continue;
        }
        const PJ_FACTORS factors = projection.factorsAt(place);
        const double expected = -std::atan2(factors.dx_dphi, factors.dy_dphi) / degree;
        EXPECT_NEAR(std::remainder(found->convergence - expected, 360.0), 0.0, 1e-4);
        ++compared;
    }
    EXPECT_EQ(compared, 10);
}

// Maps that are true at their place have their own distances and no word is said; nor is one
// where the scale is right by the factors above.
TEST(MapScale, NothingIsSaidOfMapsThatCanBeLitRightly)
{
    const struct
    {
        const char* crs;
        double x, y, cell;
    } maps[] = {
        {"+proj=stere +lat_0=90 +R=1737400 +units=m", 0, 0, 20}, // the pole in the middle
        {"+proj=stere +lat_0=-90 +R=1737400 +units=m", 30000, 8000, 60},
        {"+proj=stere +lat_0=-90 +a=3396190 +b=3376200 +units=m", 40, -60, 100}, // inside
        {"+proj=stere +lat_0=90 +R=2439400 +units=m", 400000, 0, 665},
        {"+proj=laea +lat_0=90 +R=3396190 +units=m", 100, 0, 200},
        {"+proj=aeqd +lat_0=-90 +R=1188300 +units=m", 0, 0, 300}, // Pluto
        {"+proj=eqc +R=1737400 +units=m", 2e5, 8e5, 118},         // by row
        {"+proj=eqc +lat_ts=40 +R=3396190 +units=m", -1e6, -3e6, 463},
        {"+proj=sinu +R=6051800 +units=m", 0, 4e6, 75}, // Venus, in its middle
        {"EPSG:3413", 0, 0, 500},
        {"EPSG:3031", 2e5, -3e5, 500},
        {"EPSG:6933", 1e6, 5e6, 1000}, // cylindrical, by row
    };
    for (const auto& map : maps)
    {
        SCOPED_TRACE(map.crs);
        const DemFile file = readAround(map.crs, map.x, map.y, map.cell);
        ASSERT_EQ(file.tile.width(), 9);
        EXPECT_TRUE(file.notes.empty()) << file.notes.front();
        EXPECT_EQ(file.tile.validCount(), 81u);
    }
}

TEST(MapScale, NoAdviceOfUtmBeyondTheEarth)
{
    const struct
    {
        const char* crs;
        bool earth;
    } maps[] = {{"+proj=sinu +R=3396190 +units=m", false},
                {"+proj=sinu +R=2439400 +units=m", false},
                {"+proj=sinu +R=2575000 +units=m", false},
                {"+proj=sinu +R=6051800 +units=m", false}, // Venus is 5 % smaller than the Earth
                {"+proj=sinu +R=6371000 +units=m", true},
                {"+proj=sinu +ellps=clrk66 +units=m", true}};
    for (const auto& map : maps)
    {
        SCOPED_TRACE(map.crs);
        const DemFile file = readAround(map.crs, 1.5e6, 1.8e6, 500.0);
        ASSERT_EQ(file.notes.size(), 1u);
        EXPECT_NE(file.notes[0].find("differs by direction"), std::string::npos);
        EXPECT_EQ(file.notes[0].find("UTM") != std::string::npos, map.earth) << file.notes[0];
    }
}

// Distances are the map's then, and a note says so.
TEST(MapScale, AMiddleThatIsNowhereIsTold)
{
    const struct
    {
        const char* crs;
        double x, y;
    } maps[] = {{"+proj=ortho +lat_0=0 +lon_0=0 +R=6371000 +units=m", 6e6, 5e6}, // beside the globe
                {"+proj=moll +R=6371000 +units=m", 1.7e7, 8e6},                  // beside the oval
                {"+proj=geos +h=35785831 +R=6378137 +units=m", 5.4e6, 3e6}, // a satellite's sky
                {"PROJCS[\"mine\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,"
                 "298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],"
                 "PROJECTION[\"Of_my_own\"],UNIT[\"metre\",1]]",
                 1000, 1000}};
    for (const auto& map : maps)
    {
        SCOPED_TRACE(map.crs);
        const DemFile file = readAround(map.crs, map.x, map.y, 100.0);
        ASSERT_EQ(file.tile.width(), 9);
        EXPECT_EQ(file.tile.northSpacing, 100.0);
        ASSERT_EQ(file.notes.size(), 1u);
        EXPECT_NE(file.notes[0].find("distances are taken from the map"), std::string::npos);
    }
}
