#include "io/RasterSource.h"

#include "support/LevelChecks.h"
#include "support/MemoryRaster.h"

#include <cmath>
#include <functional>

using namespace osgTerrainLight;

namespace
{
const double pi = std::acos(-1.0);

struct Point
{
    double x = 0.0, y = 0.0;
};

/// Another CRS's coordinates, by PROJ.
class Way
{
public:
    Way(const std::string& from, const std::string& to)
    {
        OGRSpatialReference source;
        OGRSpatialReference target;
        for (auto& [reference, name] : {std::pair(&source, &from), std::pair(&target, &to)})
        {
            EXPECT_EQ(reference->SetFromUserInput(name->c_str()), OGRERR_NONE);
            reference->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        }
        _way.reset(OGRCreateCoordinateTransformation(&source, &target));
    }
    Point operator()(Point at) const
    {
        EXPECT_TRUE(_way->Transform(1, &at.x, &at.y));
        return at;
    }

private:
    std::unique_ptr<OGRCoordinateTransformation> _way;
};

using HeightAt = std::function<double(double x, double y)>;

/// A raster whose pixels have heights by the map coordinates of their middle.
MemoryRaster rasterOf(const std::string& crs, double west, double north, double cell, int width,
                      int height, const HeightAt& heightAt)
{
    MemoryRaster raster;
    raster.crs = crs;
    raster.transform = {west, cell, 0, north, 0, -cell};
    raster.width = width;
    raster.height = height;
    raster.values.clear();
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
            raster.values.push_back(
                heightAt(west + (column + 0.5) * cell, north - (row + 0.5) * cell));
    return raster;
}

const std::string utm = "EPSG:32633";
constexpr double litWest = 500000.0, litNorth = 4000000.0;

/// What is lit in most tests: 40 x 30 posts of 10 m, level.
MemoryRaster lit(double height = 100.0)
{
    return rasterOf(utm, litWest, litNorth, 10.0, 40, 30,
                    [height](double, double) { return height; });
}

/// Map coordinates of a post of a level.
Point placeOf(const RasterSource& source, int level, int column, int row)
{
    return {source.frame().mapX(std::ldexp(column, level)),
            source.frame().mapY(std::ldexp(row, level))};
}

std::unique_ptr<RasterSource>
open(const std::string& path, const std::vector<std::string>& surroundings, double reach = 500.0e3)
{
    RasterSourceOptions options;
    options.surroundings = surroundings;
    options.reach = reach;
    auto source = RasterSource::open(path, options);
    EXPECT_TRUE(source) << (source ? "" : source.error().message);
    return source ? std::move(*source) : nullptr;
}

/// A height above the datum; NaN where void. Level 0: of the posts.
double heightAt(RasterSource& source, int level, int column, int row)
{
    const PostRect post{column, row, 1, 1};
    const auto found =
        level == 0 ? source.readPosts(post) : source.readLevel(level, CrestAxis::East, post);
    EXPECT_TRUE(found);
    return found ? source.heightOrigin() + static_cast<double>(found->at(0, 0)) : std::nan("");
}

bool says(const RasterSource& source, const std::string& words)
{
    for (const std::string& note : source.notes())
        if (note.find(words) != std::string::npos)
            return true;
    return false;
}
} // namespace

