// Rasters lit in windows: what they give beside one piece, in every mode and format.
#include "ToolRun.h"

#include <algorithm>
#include <cmath>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{

constexpr float noData = -9999.0f;
const std::string draft = " --quality draft";

/// Terrain with a hole, whose rows and columns are no multiple of any window.
class Windows : public GlToolTest
{
protected:
    void SetUp() override
    {
        GlToolTest::SetUp();
        if (IsSkipped())
            return;
        ASSERT_EQ(run("generate fractal f.tif --size 205,150 --spacing 30 --seed 3 -q").status, 0);
        const ReadRaster terrain(path("f.tif"));
        std::vector<float> heights = terrain.bands[0];
        for (int row = 50; row < 80; ++row) // across windows, and more than one of 64
            for (int column = 40; column < 140; ++column)
                heights[static_cast<std::size_t>(row * terrain.width + column)] = noData;
        writeRaster("d.tif", terrain.width, terrain.height, heights, {3000, 30, 0, 9000, 0, -30});
        std::filesystem::remove(path("f.tif"));
    }

    /// Both ways, of the same command.
    void runBoth(const std::string& mode, const std::string& options, const std::string& ending,
                 const std::string& windows = " --window-size 64") const
    {
        ASSERT_EQ(run(mode + " d.tif one" + ending + options + " -q").status, 0);
        const ToolRun result = run(mode + " d.tif many" + ending + options + windows);
        ASSERT_EQ(result.status, 0) << result.err;
        EXPECT_NE(result.out.find(": joining "), std::string::npos) << result.out;
    }

    /// Geometry, labels, metadata and voids are equal, values to a bound at all but `few` of them.
    void expectSame(const std::string& ending, float bound, double few) const
    {
        const ReadRaster one(path("one" + ending));
        const ReadRaster many(path("many" + ending));
        expectSamePlace(many, one);
        ASSERT_EQ(many.count, one.count);
        for (int band = 1; band <= one.count; ++band)
        {
            EXPECT_EQ(many.description(band), one.description(band));
            GDALRasterBand& from = *many.dataset->GetRasterBand(band);
            GDALRasterBand& to = *one.dataset->GetRasterBand(band);
            EXPECT_STREQ(from.GetUnitType(), to.GetUnitType());
            EXPECT_EQ(from.GetNoDataValue(), to.GetNoDataValue());
            EXPECT_EQ(from.GetRasterDataType(), to.GetRasterDataType());
            const std::vector<float>& a = many.bands[static_cast<std::size_t>(band - 1)];
            const std::vector<float>& b = one.bands[static_cast<std::size_t>(band - 1)];
            std::size_t beyond = 0;
            for (std::size_t i = 0; i < a.size(); ++i)
            {
                ASSERT_EQ(a[i] == noData, b[i] == noData) << "band " << band << ", post " << i;
                beyond += std::abs(a[i] - b[i]) > bound;
            }
            EXPECT_LE(static_cast<double>(beyond), few * static_cast<double>(a.size()))
                << "band " << band;
        }
        std::vector<std::string> manyItems = items(many);
        const auto own =
            std::find(manyItems.begin(), manyItems.end(), "TERRAINLIGHT_WINDOWS=64,64");
        ASSERT_NE(own, manyItems.end());
        manyItems.erase(own);
        EXPECT_EQ(manyItems, items(one));
    }

    static std::vector<std::string> items(const ReadRaster& raster)
    {
        std::vector<std::string> found;
        char** list = raster.dataset->GetMetadata();
        for (int i = 0; list && list[i]; ++i)
            if (std::string(list[i]).rfind("AREA_OR_POINT", 0) != 0)
                found.emplace_back(list[i]);
        std::sort(found.begin(), found.end());
        return found;
    }
};

// Windows see the terrain around them at its own posts for 128 of them, beyond that from coarser
// levels: the bounds are those of docs/methods/tiles.md at the 99th percentile, on natural terrain.
TEST_F(Windows, HorizonsAreThoseOfOnePiece)
{
    runBoth("horizon", " --azimuths 8" + draft, ".tif");
    expectSame(".tif", 0.15f, 0.01);
}

TEST_F(Windows, SkyViewIsThatOfOnePiece)
{
    runBoth("svf", " --azimuths 8" + draft, ".tif");
    expectSame(".tif", 1e-3f, 0.01);
}

TEST_F(Windows, ShadowIsThatOfOnePiece)
{
    runBoth("shadow", " --sun 250,15" + draft, ".tif");
    expectSame(".tif", 0.02f, 0.01);
}

TEST_F(Windows, LightIsThatOfOnePiece)
{
    runBoth("shade", " --azimuths 8" + draft, ".tif");
    expectSame(".tif", 5e-3f, 0.01);
}

