// Tiles of a host's osgTerrain scene light one another, as far as they are loaded.
#include "scene/TileNeighbours.h"

#include "core/MemorySource.h"
#include "core/SyntheticTerrain.h"
#include "lighting/TileWindows.h"
#include "scene/TerrainTileReader.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardGround.h"
#include "support/ScenePicture.h"
#include "support/TestFolder.h"
#include "support/Tiles.h"
#include "terrain/TerrainModel.h"

#include <osg/MatrixTransform>
#include <osg/PagedLOD>
#include <osgDB/DatabasePager>
#include <osgDB/ReadFile>
#include <osgDB/WriteFile>
#include <osgTerrain/GeometryTechnique>
#include <osgTerrain/Layer>
#include <osgTerrain/TerrainTile>

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <thread>

using namespace osgTerrainLight;

namespace
{
constexpr int side = 32; ///< cells of a tile
constexpr double spacing = 10.0;

/// A part of a terrain, with every `step`-th post.
DemTile part(const DemTile& dem, int column, int row, int cells, int step = 1)
{
    DemTile tile(cells / step + 1, cells / step + 1, dem.northSpacing * step);
    for (int y = 0; y <= cells / step; ++y)
        for (int x = 0; x <= cells / step; ++x)
            tile.setHeight(x, y, dem.heightAt(column + x * step, row + y * step));
    return tile;
}

PlacedGround groundOf(const DemTile& dem, double west, double south, double step = spacing)
{
    PlacedGround ground;
    ground.patch = {std::make_shared<const DemTile>(dem), west, south, step, step, 0.0};
    return ground;
}

/// All stale ones.
std::set<TileHandle> takeAll(TileNeighbours& neighbours)
{
    std::set<TileHandle> all;
    while (const auto handle = neighbours.takeStale())
        all.insert(*handle);
    return all;
}

/// A row of level tiles, all lit.
void setRow(TileNeighbours& neighbours, int count)
{
    for (int i = 0; i < count; ++i)
        neighbours.set(TileHandle::at(0, i, 0),
                       groundOf(analytic::plane(33, 33, spacing, 100.0), i * side * spacing, 0.0));
    for (int i = 0; i < count; ++i)
        EXPECT_TRUE(neighbours.around(TileHandle::at(0, i, 0), HorizonQuality::Normal));
    EXPECT_TRUE(takeAll(neighbours).empty());
}

/// As stock OpenSceneGraph makes it: x and y of the whole terrain, from its south-west corner.
osg::ref_ptr<osgTerrain::TerrainTile> stockTile(const DemTile& dem, double west, double south,
                                                const osgTerrain::TileID& id)
{
    osg::ref_ptr<osgTerrain::Locator> locator = new osgTerrain::Locator;
    locator->setCoordinateSystemType(osgTerrain::Locator::PROJECTED);
    locator->setTransformAsExtents(west, south, west + (dem.width() - 1) * dem.northSpacing,
                                   south + (dem.height() - 1) * dem.northSpacing);
    osg::ref_ptr<osg::HeightField> field = new osg::HeightField;
    field->allocate(static_cast<unsigned>(dem.width()), static_cast<unsigned>(dem.height()));
    for (int row = 0; row < dem.height(); ++row)
        for (int column = 0; column < dem.width(); ++column)
            field->setHeight(static_cast<unsigned>(column), static_cast<unsigned>(row),
                             dem.heightAt(column, row));
    osg::ref_ptr<osgTerrain::HeightFieldLayer> layer = new osgTerrain::HeightFieldLayer(field);
    layer->setLocator(locator);
    osg::ref_ptr<osgTerrain::TerrainTile> tile = new osgTerrain::TerrainTile;
    tile->setTileID(id);
    tile->setLocator(locator);
    tile->setElevationLayer(layer);
    tile->setTerrainTechnique(new osgTerrain::GeometryTechnique);
    return tile;
}

/// Hills of 4 × 4 tiles with a ridge that casts long shadows over several of them.
const DemTile& country()
{
    static const DemTile dem = analytic::makeTile(
        129, 129, spacing,
        [](int column, int row)
        {
            const double ridge = std::exp(-0.02 * (column - 40.0) * (column - 40.0));
            return 200.0 * ridge + 15.0 * std::sin(0.21 * column) * std::cos(0.17 * row);
        });
    return dem;
}
constexpr double halfSide = 64.0 * spacing;

std::vector<osg::ref_ptr<osgTerrain::TerrainTile>> stockTiles()
{
    std::vector<osg::ref_ptr<osgTerrain::TerrainTile>> tiles;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x)
            tiles.push_back(stockTile(part(country(), x * side, y * side, side),
                                      x * side * spacing - halfSide, y * side * spacing - halfSide,
                                      {2, x, y}));
    return tiles;
}

