// Rasters that are averaged down while they are read.
#include "io/CellAverages.h"
#include "io/GroundSpacing.h"

#include "support/DemHeights.h"
#include "support/MemoryRaster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;
const double infinite = std::numeric_limits<double>::infinity();

DemFile reduced(const MemoryRaster& raster, int maxSide, const DemReadOptions& options = {})
{
    const Result<DemFile> file = readDemReduced(raster.write(), options, maxSide);
    EXPECT_TRUE(file) << (file ? "" : file.error().message);
    return file ? *file : DemFile();
}

/// 8 × 4 posts that average to 4 × 2 cells: in all but the last two cells one post is void, and the
/// other three are low, high and their mean. Of the last two one is void, one has one post.
MemoryRaster blocks(const MemoryRaster& like, double voidValue)
{
    MemoryRaster raster = like;
    raster.width = 8;
    raster.height = 4;
    raster.values.assign(32, voidValue);
    for (int cell = 0; cell < 6; ++cell)
        for (int part = 0; part < 3; ++part)
        {
            // Each cell's void lies in another corner.
            const int corner = (cell + 1 + part) % 4;
            const int column = 2 * (cell % 4) + corner % 2;
            const int row = 2 * (cell / 4) + corner / 2;
            raster.values[static_cast<std::size_t>(row * 8 + column)] =
                20.0 * (cell + 1) + 10.0 * (part - 1);
        }
    raster.values[2 * 8 + 6] = 8.0; // cell 7
    return raster;
}

/// Stored means of blocks().
const std::vector<double> means = {20, 40, 60, 80, 100, 120, missing, 8};

/// Averages of blocks(), each made a height by metres().
template <class Metres>
void expectMeans(const DemFile& file, const Metres& metres)
{
    ASSERT_EQ(file.tile.width(), 4);
    ASSERT_EQ(file.tile.height(), 2);
    std::vector<double> expected;
    for (const double mean : means)
        expected.push_back(metres(mean));
    expectHeights(file, expected);
}

double asStored(double value)
{
    return value;
}
} // namespace

// Posts of 1 unit over cells of 1.5: the post between two cells counts half in each.
TEST(CellAverages, AreaOfEachPost)
{
    CellAverages averages(3, 2, 2, 1);
    const double posts[2][3] = {{1, 2, 4}, {8, 16, 32}};
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 3; ++column)
            averages.add(column, row, posts[row][column]);
    EXPECT_DOUBLE_EQ(averages.at(0, 0), (1 + 8 + 0.5 * (2 + 16)) / 3.0);
    EXPECT_DOUBLE_EQ(averages.at(1, 0), (4 + 32 + 0.5 * (2 + 16)) / 3.0);

    CellAverages some(5, 1, 3, 1); // cells of 5/3 posts
    some.add(1, 0, 7.0);           // 2/3 of it in the first
    some.add(3, 0, 9.0);           // a third in the second, the rest in the last
    EXPECT_DOUBLE_EQ(some.at(0, 0), 7.0);
    EXPECT_DOUBLE_EQ(some.at(1, 0), (7.0 / 3.0 + 9.0 / 3.0) / (2.0 / 3.0));
    EXPECT_DOUBLE_EQ(some.at(2, 0), 9.0);
    EXPECT_TRUE(std::isnan(CellAverages(4, 4, 2, 2).at(1, 1)));
}

// The mean of a plane over a cell is its height in the middle, where cells are whole posts.
TEST(ReducedDem, APlaneStaysOne)
{
    MemoryRaster raster;
    raster.width = 30;
    raster.height = 12;
    raster.values.clear();
    for (int row = 0; row < 12; ++row)
        for (int column = 0; column < 30; ++column)
            raster.values.push_back(100.0 + 3.0 * column - 7.0 * row);
    for (const double y : {-10.0, 10.0})
        for (const double x : {10.0, -10.0})
        {
            raster.transform = {500000, x, 0, 4000000, 0, y};
            const DemFile file = reduced(raster, 10);
            ASSERT_EQ(file.tile.width(), 10);
            ASSERT_EQ(file.tile.height(), 4);
            EXPECT_EQ(file.tile.northSpacing, 30.0);
            EXPECT_EQ(file.tile.eastSpacings, std::vector<double>{30.0});
            // Middles: the first of 3 posts is 1 post further than the post it begins with.
            EXPECT_DOUBLE_EQ(file.tile.mapOriginX, x > 0 ? 500015.0 : 500000.0 - 285.0);
            EXPECT_DOUBLE_EQ(file.tile.mapOriginY, y > 0 ? 4000015.0 : 4000000.0 - 105.0);
            std::vector<double> expected;
            for (int row = 0; row < 4; ++row)
                for (int column = 0; column < 10; ++column)
                    expected.push_back(100.0 + 3.0 * (3 * column + 1) - 7.0 * (3 * row + 1));
            expectHeights(file, expected);
            EXPECT_EQ(noteWith(file, "averaged"), "30 x 12 posts are averaged to 10 x 4");
        }
    EXPECT_EQ(reduced(raster, 30).tile.width(), 30) << "small enough as it is";
}