// A slope of 5 % to the east and 2 % to the north in UTM, known from a raster of degrees only, of
// some 92 x 111 m. A plane is its own bilinear interpolation, but for the bend of meridians within
// a cell (below 1 cm) and a hundredth of a pixel in place (0.05 m).
TEST(Surroundings, PlaneInDegreesAroundAMapInMetres)
{
    const auto plane = [](double x, double y)
    { return 0.05 * (x - litWest) + 0.02 * (y - litNorth) + 1000.0; };
    const Way toMap("EPSG:4326", utm);
    const Point middle = Way(utm, "EPSG:4326")({litWest, litNorth});
    const std::string far = rasterOf("EPSG:4326", middle.x - 0.1, middle.y + 0.1, 0.001, 200, 200,
                                     [&](double x, double y)
                                     {
                                         const Point at = toMap({x, y});
                                         return plane(at.x, at.y);
                                     })
                                .write();
    const auto source = open(lit().write(), {far});
    ASSERT_TRUE(source);
    // 0.1 degrees are cos(36.1 degrees) * 11.13 km = 9.0 km to the west, 11.1 km to the north; the
    // meridians' bend adds some. No more than 92 m apart are the posts of level 3.
    const PostRect extent = source->extent(0);
    EXPECT_NEAR(-extent.column * 10.0, 9000.0, 300.0);
    EXPECT_NEAR(extent.endRow() * 10.0, 11100.0 + 300.0, 300.0);
    int checked = 0;
    for (int level = 0; level <= 3; ++level)
        for (int row = -800; row <= 800; row += 133)
            for (int column = -700; column <= 700; column += 133)
            {
                const int i = column >> level;
                const int j = row >> level;
                const bool own =
                    PostRect{0, 0, 40, 30}.grownBy(8).contains(i * (1 << level), j * (1 << level));
                if (own)
                    continue;
                const Point at = placeOf(*source, level, i, j);
                EXPECT_NEAR(heightAt(*source, level, i, j), plane(at.x, at.y), 0.06)
                    << "level " << level << ", " << i << ", " << j;
                ++checked;
            }
    EXPECT_GT(checked, 300);
    // What is lit keeps its own heights.
    expectPosts(*source, {0, 0, 40, 30}, [&](int, int) { return 0.0f; });
}

// The top of a cone 6 km away is where it is known to be, within a cell of its level, and as high:
// its 30 % fall by 0.3 of a cell's diagonal at most.
TEST(Surroundings, ConeStandsAtItsPlaceOnEveryLevel)
{
    const Point top{litWest + 4000.0, litNorth + 4500.0};
    const Way toMap("EPSG:3857", utm);
    const Point middle = Way(utm, "EPSG:3857")({litWest, litNorth});
    const std::string far =
        rasterOf("EPSG:3857", middle.x - 9000, middle.y + 9000, 60, 300, 300,
                 [&](double x, double y)
                 {
                     const Point at = toMap({x, y});
                     return std::max(0.0, 1000.0 - 0.3 * std::hypot(at.x - top.x, at.y - top.y));
                 })
            .write();
    const auto source = open(lit().write(), {far});
    ASSERT_TRUE(source);
    for (int level = 0; level <= source->lastLevel(); ++level)
    {
        const PostRect extent = source->extent(level);
        const auto posts = level == 0 ? source->readPosts(extent)
                                      : source->readLevel(level, CrestAxis::North, extent);
        ASSERT_TRUE(posts);
        float highest = -1.0e6f;
        Point found;
        for (int row = 0; row < extent.height; ++row)
            for (int column = 0; column < extent.width; ++column)
                if (posts->at(column, row) > highest)
                {
                    highest = posts->at(column, row);
                    found = placeOf(*source, level, extent.column + column, extent.row + row);
                }
        const double cell = std::max(60.0, std::ldexp(10.0, level));
        EXPECT_LE(std::abs(found.x - top.x), cell) << "level " << level;
        EXPECT_LE(std::abs(found.y - top.y), cell) << "level " << level;
        const double height = source->heightOrigin() + static_cast<double>(highest);
        EXPECT_LE(height, 1000.0);
        EXPECT_GE(height, 1000.0 - 0.3 * 1.5 * cell) << "level " << level;
    }
}