osg::ref_ptr<TerrainLighting> eveningLight(int azimuths = 16)
{
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, azimuths);
    SkyLight sky;
    sky.sunAzimuth = 265.0;
    sky.sunElevation = 14.0;
    lighting->setSkyLight(sky);
    lighting->setFadeSeconds(0.0);
    return lighting;
}

/// Frames until the tiles are lit and nothing has run in the last few.
void settle(ScenePicture& picture, const TerrainLighting& lighting)
{
    int still = 0;
    for (int frame = 0; frame < 400 && still < 6; ++frame)
    {
        picture.draw();
        const auto* pager = picture.viewer().getDatabasePager();
        const bool loading = pager->getRequestsInProgress() || pager->requiresUpdateSceneGraph();
        const LightingStatistics now = lighting.getStatistics();
        const bool rests = !loading && now.lit == now.tiles && now.milliseconds == 0.0;
        still = rests ? still + 1 : 0;
        if (loading)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    EXPECT_EQ(still, 6) << "it does not come to rest";
}

using Pixels = std::vector<unsigned char>;

Pixels pictureOf(const osg::ref_ptr<TerrainLighting>& lighting)
{
    ScenePicture picture(lighting, halfSide);
    settle(picture, *lighting);
    return picture.pixels();
}

/// Of red, over pixels that are not at the rim: mean and greatest.
std::pair<double, int> differences(const Pixels& a, const Pixels& b)
{
    constexpr int size = ScenePicture::size;
    double sum = 0.0;
    int most = 0, count = 0;
    for (int row = 2; row < size - 2; ++row)
        for (int column = 2; column < size - 2; ++column, ++count)
        {
            const auto at = static_cast<std::size_t>(4 * (row * size + column));
            const int difference = std::abs(int(a[at]) - int(b[at]));
            sum += difference;
            most = std::max(most, difference);
        }
    return {sum / count, most};
}

Pixels inOnePiece()
{
    const osg::ref_ptr<TerrainLighting> lighting = eveningLight();
    lighting->addChild(stockTile(country(), -halfSide, -halfSide, {}));
    return pictureOf(lighting);
}
} // namespace