TEST_F(Windows, BouncedLightIsThatOfOnePiece)
{
    runBoth("shade", " --azimuths 8 --bounces 2" + draft, ".tif");
    expectSame(".tif", 1e-2f, 0.01);
}

TEST_F(Windows, SunHoursAreThoseOfOnePiece)
{
    runBoth("sunhours",
            " --from 2024-03-21T05:00 --to 2024-03-21T19:00 --step 60 --place 0,45" + draft,
            ".tif");
    expectSame(".tif", 0.05f, 0.01);
}

TEST_F(Windows, AlbedoIsCutWithTheWindows)
{
    std::vector<float> albedo;
    for (int i = 0; i < 205 * 150; ++i)
        albedo.push_back(i % 205 < 100 ? 0.1f : 0.9f);
    writeRaster("albedo.tif", 205, 150, albedo, {3000, 30, 0, 9000, 0, -30});
    runBoth("shade", " --azimuths 8 --bounces 1 --albedo albedo.tif" + draft, ".tif");
    expectSame(".tif", 1e-2f, 0.01);
}

// Rows from the south and columns from the east, as some files have them.
TEST_F(Windows, RowsAndColumnsMayRunTheOtherWay)
{
    const ReadRaster terrain(path("d.tif"));
    std::vector<float> heights = terrain.bands[0];
    std::reverse(heights.begin(), heights.end());
    writeRaster("d.tif", terrain.width, terrain.height, heights,
                {3000 + 205 * 30, -30, 0, 9000 - 150 * 30, 0, 30});
    runBoth("svf", " --azimuths 8" + draft, ".tif");
    expectSame(".tif", 1e-3f, 0.01);
    runBoth("shade", " --azimuths 8" + draft, ".png");
    const ReadRaster one(path("one.png"));
    const ReadRaster many(path("many.png"));
    expectSamePlace(many, one);
    EXPECT_EQ(many.bands[3], one.bands[3]) << "where it is void";
}

TEST_F(Windows, PicturesAreThoseOfOnePiece)
{
    runBoth("shade", " --azimuths 8" + draft, ".png");
    const ReadRaster one(path("one.png"));
    const ReadRaster many(path("many.png"));
    ASSERT_EQ(many.count, 4) << "voids are transparent";
    ASSERT_EQ(one.count, 4);
    EXPECT_EQ(many.bands[3], one.bands[3]);
    std::size_t other = 0;
    for (std::size_t i = 0; i < one.bands[1].size(); ++i)
        other += std::abs(many.bands[1][i] - one.bands[1][i]) > 2.0f;
    EXPECT_LT(other, one.bands[1].size() / 100);
}

TEST_F(Windows, ExrIsOnePieceOrRefused)
{
    const ToolRun result = run("shade d.tif o.exr --window-size 64 -q --azimuths 8" + draft);
    EXPECT_EQ(result.status, 1);
    EXPECT_TRUE(result.complains("o.exr: an OpenEXR file is written in one piece")) << result.err;
    EXPECT_EQ(left(), std::set<std::string>{"d.tif"});
}

TEST_F(Windows, FormatsAndTheirDefaults)
{
    const std::string options = " --azimuths 8 --window-size 64 -q" + draft;
    ASSERT_EQ(run("svf d.tif o.tif" + options).status, 0);
    const ReadRaster tiff(path("o.tif"));
    const auto structure = [](const ReadRaster& raster, const char* name)
    {
        const char* value = raster.dataset->GetMetadataItem(name, "IMAGE_STRUCTURE");
        return std::string(value ? value : "");
    };
    int width = 0;
    int height = 0;
    tiff.dataset->GetRasterBand(1)->GetBlockSize(&width, &height);
    EXPECT_EQ(structure(tiff, "COMPRESSION"), "DEFLATE");
    EXPECT_EQ(width, 256);
    ASSERT_EQ(run("svf d.tif c.tif -of COG" + options).status, 0);
    const ReadRaster cog(path("c.tif"));
    EXPECT_EQ(structure(cog, "LAYOUT"), "COG");
    EXPECT_EQ(cog.bands, tiff.bands);
    ASSERT_EQ(run("svf d.tif l.tif -co COMPRESS=LZW -co TILED=NO" + options).status, 0);
    const ReadRaster lzw(path("l.tif"));
    EXPECT_EQ(structure(lzw, "COMPRESSION"), "LZW");
    EXPECT_EQ(lzw.bands, tiff.bands);
    ASSERT_EQ(run("svf d.tif a.asc" + options).status, 0) << "a format that can only copy";
    EXPECT_EQ(left(), (std::set<std::string>{"d.tif", "o.tif", "c.tif", "l.tif", "a.asc",
                                             "a.asc.aux.xml"}));
}