TEST(ReducedDem, NoVoidEntersAMean)
{
    MemoryRaster like;
    for (const double value : {-9999.0, -32768.0, -32767.0, -99999.0, -3.4e38, 3.4e38, 1000001.0,
                               missing, infinite, -infinite})
    {
        SCOPED_TRACE(value);
        like.noData.reset();
        const DemFile undeclared = reduced(blocks(like, value), 4);
        expectMeans(undeclared, asStored);
        EXPECT_EQ(undeclared.notes.size(), 2u) << "how many are void, and the averaging";
        EXPECT_EQ(undeclared.notes[0].rfind("13 posts", 0), 0u) << undeclared.notes[0];
        if (std::isinf(value))
            continue;
        like.noData = value;
        const DemFile declared = reduced(blocks(like, value), 4);
        expectMeans(declared, asStored);
        EXPECT_EQ(declared.notes.size(), 1u);
    }
    like.noData.reset();
    MemoryRaster masked = blocks(like, 17.0); // what lies below a mask is no height
    for (const double value : masked.values)
        masked.datasetMask.push_back(value == 17.0 ? 0 : 255);
    expectMeans(reduced(masked, 4), asStored);
}

TEST(ReducedDem, ValuesBecomeHeightsBeforeTheyAreAveraged)
{
    MemoryRaster like;
    like.type = GDT_Byte;
    like.creation = {"PIXELTYPE=SIGNEDBYTE"};
    like.noData = -128;
    MemoryRaster raster = blocks(like, 128); // as GDAL before 3.7 writes -128
    for (double& value : raster.values)
        if (value != 128)
            value = value < 64 ? value - 64 + 256 : value - 64; // bytes on both sides of 0
    expectMeans(reduced(raster, 4), [](double mean) { return mean - 64; });

    like = MemoryRaster();
    like.metadata = {{"positive", "down"}};
    like.type = GDT_Int16;
    like.scale = 0.5;
    like.offset = 3.0;
    like.unit = "ft";
    const DemFile depths = reduced(blocks(like, -32768), 4);
    expectMeans(depths, [](double mean) { return -0.3048 * (0.5 * mean + 3.0); });
    noteWith(depths, "points down");

    DemReadOptions options;
    options.heightUnit = "us-ft";
    options.heightFactor = -2.0;
    expectMeans(reduced(blocks(like, -32768), 4, options),
                [](double mean) { return 2.0 * 1200.0 / 3937.0 * (0.5 * mean + 3.0); });

    like = MemoryRaster();
    like.type = GDT_UInt16;
    like.colourTable = true;
    like.noData = 0;
    const DemFile painted = reduced(blocks(like, 0), 4);
    expectMeans(painted, asStored);
    noteWith(painted, "colour table");
}

TEST(ReducedDem, RadiiBecomeHeights)
{
    MemoryRaster like;
    like.crs = "+proj=stere +lat_0=90 +R=2439400 +units=m";
    like.type = GDT_Float64;
    like.transform = {0, 100, 0, 1000, 0, -100};
    MemoryRaster raster = blocks(like, 0.0); // 0 is no radius, and declared nowhere
    for (double& value : raster.values)
        if (value != 0.0)
            value += 2439400.0;
    const DemFile file = reduced(raster, 4);
    expectMeans(file, asStored);
    noteWith(file, "2439400 m come off");
}

// -9999 beside -9500 is a height in each of the readers, and enters a mean as one.
TEST(ReducedDem, ACustomaryValueThatIsAHeightCounts)
{
    MemoryRaster raster;
    raster.width = raster.height = 4;
    raster.values = {-9999, -9501, -9000, -9000, -9500, -9000, -9000, -9000,
                     -9200, -9200, -9100, -9100, -9200, -9200, -9100, -9100};
    const DemFile file = reduced(raster, 2);
    expectHeights(file, {-9500, -9000, -9200, -9100});
    noteWith(file, "1 post of -9999");
}

TEST(ReducedDem, RowsBeyondAPoleStayOut)
{
    MemoryRaster raster;
    raster.crs = "EPSG:4326";
    raster.width = 4;
    raster.height = 8;
    raster.transform = {10, 1, 0, 92, 0, -1}; // rows at 91.5, 90.5, 89.5 …
    raster.values.assign(32, 500.0);
    std::fill_n(raster.values.begin(), 8, 90000.0);
    for (int column = 0; column < 4; ++column)
        raster.values[static_cast<std::size_t>(4 * 3 + column)] = 700.0;
    const DemFile file = reduced(raster, 4);
    ASSERT_EQ(file.tile.width(), 2);
    expectHeights(file, {missing, missing, 600, 600, 500, 500, 500, 500});
    // Means of 3 rows, of which the first lies beyond: those at 89.9 and 88.9 count.
    raster.height = 9;
    raster.transform[3] = 91.4;
    raster.values.assign(36, 500.0);
    std::fill_n(raster.values.begin(), 4, 90000.0);
    std::fill_n(raster.values.begin() + 8, 4, 700.0);
    expectHeights(reduced(raster, 3), {600, 500, 500});
}