// Expected: horizons of the terrain in one piece, within what windows of all posts are wrong by in
// 64 tiles of such ground (docs/methods/tiles.md, in the table's rows of 64 tiles: mean, p99), and
// much nearer than tiles alone. No setting was tuned on these seeds.
TEST(TileNeighbours, SeeWhatTheTerrainShowsInOnePiece)
{
    using namespace osgTerrainLight::testing;
    OTL_NEED_GL(context);
    constexpr int cells = 64, whole = 8 * cells + 1;
    const Result<DemTile> cliffs = generateTerrain(TerrainKind::Cliffs, whole, whole, spacing, 5);
    ASSERT_TRUE(cliffs);
    const struct
    {
        const char* name;
        DemTile dem;
    } grounds[] = {{"cliffs", *cliffs},
                   {"town", hard::town(whole, 911)},
                   {"open pit", hard::mine(whole, 912)},
                   {"sinkholes", hard::sinkholes(whole, 913)}};
    const TileCase lit = underSky(8);
    const auto horizonsWith = [&](const osg::ref_ptr<TileLight>& light)
    {
        EXPECT_TRUE(light->update(context->state()));
        return horizonsOf(context->state(), *light);
    };
    for (const auto& ground : grounds)
    {
        const double step = ground.dem.northSpacing;
        TileNeighbours neighbours;
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x)
                neighbours.set(TileHandle::at(3, x, y),
                               groundOf(part(ground.dem, x * cells, y * cells, cells),
                                        x * cells * step, y * cells * step, step));
        const std::vector<float> all =
            horizonsWith(new TileLight(ground.dem, lit.settings, lit.sky));
        for (const auto& [x, y] : {std::pair{0, 0}, {3, 4}})
        {
            std::vector<float> here;
            for (int row = y * cells; row <= (y + 1) * cells; ++row)
            {
                const auto first = all.begin() + 8 * (std::ptrdiff_t(row) * whole + x * cells);
                here.insert(here.end(), first, first + 8 * (cells + 1));
            }
            const auto windows = neighbours.around(TileHandle::at(3, x, y), HorizonQuality::Normal);
            ASSERT_TRUE(windows);
            const Differences found =
                differencesOf(here, horizonsWith(new TileLight(windows, lit.settings, lit.sky)));
            const Differences alone = differencesOf(
                here, horizonsWith(new TileLight(windows->tile, lit.settings, lit.sky)));
            MemorySource source(ground.dem);
            const auto exact = readWindows(source, 0, {x * cells, y * cells, cells + 1, cells + 1},
                                           HorizonQuality::Normal);
            ASSERT_TRUE(exact);
            const Differences withAll =
                differencesOf(here, horizonsWith(new TileLight(*exact, lit.settings, lit.sky)));
            std::printf("%-9s tile %d/%d: horizons from those in one piece: mean %.4f, p99 %.3f, "
                        "worst %.2f degrees; from all posts %.4f, %.3f, %.2f; alone %.4f, %.3f\n",
                        ground.name, x, y, found.mean, found.p99, found.worst, withAll.mean,
                        withAll.p99, withAll.worst, alone.mean, alone.p99);
            EXPECT_LE(found.mean, 1.1 * withAll.mean + 0.003) << ground.name;
            EXPECT_LE(found.p99, 1.1 * withAll.p99 + 0.003) << ground.name;
            EXPECT_GT(alone.mean, 10.0 * found.mean) << ground.name;
        }
    }
}

// Expected: the same bits, whatever came first: windows are functions of what is there.
TEST(TileNeighbours, SeeTheSameInAnyOrder)
{
    std::vector<std::pair<int, int>> places;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x)
            places.emplace_back(x, y);
    std::shared_ptr<const TileWindows> first;
    for (unsigned seed = 0; seed < 10; ++seed)
    {
        std::shuffle(places.begin(), places.end(), std::mt19937(seed));
        TileNeighbours neighbours;
        for (const auto& [x, y] : places)
        {
            neighbours.set(TileHandle::at(2, x, y),
                           groundOf(part(country(), x * side, y * side, side), x * side * spacing,
                                    y * side * spacing));
            if (seed % 2 == 0) // lit between arrivals, too
                neighbours.around(TileHandle::at(2, x, y), HorizonQuality::Normal);
        }
        const auto windows = neighbours.around(TileHandle::at(2, 1, 2), HorizonQuality::Normal);
        ASSERT_TRUE(windows);
        if (!first)
            first = windows;
        EXPECT_EQ(windows->near.column, first->near.column);
        ASSERT_EQ(windows->heights.values().size(), first->heights.values().size());
        EXPECT_TRUE(std::equal(windows->heights.values().begin(), windows->heights.values().end(),
                               first->heights.values().begin()));
    }
}