// Levels coarser than the one that is sampled are reduced from it, by the definition of levels.
TEST(Surroundings, CoarserLevelsAreReducedFromTheSampledOne)
{
    const std::string far =
        rasterOf(utm, litWest - 2000, litNorth + 2000, 40, 100, 100,
                 [](double x, double y) { return std::fmod(std::abs(x * 7 + y * 13), 300.0); })
            .write();
    MemoryRaster empty = lit();
    empty.noData = 100; // void but for one post, so that all is seen of the surroundings
    empty.values[0] = 50;
    const auto source = open(empty.write(), {far});
    ASSERT_TRUE(source);
    // 40 m are 4 posts: level 2 is sampled. On it, work the next one out.
    const PostRect coarse = source->extent(3);
    const PostRect base{coarse.column * 2, coarse.row * 2, coarse.width * 2 + 1,
                        coarse.height * 2 + 1};
    const auto posts = source->readLevel(2, CrestAxis::East, base);
    ASSERT_TRUE(posts);
    const DirectLevels direct(*posts);
    const auto found = source->readLevel(3, CrestAxis::North, coarse);
    ASSERT_TRUE(found);
    int checked = 0;
    for (int row = 1; row < coarse.height - 1; ++row)
        for (int column = 1; column < coarse.width - 1; ++column)
        {
            const Point at = placeOf(*source, 3, coarse.column + column, coarse.row + row);
            if (std::hypot(at.x - litWest, at.y - litNorth) < 300.0 ||
                PostRect{0, 0, source->width() / 8 + 1, source->height() / 8 + 1}
                    .grownBy(1)
                    .contains(coarse.column + column, coarse.row + row))
                continue; // near the valid post, and where what is lit is void
            EXPECT_TRUE(
                sameHeight(found->at(column, row), direct.post(1, CrestAxis::North, column, row)))
                << column << ", " << row;
            ++checked;
        }
    EXPECT_GT(checked, 1500);
}

// Of two, the first counts where both are valid; what is lit comes before both, and its voids stay
// voids, since what is written is void where the input is.
TEST(Surroundings, FirstGivenWins)
{
    const auto level = [](double height) { return [height](double, double) { return height; }; };
    const std::string west =
        rasterOf(utm, litWest - 1000, litNorth + 1000, 10, 120, 230, level(200)).write();
    const std::string all =
        rasterOf(utm, litWest - 1000, litNorth + 1000, 20, 120, 120, level(300)).write();
    MemoryRaster middle = lit();
    middle.noData = -1;
    middle.values[5] = -1;  // north-west of the middle: beneath the first
    middle.values[39] = -1; // north-east
    const auto source = open(middle.write(), {west, all});
    ASSERT_TRUE(source);
    EXPECT_EQ(heightAt(*source, 0, 0, 0), 100.0);
    EXPECT_TRUE(std::isnan(heightAt(*source, 0, 5, 29)));
    EXPECT_TRUE(std::isnan(heightAt(*source, 0, 39, 29)));
    EXPECT_EQ(heightAt(*source, 0, -50, 10), 200.0);
    EXPECT_EQ(heightAt(*source, 0, 60, 10), 300.0);
    EXPECT_EQ(heightAt(*source, 2, 20, 10), 300.0);
    EXPECT_EQ(heightAt(*source, 2, -20, 10), 200.0);
    EXPECT_TRUE(std::isnan(heightAt(*source, 0, 250, 10)));
    const auto other = open(middle.write(), {all, west});
    ASSERT_TRUE(other);
    EXPECT_EQ(heightAt(*other, 0, -50, 10), 300.0);
}

