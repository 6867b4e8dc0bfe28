#include "terrain/PagedTerrain.h"

#include "core/SyntheticTerrain.h"
#include "io/RasterSource.h"
#include "lighting/TileWindows.h"
#include "scene/TerrainTileReader.h"
#include "support/GlContext.h"
#include "support/HeldObjects.h"
#include "support/MemoryRaster.h"
#include "support/ScenePicture.h"
#include "support/TestFolder.h"
#include "support/Tiles.h"
#include "terrain/TerrainModel.h"

#include <osg/ContextData>
#include <osg/CullingSet>
#include <osg/MatrixTransform>
#include <osg/PagedLOD>
#include <osg/Texture>
#include <osg/TriangleFunctor>
#include <osgDB/DatabasePager>
#include <osgTerrain/Layer>
#include <osgUtil/UpdateVisitor>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <thread>

using namespace osgTerrainLight;

namespace
{
std::string rasterOf(int side, const std::function<double(int column, int row)>& heightAt)
{
    MemoryRaster raster;
    raster.width = raster.height = side;
    raster.transform = {500000.0, 30.0, 0.0, 4000000.0, 0.0, -30.0};
    raster.values.clear();
    raster.noData = -9999.0;
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column)
            raster.values.push_back(heightAt(column, row));
    raster.creation = {"TILED=YES"};
    const std::string path = raster.write();
    std::vector<int> factors;
    for (int factor = 2; side / factor > 64; factor *= 2)
        factors.push_back(factor);
    addOverviews(path, factors);
    return path;
}

/// Valleys of several sizes in terraces of 30 m, and a lone mountain in the north-east. holes: 8 %
/// of posts in the south-west are void.
std::string hillyRaster(int side, bool holes = false)
{
    return rasterOf(side,
                    [side, holes](int column, int row)
                    {
                        if (holes && column < 0.28 * side && row > 0.72 * side)
                            return -9999.0;
                        const double x = column - 0.7 * side, y = row - 0.3 * side;
                        const double height =
                            900.0 + 150.0 * std::sin(0.031 * column) * std::cos(0.023 * row) +
                            40.0 * std::sin(0.17 * column + 0.11 * row) +
                            6.0 * std::sin(0.9 * column) * std::sin(1.1 * row) +
                            1500.0 * std::exp(-(x * x + y * y) / (0.01 * side * side));
                        return 30.0 * std::round(height / 30.0);
                    });
}

/// Blocks of 3 to 6 posts a side and 10 to 200 m, in streets.
std::string townRaster(int side)
{
    return rasterOf(side,
                    [](int column, int row)
                    {
                        const bool street = column % 7 < 1 + (row / 7) % 3 || row % 7 < 2;
                        const unsigned house = (static_cast<unsigned>(column / 7) * 2654435761u) ^
                                               (static_cast<unsigned>(row / 7) * 40503u * 65537u);
                        return street ? 100.0 : 110.0 + (house >> 8) % 190;
                    });
}

/// 1.5 % of it are void, in patches of 9 x 5 posts.
std::string patchyRaster()
{
    return rasterOf(2305,
                    [](int column, int row)
                    {
                        const unsigned patch = (static_cast<unsigned>(column / 9) * 2654435761u) ^
                                               (static_cast<unsigned>(row / 5) * 2246822519u);
                        return (patch >> 9) % 100 < 4
                                   ? -9999.0
                                   : 800.0 + 300.0 * std::sin(0.05 * column) * std::sin(0.04 * row);
                    });
}

std::string generatedRaster(TerrainKind kind, int side, std::uint32_t seed)
{
    const Result<DemTile> tile = generateTerrain(kind, side, side, 30.0, seed);
    EXPECT_TRUE(tile);
    return rasterOf(side, [&](int column, int row)
                    { return 1000.0 + static_cast<double>(tile->heightAt(column, row)); });
}

osg::ref_ptr<PagedTerrain> paged(const std::string& path, int cellsLog2 = 8,
                                 std::vector<DrapedColour> colours = {})
{
    auto source = OverviewSource::open(path, {}, cellsLog2);
    EXPECT_TRUE(source) << source.error().message;
    return new PagedTerrain(std::move(*source), std::move(colours), HorizonQuality::Normal);
}

