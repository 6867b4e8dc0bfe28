// Tiles that a host adds with their place on the map light one another, and see the surroundings
// that the host has set.
#include "scene/HostTiles.h"

#include "core/MemorySource.h"
#include "core/SyntheticTerrain.h"
#include "gpu/Textures.h"
#include "lighting/TileWindows.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardGround.h"
#include "support/ScenePicture.h"
#include "support/Tiles.h"
#include <osgTerrainLight/TerrainLighting.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <stdexcept>

using namespace osgTerrainLight;
namespace tiles = osgTerrainLight::testing;

namespace
{
constexpr double spacing = 10.0;
constexpr float nothing = std::numeric_limits<float>::quiet_NaN();

/// Every `step`-th post of a part of a terrain, which says where it lies.
DemTile part(const DemTile& dem, int column, int row, int cells, int step = 1)
{
    const double apart = dem.northSpacing * step;
    DemTile tile(cells / step + 1, cells / step + 1, apart);
    tile.heightOrigin = dem.heightOrigin;
    tile.mapOriginX = column * dem.northSpacing;
    tile.mapOriginY = row * dem.northSpacing;
    tile.mapStepX = tile.mapStepY = apart;
    for (int y = 0; y <= cells / step; ++y)
        for (int x = 0; x <= cells / step; ++x)
            tile.setHeight(x, y, dem.heightAt(column + x * step, row + y * step));
    return tile;
}

/// Without its place.
DemTile unplaced(DemTile tile)
{
    tile.mapOriginX = tile.mapOriginY = 0.0;
    tile.mapStepX = tile.mapStepY = 1.0;
    return tile;
}

/// Ground of `dem`, whose post (0, 0) is that of the map.
Surroundings surroundingsOf(const DemTile& dem)
{
    Surroundings around;
    around.east = (dem.width() - 1) * dem.northSpacing;
    around.north = (dem.height() - 1) * dem.northSpacing;
    around.heights = [dem](const PostGrid& grid)
    {
        std::vector<float> heights;
        for (int row = 0; row < grid.rows; ++row)
            for (int column = 0; column < grid.columns; ++column)
            {
                const double x = (grid.west + column * grid.eastStep) / dem.northSpacing;
                const double y = (grid.south + row * grid.northStep) / dem.northSpacing;
                EXPECT_TRUE(x >= -1.0e-3 && y >= -1.0e-3 && x <= dem.width() - 1 + 1.0e-3 &&
                            y <= dem.height() - 1 + 1.0e-3);
                heights.push_back(
                    dem.heightAt(static_cast<int>(x + 0.5), static_cast<int>(y + 0.5)) +
                    static_cast<float>(dem.heightOrigin));
            }
        return heights;
    };
    return around;
}

/// A lighting with tiles of a host, drawn without a display.
class Host
{
public:
    explicit Host(const tiles::TileCase& lit)
        : lighting(lightingWithBudget(0.0, 8)), picture(lighting, 100.0)
    {
        lighting->setSettings(lit.settings);
        lighting->setSkyLight(lit.sky);
        lighting->setFadeSeconds(0.0);
    }

