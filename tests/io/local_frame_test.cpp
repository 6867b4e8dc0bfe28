// Viewpoints in the local metres of a terrain.
#include "io/LocalFrame.h"

#include "support/MapTransform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

using namespace osgTerrainLight;

namespace
{
constexpr double degree = 3.14159265358979323846 / 180.0;

std::string wktOf(const char* crs)
{
    OGRSpatialReference reference;
    EXPECT_EQ(reference.SetFromUserInput(crs), OGRERR_NONE);
    char* text = nullptr;
    reference.exportToWkt(&text);
    const std::string wkt = text;
    CPLFree(text);
    return wkt;
}

/// 101 x 61 posts, level at 200 m, in steps of the map; `metres` is the east spacing of a map of
/// degrees, and the step of any other.
DemTile tileAt(const char* crs, double west, double south, double step, double metres)
{
    DemTile tile(101, 61, metres);
    tile.crs = crs ? wktOf(crs) : "";
    tile.mapOriginX = west;
    tile.mapOriginY = south;
    tile.mapStepX = tile.mapStepY = step;
    tile.heightOrigin = 150.0;
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column)
            tile.setHeight(column, row, 50.0f);
    return tile;
}

EarthViewpoint at(double longitude, double latitude)
{
    EarthViewpoint viewpoint;
    viewpoint.name = "v";
    viewpoint.longitude = longitude;
    viewpoint.latitude = latitude;
    viewpoint.height = 321.0;
    viewpoint.heading = 30.0;
    viewpoint.pitch = -20.0;
    viewpoint.range = 500.0;
    return viewpoint;
}

Result<Viewpoint> placed(const EarthViewpoint& viewpoint, const DemTile& tile)
{
    std::vector<std::string> notes;
    Result<Viewpoint> result = placeViewpoint(viewpoint, localFrameOf(tile), notes);
    EXPECT_TRUE(notes.empty()) << notes.front();
    return result;
}
} // namespace

// Expected: the metres that PROJ gives, from the middle of the tile. North of the map lies off true
// north by difference in longitude times sine of latitude, within 1/100 degree so near to the
// central meridian (Snyder 1987, eq. 8-14).
TEST(LocalFrame, PlacesOnUtm)
{
    const DemTile tile = tileAt("EPSG:32633", 700000.0, 5300000.0, 30.0, 30.0);
    const auto toUtm = transformation("EPSG:4326", "EPSG:32633");
    for (const auto& [longitude, latitude] : {std::pair(17.7, 47.83), std::pair(17.71, 47.82)})
    {
        double x = longitude, y = latitude;
        ASSERT_TRUE(toUtm->Transform(1, &x, &y));
        const Result<Viewpoint> view = placed(at(longitude, latitude), tile);
        ASSERT_TRUE(view) << view.error().message;
        EXPECT_EQ(view->name, "v");
        EXPECT_NEAR(view->x, x - 701500.0, 1.0e-3);
        EXPECT_NEAR(view->y, y - 5300900.0, 1.0e-3);
        EXPECT_EQ(view->z, 321.0);
        EXPECT_NEAR(view->heading, 30.0 - (longitude - 15.0) * std::sin(latitude * degree), 0.01);
        EXPECT_EQ(view->pitch, -20.0);
        EXPECT_EQ(view->range, 500.0);
    }
}

// Expected: a post's own place in the tile, also where the tile lies across the 180th meridian, or
// counts longitudes from 0 to 360.
TEST(LocalFrame, PlacesInDegrees)
{
    for (const double west : {11.0, 179.95, 275.0, -180.02})
    {
        const DemTile tile = tileAt("EPSG:4326", west, 48.0, 0.001, 75.0);
        for (const double turn : {-360.0, 0.0})
        {
            const double longitude = std::remainder(west + 0.080, 360.0);
            const Result<Viewpoint> view =
                placed(at(longitude + (longitude > 0.0 ? turn : 0.0), 48.010), tile);
            ASSERT_TRUE(view) << west << ": " << view.error().message;
            EXPECT_NEAR(view->x, 30 * 75.0, 1.0e-4) << west;
            EXPECT_NEAR(view->y, -20 * 75.0, 1.0e-4);
            EXPECT_NEAR(view->heading, 30.0, 1.0e-6);
        }
    }
}