// A cell's spacing and factor are those of its own middle.
TEST(ReducedDem, DistancesOfDegreesAndOfMercator)
{
    MemoryRaster raster;
    raster.crs = "EPSG:4326";
    raster.width = raster.height = 40;
    raster.transform = {10, 0.5, 0, 70, 0, -0.5};
    raster.values.assign(1600, 5.0);
    const DemFile degrees = reduced(raster, 8); // cells of 2.5 degrees
    for (int row = 0; row < 8; ++row)
    {
        const double latitude = (50.0 + 2.5 * (row + 0.5)) * pi / 180.0;
        const double w = std::sqrt(1.0 - 0.00669437999014 * std::pow(std::sin(latitude), 2.0));
        EXPECT_NEAR(degrees.tile.eastSpacing(row),
                    2.5 * pi / 180.0 * 6378137.0 * std::cos(latitude) / w, 1e-3);
    }

    const double radius = 6371000.0;
    raster.crs = "+proj=merc +units=m +R=6371000";
    raster.transform = {0, 20000, 0, 8e6, 0, -20000};
    for (std::size_t i = 0; i < raster.values.size(); ++i)
        raster.values[i] = i / 5 % 2 == (i / 40) / 5 % 2 ? 0.0 : 100.0;
    const DemFile mercator = reduced(raster, 8);
    // The middle lies between two rows of cells.
    EXPECT_NEAR(mercator.tile.northSpacing, 100000.0 / std::cosh(7.6e6 / radius), 1.0);
    for (int row = 0; row < 8; ++row)
    {
        const double y = 7.6e6 + (row - 3.5) * 100000.0;
        EXPECT_NEAR(std::abs(static_cast<double>(mercator.tile.heightAt(0, row))),
                    50.0 * std::cosh(y / radius) / std::cosh(7.6e6 / radius), 2e-3)
            << row;
    }
}

TEST(ReducedDem, AnOverviewStandsForWhatIsTooLargeToReadWhole)
{
    MemoryRaster raster;
    raster.width = raster.height = 64;
    raster.values.assign(64 * 64, 10.0);
    const std::string path = raster.write();
    GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
    const int levels[] = {2, 4, 8};
    ASSERT_EQ(dataset->BuildOverviews("NEAREST", 3, const_cast<int*>(levels), 0, nullptr, nullptr,
                                      nullptr),
              CE_None);
    for (int i = 0; i < 3; ++i) // each says which it is; a quarter of it is void
    {
        GDALRasterBand& overview = *dataset->GetRasterBand(1)->GetOverview(i);
        const int side = 32 >> i;
        std::vector<float> values(static_cast<std::size_t>(side * side),
                                  static_cast<float>(20 + i));
        for (std::size_t k = 0; k < values.size(); k += 4)
            values[k] = -32768.0f;
        ASSERT_EQ(overview.RasterIO(GF_Write, 0, 0, side, side, values.data(), side, side,
                                    GDT_Float32, 0, 0, nullptr),
                  CE_None);
    }
    dataset.reset();
    const auto first = [&](std::size_t maxPosts, int maxSide)
    {
        DemReadOptions options;
        options.maxPosts = maxPosts;
        const Result<DemFile> file = readDemReduced(path, options, maxSide);
        EXPECT_TRUE(file) << (file ? "" : file.error().message);
        EXPECT_EQ(file->tile.width(), maxSide);
        EXPECT_DOUBLE_EQ(file->tile.northSpacing, 640.0 / maxSide);
        EXPECT_NEAR(file->tile.mapOriginX, 500000.0 + 320.0 / maxSide, 1e-6);
        EXPECT_EQ(file->tile.validCount(), file->tile.postCount());
        return std::pair(heightsOf(*file).front(), file->notes.back());
    };
    EXPECT_EQ(first(64 * 64, 4).first, 10.0);
    EXPECT_EQ(first(64 * 64 - 1, 4).first, 22.0) << "8 a side";
    EXPECT_EQ(first(100, 12).first, 21.0) << "16 a side";
    EXPECT_EQ(first(100, 20).first, 20.0) << "32 a side";
    EXPECT_EQ(first(100, 40).first, 10.0) << "no overview has as many";
    EXPECT_EQ(first(100, 12).second,
              "64 x 64 posts are averaged to 12 x 12, from the overview of 16 x 16");
}

TEST(ReducedDem, ErrorsNameTheFile)
{
    MemoryRaster raster;
    raster.values.assign(6, -9999.0);
    raster.noData = -9999.0;
    const std::string path = raster.write();
    const Result<DemFile> empty = readDemReduced(path, {}, 2);
    ASSERT_FALSE(empty);
    EXPECT_EQ(empty.error().message, path + ": holds no valid height: all of 3 x 2 posts are void");
    EXPECT_EQ(readDemReduced("/nowhere/at_all.tif", {}, 4).error().code, ErrorCode::NotFound);
    DemReadOptions options;
    double last = 0.0;
    options.progress = [&last](double done)
    {
        EXPECT_GT(done, last);
        last = done;
        return true;
    };
    EXPECT_TRUE(readDemReduced(MemoryRaster().write(), options, 2));
    EXPECT_EQ(last, 1.0);
}