    TileHandle add(const DemTile& dem, const TileHandle& name)
    {
        const osg::ref_ptr<osg::Geometry> quad = osg::createTexturedQuadGeometry(
            osg::Vec3(-100, -100, 0), osg::Vec3(200, 0, 0), osg::Vec3(0, 200, 0));
        lighting->addChild(quad);
        const TileHandle handle =
            lighting->addTile(dem, quad->getOrCreateStateSet(), {}, false, name);
        EXPECT_TRUE(handle);
        _tiles[handle] = quad;
        return handle;
    }
    void remove(const TileHandle& handle)
    {
        EXPECT_TRUE(lighting->removeTile(handle));
        lighting->removeChild(_tiles[handle]);
        _tiles.erase(handle);
    }
    /// Frames until the tiles are lit and nothing has run in the last few.
    void settle()
    {
        int still = 0;
        for (int frame = 0; frame < 400 && still < 4; ++frame)
        {
            picture.draw();
            const LightingStatistics now = lighting->getStatistics();
            still = now.lit == now.tiles && now.milliseconds == 0.0 ? still + 1 : 0;
        }
        EXPECT_EQ(still, 4) << "it does not come to rest";
    }
    /// Its shading, of posts that are drawn and of its margin: rgb.
    std::vector<float> shading(const TileHandle& handle)
    {
        picture.draw(); // its context is the current one then
        const std::vector<float> read = readFloats(picture.state(), *textureOf(handle), 4);
        std::vector<float> values;
        for (std::size_t i = 0; i < read.size(); i += 4)
            values.insert(values.end(), {read[i], read[i + 1], read[i + 2]});
        return values;
    }
    /// How many tiles have another texture than at the last call: those that were lit again.
    std::set<TileHandle> litAgain()
    {
        std::set<TileHandle> again;
        std::map<TileHandle, osg::ref_ptr<osg::Texture2D>> now;
        for (const auto& [handle, quad] : _tiles)
        {
            now[handle] = textureOf(handle);
            if (now[handle] != _textures[handle])
                again.insert(handle);
        }
        _textures = now;
        return again;
    }

    osg::ref_ptr<TerrainLighting> lighting;
    ScenePicture picture;

private:
    osg::Texture2D* textureOf(const TileHandle& handle)
    {
        return dynamic_cast<osg::Texture2D*>(
            _tiles[handle]->getOrCreateStateSet()->getTextureAttribute(
                lighting->getTextureUnit(), osg::StateAttribute::TEXTURE));
    }

    std::map<TileHandle, osg::ref_ptr<osg::Geometry>> _tiles;
    std::map<TileHandle, osg::ref_ptr<osg::Texture2D>> _textures;
};

/// Hills with a ridge that casts long shadows over several tiles.
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

/// The same without tiles around.
std::vector<float> aloneUnder(const tiles::TileCase& lit, const DemTile& dem)
{
    Host host(lit);
    const TileHandle tile = host.add(unplaced(dem), {});
    host.settle();
    return host.shading(tile);
}

std::set<TileHandle> row(int first, int last)
{
    std::set<TileHandle> handles;
    for (int i = first; i <= last; ++i)
        handles.insert(TileHandle::at(0, i, 0));
    return handles;
}

/// A row of level tiles of 32 cells.
void addRow(Host& host, int count)
{
    const DemTile ground = analytic::plane(32 * count + 1, 33, spacing, 100.0);
    for (int i = 0; i < count; ++i)
        host.add(part(ground, 32 * i, 0, 32), TileHandle::at(0, i, 0));
}
} // namespace