// A raster of degrees with surroundings in metres, of feet: the unit is that of any raster.
TEST(Surroundings, PlaneInMetresAndFeetAroundDegrees)
{
    const auto plane = [](double x, double y)
    { return 0.01 * (x - litWest) + 0.03 * (y - litNorth) + 2000.0; };
    const Point middle = Way(utm, "EPSG:4326")({litWest, litNorth});
    MemoryRaster degrees = rasterOf("EPSG:4326", middle.x, middle.y, 0.0005, 30, 20,
                                    [](double, double) { return 2000.0; });
    MemoryRaster far = rasterOf(utm, litWest - 8000, litNorth + 8000, 100, 160, 160,
                                [&](double x, double y) { return plane(x, y) / 0.3048; });
    far.unit = "ft";
    const auto source = open(degrees.write(), {far.write()});
    ASSERT_TRUE(source);
    const Way toMap("EPSG:4326", utm);
    for (const auto& [column, row] : {std::pair(-100, 5), std::pair(60, 60), std::pair(10, -80)})
    {
        const Point at = placeOf(*source, 0, column, row);
        const Point onMap = toMap(at);
        EXPECT_NEAR(heightAt(*source, 0, column, row), plane(onMap.x, onMap.y), 0.05);
    }
    // Rows beyond the raster have the spacing of their latitude: WGS 84's, by a cosine.
    EXPECT_NEAR(source->eastSpacing(300) / source->eastSpacing(0),
                std::cos(placeOf(*source, 0, 0, 300).y * pi / 180.0) /
                    std::cos(placeOf(*source, 0, 0, 0).y * pi / 180.0),
                1.0e-5);
}

// Across the 180th meridian: longitudes 179 ... 181 of what is lit are 179 ... 180 and -180 ...
// -179 of a raster of the whole body, whose heights are its distances from that meridian.
TEST(Surroundings, WholeBodyAcrossTheAntimeridian)
{
    const std::string globe =
        rasterOf("EPSG:4326", -180, 90, 1, 360, 180,
                 [](double x, double) { return 10.0 * (180.0 - std::abs(x)); })
            .write();
    const std::string path =
        rasterOf("EPSG:4326", 179.5, 10, 0.1, 10, 10, [](double, double) { return 5.0; }).write();
    const auto source = open(path, {globe}, 300.0e3);
    ASSERT_TRUE(source);
    // Posts 0.1 degrees apart, from 179.55 on: 2 degrees to the east are 181.55 degrees.
    EXPECT_NEAR(heightAt(*source, 0, 20, 4), 15.5, 0.2); // 0.01 of a pixel is 0.1 m
    EXPECT_NEAR(heightAt(*source, 0, -20, 4), 24.5, 0.2);
    EXPECT_LE(source->extent(0).column, -26); // 300 km are 2.7 degrees
    EXPECT_GE(source->extent(0).endColumn(), 36);
}

// A raster of the whole body, of 1 degree, around a map, and around a pole, where all of its
// columns meet: its heights are 10 m per degree of latitude. Posts that are sampled lie less than 1
// degree apart; between them the circle of latitude bends by 0.2 degrees at most (1 degree squared
// over 8 times 0.6 degrees, the nearest to the pole that is asked for), 2 m.
TEST(Surroundings, WholeBodyAroundMaps)
{
    const std::string globe =
        rasterOf("EPSG:4326", -180, 90, 1, 360, 180, [](double, double y) { return 10.0 * y; })
            .write();
    const auto expectLatitudes = [&globe](const std::string& crs, double x, double y)
    {
        const std::string path =
            rasterOf(crs, x, y, 100, 10, 10, [](double, double) { return 0.0; }).write();
        const auto source = open(path, {globe}, 420.0e3);
        ASSERT_TRUE(source);
        // A post of a polar map is 103 m or less on the ground.
        EXPECT_LE(source->extent(0).column, -4000);
        EXPECT_GE(source->extent(0).endRow(), 4000);
        const Way toDegrees(crs, "EPSG:4326");
        for (int row = -3900; row <= 3900; row += 780)
            for (int column = -3900; column <= 3900; column += 780)
            {
                const Point at = toDegrees(placeOf(*source, 0, column, row));
                if (at.y > 89.4 || (column == 0 && row == 0))
                    continue;
                EXPECT_NEAR(heightAt(*source, 0, column, row), 10.0 * at.y, 2.0)
                    << crs << " " << column << ", " << row;
            }
    };
    expectLatitudes(utm, litWest, litNorth);
    expectLatitudes("EPSG:3413", 0.0, 0.0);
    expectLatitudes("EPSG:3413", 20000.0, -90000.0);
}