// What is lit of a raster sees the rest of it, in one piece as in windows, unless told not to.
TEST_F(Windows, APartSeesTheTerrainOutside)
{
    const std::string options = " -srcwin 60 90 40 50 --azimuths 8 -q" + draft;
    ASSERT_EQ(run("svf d.tif whole.tif --azimuths 8 -q" + draft).status, 0);
    ASSERT_EQ(run("svf d.tif part.tif" + options).status, 0);
    ASSERT_EQ(run("svf d.tif alone.tif --isolated" + options).status, 0);
    const ReadRaster whole(path("whole.tif"));
    const ReadRaster part(path("part.tif"));
    const ReadRaster alone(path("alone.tif"));
    EXPECT_EQ(alone.metadata("TERRAINLIGHT_ISOLATED"), "YES");
    int seeing = 0;
    int blind = 0;
    for (int row = 0; row < 50; ++row)
        for (int column = 0; column < 40; ++column)
        {
            const float expected = whole.at(1, 60 + column, 90 + row);
            seeing += std::abs(part.at(1, column, row) - expected) > 2e-3f;
            blind += std::abs(alone.at(1, column, row) - expected) > 2e-3f;
        }
    EXPECT_LT(seeing, 20) << "of 2000 posts";
    EXPECT_GT(blind, 200);
    ASSERT_EQ(run("svf d.tif same.tif --window 60 90 40 50 --azimuths 8 -q" + draft).status, 0);
    EXPECT_EQ(ReadRaster(path("same.tif")).bands, part.bands);
}

// A wall that only a second raster knows.
TEST_F(Windows, SurroundingsCastShadows)
{
    writeRaster("plain.tif", 40, 40, std::vector<float>(1600, 100.0f), {3000, 30, 0, 9000, 0, -30});
    std::vector<float> wall(60 * 60, 100.0f);
    for (int row = 0; row < 60; ++row)
        for (int column = 0; column < 4; ++column)
            wall[static_cast<std::size_t>(row * 60 + column)] = 1500.0f;
    writeRaster("wide.tif", 60, 60, wall, {1500, 60, 0, 10500, 0, -60});
    const std::string sun = " --sun 270,20 -q" + draft;
    ASSERT_EQ(run("shadow plain.tif open.tif" + sun).status, 0);
    const ToolRun result = run("shadow plain.tif shaded.tif --surroundings wide.tif" + sun);
    ASSERT_EQ(result.status, 0) << result.err;
    const ReadRaster shaded(path("shaded.tif"));
    EXPECT_EQ(ReadRaster(path("open.tif")).at(1, 5, 20), 1.0f);
    EXPECT_EQ(shaded.at(1, 5, 20), 0.0f);
    EXPECT_EQ(shaded.metadata("TERRAINLIGHT_SURROUNDINGS"), "wide.tif");
}

// A ridge 30 km away that only a second raster knows, of other cells: where its shadow ends by its
// crest's line to the sun, within a cell of the second raster.
TEST_F(Windows, SurroundingsCastShadowsFromFarAway)
{
    constexpr int columns = 60, farColumns = 60;
    constexpr double cell = 90.0, farCell = 900.0, crest = -30000.0, top = 2600.0;
    writeRaster("plain.tif", columns, 40, std::vector<float>(columns * 40, 0.0f),
                {0, cell, 0, 3600, 0, -cell});
    // The crest falls by 2 in 9 to either side, and goes on far to the north and south.
    const double west = crest - 20.5 * farCell;
    std::vector<float> ridge(farColumns * 160);
    for (int row = 0; row < 160; ++row)
        for (int column = 0; column < farColumns; ++column)
            ridge[static_cast<std::size_t>(row * farColumns + column)] =
                static_cast<float>(std::max(0.0, top - 200.0 * std::abs(column - 20)));
    writeRaster("ridge.tif", farColumns, 160, ridge, {west, farCell, 0, 72000, 0, -farCell});
    for (const double edge : {1000.0, 2700.0, 4000.0})
    {
        const double elevation = std::atan2(top, edge - crest) * 180.0 / 3.14159265358979323846;
        const std::string sun = " --sun 270," + std::to_string(elevation) + " -q" + draft;
        ASSERT_EQ(run("shadow plain.tif shaded.tif --surroundings ridge.tif" + sun).status, 0);
        const ReadRaster shaded(path("shaded.tif"));
        double dark = 0.0; // posts of a row; half of the disc is seen where the shadow ends
        for (int column = 0; column < columns; ++column)
            dark += 1.0 - static_cast<double>(shaded.at(1, column, 20));
        EXPECT_NEAR(dark * cell, edge, farCell);
        std::printf("shadow of a ridge 30 km away: %.0f m, expected %.0f\n", dark * cell, edge);
    }
}