/// The tiles in a graph that is loaded.
std::vector<osgTerrain::TerrainTile*> tilesIn(osg::Node& node)
{
    struct Finder : osg::NodeVisitor
    {
        Finder() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
        void apply(osg::Group& group) override
        {
            if (auto* tile = dynamic_cast<osgTerrain::TerrainTile*>(&group))
                tiles.push_back(tile);
            else
                traverse(group);
        }
        std::vector<osgTerrain::TerrainTile*> tiles;
    } finder;
    node.accept(finder);
    return finder.tiles;
}

std::shared_ptr<const TileWindows> windowsOf(const osgTerrain::TerrainTile& tile)
{
    return dynamic_cast<const DemData&>(*tile.getUserData()).windows();
}

osg::ref_ptr<osg::Node> childrenOf(PagedTerrain& terrain, const std::string& name)
{
    osgDB::ReaderWriter::ReadResult read = terrain.readNode(name, nullptr);
    EXPECT_TRUE(read.validNode()) << name << ": " << read.message();
    return read.getNode();
}

osgTerrain::TerrainTile* tileAt(osg::Node& node, int x, int y)
{
    for (osgTerrain::TerrainTile* tile : tilesIn(node))
        if (tile->getTileID().x == x && tile->getTileID().y == y)
            return tile;
    return nullptr;
}

bool same(const Raster<float>& a, const Raster<float>& b)
{
    return a.width() == b.width() && a.height() == b.height() &&
           std::equal(a.values().begin(), a.values().end(), b.values().begin(),
                      [](float one, float other)
                      { return one == other || (std::isnan(one) && std::isnan(other)); });
}

/// Frames until nothing is loaded and all tiles are lit.
void drawAll(ScenePicture& picture, const TerrainLighting& lighting)
{
    const auto& pager = *picture.viewer().getDatabasePager();
    int still = 0;
    for (int frame = 0; frame < 2000 && still < 3; ++frame)
    {
        picture.draw();
        const LightingStatistics now = lighting.getStatistics();
        const bool loading = pager.getRequestsInProgress() || pager.requiresUpdateSceneGraph();
        still = !loading && now.lit == now.tiles ? still + 1 : 0;
        if (loading)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    EXPECT_EQ(still, 3) << "it does not come to rest";
}
} // namespace

TEST(PagedTerrain, SmallRastersAreOneTile)
{
    const std::string path = hillyRaster(300);
    EXPECT_FALSE(isPaged(path, {}));
    const Result<TerrainModel> model = loadRaster(path, {}, {});
    ASSERT_TRUE(model) << model.error().message;
    EXPECT_EQ(tilesIn(*model->node).size(), 1u);
    EXPECT_FALSE(windowsOf(*tilesIn(*model->node)[0]));
    EXPECT_TRUE(isPaged(hillyRaster(2100), {}));
    EXPECT_FALSE(isPaged("/vsimem/not_there.tif", {}));
}

TEST(PagedTerrain, TilesStandByTheirPlace)
{
    const osg::ref_ptr<PagedTerrain> terrain = paged(hillyRaster(200), 5);
    const int root = terrain->source().root();
    ASSERT_EQ(root, 3); // 199 cells in 8 tiles of 32
    const Result<osg::ref_ptr<osg::Node>> top = terrain->root();
    ASSERT_TRUE(top);
    ASSERT_EQ(tilesIn(**top).size(), 1u);
    EXPECT_TRUE(tilesIn(**top)[0]->getTileID() == osgTerrain::TileID(0, 0, 0));
    const osg::ref_ptr<osg::Node> children = childrenOf(*terrain, "3/0/0");
    ASSERT_EQ(tilesIn(*children).size(), 4u);
    EXPECT_TRUE(tileAt(*children, 1, 0)->getTileID() == osgTerrain::TileID(1, 1, 0));
    // The raster lies in the north-west, in 199 of 256 columns and rows: of the tiles in the
    // south-east only one has some of it.
    const osg::ref_ptr<osg::Node> corner = childrenOf(*terrain, "1/3/0");
    ASSERT_EQ(tilesIn(*corner).size(), 1u);
    EXPECT_TRUE(tilesIn(*corner)[0]->getTileID() == osgTerrain::TileID(3, 6, 1));
    // No finest tile has children, and no other name has any.
    for (const char* name : {"0/1/1", "", "country.tif", "2/x/1"})
        EXPECT_TRUE(terrain->readNode(name, nullptr).notFound()) << name;
}