// Expected: degrees of another body are its own.
TEST(LocalFrame, PlacesOnTheMoon)
{
    const DemTile tile = tileAt("+proj=longlat +R=1737400 +no_defs", 11.0, 48.0, 0.001, 20.0);
    const Result<Viewpoint> view = placed(at(11.080, 48.010), tile);
    ASSERT_TRUE(view) << view.error().message;
    EXPECT_NEAR(view->x, 30 * 20.0, 1.0e-3);
    EXPECT_NEAR(view->y, -20 * 20.0, 1.0e-3);
}

// Expected: a place without height lies on the terrain, at 200 m, beyond voids and beside the
// terrain, too; the default range is the diagonal of 100 x 60 steps.
TEST(LocalFrame, WhatIsLeftOut)
{
    DemTile tile = tileAt("EPSG:4326", 11.0, 48.0, 0.001, 75.0);
    for (int column = 70; column < 90; ++column)
        tile.setVoid(column, 10);
    for (const double longitude : {11.02, 11.08, 11.13})
    {
        EarthViewpoint viewpoint = at(longitude, 48.010);
        viewpoint.height.reset();
        viewpoint.range = 0.0;
        const Result<Viewpoint> view = placed(viewpoint, tile);
        ASSERT_TRUE(view) << view.error().message;
        EXPECT_NEAR(view->z, 200.0, 1.0e-9);
        EXPECT_NEAR(view->range, 75.0 * std::hypot(100.0, 60.0), 1.0e-6);
    }
}

// Expected: a camera that would stand 300 m * sin(20) below the place, in the ground, stands 1 % of
// its range above it, and still looks at the place from the same direction.
TEST(LocalFrame, NobodyStandsInTheGround)
{
    const DemTile tile = tileAt("EPSG:4326", 11.0, 48.0, 0.001, 75.0);
    EarthViewpoint viewpoint = at(11.05, 48.03);
    viewpoint.height = 250.0;
    viewpoint.pitch = 20.0;
    viewpoint.range = 300.0;
    std::vector<std::string> notes;
    const Result<Viewpoint> view = placeViewpoint(viewpoint, localFrameOf(tile), notes);
    ASSERT_TRUE(view) << view.error().message;
    const double level = 300.0 * std::cos(20.0 * degree);
    EXPECT_NEAR(view->range * std::cos(view->pitch * degree), level, 1.0e-6);
    EXPECT_NEAR(250.0 - view->range * std::sin(view->pitch * degree), 203.0, 1.0e-6);
    EXPECT_EQ(view->heading, 30.0);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_EQ(notes[0], "its camera is raised by 55.61 m, above the terrain"); // 203 - 147.39
}

// Expected: messages that name the place and what is needed.
TEST(LocalFrame, PlacesThatCannotBeShown)
{
    const DemTile degrees = tileAt("EPSG:4326", 11.0, 48.0, 0.001, 75.0);
    const struct
    {
        EarthViewpoint viewpoint;
        DemTile tile;
        const char* said;
    } wrongs[] = {
        {at(0.0, 48.03), degrees,
         "longitude 0, latitude 48.03 lies 825 km outside the terrain; needs a place on it, or at "
         "most 8.746 km from its edge"},
        {at(11.05, 48.03), tileAt(nullptr, 0.0, 0.0, 1.0, 75.0), "the terrain has no CRS"},
        {at(11.05, -90.0), tileAt("EPSG:3857", 1.2e6, 6.1e6, 50.0, 50.0),
         "does not lie on the map of CRS \"WGS 84 / Pseudo-Mercator\""},
        {at(11.05, 48.03), tileAt("LOCAL_CS[\"a site\",UNIT[\"metre\",1]]", 0.0, 0.0, 1.0, 75.0),
         "does not lie on the map of CRS \"a site\""}};
    for (const auto& [viewpoint, tile, said] : wrongs)
    {
        const Result<Viewpoint> view = placed(viewpoint, tile);
        ASSERT_FALSE(view) << said;
        EXPECT_NE(view.error().message.find(said), std::string::npos) << view.error().message;
    }
}