// Expected, on level ground at 100 m in tiles of 32 posts: a pit reaches the tiles that are at most
// 128 posts away, four on each side and itself not; a mast of 50 m reaches all, which it is higher
// than by more than 0.01 degrees; the departure of the tile with the mast, too; one of a tile
// whose ground is level reaches the four on each side.
TEST(TileNeighbours, AreStaleWithinReach)
{
    TileNeighbours neighbours;
    constexpr int count = 20, changed = 7;
    setRow(neighbours, count);
    const TileHandle handle = TileHandle::at(0, changed, 0);
    const auto changeTo = [&](double height, int column)
    {
        DemTile dem = analytic::plane(33, 33, spacing, 100.0);
        dem.setHeight(column, 16, static_cast<float>(height));
        neighbours.set(handle, groundOf(dem, changed * side * spacing, 0.0));
    };
    const auto near = [&](int before, int after)
    {
        std::set<TileHandle> expected;
        for (int i = changed - before; i <= changed + after; ++i)
            if (i != changed)
                expected.insert(TileHandle::at(0, i, 0));
        return expected;
    };
    // A pit in column 16: 4 tiles on are 16 + 3 * 32 = 112 posts away, 5 tiles 144.
    changeTo(90.0, 16);
    EXPECT_EQ(takeAll(neighbours), near(4, 4));
    changeTo(90.0, 16);
    EXPECT_TRUE(takeAll(neighbours).empty()) << "nothing has changed";
    changeTo(150.0, 16);
    EXPECT_EQ(takeAll(neighbours), near(changed, count - 1 - changed));
    neighbours.remove(handle);
    EXPECT_EQ(takeAll(neighbours), near(changed, count - 1 - changed));
    neighbours.remove(TileHandle::at(0, 15, 0)); // level: to 10 ... 19, 5 tiles on: 128 posts
    std::set<TileHandle> expected;
    for (int i = 10; i <= 19; ++i)
        if (i != 15)
            expected.insert(TileHandle::at(0, i, 0));
    EXPECT_EQ(takeAll(neighbours), expected);
}

// Expected: finer tiles over ground that a tile sees at its own spacing change nothing for it, but
// for a finer tile beside them; and a tile's own spacing counts before all others.
TEST(TileNeighbours, SeeTheirOwnLevel)
{
    TileNeighbours neighbours;
    setRow(neighbours, 3);
    const TileHandle west = TileHandle::at(1, 2, 0), east = TileHandle::at(1, 3, 0);
    const DemTile high = analytic::plane(33, 33, 0.5 * spacing, 300.0);
    neighbours.set(west, groundOf(high, side * spacing, 0.0, 0.5 * spacing));
    EXPECT_TRUE(takeAll(neighbours).empty());
    neighbours.around(west, HorizonQuality::Normal);
    neighbours.set(east, groundOf(high, 1.5 * side * spacing, 0.0, 0.5 * spacing));
    EXPECT_EQ(takeAll(neighbours), std::set<TileHandle>{west});
    const auto coarse = neighbours.around(TileHandle::at(0, 0, 0), HorizonQuality::Normal);
    ASSERT_TRUE(coarse);
    const auto at = [](const TileWindows& windows, int column, int row)
    {
        return windows.heights.at(windows.place.column - windows.near.column + column,
                                  windows.place.row - windows.near.row + row) +
               static_cast<float>(windows.tile.heightOrigin);
    };
    EXPECT_EQ(at(*coarse, 40, 5), 100.0f);
    const auto fine = neighbours.around(west, HorizonQuality::Normal);
    EXPECT_EQ(at(*fine, 40, 5), 300.0f) << "its sibling";
    EXPECT_EQ(at(*fine, -5, 5), 100.0f) << "ground that is there at the coarser level alone";
    EXPECT_EQ(at(*fine, -1, 5), 100.0f) << "between coarse posts";
}

// Expected: east spacings as they are measured on the globe (chords, by OpenSceneGraph), and the
// neighbour's heights beyond the tile.
TEST(TileNeighbours, OfAGlobeSeeOneAnother)
{
    TileNeighbours neighbours;
    std::vector<DemTile> read;
    const double width = osg::DegreesToRadians(0.01);
    for (int i = 0; i < 2; ++i)
    {
        const auto tile =
            stockTile(analytic::plane(33, 33, spacing, 100.0 + 50.0 * i), 0.0, 0.0, {3, i, 0});
        osg::ref_ptr<osgTerrain::Locator> locator = new osgTerrain::Locator;
        locator->setCoordinateSystemType(osgTerrain::Locator::GEOCENTRIC);
        locator->setEllipsoidModel(new osg::EllipsoidModel);
        locator->setTransformAsExtents(1.0 + i * width, 1.0, 1.0 + (i + 1) * width, 1.0 + width);
        tile->setLocator(locator);
        tile->getElevationLayer()->setLocator(locator);
        const auto heights = readTerrainTile(*tile, {});
        ASSERT_TRUE(heights) << heights.error().message;
        const auto ground = placeTerrainTile(*tile, {}, heights->dem);
        ASSERT_TRUE(ground);
        neighbours.set(TileHandle::at(3, i, 0), *ground);
        read.push_back(heights->dem);
    }
    const auto windows = neighbours.around(TileHandle::at(3, 0, 0), HorizonQuality::Normal);
    ASSERT_TRUE(windows);
    for (int row = 0; row < 33; ++row)
        EXPECT_NEAR(windows->tile.eastSpacing(row) / read[0].eastSpacing(row), 1.0, 1e-5) << row;
    const int column = windows->place.column - windows->near.column + 40;
    EXPECT_EQ(windows->heights.at(column, 5) + static_cast<float>(windows->tile.heightOrigin),
              150.0f);
}