// Expected: children where a cell in the middle of the tile, facing the camera, has more than two
// pixels. At a distance d it has f * cell / d of them, f the focal length in pixels.
TEST(PagedTerrain, RefinesWhereACellHasMoreThanTwoPixels)
{
    const osg::ref_ptr<PagedTerrain> terrain = paged(hillyRaster(257), 5);
    const Result<osg::ref_ptr<osg::Node>> root = terrain->root();
    ASSERT_TRUE(root);
    const auto* lod = dynamic_cast<const osg::PagedLOD*>(root->get());
    ASSERT_TRUE(lod);
    constexpr double cell = 240.0; // 8 of 30 m
    const double focal = 384.0 / std::tan(0.5 * osg::DegreesToRadians(30.0));
    const osg::ref_ptr<osg::Viewport> window = new osg::Viewport(0.0, 0.0, 1024.0, 768.0);
    osg::Vec4 pixels = osg::CullingSet::computePixelSizeVector(
        *window, osg::Matrixd::perspective(30.0, 1024.0 / 768.0, 1.0, 1e7), osg::Matrixd());
    for (const double perCell : {1.7, 2.3})
    {
        const osg::Vec3 middle(0.0f, 0.0f, static_cast<float>(-focal * cell / perCell));
        const float size = lod->getRadius() / (middle * pixels);
        EXPECT_EQ(size > lod->getMinRange(1), perCell > 2.0) << perCell;
    }
}

TEST(PagedTerrain, NeighboursShareTheirEdge)
{
    const osg::ref_ptr<PagedTerrain> terrain = paged(hillyRaster(200), 5);
    for (const char* name : {"1/0/2", "2/0/1", "3/0/0"})
    {
        const osg::ref_ptr<osg::Node> children = childrenOf(*terrain, name);
        const std::vector<osgTerrain::TerrainTile*> tiles = tilesIn(*children);
        ASSERT_EQ(tiles.size(), 4u);
        const DemTile& west = windowsOf(*tiles[0])->tile;
        const DemTile& east = windowsOf(*tiles[1])->tile;
        const DemTile& north = windowsOf(*tiles[2])->tile;
        for (int i = 0; i <= 32; ++i)
        {
            EXPECT_EQ(west.heightAt(32, i), east.heightAt(0, i));
            EXPECT_EQ(west.heightAt(i, 32), north.heightAt(i, 0));
        }
        // Drawn where they are, in the frame of the scene.
        const auto middleOf = [](const osgTerrain::TerrainTile& tile)
        { return tile.getParent(0)->asTransform()->asMatrixTransform()->getMatrix().getTrans(); };
        const int level = name[0] - '0' - 1;
        EXPECT_NEAR((middleOf(*tiles[1]) - middleOf(*tiles[0])).length(), 32 * 30.0 * (1 << level),
                    1e-6);
    }
}