// A raster that is finer than what is lit is sampled at its posts.
TEST(Surroundings, FinerThanWhatIsLit)
{
    const std::string far =
        rasterOf(utm, litWest - 300, litNorth + 300, 2, 500, 500,
                 [](double x, double y) { return 0.1 * (x - litWest) + 0.2 * (y - litNorth); })
            .write();
    const auto source = open(lit().write(), {far});
    ASSERT_TRUE(source);
    const Point at = placeOf(*source, 0, -20, 35);
    EXPECT_NEAR(heightAt(*source, 0, -20, 35), 0.1 * (at.x - litWest) + 0.2 * (at.y - litNorth),
                0.01);
}

// No further than asked for: 2 km of posts of 10 m; and a raster that lies beyond is not used.
TEST(Surroundings, ReachLimitsThem)
{
    const auto level = [](double, double) { return 120.0; };
    const std::string wide =
        rasterOf(utm, litWest - 20000, litNorth + 20000, 100, 400, 400, level).write();
    const std::string away =
        rasterOf(utm, litWest + 50000, litNorth + 20000, 100, 40, 40, level).write();
    const auto source = open(lit().write(), {wide, away}, 2000.0);
    ASSERT_TRUE(source);
    // Levels end at whole posts of the one that is sampled, 8 apart.
    EXPECT_LE(std::abs(source->extent(0).column + 200), 8);
    EXPECT_LE(std::abs(source->extent(0).endColumn() - 240), 9);
    EXPECT_TRUE(says(*source, "no terrain within 2000 m"));
    const int last = source->lastLevel();
    EXPECT_LE(source->extent(last).width, 64);
    EXPECT_LE(source->extent(last).height, 64);
}

TEST(Surroundings, OtherHeightsAreTold)
{
    const auto at = [](double height) { return [height](double, double) { return height; }; };
    const std::string higher =
        rasterOf(utm, litWest - 1000, litNorth + 1000, 40, 60, 60, at(172)).write();
    const std::string near =
        rasterOf(utm, litWest - 1000, litNorth + 1000, 40, 60, 60, at(140)).write();
    EXPECT_TRUE(says(*open(lit().write(), {higher}), "heights are 72 m above"));
    EXPECT_FALSE(says(*open(lit().write(), {near}), "datum"));
}

TEST(Surroundings, MapsThatDoNotGoTogether)
{
    MemoryRaster bare = lit();
    bare.crs.clear();
    const std::string placed = lit().write();
    const std::string unplaced = bare.write();
    RasterSourceOptions options;
    options.surroundings = {unplaced};
    const auto one = RasterSource::open(placed, options);
    ASSERT_FALSE(one);
    EXPECT_NE(one.error().message.find(unplaced + ": has no CRS"), std::string::npos);
    options.surroundings = {placed};
    const auto other = RasterSource::open(unplaced, options);
    ASSERT_FALSE(other);
    EXPECT_NE(other.error().message.find(unplaced + ": has no CRS"), std::string::npos);

    bare.transform[0] -= 200; // half of it lies beside
    const auto both = open(unplaced, {bare.write()});
    ASSERT_TRUE(both);
    EXPECT_TRUE(says(*both, "map coordinates are taken as those of"));
    EXPECT_EQ(heightAt(*both, 0, -10, 5), 100.0);

    RasterSourceOptions cells = options;
    cells.read.cellSize = 10.0;
    bare.transform.clear();
    const auto nowhere = RasterSource::open(bare.write(), cells);
    ASSERT_FALSE(nowhere);
    EXPECT_NE(nowhere.error().message.find("has no geotransform"), std::string::npos);

    options.surroundings = {"no_such.tif"};
    EXPECT_EQ(RasterSource::open(placed, options).error().code, ErrorCode::NotFound);
}