// Expected: the picture of the terrain in one piece, within a tenth of 255 in the mean of its
// pixels, and 12 along the shadow's edge (measured 0.001 and 1); tiles that are lit
// alone, as a lighting for each makes them, miss the ridge's shadow by many times that.
TEST(TileNeighbours, OfAStockSceneAreLitAsOnePiece)
{
    OTL_NEED_GL(context);
    const Pixels whole = inOnePiece();
    const osg::ref_ptr<TerrainLighting> lighting = eveningLight();
    const osg::ref_ptr<osg::Group> scene = new osg::Group, apart = new osg::Group;
    for (const auto& tile : stockTiles())
    {
        scene->addChild(tile);
        const osg::ref_ptr<TerrainLighting> own = eveningLight();
        own->addChild(new osgTerrain::TerrainTile(*tile, osg::CopyOp::DEEP_COPY_ALL));
        apart->addChild(own);
    }
    lighting->addChild(scene);
    const Said said;
    const auto [mean, most] = differences(whole, pictureOf(lighting));
    EXPECT_EQ(said.text(), "");
    ScenePicture picture(apart, halfSide);
    picture.draw(6);
    const auto [meanAlone, mostAlone] = differences(whole, picture.pixels());
    std::printf("red of 255 from one piece: mean %.3f, worst %d; tiles alone %.3f, %d\n", mean,
                most, meanAlone, mostAlone);
    EXPECT_LE(mean, 0.1);
    EXPECT_LE(most, 12); // along the shadow's edge
    EXPECT_GT(meanAlone, 3.0);
}

// Expected: the same pixels in ten orders of arrival, with frames between arrivals.
TEST(TileNeighbours, OfAStockSceneAreLitTheSameInAnyOrder)
{
    OTL_NEED_GL(context);
    Pixels first;
    const osg::ref_ptr<osg::Group> root = new osg::Group; // one context for all
    ScenePicture picture(root, halfSide);
    for (unsigned seed = 0; seed < 10; ++seed)
    {
        auto tiles = stockTiles();
        std::shuffle(tiles.begin(), tiles.end(), std::mt19937(seed));
        const osg::ref_ptr<TerrainLighting> lighting = eveningLight(8);
        root->removeChildren(0, root->getNumChildren());
        root->addChild(lighting);
        for (std::size_t i = 0; i < tiles.size(); ++i)
        {
            lighting->addChild(tiles[i]);
            if (i % 4 == 1)
                picture.draw();
        }
        settle(picture, *lighting);
        if (first.empty())
            first = picture.pixels();
        EXPECT_EQ(picture.pixels(), first) << seed;
    }
}