// Expected: shading of the terrain in one piece, within what windows of all posts, read by other
// code, differ from it by, and a half's last bit (2^-11 of values up to 2) for the texture; and
// nearer than tiles alone by far. No setting was tuned on these seeds.
TEST(HostTiles, AreLitAsOnePiece)
{
    using namespace osgTerrainLight::testing;
    OTL_NEED_GL(context);
    constexpr int cells = 64, side = 4, whole = side * cells + 1;
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
    const TileCase lit = inTheAfternoon(8, 0);
    for (const auto& ground : grounds)
    {
        Host host(lit), outside(lit);
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
                host.add(part(ground.dem, x * cells, y * cells, cells), TileHandle::at(2, x, y));
        host.settle();
        EXPECT_TRUE(outside.lighting->setSurroundings(surroundingsOf(ground.dem)));
        const TileHandle only =
            outside.add(part(ground.dem, cells, 2 * cells, cells), TileHandle::at(2, 1, 2));
        outside.settle();

        context->makeCurrent();
        const osg::ref_ptr<TileLight> inOne = new TileLight(ground.dem, lit.settings, lit.sky);
        ASSERT_TRUE(inOne->update(context->state()));
        const std::vector<float> all = shadingOf(context->state(), *inOne);
        for (const auto& [x, y] : {std::pair{0, 0}, {1, 2}})
        {
            std::vector<float> here;
            for (int line = y * cells; line <= (y + 1) * cells; ++line)
            {
                const auto first = all.begin() + 3 * (std::ptrdiff_t(line) * whole + x * cells);
                here.insert(here.end(), first, first + 3 * (cells + 1));
            }
            MemorySource source(ground.dem);
            const auto windows = readWindows(
                source, 0, {x * cells, y * cells, cells + 1, cells + 1}, HorizonQuality::Normal);
            ASSERT_TRUE(windows);
            context->makeCurrent();
            const osg::ref_ptr<TileLight> exact = new TileLight(*windows, lit.settings, lit.sky);
            ASSERT_TRUE(exact->update(context->state()));
            const Differences withAll = differencesOf(here, shadingOf(context->state(), *exact));
            const std::vector<float> ours = host.shading(TileHandle::at(2, x, y));
            const Differences found = differencesOf(here, ours);
            const Differences alone =
                differencesOf(here, aloneUnder(lit, part(ground.dem, x * cells, y * cells, cells)));
            std::printf("%-9s tile %d/%d: shading from that in one piece: mean %.5f, p99 %.4f; "
                        "from all posts %.5f, %.4f; alone %.4f, %.3f\n",
                        ground.name, x, y, found.mean, found.p99, withAll.mean, withAll.p99,
                        alone.mean, alone.p99);
            EXPECT_LE(found.mean, 1.1 * withAll.mean + 0.001) << ground.name;
            EXPECT_LE(found.p99, 1.1 * withAll.p99 + 0.001) << ground.name;
            EXPECT_GT(alone.mean, 5.0 * found.mean) << ground.name;
            if (x == 1)
            {
                EXPECT_EQ(outside.shading(only), ours) << ground.name << ", by a function";
            }
        }
    }
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: the same bits in any order, with frames between arrivals.
TEST(HostTiles, AreLitTheSameInAnyOrder)
{
    OTL_NEED_GL(context);
    std::vector<std::pair<int, int>> places;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x)
            places.emplace_back(x, y);
    std::vector<std::vector<float>> first;
    for (unsigned seed = 0; seed < 5; ++seed)
    {
        std::shuffle(places.begin(), places.end(), std::mt19937(seed));
        Host host(tiles::inTheAfternoon(8, 1));
        for (std::size_t i = 0; i < places.size(); ++i)
        {
            const auto& [x, y] = places[i];
            host.add(part(country(), 32 * x, 32 * y, 32), TileHandle::at(2, x, y));
            if (i % 4 == seed % 4)
                host.picture.draw();
        }
        host.settle();
        std::vector<std::vector<float>> all;
        for (int i = 0; i < 16; ++i)
            all.push_back(host.shading(TileHandle::at(2, i % 4, i / 4)));
        if (first.empty())
            first = all;
        EXPECT_TRUE(all == first) << seed;
    }
}

