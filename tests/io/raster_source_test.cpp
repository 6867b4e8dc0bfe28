#include "io/RasterSource.h"

#include "support/LevelChecks.h"
#include "support/MemoryRaster.h"

#include <cmath>
#include <random>

using namespace osgTerrainLight;

namespace
{
constexpr float missing = std::numeric_limits<float>::quiet_NaN();

/// Seeded whole numbers of a kilometre.
std::vector<double> hills(int width, int height)
{
    std::mt19937 random(static_cast<unsigned>(width * 1000 + height));
    std::uniform_int_distribution<int> heights(0, 1000);
    std::vector<double> values;
    for (int i = 0; i < width * height; ++i)
        values.push_back(heights(random));
    return values;
}

MemoryRaster hilly(int width, int height)
{
    MemoryRaster raster;
    raster.width = width;
    raster.height = height;
    raster.values = hills(width, height);
    return raster;
}

float heightOf(const DemTile& tile, int column, int row)
{
    return column >= 0 && row >= 0 && column < tile.width() && row < tile.height() &&
                   tile.isValid(column, row)
               ? tile.heightAt(column, row)
               : missing;
}

/// All posts, and some around them, are those of readDem(), to the last bit.
void expectReadDems(const std::string& path, const DemReadOptions& options = {})
{
    const Result<DemFile> file = readDem(path, options);
    ASSERT_TRUE(file) << file.error().message;
    RasterSourceOptions same;
    same.read = options;
    const auto source = RasterSource::open(path, same);
    ASSERT_TRUE(source) << source.error().message;
    const DemTile& tile = file->tile;
    EXPECT_EQ((*source)->width(), tile.width());
    EXPECT_EQ((*source)->height(), tile.height());
    EXPECT_EQ((*source)->heightOrigin(), tile.heightOrigin);
    EXPECT_EQ((*source)->northSpacing(), tile.northSpacing);
    EXPECT_EQ((*source)->lowest(), file->lowest);
    EXPECT_EQ((*source)->highest(), file->highest);
    EXPECT_EQ((*source)->notes(), file->notes);
    EXPECT_EQ((*source)->frame().geoTransform, file->frame.geoTransform);
    for (int row = 0; row < tile.height(); ++row)
        EXPECT_EQ((*source)->eastSpacing(row), tile.eastSpacing(row));
    expectPosts(**source, PostRect{0, 0, tile.width(), tile.height()}.grownBy(3),
                [&tile](int column, int row) { return heightOf(tile, column, row); });
    for (const PostRect part : {PostRect{5, 3, 11, 7}, PostRect{-2, 10, 9, 40}})
        expectPosts(**source, part,
                    [&tile](int column, int row) { return heightOf(tile, column, row); });
    expectLevelsOfPosts(**source, (*source)->lastLevel());
}
} // namespace

TEST(RasterSource, PlainRasterAsReadDem)
{
    expectReadDems(hilly(45, 37).write());
}

TEST(RasterSource, ScaledFeetWithNoDataAsReadDem)
{
    MemoryRaster raster = hilly(40, 33);
    raster.type = GDT_Int16;
    raster.unit = "ft";
    raster.scale = 0.1;
    raster.offset = 12.5;
    raster.noData = 500;
    for (std::size_t i = 0; i < raster.values.size(); i += 7)
        raster.values[i] = 500;
    DemReadOptions options;
    options.heightFactor = -1.5;
    expectReadDems(raster.write());
    expectReadDems(raster.write(), options);
}

TEST(RasterSource, MaskAndCustomaryVoidsAsReadDem)
{
    MemoryRaster raster = hilly(40, 33);
    raster.values[100] = -9999; // a void by custom, since no other value is near
    raster.values[1200] = -32768;
    raster.datasetMask.assign(raster.values.size(), 255);
    for (std::size_t i = 3; i < raster.values.size(); i += 5)
        raster.datasetMask[i] = 0;
    expectReadDems(raster.write());
}

TEST(RasterSource, DoublesOfLargeNumbersAsReadDem)
{
    MemoryRaster raster = hilly(20, 30);
    raster.type = GDT_Float64;
    for (double& value : raster.values)
        value = 123456.789 + value * 1.0e-3;
    expectReadDems(raster.write());
}

TEST(RasterSource, FlippedRastersAsReadDem)
{
    MemoryRaster raster = hilly(41, 29);
    raster.transform = {500000, 10, 0, 4000000, 0, 10};
    expectReadDems(raster.write());
    raster.transform = {500000, -10, 0, 4000000, 0, -10};
    expectReadDems(raster.write());
    raster.transform = {500000, -10, 0, 4000000, 0, 10};
    expectReadDems(raster.write());
}

// Every row has its own spacing; rows beyond a pole are void.
TEST(RasterSource, DegreesAsReadDem)
{
    MemoryRaster raster = hilly(41, 29);
    raster.crs = "EPSG:4326";
    raster.transform = {10, 0.5, 0, 60, 0, -0.5};
    expectReadDems(raster.write());
    raster.transform = {10, 0.5, 0, 91, 0, -0.5};
    expectReadDems(raster.write());
}

// Heights are multiplied by the scale of the map at their post.
TEST(RasterSource, WebMercatorAsReadDem)
{
    MemoryRaster raster = hilly(41, 29);
    raster.crs = "EPSG:3857";
    raster.transform = {1000000, 20000, 0, 8000000, 0, -20000};
    expectReadDems(raster.write());
}

// Radii of a body: the Moon's 1737.4 km come off.
TEST(RasterSource, RadiiAsReadDem)
{
    MemoryRaster raster = hilly(30, 20);
    raster.crs = "+proj=longlat +R=1737400 +no_defs";
    raster.transform = {10, 0.1, 0, 20, 0, -0.1};
    for (double& value : raster.values)
        value += 1737000;
    expectReadDems(raster.write());
}