// Expected: after an edit, the picture of a scene that has had the edited heights from the start.
TEST(TileNeighbours, OfAStockSceneFollowEditsAndDepartures)
{
    OTL_NEED_GL(context);
    const auto raise = [](osgTerrain::TerrainTile& tile)
    {
        auto* layer = dynamic_cast<osgTerrain::HeightFieldLayer*>(tile.getElevationLayer());
        for (unsigned row = 8; row < 24; ++row)
            for (unsigned column = 20; column < 24; ++column)
                layer->getHeightField()->setHeight(column, row, 250.0f);
        layer->dirty();
        tile.setDirty(true);
    };
    const auto sceneOf = [](const std::vector<osg::ref_ptr<osgTerrain::TerrainTile>>& tiles)
    {
        const osg::ref_ptr<TerrainLighting> lighting = eveningLight();
        for (const auto& tile : tiles)
            lighting->addChild(tile);
        return lighting;
    };
    auto fresh = stockTiles();
    raise(*fresh[9]);
    fresh.erase(fresh.begin() + 4);
    const Pixels expected = pictureOf(sceneOf(fresh));

    const auto tiles = stockTiles();
    const osg::ref_ptr<TerrainLighting> lighting = sceneOf(tiles);
    ScenePicture picture(lighting, halfSide);
    settle(picture, *lighting);
    const Pixels before = picture.pixels();
    raise(*tiles[9]);
    settle(picture, *lighting);
    lighting->removeChild(tiles[4]);
    settle(picture, *lighting);
    EXPECT_GT(differences(before, expected).first, 1.0) << "there is something to follow";
    EXPECT_EQ(differences(picture.pixels(), expected), (std::pair{0.0, 0}));
}

// A database as VirtualPlanetBuilder lays it out, in files that stock OpenSceneGraph has written:
// below a PagedLOD a coarse tile, and a file with its finer tiles. Expected: all tiles are found
// and lit, the picture is the one in one piece, and nothing is said.
TEST(TileNeighbours, OfAPagedDatabaseAreLitAsOnePiece)
{
    OTL_NEED_GL(context);
    const Pixels whole = inOnePiece();
    const std::string folder = testFolder().string();
    osg::ref_ptr<osg::Group> fine = new osg::Group;
    for (const auto& tile : stockTiles())
        fine->addChild(tile);
    ASSERT_TRUE(osgDB::writeNodeFile(*fine, folder + "/fine.osgb"));
    osg::ref_ptr<osg::PagedLOD> lod = new osg::PagedLOD;
    lod->setRangeMode(osg::LOD::PIXEL_SIZE_ON_SCREEN);
    lod->setCenter({0.0f, 0.0f, 0.0f});
    lod->setRadius(900.0f);
    lod->addChild(stockTile(part(country(), 0, 0, 128, 4), -halfSide, -halfSide, {0, 0, 0}), 0.0f,
                  10.0f);
    lod->setFileName(1, "fine.osgb");
    lod->setRange(1, 10.0f, 1.0e9f);
    ASSERT_TRUE(osgDB::writeNodeFile(*lod, folder + "/root.osgb"));

    const osg::ref_ptr<osg::Node> read = osgDB::readRefNodeFile(folder + "/root.osgb");
    ASSERT_TRUE(read);
    const osg::ref_ptr<TerrainLighting> lighting = eveningLight();
    lighting->addChild(read);
    const Said said;
    ScenePicture picture(lighting, halfSide);
    settle(picture, *lighting);
    EXPECT_EQ(lighting->getTileCount(), 17u);
    const auto [mean, most] = differences(whole, picture.pixels());
    std::printf("red of 255 from one piece: mean %.3f, worst %d\n", mean, most);
    EXPECT_LE(mean, 0.1);
    EXPECT_LE(most, 12);
    EXPECT_EQ(said.text(), "");
}

// Expected: with no time to speak of, one tile whose surroundings are read per frame, and in the
// end the same picture.
TEST(TileNeighbours, OfAStockSceneAreReadWithinTheBudget)
{
    OTL_NEED_GL(context);
    const auto sceneOf = [](const osg::ref_ptr<TerrainLighting>& lighting)
    {
        for (const auto& tile : stockTiles())
            lighting->addChild(tile);
        return lighting;
    };
    const Pixels expected = pictureOf(sceneOf(eveningLight(8)));
    const osg::ref_ptr<TerrainLighting> lighting = sceneOf(eveningLight(8));
    lighting->setTimeBudget(1.0e-6);
    ScenePicture picture(lighting, halfSide);
    for (unsigned frame = 1; frame <= 16; ++frame)
    {
        picture.draw();
        EXPECT_EQ(lighting->getTileCount(), frame);
    }
    lighting->setTimeBudget(0.0);
    settle(picture, *lighting);
    EXPECT_EQ(picture.pixels(), expected);
}
