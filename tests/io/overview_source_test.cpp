#include "io/OverviewSource.h"

#include "core/LevelReducer.h"
#include "io/RasterSource.h"
#include "support/MemoryRaster.h"

#include <cmath>
#include <random>

using namespace osgTerrainLight;

namespace
{
/// Seeded whole numbers of a kilometre, with overviews by the nearest pixel where asked for.
struct Hills
{
    int width, height;
    std::vector<double> values;
    std::string path;

    Hills(int columns, int rows, const std::vector<int>& overviews = {}, double north = -10.0,
          std::optional<double> noData = std::nullopt)
        : width(columns), height(rows)
    {
        std::mt19937 random(static_cast<unsigned>(columns * 1000 + rows));
        std::uniform_int_distribution<int> heights(0, 1000);
        for (int i = 0; i < columns * rows; ++i)
            values.push_back(heights(random));
        MemoryRaster raster;
        raster.width = columns;
        raster.height = rows;
        raster.values = values;
        raster.transform[5] = north;
        raster.noData = noData;
        path = raster.write();
        if (!overviews.empty())
            addOverviews(path, overviews);
    }

    double pixel(int column, int row) const
    {
        return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(column)];
    }
};

std::unique_ptr<OverviewSource> opened(const std::string& path, int cellsLog2)
{
    auto source = OverviewSource::open(path, {}, cellsLog2);
    EXPECT_TRUE(source) << source.error().message;
    return source ? std::move(*source) : nullptr;
}

/// All posts of a level are pixels of the file: counted from its north-western one, every 2^level.
void expectPixels(const Hills& hills, OverviewSource& source, bool northUp = true)
{
    for (int level = 0; level <= source.root(); ++level)
    {
        const int step = 1 << level;
        const PostRect all = source.extent(level).grownBy(1);
        const Result<Raster<float>> posts = source.readSurface(level, all);
        ASSERT_TRUE(posts);
        int valid = 0;
        for (int row = 0; row < all.height; ++row)
            for (int column = 0; column < all.width; ++column)
            {
                const int x = (all.column + column) * step;
                const int south = (all.row + row) * step;
                const int y = northUp ? source.height() - 1 - south : south;
                const float height = posts->at(column, row);
                if (x < 0 || y < 0 || x >= hills.width || y >= hills.height)
                {
                    ASSERT_TRUE(std::isnan(height)) << level << ": " << x << ", " << y;
                    continue;
                }
                ++valid;
                ASSERT_EQ(static_cast<double>(height) + source.heightOrigin(), hills.pixel(x, y))
                    << level << ": " << x << ", " << y;
            }
        EXPECT_EQ(valid, ((hills.width - 1) / step + 1) * ((hills.height - 1) / step + 1));
    }
}
} // namespace

TEST(OverviewSource, PostsOfEveryLevelArePixelsOfTheRaster)
{
    for (const auto& [width, height] : {std::pair(37, 21), std::pair(64, 65), std::pair(9, 33)})
    {
        const Hills hills(width, height);
        const auto source = opened(hills.path, 3);
        ASSERT_TRUE(source);
        EXPECT_GE(source->cells() << source->root(), std::max(width, height) - 1);
        expectPixels(hills, *source);
    }
}

TEST(OverviewSource, ReadsCoarseLevelsFromOverviews)
{
    const Hills hills(208, 152, {2, 4, 8});
    expectPixels(hills, *opened(hills.path, 4));
    // Overviews that hold something else are seen: it is they that are read.
    {
        GDALDatasetUniquePtr dataset(GDALDataset::Open(hills.path.c_str(), GDAL_OF_UPDATE));
        GDALRasterBand* overview = dataset->GetRasterBand(1)->GetOverview(1);
        ASSERT_TRUE(overview);
        ASSERT_EQ(overview->Fill(500.0), CE_None);
    }
    const auto source = opened(hills.path, 4);
    const Result<Raster<float>> posts = source->readSurface(2, source->extent(2));
    ASSERT_TRUE(posts);
    for (const float height : posts->values())
        ASSERT_EQ(static_cast<double>(height) + source->heightOrigin(), 500.0);
}

// GDAL's overviews of an odd size, each made from the one before, hold pixels that are not a whole
// number apart: each within one of its own. Heights tell the column that a post is from.
TEST(OverviewSource, OverviewsOfOtherSizesAreNearby)
{
    MemoryRaster raster;
    raster.width = 203;
    raster.height = 149;
    raster.values.clear();
    for (int i = 0; i < raster.width * raster.height; ++i)
        raster.values.push_back(i % raster.width);
    const std::string path = raster.write();
    addOverviews(path, {2, 4, 8});
    const auto source = opened(path, 4);
    for (int level = 1; level <= 3; ++level)
    {
        const PostRect all = source->extent(level);
        const Result<Raster<float>> posts = source->readSurface(level, all);
        ASSERT_TRUE(posts);
        for (int row = 0; row < all.height; ++row)
            for (int column = 0; column < all.width; ++column)
                EXPECT_NEAR(static_cast<double>(posts->at(column, row)) + source->heightOrigin(),
                            (all.column + column) << level, (1 << level) - 0.5);
    }
}