TEST(PagedTerrain, SkirtsHangFromTilesAndAreNotLitBy)
{
    const osg::ref_ptr<PagedTerrain> terrain = paged(hillyRaster(200), 5);
    const osg::ref_ptr<osg::Node> children = childrenOf(*terrain, "1/0/2");
    for (osgTerrain::TerrainTile* tile : tilesIn(*children))
    {
        const auto* layer =
            dynamic_cast<const osgTerrain::HeightFieldLayer*>(tile->getElevationLayer());
        ASSERT_TRUE(layer);
        const DemTile& dem = windowsOf(*tile)->tile;
        float range = 0.0f;
        for (int i = 0; i + 1 < dem.width(); ++i)
            range = std::max(range, std::abs(dem.heightAt(i, 0) - dem.heightAt(i + 1, 0)));
        for (int row = 0; row < dem.height(); ++row)
            for (int column = 0; column < dem.width(); ++column)
                ASSERT_EQ(layer->getHeightField()->getHeight(static_cast<unsigned>(column),
                                                             static_cast<unsigned>(row)),
                          dem.heightAt(column, row));
        // Straight down, on slopes too: every vertex stands over a post.
        struct Vertices : osg::NodeVisitor
        {
            Vertices() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
            void apply(osg::Geometry& geometry) override
            {
                const osg::Matrixd toTile = osg::computeLocalToWorld(getNodePath());
                const auto& all = dynamic_cast<const osg::Vec3Array&>(*geometry.getVertexArray());
                for (const osg::Vec3& vertex : all)
                    places.push_back(osg::Vec3d(vertex) * toTile);
            }
            std::vector<osg::Vec3d> places;
        } drawn;
        tile->accept(drawn);
        // Of each post of the edges two more: there and below.
        ASSERT_EQ(drawn.places.size(), dem.postCount() + 8u * 33u);
        for (std::size_t i = dem.postCount(); i < drawn.places.size(); i += 2)
            EXPECT_GE(drawn.places[i].z() - drawn.places[i + 1].z(), double(range) - 1.0e-3);
        for (const osg::Vec3d& place : drawn.places)
        {
            EXPECT_NEAR(place.x() / 30.0, std::round(place.x() / 30.0), 1.0e-4);
            EXPECT_NEAR(place.y() / 30.0, std::round(place.y() / 30.0), 1.0e-4);
        }
    }
}

// What a tile is lit by comes from the raster alone.
TEST(PagedTerrain, LightDoesNotDependOnWhatElseIsLoaded)
{
    const std::string path = hillyRaster(600);
    std::vector<std::string> names = {"4/0/0"};
    for (int level = 3; level >= 1; --level)
        for (int y = 0; y < 1 << (4 - level); ++y)
            for (int x = 0; x < 1 << (4 - level); ++x)
                names.push_back(std::to_string(level) + "/" + std::to_string(x) + "/" +
                                std::to_string(y));
    const osg::ref_ptr<PagedTerrain> alone = paged(path, 6);
    ASSERT_EQ(alone->source().root(), 4);
    const osg::ref_ptr<osg::Node> expected = childrenOf(*alone, "1/3/6");
    for (unsigned seed = 0; seed < 10; ++seed)
    {
        std::shuffle(names.begin(), names.end(), std::mt19937(seed));
        const osg::ref_ptr<PagedTerrain> shuffled = paged(path, 6);
        for (const std::string& name : names)
            childrenOf(*shuffled, name);
        const osg::ref_ptr<osg::Node> found = childrenOf(*shuffled, "1/3/6");
        const auto before = tilesIn(*expected), after = tilesIn(*found);
        ASSERT_EQ(before.size(), after.size());
        for (std::size_t i = 0; i < before.size(); ++i)
        {
            const TileWindows& one = *windowsOf(*before[i]);
            const TileWindows& other = *windowsOf(*after[i]);
            EXPECT_TRUE(same(one.heights, other.heights));
            ASSERT_EQ(one.levels.size(), other.levels.size());
            for (std::size_t k = 0; k < one.levels.size(); ++k)
                for (std::size_t axis = 0; axis < 2; ++axis)
                    EXPECT_TRUE(same(one.levels[k].heights[axis], other.levels[k].heights[axis]));
        }
    }
}