TEST(RasterSource, SmallestRastersAsReadDem)
{
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 40), std::pair(40, 1)})
        expectReadDems(hilly(width, height).write());
}

// Beyond -srcwin lies the rest of the raster, in its place: the posts are those of the whole one,
// whose origin is the same, since heights of the whole raster decide it.
TEST(RasterSource, WindowSeesTheRestOfTheRaster)
{
    for (const std::vector<double>& transform :
         {std::vector<double>{500000, 10, 0, 4000000, 0, -10},
          std::vector<double>{500000, -10, 0, 4000000, 0, 10}})
    {
        MemoryRaster raster = hilly(50, 40);
        raster.transform = transform;
        const std::string path = raster.write();
        const Result<DemFile> whole = readDem(path);
        ASSERT_TRUE(whole);
        RasterSourceOptions options;
        options.read.window = PixelWindow{13, 9, 20, 12};
        const auto source = RasterSource::open(path, options);
        ASSERT_TRUE(source) << source.error().message;
        EXPECT_EQ((*source)->width(), 20);
        EXPECT_EQ((*source)->height(), 12);
        const bool turned = transform[1] < 0.0;
        const int west = turned ? 50 - 13 - 20 : 13;
        const int south = turned ? 9 : 40 - 9 - 12;
        EXPECT_EQ((*source)->extent(0).column, -west);
        EXPECT_EQ((*source)->extent(0).row, -south);
        EXPECT_EQ((*source)->extent(0).width, 50);
        expectPosts(**source, (*source)->extent(0).grownBy(2),
                    [&](int column, int row)
                    { return heightOf(whole->tile, column + west, row + south); });
        expectLevelsOfPosts(**source, (*source)->lastLevel());
    }
}

TEST(RasterSource, WindowAloneWhereAskedFor)
{
    const std::string path = hilly(50, 40).write();
    RasterSourceOptions options;
    options.read.window = PixelWindow{13, 9, 20, 12};
    options.beyondWindow = false;
    const auto source = RasterSource::open(path, options);
    ASSERT_TRUE(source);
    const Result<DemFile> file = readDem(path, options.read);
    ASSERT_TRUE(file);
    EXPECT_EQ((*source)->heightOrigin(), file->tile.heightOrigin);
    expectPosts(**source, PostRect{0, 0, 20, 12}.grownBy(5),
                [&](int column, int row) { return heightOf(file->tile, column, row); });
}

// Posts of 10 m: a reach of 55 m sees 6 more on each side.
TEST(RasterSource, ReachLimitsWhatIsSeenOfTheRaster)
{
    RasterSourceOptions options;
    options.read.window = PixelWindow{20, 20, 5, 5};
    options.reach = 55.0;
    const auto source = RasterSource::open(hilly(50, 40).write(), options);
    ASSERT_TRUE(source);
    EXPECT_EQ((*source)->extent(0).column, -6);
    EXPECT_EQ((*source)->extent(0).width, 17);
}

// Rows beyond the raster have a spacing, too: that of a raster which has them.
TEST(RasterSource, SpacingOfRowsBeyondDegrees)
{
    MemoryRaster raster = hilly(10, 20);
    raster.crs = "EPSG:4326";
    raster.transform = {10, 0.5, 0, 60, 0, -0.5};
    const Result<DemFile> whole = readDem(raster.write());
    RasterSourceOptions options;
    options.read.window = PixelWindow{0, 5, 10, 10};
    const auto source = RasterSource::open(raster.write(), options);
    ASSERT_TRUE(whole && source);
    for (int row = -5; row < 15; ++row)
        EXPECT_NEAR((*source)->eastSpacing(row), whole->tile.eastSpacing(row + 5), 1.0e-7);
}

// Voids are left out of all levels, whichever rows GDAL gives together: strips of 1 and of 16 rows
// and tiles of 16 x 16 give the same (expectReadDems checks the definition).
TEST(RasterSource, VoidsAcrossStripsAndTiles)
{
    MemoryRaster raster = hilly(70, 61);
    raster.noData = 0;
    for (int row = 10; row < 40; ++row)
        for (int column = 5; column < 50; ++column)
            raster.values[static_cast<std::size_t>(row * 70 + column)] = 0;
    for (const std::vector<std::string>& creation :
         {std::vector<std::string>{"BLOCKYSIZE=1"}, std::vector<std::string>{"BLOCKYSIZE=16"},
          std::vector<std::string>{"TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=16"}})
    {
        raster.creation = creation;
        expectReadDems(raster.write());
    }
}

// The definition of levels bounds their sizes: 16 posts a side of the raster's own.
TEST(RasterSource, CoarsestLevelHasFewPosts)
{
    const auto source = RasterSource::open(hilly(300, 70).write());
    ASSERT_TRUE(source);
    EXPECT_EQ((*source)->lastLevel(), 5); // 299 / 32 + 2 posts, 299 / 16 + 2 on level 4
    EXPECT_EQ((*source)->extent(5).width, 11);
    EXPECT_EQ((*source)->extent(5).height, 4);
}

TEST(RasterSource, ErrorsAreThoseOfReadDem)
{
    const auto none = RasterSource::open("no_such.tif");
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, ErrorCode::NotFound);
    MemoryRaster raster;
    raster.noData = 7;
    raster.values.assign(6, 7);
    const std::string path = raster.write();
    const auto all = RasterSource::open(path);
    ASSERT_FALSE(all);
    EXPECT_EQ(all.error().message, readDem(path).error().message);
    raster.transform.clear();
    EXPECT_FALSE(RasterSource::open(raster.write()));
}