// A block that cannot be read, of rows 32 ... 47, is an error of the raster that has it.
TEST(Surroundings, UnreadableBlockNamesItsRaster)
{
    MemoryRaster wide = rasterOf(utm, litWest - 2000, litNorth + 2000, 40, 100, 100,
                                 [](double x, double) { return x - litWest + 3000.0; });
    wide.creation = {"COMPRESS=DEFLATE", "BLOCKYSIZE=16"};
    const std::string far = wide.write();
    std::string place;
    {
        const GDALDatasetUniquePtr dataset(GDALDataset::Open(far.c_str(), GDAL_OF_RASTER));
        place = dataset->GetRasterBand(1)->GetMetadataItem("BLOCK_OFFSET_0_2", "TIFF");
    }
    VSILFILE* file = VSIFOpenL(far.c_str(), "rb+");
    VSIFSeekL(file, std::stoull(place), SEEK_SET);
    const std::string spoilt(60, '\xff');
    EXPECT_EQ(VSIFWriteL(spoilt.data(), 1, spoilt.size(), file), spoilt.size());
    VSIFCloseL(file);
    RasterSourceOptions options;
    options.surroundings = {far};
    const auto source = RasterSource::open(lit().write(), options);
    ASSERT_FALSE(source);
    EXPECT_NE(source.error().message.find(far + ": cannot read rows 32 to 47"), std::string::npos)
        << source.error().message;
}

// Voids of surroundings stay void, by nodata value and by custom alike.
TEST(Surroundings, VoidsOfSurroundings)
{
    MemoryRaster far = rasterOf(utm, litWest - 2000, litNorth + 2000, 40, 100, 100,
                                [](double x, double)
                                {
                                    const double east = x - litWest;
                                    return east > 1000.0 ? -32768.0 : east < -1000.0 ? 7.0 : 150.0;
                                });
    far.noData = 7;
    const auto source = open(lit().write(), {far.write()});
    ASSERT_TRUE(source);
    EXPECT_EQ(heightAt(*source, 0, 80, 10), 150.0);
    EXPECT_TRUE(std::isnan(heightAt(*source, 0, 110, 10)));
    EXPECT_TRUE(std::isnan(heightAt(*source, 0, -110, 10)));
    EXPECT_TRUE(says(*source, "of -32768"));
    for (int level = 1; level <= source->lastLevel(); ++level)
    {
        const auto heights = source->readLevel(level, CrestAxis::East, source->extent(level));
        for (const float height : heights->values())
            EXPECT_TRUE(std::isnan(height) || std::abs(height) <= 50.0f) << level;
    }
}

// Their levels are kept as well, for this raster; no pass is made a second time.
TEST(Surroundings, LevelsAreKept)
{
    const std::string path = lit().write();
    const std::string far = rasterOf(utm, litWest - 2000, litNorth + 2000, 40, 100, 100,
                                     [](double x, double) { return x - litWest + 3000.0; })
                                .write();
    RasterSourceOptions options;
    options.surroundings = {far};
    int steps = 0;
    options.read.progress = [&steps](double) { return ++steps > 0; };
    const auto first = RasterSource::open(path, options);
    ASSERT_TRUE(first);
    EXPECT_GT(steps, 0);
    steps = 0;
    const auto second = RasterSource::open(path, options);
    ASSERT_TRUE(second);
    EXPECT_EQ(steps, 0);
    EXPECT_EQ((*first)->readPosts({-50, 3, 9, 9})->values(),
              (*second)->readPosts({-50, 3, 9, 9})->values());
    options.reach = 1000.0;
    ASSERT_TRUE(RasterSource::open(path, options));
    EXPECT_GT(steps, 0);
}