// Expected: the raster lit in one piece, at full resolution everywhere. Beside it the windows of
// all posts (RasterSource), which the tool has: what overviews by the nearest pixel miss lies 512
// posts and more away. On ground that no setting was tuned on.
TEST(PagedTerrain, SeesWhatTheWholeRasterShows)
{
    using namespace osgTerrainLight::testing;
    OTL_NEED_GL(context);
    constexpr int side = 2305;
    const struct
    {
        const char* name;
        std::string path;
    } grounds[] = {
        {"terraces", hillyRaster(side)},
        {"town", townRaster(side)},
        {"fractal", generatedRaster(TerrainKind::Fractal, side, 77)},
        {"cliffs", generatedRaster(TerrainKind::Cliffs, side, 77)},
    };
    const TileCase lit = underSky(8);
    const auto horizonsWith = [&](const osg::ref_ptr<TileLight>& light)
    {
        EXPECT_TRUE(light->update(context->state()));
        return horizonsOf(context->state(), *light);
    };
    for (const auto& ground : grounds)
    {
        const osg::ref_ptr<PagedTerrain> terrain = paged(ground.path);
        const osg::ref_ptr<osg::Node> children = childrenOf(*terrain, "1/2/5");
        osgTerrain::TerrainTile* tile = tileAt(*children, 5, 11);
        ASSERT_TRUE(tile);
        const auto drawn = windowsOf(*tile);
        PostRect posts = drawn->place;
        posts.column -= terrain->source().terrain().column;
        posts.row -= terrain->source().terrain().row;

        RasterSourceOptions options;
        options.cacheFolder = testFolder().string();
        const auto all = RasterSource::open(ground.path, options);
        ASSERT_TRUE(all) << all.error().message;
        const auto exact = readWindows(**all, 0, posts, HorizonQuality::Normal);
        ASSERT_TRUE(exact);

        const Result<DemFile> file = readDem(ground.path);
        ASSERT_TRUE(file);
        const std::vector<float> whole =
            horizonsWith(new TileLight(file->tile, lit.settings, lit.sky));
        std::vector<float> here; // azimuths of a post side by side
        for (int row = posts.row; row < posts.endRow(); ++row)
        {
            const auto first = whole.begin() + 8 * (std::ptrdiff_t(row) * side + posts.column);
            here.insert(here.end(), first, first + 8 * posts.width);
        }
        const Differences withAll =
            differencesOf(here, horizonsWith(new TileLight(*exact, lit.settings, lit.sky)));
        const Differences found =
            differencesOf(here, horizonsWith(new TileLight(drawn, lit.settings, lit.sky)));
        std::printf("%-8s horizons from those in one piece: with all posts mean %.4f, p99 %.3f, "
                    "worst %.2f; with overviews mean %.4f, p99 %.3f, worst %.2f degrees\n",
                    ground.name, withAll.mean, withAll.p99, withAll.worst, found.mean, found.p99,
                    found.worst);
        // Not worse by more than a tenth, or by what a code of 16 bits can tell.
        EXPECT_LE(found.mean, 1.1 * withAll.mean + 0.003) << ground.name;
        EXPECT_LE(found.p99, 1.1 * withAll.p99 + 0.003) << ground.name;
    }
}

// Around small voids, too, on all levels, with what surrounds the tile.
TEST(PagedTerrain, DrawnPostsAreLit)
{
    using namespace osgTerrainLight::testing;
    OTL_NEED_GL(context);
    const std::string path = patchyRaster();
    const osg::ref_ptr<PagedTerrain> terrain = paged(path);
    const auto root = terrain->root();
    ASSERT_TRUE(root);
    TileCase lit = underSky(8);
    int tiles = 0;
    for (const osg::ref_ptr<osg::Node>& node :
         {osg::ref_ptr<osg::Node>(*root), childrenOf(*terrain, "4/0/0"),
          childrenOf(*terrain, "2/1/2")})
        for (osgTerrain::TerrainTile* tile : tilesIn(*node))
        {
            const auto windows = windowsOf(*tile);
            const osg::ref_ptr<TileLight> light = new TileLight(windows, lit.settings, lit.sky);
            ASSERT_TRUE(light->update(context->state()));
            const Raster<osg::Vec4f> shading = light->readShading(context->state());
            int dark = 0, valid = 0;
            for (int row = 0; row < shading.height(); ++row)
                for (int column = 0; column < shading.width(); ++column)
                    if (windows->tile.isValid(column, row))
                    {
                        ++valid;
                        dark += shading.at(column, row).y() < 0.05f ? 1 : 0;
                    }
            EXPECT_EQ(dark, 0) << "of " << valid << ", tile " << tile->getTileID().level << "/"
                               << tile->getTileID().x << "/" << tile->getTileID().y;
            ++tiles;
        }
    EXPECT_GE(tiles, 3);
}