// Expected, on level ground in tiles of 32 posts: an edit of a pit, and a removal, light those
// tiles again that are at most 128 posts away, four on each side, and the edited one; a mast of 50
// m all. Nothing else is lit again, and what is lit again is what it would have been from the
// start.
TEST(HostTiles, FollowEditsAndRemovals)
{
    OTL_NEED_GL(context);
    Host host(tiles::inTheAfternoon(8, 0));
    constexpr int count = 12, changed = 5;
    addRow(host, count);
    host.settle();
    host.litAgain();
    const TileHandle handle = TileHandle::at(0, changed, 0);
    const auto changeTo = [&](float height)
    {
        std::vector<float> heights(33 * 33, 100.0f);
        heights[16 * 33 + 16] = height;
        EXPECT_TRUE(host.lighting->setTileHeights(handle, heights));
        host.settle();
        return host.litAgain();
    };
    EXPECT_EQ(changeTo(90.0f), row(changed - 4, changed + 4));
    EXPECT_EQ(changeTo(150.0f), row(0, count - 1));
    const std::vector<float> edited = host.shading(TileHandle::at(0, changed + 1, 0));
    {
        Host fresh(tiles::inTheAfternoon(8, 0));
        DemTile ground = analytic::plane(32 * count + 1, 33, spacing, 100.0);
        ground.setHeight(32 * changed + 16, 16, 150.0f);
        for (int i = 0; i < count; ++i)
            fresh.add(part(ground, 32 * i, 0, 32), TileHandle::at(0, i, 0));
        fresh.settle();
        EXPECT_EQ(fresh.shading(TileHandle::at(0, changed + 1, 0)), edited);
    }
    host.remove(handle);
    host.settle();
    std::set<TileHandle> others = row(0, count - 1);
    others.erase(handle);
    EXPECT_EQ(host.litAgain(), others);
    host.remove(TileHandle::at(0, 11, 0)); // level
    host.settle();
    EXPECT_EQ(host.litAgain(), row(6, 10)) << "to 352 - 224 = 128 posts; the next one is gone";
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: tiles with neither a CRS nor a level in their name, and tiles whose map coordinates
// were never set, are lit as the tile alone, wherever they say that they are.
TEST(HostTiles, WithoutAPlaceAreLitAlone)
{
    OTL_NEED_GL(context);
    const tiles::TileCase lit = tiles::inTheAfternoon(8, 0);
    const DemTile west = part(country(), 32, 32, 32), east = part(country(), 64, 32, 32);
    const std::vector<float> alone = aloneUnder(lit, east);
    const auto besideWest = [&](const DemTile& tile, const DemTile& other, bool named)
    {
        Host host(lit);
        host.add(other, named ? TileHandle::at(2, 1, 1) : TileHandle());
        const TileHandle handle = host.add(tile, named ? TileHandle::at(2, 2, 1) : TileHandle());
        host.settle();
        return host.shading(handle);
    };
    EXPECT_EQ(besideWest(east, west, false), alone) << "no CRS, no name";
    EXPECT_EQ(besideWest(unplaced(east), unplaced(west), true), alone) << "no coordinates";
    EXPECT_NE(besideWest(east, west, true), alone) << "by name";
    DemTile eastOnMap = east, westOnMap = west;
    eastOnMap.crs = "EPSG:32632";
    EXPECT_EQ(besideWest(eastOnMap, westOnMap, true), alone) << "two maps";
    westOnMap.crs = eastOnMap.crs;
    EXPECT_EQ(besideWest(eastOnMap, westOnMap, false), besideWest(east, west, true)) << "by CRS";
}

// Expected: radians on the CRS's ellipsoid where it is geographic, map units elsewhere; no place
// for what has none.
TEST(HostTiles, LieWhereTheirMapSays)
{
    DemTile tile = analytic::plane(5, 9, spacing, 100.0);
    EXPECT_FALSE(HostTiles::placeOf(tile, TileHandle::at(0, 0, 0))) << "never set";
    DemTile perMetre = analytic::plane(5, 9, 1.0, 100.0);
    EXPECT_TRUE(HostTiles::placeOf(perMetre, TileHandle::at(3, 0, 0))) << "it may be there";
    EXPECT_FALSE(HostTiles::placeOf(perMetre, TileHandle::at(3, 1, 0)));
    EXPECT_FALSE(HostTiles::placeOf(perMetre, {}));
    perMetre.crs = "EPSG:32632";
    EXPECT_TRUE(HostTiles::placeOf(perMetre, {}));
    tile.mapOriginX = 9.0;
    tile.mapOriginY = 46.0;
    tile.mapStepX = tile.mapStepY = 0.001;
    EXPECT_FALSE(HostTiles::placeOf(tile, {})) << "no CRS, no name";
    const auto plane = HostTiles::placeOf(tile, TileHandle::at(0, 0, 0));
    ASSERT_TRUE(plane);
    EXPECT_EQ(plane->semiMajor, 0.0);
    EXPECT_EQ(plane->patch.west, 9.0);
    tile.crs = "EPSG:4326";
    const auto globe = HostTiles::placeOf(tile, {});
    ASSERT_TRUE(globe);
    EXPECT_EQ(globe->semiMajor, 6378137.0);
    const double radian = std::acos(-1.0) / 180.0;
    EXPECT_DOUBLE_EQ(globe->patch.west, 9.0 * radian);
    EXPECT_DOUBLE_EQ(globe->patch.northStep, 0.001 * radian);
    EXPECT_FALSE(globe->isOnMapOf(*plane));
    tile.crs = "a site of ours";
    const auto site = HostTiles::placeOf(tile, {});
    ASSERT_TRUE(site);
    EXPECT_EQ(site->patch.west, 9.0);
    tile.mapStepY = -0.001;
    EXPECT_FALSE(HostTiles::placeOf(tile, {})) << "rows to the south";
    tile.mapStepY = 0.001;
    tile.mapOriginX = std::nan("");
    EXPECT_FALSE(HostTiles::placeOf(tile, {}));
}

// Expected: a fine tile sees coarse ground beside it as a coarse tile does; fine tiles that come
// over ground that a coarse one sees at its own spacing do not light it again.
TEST(HostTiles, OfSeveralLevelsSeeOneAnother)
{
    OTL_NEED_GL(context);
    const tiles::TileCase lit = tiles::inTheAfternoon(8, 0);
    Host host(lit);
    const TileHandle coarse = host.add(part(country(), 0, 0, 128, 4), TileHandle::at(0, 0, 0));
    host.settle();
    host.litAgain();
    const TileHandle fine = host.add(part(country(), 64, 32, 32), TileHandle::at(2, 2, 1));
    host.settle();
    EXPECT_EQ(host.litAgain(), std::set<TileHandle>{fine});
    // The ridge is smooth: bilinear between every fourth post it is nearly what it is.
    Host all(lit);
    EXPECT_TRUE(all.lighting->setSurroundings(surroundingsOf(country())));
    const TileHandle same = all.add(part(country(), 64, 32, 32), TileHandle::at(2, 2, 1));
    all.settle();
    const double byCoarse = tiles::differencesOf(all.shading(same), host.shading(fine)).mean;
    const double alone =
        tiles::differencesOf(all.shading(same), aloneUnder(lit, part(country(), 64, 32, 32))).mean;
    std::printf("shading from that among fine posts: mean %.4f; alone %.4f\n", byCoarse, alone);
    EXPECT_LT(byCoarse, 0.1 * alone);
    host.remove(fine);
    host.settle();
    EXPECT_TRUE(host.litAgain().empty()) << "what goes from over " << coarse.x;
}

// Expected: the albedo and the gloss that a host has set stay where a tile is lit again because
// others came, and where bounces want a margin: as if all had been there from the start.
TEST(HostTiles, KeepWhatTheirHostHasSet)
{
    OTL_NEED_GL(context);
    const std::vector<Rgb> red(33 * 33, Rgb{0.9f, 0.1f, 0.1f});
    const std::vector<std::array<float, 2>> gloss(33 * 33, {0.3f, 20.0f});
    const DemTile west = part(country(), 32, 32, 32), east = part(country(), 64, 32, 32);
    const TileHandle westName = TileHandle::at(2, 1, 1), eastName = TileHandle::at(2, 2, 1);
    const tiles::TileCase direct = tiles::inTheAfternoon(8, 0);
    const tiles::TileCase bouncing = tiles::inTheAfternoon(8, 1);
    Host fresh(bouncing);
    fresh.add(west, westName);
    fresh.add(east, eastName);
    EXPECT_TRUE(fresh.lighting->setTileAlbedo(eastName, red));
    EXPECT_TRUE(fresh.lighting->setTileGloss(eastName, gloss));
    fresh.settle();
    Host host(direct);
    host.add(east, eastName);
    EXPECT_TRUE(host.lighting->setTileAlbedo(eastName, red));
    EXPECT_TRUE(host.lighting->setTileGloss(eastName, gloss));
    host.settle();
    host.add(west, westName);
    host.settle();
    host.lighting->setSettings(bouncing.settings);
    host.settle();
    const std::vector<float> lit = host.shading(eastName);
    EXPECT_EQ(lit.size() / 3, 65u * 33u) << "a margin over the tile in the west";
    EXPECT_EQ(lit, fresh.shading(eastName));
    EXPECT_FALSE(host.lighting->setTileAlbedo(eastName, std::vector<Rgb>(65 * 33)));
    EXPECT_TRUE(host.lighting->setTileAlbedo(eastName, {}));
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: a function that fails is told of once, whatever it does and however often, and the
// tile is then lit as with surroundings that are void.
TEST(HostSurroundings, ThatFailAreVoid)
{
    OTL_NEED_GL(context);
    const tiles::TileCase lit = tiles::inTheAfternoon(8, 0);
    const DemTile tile = part(country(), 64, 32, 32);
    const auto under = [&](const std::function<std::vector<float>(const PostGrid&)>& heights)
    {
        Host host(lit);
        Surroundings around = surroundingsOf(country());
        around.heights = heights;
        EXPECT_TRUE(host.lighting->setSurroundings(around));
        const TileHandle handle = host.add(tile, TileHandle::at(2, 2, 1));
        host.settle();
        host.lighting->surroundingsChanged(0.0, 0.0, 100.0, 100.0);
        host.settle();
        return host.shading(handle);
    };
    const auto all = [](const PostGrid& grid, float height)
    { return std::vector<float>(static_cast<std::size_t>(grid.columns * grid.rows), height); };
    const std::vector<float> inVoid =
        under([&](const PostGrid& grid) { return all(grid, nothing); });
    const auto expectVoid =
        [&](const char* reason, const std::function<std::vector<float>(const PostGrid&)>& heights)
    {
        const Said said;
        EXPECT_TRUE(under(heights) == inVoid) << reason;
        EXPECT_EQ(said.count("without some of its surroundings"), *reason ? 1 : 0) << said.text();
        EXPECT_EQ(said.count(reason), 1) << said.text();
    };
    expectVoid("it threw: no such file",
               [](const PostGrid&) -> std::vector<float>
               { throw std::runtime_error("no such file"); });
    expectVoid("failed: it threw\n", [](const PostGrid&) -> std::vector<float> { throw 7; });
    expectVoid("it returned 3 heights", [](const PostGrid&) { return std::vector<float>(3); });
    expectVoid("it returned 0 heights", [](const PostGrid&) { return std::vector<float>(); });
    {
        const Said said;
        for (const float height : {std::numeric_limits<float>::infinity(), 2.0e6f, -2.0e6f})
            EXPECT_TRUE(under([&](const PostGrid& grid) { return all(grid, height); }) == inVoid);
        EXPECT_EQ(said.text(), "");
    }
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: what is wrong is refused with a reason, and changes nothing.
TEST(HostSurroundings, ThatAreWrongAreRefused)
{
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 8);
    const Surroundings right = surroundingsOf(country());
    EXPECT_EQ(right.complaint(), "");
    Surroundings reversed = right, infinite = right, without = right;
    std::swap(reversed.west, reversed.east);
    infinite.north = std::numeric_limits<double>::infinity();
    without.heights = nullptr;
    const Said said;
    for (const Surroundings& wrong : {reversed, infinite, without})
        EXPECT_FALSE(lighting->setSurroundings(wrong));
    EXPECT_EQ(said.count("surroundings not set: "), 3) << said.text();
    EXPECT_EQ(said.count("needs a function that returns heights"), 1);
    lighting->surroundingsChanged(1.0, 0.0, 0.0, 1.0);
    lighting->surroundingsChanged(0.0, 0.0, 1.0, std::nan(""));
    lighting->surroundingsChanged(0.0, 0.0, 1.0, 1.0, std::nan(""));
    EXPECT_EQ(said.count("change of surroundings not taken"), 3) << said.text();
    EXPECT_TRUE(lighting->setSurroundings(right));
    lighting->removeSurroundings();
    lighting->removeSurroundings();
}

// Expected, on level ground: a change whose greatest height is known lights the tiles within 128
// posts of it again, one of unknown height all; new surroundings, and none any more, all of their
// map. Tiles that are lit alone by themselves are lit by the surroundings.
TEST(HostSurroundings, ThatChangeLightTilesInReachAgain)
{
    OTL_NEED_GL(context);
    Host host(tiles::inTheAfternoon(8, 0));
    constexpr int count = 12;
    addRow(host, count);
    host.settle();
    host.litAgain();
    const auto again = [&]
    {
        host.settle();
        return host.litAgain();
    };
    Surroundings around;
    around.east = count * 32 * spacing;
    around.south = -1000.0;
    around.north = 1000.0;
    float wall = 100.0f;
    around.heights = [&](const PostGrid& grid)
    { return std::vector<float>(static_cast<std::size_t>(grid.columns * grid.rows), wall); };
    EXPECT_TRUE(host.lighting->setSurroundings(around));
    EXPECT_EQ(again(), row(0, count - 1));
    // In columns 0 to 31. The sixth tile begins at column 160, 129 posts on: coarse posts spread a
    // change by a part of 1.5 / 64 of the distance. The seventh begins at 192.
    host.lighting->surroundingsChanged(0.0, -500.0, 310.0, -400.0, 100.0);
    EXPECT_EQ(again(), row(0, 5));
    const std::vector<float> before = host.shading(TileHandle::at(0, 8, 0));
    wall = 150.0f;
    host.lighting->surroundingsChanged(0.0, -1000.0, around.east, 1000.0);
    EXPECT_EQ(again(), row(0, count - 1));
    EXPECT_NE(host.shading(TileHandle::at(0, 8, 0)), before);
    host.lighting->removeSurroundings();
    EXPECT_EQ(again(), row(0, count - 1));
    host.lighting->surroundingsChanged(0.0, 0.0, around.east, 1000.0);
    EXPECT_TRUE(again().empty()) << "there are none";
    around.crs = "EPSG:32632";
    EXPECT_TRUE(host.lighting->setSurroundings(around));
    EXPECT_TRUE(again().empty()) << "of another map";
}

// Expected: with no time to speak of, one tile whose surroundings are read per update, the others
// wait and are not lit alone meanwhile; in the end the same light as at once.
TEST(HostTiles, AreReadWithinTheBudget)
{
    OTL_NEED_GL(context);
    const tiles::TileCase lit = tiles::inTheAfternoon(8, 0);
    Host atOnce(lit), slowly(lit);
    addRow(atOnce, 6);
    addRow(slowly, 6);
    atOnce.settle();
    slowly.lighting->setTimeBudget(1.0e-6);
    slowly.litAgain();
    for (int frame = 1; frame <= 6; ++frame)
    {
        slowly.picture.draw();
        EXPECT_EQ(slowly.litAgain().size(), 1u) << frame;
    }
    slowly.lighting->setTimeBudget(0.0);
    slowly.settle();
    for (int i = 0; i < 6; ++i)
    {
        const std::vector<float> expected = atOnce.shading(TileHandle::at(0, i, 0));
        EXPECT_EQ(slowly.shading(TileHandle::at(0, i, 0)), expected) << i;
    }
}

// Expected: a tile that is lit again keeps its former light until its new one is there, and none
// of its StateSet's state stays once it is removed, whatever it was doing.
TEST(HostTiles, LeaveTheirStateSetAsItWas)
{
    OTL_NEED_GL(context);
    Host host(tiles::inTheAfternoon(8, 1));
    host.lighting->setFadeSeconds(0.5);
    const osg::ref_ptr<osg::StateSet> stateSet = new osg::StateSet;
    const osg::ref_ptr<osg::StateSet> before = new osg::StateSet;
    const DemTile tile = part(country(), 64, 32, 32);
    for (int frames = 0; frames < 6; ++frames)
    {
        const TileHandle handle =
            host.lighting->addTile(tile, stateSet, {}, true, TileHandle::at(2, 2, 1));
        EXPECT_TRUE(stateSet->getTextureAttribute(host.lighting->getTextureUnit(),
                                                  osg::StateAttribute::TEXTURE));
        host.picture.draw(frames);
        host.add(part(country(), 32, 32, 32), TileHandle::at(2, 1, 1));
        host.picture.draw(frames);
        EXPECT_TRUE(host.lighting->setTileHeights(handle, tile.heights()));
        EXPECT_TRUE(host.lighting->removeTile(handle));
        host.remove(TileHandle::at(2, 1, 1));
        host.picture.draw(4);
        EXPECT_EQ(stateSet->compare(*before, true), 0) << frames;
    }
    EXPECT_EQ(host.lighting->getTileHandles().size(), 0u);
    EXPECT_EQ(takeGlErrors(), "");
}