// Voids of what is lit let light pass, whichever windows it is lit in, and whatever surroundings
// have there.
TEST_F(Windows, SurroundingsDoNotFillVoidsOfWhatIsLit)
{
    constexpr int side = 320;
    std::vector<float> heights(side * side, 100.0f), mountain(side * side, 100.0f);
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column)
        {
            const auto i = static_cast<std::size_t>(row * side + column);
            const double away = std::hypot(column - 100.0, row - 160.0);
            mountain[i] = static_cast<float>(std::max(100.0, 4000.0 - 60.0 * away));
            if (away < 80.0)
                heights[i] = -9999.0f;
        }
    const std::vector<double> place = {0, 30, 0, 9600, 0, -30};
    writeRaster("hole.tif", side, side, heights, place);
    writeRaster("full.tif", side, side, mountain, place);
    const std::string sun = " --sun 270,12 -q --surroundings full.tif" + draft;
    ASSERT_EQ(run("shadow hole.tif one.tif" + sun).status, 0);
    ASSERT_EQ(run("shadow hole.tif many.tif --window-size 64" + sun).status, 0);
    const ReadRaster one(path("one.tif")), many(path("many.tif"));
    for (int row = 0; row < side; ++row)
        for (int column = 190; column < side; ++column)
        {
            ASSERT_EQ(one.at(1, column, row), 1.0f);
            ASSERT_EQ(many.at(1, column, row), 1.0f) << column << ", " << row;
        }
}

TEST_F(Windows, InfoSaysWhatItTakes)
{
    const ToolRun small = run("info d.tif --azimuths 8");
    EXPECT_EQ(small.status, 0) << small.err;
    EXPECT_NE(small.out.find("none: in one piece"), std::string::npos) << small.out;
    const ToolRun many = run("info d.tif --azimuths 8 --window-size 64");
    EXPECT_EQ(many.status, 0) << many.err;
    EXPECT_NE(many.out.find("12 of at most 64 x 64 posts"), std::string::npos) << many.out;
    for (const char* name : {"Memory: ", "Disk for windows: ", "Disk for levels: ", "Time: "})
        EXPECT_NE(many.out.find(name), std::string::npos) << name;
}

// A small raster has no windows; little memory gives more of them.
TEST_F(Windows, MemoryDecides)
{
    const std::string options = " --azimuths 8" + draft;
    EXPECT_EQ(run("svf d.tif o.tif" + options).out.find("window"), std::string::npos);
    ASSERT_EQ(run("generate fractal big.tif --size 1500,1400 -q").status, 0);
    const std::string many = run("svf big.tif o.tif --job 1/1000000 --memory 256" + options).out;
    EXPECT_NE(many.find("windows of at most"), std::string::npos) << many;
    EXPECT_EQ(run("svf big.tif o.tif --memory 100" + options).status, 2);
    EXPECT_EQ(run("svf big.tif o.tif --window-size 5000" + options).status, 2);
}

TEST_F(Windows, ProgressIsOverTheWhole)
{
    const std::string options = " --azimuths 8 --window-size 64" + draft;
    const ToolRun result = run("svf d.tif o.tif" + options);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(
        result.out.rfind("svf: 12 windows of at most 64 x 64 posts\nsvf: window 1 of 12\n", 0), 0u)
        << result.out;
    EXPECT_NE(result.out.find("svf: window 12 of 12, about 1 s left\n"), std::string::npos)
        << result.out;
    EXPECT_NE(result.out.find("svf: joining 12 of 12 windows\n"), std::string::npos);
    EXPECT_NE(result.out.find("svf: 30750 posts, 8 azimuths, "), std::string::npos);
    EXPECT_NE(result.out.find(" for 12 windows\n"), std::string::npos);
    EXPECT_EQ(run("svf d.tif o.tif -q" + options).out, "");
}

TEST_F(Windows, ABudgetIsChosenOnceForAll)
{
    const ToolRun result = run("svf d.tif o.tif --max-error 0.01 --window-size 64");
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("choosing settings on the window in the middle"), std::string::npos);
    EXPECT_NE(result.out.find("svf: chosen: quality "), std::string::npos) << result.out;
    const ReadRaster raster(path("o.tif"));
    EXPECT_NE(raster.metadata("TERRAINLIGHT_ERROR_BOUND"), "");
    EXPECT_NE(raster.metadata("TERRAINLIGHT_AZIMUTHS"), "");
}

} // namespace