// Triangles, those of skirts too, are at most a cell wide.
TEST(PagedTerrain, NoWallsStandInVoids)
{
    struct Widest
    {
        double east = 0.0, north = 0.0;
        int triangles = 0;
        void operator()(const osg::Vec3& a, const osg::Vec3& b, const osg::Vec3& c, bool = false)
        {
            osg::BoundingBox box;
            for (const osg::Vec3& corner : {a, b, c})
                box.expandBy(corner);
            east = std::max(east, double(box.xMax()) - double(box.xMin()));
            north = std::max(north, double(box.yMax()) - double(box.yMin()));
            ++triangles;
        }
    };
    struct Triangles : osg::NodeVisitor
    {
        Triangles() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
        void apply(osg::Drawable& drawable) override { drawable.accept(widest); }
        osg::TriangleFunctor<Widest> widest;
    };
    const osg::ref_ptr<PagedTerrain> terrain = paged(patchyRaster());
    int tiles = 0;
    const osg::ref_ptr<osg::Node> children = childrenOf(*terrain, "2/1/2");
    for (osgTerrain::TerrainTile* tile : tilesIn(*children))
    {
        Triangles drawn;
        tile->accept(drawn);
        EXPECT_GT(drawn.widest.triangles, 2 * 250 * 250 * 9 / 10);
        const double cell = windowsOf(*tile)->tile.northSpacing;
        EXPECT_LE(drawn.widest.east, 1.001 * cell);
        EXPECT_LE(drawn.widest.north, 1.001 * cell);
        ++tiles;
    }
    EXPECT_EQ(tiles, 4);
}

TEST(PagedTerrain, IsLoadedByThePagerAndLit)
{
    OTL_NEED_GL(context);
    const std::string path = hillyRaster(2305, true);
    LightParameters light;
    light.settings.azimuths = 8;
    const Result<TerrainModel> model = loadRaster(path, {}, light);
    ASSERT_TRUE(model) << model.error().message;
    TerrainLighting& lighting = *model->node;
    EXPECT_EQ(tilesIn(lighting).size(), 1u);
    const Said said;
    ScenePicture picture(&lighting, 3000.0); // 128 pixels for 6 km: level 0 has 200 posts there
    picture.viewer().getCamera()->setLODScale(0.2f);
    drawAll(picture, lighting);
    const LightingStatistics statistics = lighting.getStatistics();
    EXPECT_GE(statistics.tiles, 9u);
    EXPECT_EQ(statistics.lit, statistics.tiles);
    EXPECT_EQ(said.text().find("lit alone"), std::string::npos) << said.text();
    // In a still scene nothing runs.
    const unsigned before = lighting.getDispatchCount();
    picture.draw(3);
    EXPECT_EQ(lighting.getDispatchCount(), before);
    EXPECT_EQ(lighting.getStatistics().milliseconds, 0.0);
}

// A level that comes and goes leaves nothing: as many textures, and as much memory for them, after
// the last of many rounds as after the first ones.
TEST(PagedTerrain, LevelsThatComeAndGoLeaveNothing)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<PagedTerrain> terrain = paged(hillyRaster(300), 5);
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 8);
    const osg::ref_ptr<osg::Group> finer = new osg::Group;
    lighting->addChild(finer);
    ScenePicture picture(lighting, 2000.0);
    const auto textures = [&]
    {
        picture.draw(8); // what is released waits for frames that are still drawn
        auto* manager = osg::get<osg::TextureObjectManager>(picture.state().getContextID());
        return std::pair(manager->getNumberActiveTextureObjects() +
                             manager->getNumberOrphanedTextureObjects(),
                         manager->getCurrTexturePoolSize());
    };
    std::pair<unsigned, unsigned> first;
    for (int round = 0; round < 200; ++round)
    {
        const std::string name = "1/" + std::to_string(1 + round % 3) + "/4";
        finer->addChild(childrenOf(*terrain, name));
        picture.draw(2);
        EXPECT_EQ(lighting->getTileCount(), 4u);
        finer->removeChildren(0, finer->getNumChildren());
        if (round == 3)
            first = textures();
    }
    EXPECT_EQ(textures(), first);
    EXPECT_EQ(lighting->getTileCount(), 0u);
    EXPECT_EQ(lighting->getTileHandles().size(), 0u);
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

