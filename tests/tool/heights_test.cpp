#include "ToolRun.h"

#include "support/MemoryRaster.h"

#include <cmath>

// Options of how heights are read, and of the planet that they lie on.

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{
constexpr double pi = 3.14159265358979323846;

class Heights : public GlToolTest
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
    EXPECT_NEAR(elevation("--unit 'US survey foot' --z-factor 0.5"),
                degrees(50.0 * 1200.0 / 3937.0), 0.003);
    EXPECT_NEAR(elevation("--z-factor -1"), 0.0, 0.003) << "a level post stands before the drop";
    EXPECT_EQ(run("svf wall.tif s.tif --unit parsec").status, 2);
    EXPECT_EQ(run("svf wall.tif s.tif --z-factor 0").status, 2);
}

// Expected: the same bits as of a raster that holds the heights in metres, exact in both.
TEST_F(Heights, EveryModeTakesUnitAndFactor)
{
    MemoryRaster metres = wall();
    MemoryRaster picture = wall(); // 16 bits, no place, no unit
    picture.type = GDT_UInt16;
    picture.crs = "";
    picture.transform.clear();
    for (std::size_t i = 0; i < metres.values.size(); ++i)
    {
        metres.values[i] *= 1.25;
        picture.values[i] *= 160.0;
    }
    save(metres, "metres.tif");
    const std::string levels = picture.write();
    const GDALDatasetUniquePtr opened(GDALDataset::Open(levels.c_str()));
    GDALDatasetUniquePtr(GetGDALDriverManager()->GetDriverByName("PNG")->CreateCopy(
        path("picture.png").c_str(), opened.get(), FALSE, nullptr, nullptr, nullptr));

    const std::string day = " --from 2024-06-21T06:00 --to 2024-06-21T08:00 --place 15,38";
    const std::vector<std::pair<std::string, std::string>> modes = {
        {"horizon", " o.tif --azimuths 4 -q"}, {"svf", " o.tif --azimuths 4 -q"},
        {"shadow", " o.tif --sun 90,20 -q"},   {"shade", " o.tif --azimuths 4 -q"},
        {"sunhours", " o.tif -q" + day},       {"render", " o.png --top --size 16,16 -q"}};
    for (const auto& [mode, options] : modes)
    {
        SCOPED_TRACE(mode);
        const auto result = [&](const std::string& input)
        {
            const ToolRun done = run(mode + " " + input + options);
            EXPECT_EQ(done.status, 0) << done.err;
            return ReadRaster(path(mode == "render" ? "o.png" : "o.tif")).bands;
        };
        EXPECT_EQ(result("picture.png --cell-size 10 --unit cm --z-factor 0.78125"),
                  result("metres.tif"));
    }
    const ToolRun info = run("info picture.png --cell-size 10 --unit cm --z-factor 0.78125");
    EXPECT_NE(info.out.find("0 ... 125 m"), std::string::npos) << info.out;
}

TEST_F(Heights, EveryAssumptionIsSaidOnce)
{
    MemoryRaster raster; // radii of Phobos, in an equatorial map
    raster.crs = "+proj=eqc +R=11100 +units=m";
    raster.transform = {0, 100, 0, 1000, 0, -100};
    raster.type = GDT_Int16;
    raster.offset = 11000.0;
    raster.values = {1, -32768, 3, -32768, -2, 6};
    raster.unit = "furlongs of old";
    save(raster, "in.tif");
    const ToolRun result = run("svf in.tif out.tif -q --azimuths 4 --body-radius 0");
    EXPECT_EQ(result.status, 0) << result.err;
    const std::string start = "terrainlight: warning: in.tif: ";
    EXPECT_EQ(result.err,
              start +
                  "height unit \"furlongs of old\" is not known: heights are taken as metres\n" +
                  start + "heights are radii of the body: its 11100 m come off\n" + start +
                  "2 posts of -32768, which is no declared nodata value: taken as void\n");
}