TEST(OverviewSource, TakesRowsFromTheSouth)
{
    const Hills hills(37, 21, {}, 10.0);
    expectPixels(hills, *opened(hills.path, 3), false);
}

TEST(OverviewSource, VoidsStayVoid)
{
    const Hills hills(64, 64, {2, 4}, -10.0, 500.0);
    const auto source = opened(hills.path, 4);
    for (int level = 0; level <= 2; ++level)
    {
        const PostRect all = source->extent(level);
        const Result<Raster<float>> posts = source->readSurface(level, all);
        ASSERT_TRUE(posts);
        for (int row = 0; row < all.height; ++row)
            for (int column = 0; column < all.width; ++column)
            {
                const int x = (all.column + column) << level;
                const int y = source->height() - 1 - ((all.row + row) << level);
                ASSERT_EQ(std::isnan(posts->at(column, row)), hills.pixel(x, y) == 500.0);
            }
    }
}

// Expected: LevelReducer, fed with the posts themselves. Crests come from posts two levels finer,
// which for the first two levels are those of the raster.
TEST(OverviewSource, CrestsAreThoseOfTheReducer)
{
    const Hills hills(152, 88, {2, 4});
    const auto source = opened(hills.path, 4);
    const PostRect all{0, 0, source->width(), source->height()};
    const Result<Raster<float>> posts = source->readPosts(all);
    ASSERT_TRUE(posts);
    std::vector<std::array<Raster<float>, 2>> levels;
    for (int level = 1; level <= 2; ++level)
    {
        const int side = LevelReducer::posts(all.width, level);
        levels.push_back({Raster<float>(side, side), Raster<float>(side, side)});
    }
    LevelReducer reducer(all.width, all.height, 2,
                         [&](int level, int row, const std::array<std::vector<float>, 2>& heights)
                         {
                             for (std::size_t axis = 0; axis < 2; ++axis)
                                 std::copy(
                                     heights[axis].begin(), heights[axis].end(),
                                     &levels[static_cast<std::size_t>(level - 1)][axis].at(0, row));
                         });
    for (int row = 0; row < all.height; ++row)
        reducer.addRow(&posts->at(0, row));
    for (int level = 1; level <= 2; ++level)
        for (const CrestAxis axis : {CrestAxis::East, CrestAxis::North})
        {
            // At the raster's edge there is void ground beside the posts, here as everywhere.
            const PostRect extent = source->extent(level).grownBy(-1);
            const Result<Raster<float>> read = source->readLevel(level, axis, extent);
            ASSERT_TRUE(read);
            const Raster<float>& expected =
                levels[static_cast<std::size_t>(level - 1)][axis == CrestAxis::East ? 0 : 1];
            for (int row = 0; row < extent.height; ++row)
                for (int column = 0; column < extent.width; ++column)
                    ASSERT_EQ(read->at(column, row),
                              expected.at(extent.column + column, extent.row + row))
                        << level << ": " << column << ", " << row;
        }
}

TEST(OverviewSource, TellsOfOverviewsThatAreMissing)
{
    const auto notesOf = [](const std::vector<int>& overviews)
    {
        MemoryRaster raster;
        raster.width = 9000;
        raster.height = 3;
        raster.values.assign(27000, 7.0);
        const std::string path = raster.write();
        if (!overviews.empty())
            addOverviews(path, overviews);
        std::string all;
        const auto source = opened(path, 8);
        for (const std::string& note : source->notes())
            all += note + "\n";
        return all;
    };
    EXPECT_NE(notesOf({}).find("gdaladdo -r nearest"), std::string::npos) << notesOf({});
    EXPECT_NE(notesOf({}).find("2 4 8 16 32"), std::string::npos) << notesOf({});
    EXPECT_EQ(notesOf({2, 4, 8, 16}).find("gdaladdo"), std::string::npos) << notesOf({2, 4, 8, 16});
}

TEST(OverviewSource, RefusesWhatHasNoHeights)
{
    const auto missing = OverviewSource::open("/vsimem/not_there.tif", {});
    ASSERT_FALSE(missing);
    EXPECT_NE(missing.error().message.find("/vsimem/not_there.tif"), std::string::npos);
    MemoryRaster raster;
    raster.noData = 7.0;
    raster.values.assign(6, 7.0);
    const std::string path = raster.write();
    const auto empty = OverviewSource::open(path, {});
    ASSERT_FALSE(empty);
    EXPECT_NE(empty.error().message.find("holds no valid height"), std::string::npos)
        << empty.error().message;
}