// Expected: flying in to four places in turn and out again leaves no OpenGL object, no memory of
// light and no resident memory behind: cycle 20, when allocators and caches have what they need,
// and cycle 200 differ by 2 % at most. The resident set wanders by 1.8 % between them; 2 % of the
// counts is less than one object. Run by tests/bench/paging_cycles.sh: it takes minutes.
TEST(PagedTerrain, DISABLED_CyclesLeaveNothing)
{
    OTL_NEED_GL(context);
    constexpr int warm = 20, last = 200;
    const osg::ref_ptr<PagedTerrain> terrain = paged(hillyRaster(257), 5); // 7680 m
    const Result<osg::ref_ptr<osg::Node>> root = terrain->root();
    ASSERT_TRUE(root);
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 8);
    lighting->addChild(*root);
    ScenePicture picture(lighting, 5000.0);
    osgDB::DatabasePager& pager = *picture.viewer().getDatabasePager();
    pager.setTargetMaximumNumberOfPageLOD(0);
    osg::Camera& camera = *picture.viewer().getCamera();
    Held first;
    for (int cycle = 1; cycle <= last; ++cycle)
    {
        const double east = cycle % 2 ? -2000.0 : 1500.0, north = cycle % 4 < 2 ? -1500.0 : 2000.0;
        camera.setProjectionMatrixAsOrtho(east - 500.0, east + 500.0, north - 500.0, north + 500.0,
                                          1.0, 1.0e6);
        drawAll(picture, *lighting);
        const std::size_t most = lighting->getTileCount();
        EXPECT_GE(most, 13u) << "the root, and the children of three";
        camera.setProjectionMatrixAsOrtho(-4.0e5, 4.0e5, -4.0e5, 4.0e5, 1.0, 1.0e6);
        int frames = 0; // the pager lets go what was not drawn for a tenth of a second
        for (; lighting->getTileCount() > 1 && frames < 500; ++frames)
        {
            picture.draw();
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        EXPECT_EQ(lighting->getTileCount(), 1u) << "flown out in cycle " << cycle;
        picture.draw(8); // what is released waits for frames that are still drawn
        const Held held = heldBy(picture, *lighting);
        if (cycle == warm)
            first = held;
        if (cycle <= 5 || cycle % 20 == 0)
            std::printf("cycle %3d: %zu tiles seen, %u textures, %u buffers, %.2f MiB of light, "
                        "%.1f MiB resident\n",
                        cycle, most, held.textures, held.buffers,
                        static_cast<double>(held.graphics) / 1048576.0,
                        static_cast<double>(held.resident) / 1048576.0);
        std::fflush(stdout);
        if (cycle != last)
            continue;
        EXPECT_LE(held.textures, 1.02 * first.textures);
        EXPECT_LE(held.buffers, 1.02 * first.buffers);
        EXPECT_LE(static_cast<double>(held.graphics), 1.02 * static_cast<double>(first.graphics));
        EXPECT_LE(static_cast<double>(held.resident), 1.02 * static_cast<double>(first.resident));
    }
}

namespace
{
/// 64 tiles of 32 cells side by side, and the 16 above them, which are there and not drawn: more
/// than keep what they are lit from.
struct Country
{
    explicit Country(int rows = 4) : terrain(paged(hillyRaster(257), 5))
    {
        lighting->addChild(finest);
        lighting->addChild(above);
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < 4; ++x)
                finest->addChild(
                    childrenOf(*terrain, "1/" + std::to_string(x) + "/" + std::to_string(y)));
        for (const char* name : {"2/0/0", "2/1/0", "2/0/1", "2/1/1"})
            above->addChild(childrenOf(*terrain, name), false);
    }
    void draw()
    {
        picture.draw(4);
        EXPECT_EQ(lighting->getStatistics().waiting, 0u);
    }

