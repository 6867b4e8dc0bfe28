#include "ToolRun.h"

#include "support/MemoryRaster.h"

#include <cmath>

// Options of how heights are read, and of the planet that they lie on.

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{
constexpr double pi = 3.14159265358979323846;

class Heights : public ToolTest
{
protected:
    void save(const MemoryRaster& raster, const std::string& name) const
    {
        const std::string source = raster.write();
        const GDALDatasetUniquePtr dataset(GDALDataset::Open(source.c_str()));
        GDALDatasetUniquePtr copy(dataset->GetDriver()->CreateCopy(
            path(name).c_str(), dataset.get(), TRUE, nullptr, nullptr, nullptr));
        ASSERT_TRUE(copy);
    }

    /// A wall of 100 at the eastern edge, two cells of 10 m from the western posts.
    MemoryRaster wall() const
    {
        MemoryRaster raster;
        raster.width = raster.height = 3;
        raster.values = {0, 0, 100, 0, 0, 100, 0, 0, 100};
        return raster;
    }

    /// Elevation [degrees] of the wall, seen to the east from the western middle post.
    double elevation(const std::string& options) const
    {
        const ToolRun result = run("horizon wall.tif h.tif -q --azimuths 4 " + options);
        EXPECT_EQ(result.status, 0) << result.err;
        return static_cast<double>(ReadRaster(path("h.tif")).at(2, 0, 1));
    }
};
} // namespace

// tan = height / 20 m; codes of horizons are 0.0014 degrees wide.
TEST_F(Heights, UnitAndFactorAreThoseGiven)
{
    save(wall(), "wall.tif");
    const auto degrees = [](double height) { return std::atan(height / 20.0) * 180.0 / pi; };
    EXPECT_NEAR(elevation(""), degrees(100.0), 0.003);
    EXPECT_NEAR(elevation("--unit ft"), degrees(30.48), 0.003);
    EXPECT_NEAR(elevation("--z-factor 0.25"), degrees(25.0), 0.003);
    EXPECT_NEAR(elevation("--unit 'US survey foot' --z-factor 0.5"),
                degrees(50.0 * 1200.0 / 3937.0), 0.003);
    EXPECT_NEAR(elevation("--z-factor -1"), 0.0, 0.003) << "a level post stands before the drop";
    EXPECT_EQ(run("svf wall.tif s.tif --unit parsec").status, 2);
    EXPECT_EQ(run("svf wall.tif s.tif --z-factor 0").status, 2);
}

// The hint comes from d/2R > 0.1 degrees over the diagonal d of the raster: 22 km on Earth, 12 km
// on Mars, 6 km on the Moon.
TEST_F(Heights, CurvatureThatMattersIsHintedAt)
{
    const struct
    {
        const char* crs;
        double cell; // of 3 a side
        bool hint;
        const char* radius;
    } cases[] = {{"EPSG:32633", 6000.0, true, "6378137"},
                 {"EPSG:32633", 4000.0, false, "6378137"},
                 {"+proj=stere +lat_0=90 +R=3396190 +units=m", 3500.0, true, "3396190"},
                 {"+proj=tmerc +R=1737400 +units=m", 1700.0, true, "1737400"},
                 {"+proj=tmerc +R=1737400 +units=m", 1100.0, false, "1737400"}};
    for (const auto& c : cases)
    {
        SCOPED_TRACE(std::string(c.crs) + ", cells of " + std::to_string(c.cell));
        MemoryRaster raster = wall();
        raster.crs = c.crs;
        raster.transform = {500000, c.cell, 0, 100000, 0, -c.cell};
        save(raster, "in.tif");
        const ToolRun plain = run("horizon in.tif out.tif -q --azimuths 4");
        EXPECT_EQ(plain.status, 0) << plain.err;
        EXPECT_EQ(plain.complains("--body-radius auto"), c.hint) << plain.err;
        EXPECT_EQ(plain.complains(c.radius), c.hint) << plain.err;
        EXPECT_FALSE(
            run("horizon in.tif out.tif -q --azimuths 4 --body-radius 0").complains("curvature"));
        const ToolRun own = run("horizon in.tif out.tif -q --azimuths 4 --body-radius auto");
        EXPECT_EQ(own.status, 0) << own.err;
        EXPECT_FALSE(own.complains("curvature")) << own.err;
        EXPECT_EQ(ReadRaster(path("out.tif")).metadata("TERRAINLIGHT_BODY_RADIUS"), c.radius);
    }
    EXPECT_EQ(run("horizon in.tif out.tif -q --azimuths 4 --body-radius moon").status, 0);
    EXPECT_EQ(ReadRaster(path("out.tif")).metadata("TERRAINLIGHT_BODY_RADIUS"), "1737400");
    EXPECT_TRUE(run("horizon in.tif out.tif --body-radius pluto").complains("moon, mars or auto"));
    MemoryRaster nowhere = wall();
    nowhere.crs = "";
    save(nowhere, "nowhere.tif");
    const ToolRun none = run("horizon nowhere.tif out.tif -q --body-radius auto");
    EXPECT_EQ(none.status, 1);
    EXPECT_TRUE(none.complains("names no planet")) << none.err;
}