// The hint comes from d/2R > 0.1 degrees over the diagonal d of the raster: 22 km on Earth, 12 km
// on Mars, 6 km on the Moon. Names are mean radii; auto is the CRS's semi-major axis.
TEST_F(Heights, CurvatureThatMattersIsHintedAt)
{
    const char* earth = "EPSG:32633";
    const char* mars = "+proj=stere +lat_0=90 +R=3396190 +units=m";
    const char* moon = "+proj=tmerc +R=1737400 +units=m";
    const struct
    {
        const char* crs;
        double cell; // of 3 a side
        const char* options;
        const char* hint;   // the radius named, or null
        const char* radius; // written
    } cases[] = {{earth, 6000.0, "", "6378137", ""},
                 {earth, 4000.0, "", nullptr, ""},
                 {earth, 6000.0, "--body-radius 0", nullptr, ""},
                 {earth, 6000.0, "--body-radius earth", nullptr, "6371000"},
                 {mars, 3500.0, "", "3396190", ""},
                 {mars, 3500.0, "--body-radius AUTO", nullptr, "3396190"},
                 {mars, 3500.0, "--body-radius Mars", nullptr, "3389500"},
                 {moon, 1700.0, "", "1737400", ""},
                 {moon, 1100.0, "", nullptr, ""},
                 {moon, 1700.0, "--body-radius moon", nullptr, "1737400"},
                 {"+proj=longlat +R=2439400", 0.06, "", "2439400", ""}}; // Mercury
    for (const auto& c : cases)
    {
        SCOPED_TRACE(std::string(c.crs) + ", " + std::to_string(c.cell) + " " + c.options);
        MemoryRaster raster = wall();
        raster.crs = c.crs;
        const bool degrees = c.cell < 1.0;
        raster.transform = {degrees ? 5.0 : 500000, c.cell, 0, degrees ? 1.0 : 100000, 0, -c.cell};
        save(raster, "in.tif");
        const ToolRun result =
            run("horizon in.tif out.tif -q --azimuths 4 " + std::string(c.options));
        EXPECT_EQ(result.status, 0) << result.err;
        EXPECT_EQ(result.complains("curvature"), c.hint != nullptr) << result.err;
        EXPECT_EQ(result.complains("--body-radius auto (" + std::string(c.hint ? c.hint : "") +
                                   " m) follows it, --body-radius 0 stays flat"),
                  c.hint != nullptr)
            << result.err;
        EXPECT_EQ(ReadRaster(path("out.tif")).metadata("TERRAINLIGHT_BODY_RADIUS"), c.radius);
    }
    EXPECT_TRUE(run("horizon in.tif out.tif --body-radius pluto").complains("moon, mars or auto"));
    MemoryRaster nowhere = wall();
    nowhere.crs = "";
    save(nowhere, "nowhere.tif");
    const ToolRun none = run("horizon nowhere.tif out.tif -q --body-radius auto");
    EXPECT_EQ(none.status, 1);
    EXPECT_TRUE(none.complains("names no planet")) << none.err;
}

// A budget takes no radius, so the hint names no option that is refused beside it.
TEST_F(Heights, TheHintOfCurvatureSuitsABudget)
{
    MemoryRaster raster = wall();
    raster.crs = "+proj=stere +lat_0=-90 +R=2575000 +units=m"; // Titan
    raster.transform = {500000, 3000, 0, 100000, 0, -3000};
    save(raster, "in.tif");
    for (const std::string budget : {"--max-error 0.05", "--max-ms 10000"})
    {
        const ToolRun result = run("svf in.tif out.tif -q " + budget);
        EXPECT_EQ(result.status, 0) << result.err;
        EXPECT_TRUE(result.complains("degrees: " + budget.substr(0, budget.find(' ')) +
                                     " knows flat ground only; --body-radius auto (2575000 m) "
                                     "instead of it follows the curvature"))
            << result.err;
        EXPECT_FALSE(result.complains("--body-radius 0")) << result.err;
        EXPECT_EQ(run("svf in.tif out.tif --body-radius auto " + budget).status, 2);
    }
}