    osg::ref_ptr<PagedTerrain> terrain;
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 8);
    osg::ref_ptr<osg::Group> finest = new osg::Group;
    osg::ref_ptr<osg::Switch> above = new osg::Switch;
    ScenePicture picture{lighting, 3800.0};
};

SkyLight lowSun()
{
    SkyLight sky;
    sky.sunAzimuth = 200.0;
    sky.sunElevation = 12.0;
    return sky;
}
} // namespace

// Expected: the picture of a scene that never had another light, to the last bit, in which no tile
// had rested when its light was computed.
TEST(PagedTerrain, TilesThatRestWakeForNewLight)
{
    OTL_NEED_GL(context);
    Country fresh;
    fresh.lighting->setSkyLight(lowSun());
    fresh.draw();
    Country country;
    country.draw();
    // Twice as many tiles and more take little more memory than half of them.
    Country half(2);
    half.draw();
    EXPECT_LT(country.lighting->getStatistics().bytes,
              1.2 * static_cast<double>(half.lighting->getStatistics().bytes));
    const std::vector<unsigned char> noon = country.picture.pixels();
    EXPECT_NE(noon, fresh.picture.pixels());
    country.lighting->setSkyLight(lowSun());
    country.draw();
    EXPECT_EQ(country.picture.pixels(), fresh.picture.pixels());
    country.lighting->setSkyLight({});
    country.draw();
    EXPECT_EQ(country.picture.pixels(), noon);
}

// A tile that comes begins with the light of the one above, which rests.
TEST(PagedTerrain, TilesThatRestLendTheirLight)
{
    OTL_NEED_GL(context);
    Country country;
    country.draw();
    country.finest->removeChild(0u, 4u);
    country.picture.draw(4); // until no frame uses what was bound to them
    const osg::ref_ptr<osg::Node> again = childrenOf(*country.terrain, "1/1/0");
    country.lighting->setTimeBudget(1.0e-6);
    country.finest->addChild(again);
    country.picture.draw();
    for (const osgTerrain::TerrainTile* tile : tilesIn(*again))
        EXPECT_TRUE(tile->getStateSet()->getTextureAttribute(ShadingTexture::formerUnit,
                                                             osg::StateAttribute::TEXTURE));
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(PagedTerrain, DrapesPicturesAtTheirOwnResolution)
{
    const std::string path = hillyRaster(200); // 6000 m
    MemoryRaster picture;
    picture.type = GDT_Byte;
    picture.width = picture.height = 1200; // of 5 m
    picture.transform = {500000.0, 5.0, 0.0, 4000000.0, 0.0, -5.0};
    picture.bands = 1;
    picture.values.assign(1200 * 1200, 0.0);
    for (std::size_t i = 0; i < picture.values.size(); ++i)
        picture.values[i] = (i / 8 + i / 1200 / 8) % 2 == 0 ? 40.0 : 200.0;
    const osg::ref_ptr<PagedTerrain> terrain =
        paged(path, 5, {{picture.write(), 1.0}, {"/vsimem/not_there.png", 1.0}});
    const Said said;
    const osg::ref_ptr<osg::Node> finest = childrenOf(*terrain, "1/0/3");
    const osg::ref_ptr<osg::Node> coarse = childrenOf(*terrain, "3/0/0");
    const auto widthOf = [](osgTerrain::TerrainTile& tile)
    {
        const osgTerrain::Layer* layer = tile.getColorLayer(0);
        return layer && layer->getImage() ? layer->getImage()->s() : 0;
    };
    // 32 cells of 30 m are 192 pixels; of 120 m 768, which are too many.
    EXPECT_NEAR(widthOf(*tilesIn(*finest)[0]), 192, 2);
    EXPECT_EQ(widthOf(*tilesIn(*coarse)[0]), 512);
    EXPECT_EQ(said.count("not_there.png"), 1) << said.text();
}
