// What the layers of a map make together.
#include "io/DemReader.h"
#include "io/EarthFile.h"
#include "io/MapReader.h"
#include "scene/TerrainTileReader.h"
#include "support/MapTransform.h"
#include "support/MemoryRaster.h"
#include "support/TestFolder.h"
#include "terrain/TerrainModel.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <osg/Image>
#include <osg/NodeVisitor>
#include <osg/PagedLOD>
#include <osgTerrain/TerrainTile>

#include <cmath>
#include <string>

using namespace osgTerrainLight;

namespace
{
const std::string folder = OTL_SOURCE_DIR "/earth_files";

TerrainModel modelOf(const std::string& name)
{
    const std::string path = folder + "/" + name;
    const Result<EarthMap> map = readEarthFile(path);
    EXPECT_TRUE(map) << (map ? "" : map.error().message);
    Result<TerrainModel> model =
        map ? loadMap(*map, folder, path) : Result<TerrainModel>(map.error());
    EXPECT_TRUE(model) << (model ? "" : model.error().message);
    return model ? *model : TerrainModel{};
}

const DemTile& tileOf(const TerrainModel& model)
{
    struct Finder : osg::NodeVisitor
    {
        Finder() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
        void apply(osg::Node& node) override
        {
            if (const auto* data = dynamic_cast<const DemData*>(node.getUserData()))
                tile = &data->tile();
            traverse(node);
        }
        const DemTile* tile = nullptr;
    };
    static const DemTile none(2, 2, 1.0);
    Finder finder;
    if (model.node)
        model.node->accept(finder);
    EXPECT_TRUE(finder.tile);
    return finder.tile ? *finder.tile : none;
}

/// The colours that the terrain is drawn with.
const osg::Image& coloursOf(const TerrainModel& model)
{
    struct Finder : osg::NodeVisitor
    {
        Finder() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
        void apply(osg::Group& group) override
        {
            if (auto* tile = dynamic_cast<osgTerrain::TerrainTile*>(&group))
                image = tile->getColorLayer(0)->getImage();
            traverse(group);
        }
        const osg::Image* image = nullptr;
    };
    static const osg::ref_ptr<osg::Image> none = new osg::Image;
    Finder finder;
    if (model.node)
        model.node->accept(finder);
    EXPECT_TRUE(finder.image);
    return finder.image ? *finder.image : *none;
}
} // namespace

// Expected: in the cone its formula, at the metres that PROJ gives for each post; whole metres are
// out by 0.5 m, and a square of 50 m is bilinear within 50^2 / 8 * 0.4 / distance. Around the cone
// the samples of the first layer.
TEST(MapLayers, AConeInUtmOverHeightsInDegrees)
{
    const TerrainModel model = modelOf("inset.earth");
    EXPECT_TRUE(model.warnings.empty());
    const DemTile& tile = tileOf(model);
    const Result<DemFile> base = readDem(OTL_SOURCE_DIR "/samples/data/jacksboro_90m.tif");
    ASSERT_TRUE(base);
    const DemTile& under = base->tile;
    const auto toUtm = transformation("EPSG:4326", "EPSG:32616");
    int onCone = 0, around = 0;
    for (int row = 2; row < tile.height() - 2; row += 3)
        for (int column = 2; column < tile.width() - 2; column += 3)
        {
            const double longitude = tile.mapOriginX + column * tile.mapStepX;
            const double latitude = tile.mapOriginY + row * tile.mapStepY;
            double x = longitude, y = latitude;
            ASSERT_TRUE(toUtm->Transform(1, &x, &y));
            const double distance = std::hypot(x - 746000.0, y - 4054000.0);
            ASSERT_TRUE(tile.isValid(column, row));
            const double height = tile.heightOrigin + double(tile.heightAt(column, row));
            if (distance > 200.0 && distance < 1900.0)
            {
                ++onCone;
                ASSERT_NEAR(height, 1400.0 - 0.4 * distance, 1.5) << distance;
            }
            if (distance > 2100.0)
            {
                ++around;
                const double across = (longitude - under.mapOriginX) / under.mapStepX;
                const double up = (latitude - under.mapOriginY) / under.mapStepY;
                const int left = static_cast<int>(across), low = static_cast<int>(up);
                const auto at = [&](int i, int k)
                { return under.heightOrigin + double(under.heightAt(left + i, low + k)); };
                const double shareX = across - left, shareY = up - low;
                ASSERT_NEAR(height,
                            (1.0 - shareY) * ((1.0 - shareX) * at(0, 0) + shareX * at(1, 0)) +
                                shareY * ((1.0 - shareX) * at(0, 1) + shareX * at(1, 1)),
                            1.0)
                    << column << ", " << row;
            }
        }
    EXPECT_GT(onCone, 300);
    EXPECT_GT(around, 10000);
}

// Expected: what the same layers make without composites.
TEST(MapLayers, CompositesAreTheirLayers)
{
    const TerrainModel composites = modelOf("composite.earth");
    const TerrainModel alone = modelOf("inset.earth");
    EXPECT_TRUE(composites.warnings.empty());
    EXPECT_EQ(tileOf(composites).heights(), tileOf(alone).heights());
}

// Expected: each pixel of the same map without opacity, halved over white: alpha 127.5 is 128.
TEST(MapLayers, OpacityIsOverWhatLiesBelow)
{
    const TerrainModel pale = modelOf("opacity.earth");
    const TerrainModel full = modelOf("jacksboro.earth");
    const osg::Image& found = coloursOf(pale);
    const osg::Image& opaque = coloursOf(full);
    ASSERT_EQ(found.getTotalSizeInBytes(), opaque.getTotalSizeInBytes());
    ASSERT_GT(found.getTotalSizeInBytes(), 3u * 400 * 340);
    for (unsigned i = 0; i < found.getTotalSizeInBytes(); ++i)
        ASSERT_EQ(found.data()[i], (opaque.data()[i] * 128 + 255 * 127 + 127) / 255);
}

// Expected: feet of the file are metres of the terrain.
TEST(MapLayers, AVirtualRasterInFeet)
{
    const TerrainModel feet = modelOf("virtual_raster.earth");
    const TerrainModel metres = modelOf("inset.earth");
    EXPECT_TRUE(feet.warnings.empty());
    const DemTile& found = tileOf(feet);
    const DemTile& wanted = tileOf(metres);
    ASSERT_EQ(found.postCount(), wanted.postCount());
    for (std::size_t i = 0; i < found.postCount(); ++i)
        ASSERT_NEAR(found.heightOrigin + double(found.heights()[i]),
                    wanted.heightOrigin + double(wanted.heights()[i]), 1.0e-3);
}

// Expected: a GeoPackage of the cone is the cone; MBTiles, which GDAL makes of the colours in their
// own projection, cover the terrain and have the colours of the source in the mean, within what
// resampling leaves.
TEST(MapLayers, GeoPackageAndMbTiles)
{
    GDALAllRegister();
    const auto copied = [](const std::string& from, const char* driver, const std::string& name)
    {
        const GDALDatasetUniquePtr source(GDALDataset::Open((OTL_SOURCE_DIR "/" + from).c_str()));
        const std::string path = (testFolder() / name).string();
        GDALDriver* format = GetGDALDriverManager()->GetDriverByName(driver);
        if (!source || !format)
            return false;
        const char* png[] = {"TILE_FORMAT=PNG", nullptr};
        return GDALDatasetUniquePtr(format->CreateCopy(path.c_str(), source.get(), FALSE,
                                                       const_cast<char**>(png), nullptr,
                                                       nullptr)) != nullptr;
    };
    if (!copied("earth_files/data/cone.tif", "GPKG", "cone.gpkg") ||
        !copied("samples/data/jacksboro_colour.tif", "MBTILES", "colour.mbtiles"))
        GTEST_SKIP() << "skipped: this GDAL writes no GeoPackage or MBTiles (built without SQLite)";
    const Result<EarthMap> map = parseEarth(
        "<map><GDALElevation url='cone.gpkg'/><MBTilesImage filename='colour.mbtiles'/></map>",
        "m.earth");
    ASSERT_TRUE(map) << map.error().message;
    const Result<TerrainModel> model = loadMap(*map, testFolder().string(), "m.earth");
    ASSERT_TRUE(model) << model.error().message;
    EXPECT_TRUE(model->warnings.empty()) << model->warnings.front();
    const Result<DemFile> cone = readDem(folder + "/data/cone.tif");
    ASSERT_TRUE(cone);
    EXPECT_EQ(tileOf(*model).heights(), cone->tile.heights());
    EXPECT_EQ(tileOf(*model).validity(), cone->tile.validity());

    const Result<ColourImage> wanted =
        readColour(OTL_SOURCE_DIR "/samples/data/jacksboro_colour.tif", cone->tile);
    ASSERT_TRUE(wanted);
    const auto meanOf = [](const auto& at, int count)
    {
        double sum = 0.0;
        for (int i = 0; i < count; ++i)
            sum += at(i);
        return sum / count;
    };
    const osg::Image& image = coloursOf(*model);
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(
            meanOf([&](int i) { return image.data()[3 * i + channel]; }, image.s() * image.t()),
            meanOf([&](int i) { return wanted->pixels[static_cast<std::size_t>(4 * i + channel)]; },
                   wanted->width * wanted->height),
            2.0);
}

// Expected: the colour of the tile that each place lies in, after the numbers of tiles in Web
// Mercator; at least a pixel of a tile away from its edges, since pixels are interpolated.
TEST(MapLayers, TilesByLongitudeAndLatitude)
{
    const TerrainModel model = modelOf("tiles.earth");
    EXPECT_TRUE(model.warnings.empty());
    const DemTile& tile = tileOf(model);
    const osg::Image& image = coloursOf(model);
    constexpr double pi = 3.14159265358979323846;
    int seen[4] = {};
    for (int row = 0; row < image.t(); ++row)
        for (int column = 0; column < image.s(); ++column)
        {
            const double longitude =
                tile.mapOriginX + (column + 0.5) / image.s() * (tile.width() - 1) * tile.mapStepX;
            const double latitude =
                tile.mapOriginY + (row + 0.5) / image.t() * (tile.height() - 1) * tile.mapStepY;
            const double x = (longitude + 180.0) / 360.0 * 512.0;
            const double y = (1.0 - std::asinh(std::tan(latitude * pi / 180.0)) / pi) * 256.0;
            if (std::abs(x - 136.0) < 1.5 / 64.0 || std::abs(y - 200.0) < 1.5 / 64.0)
                continue;
            const int square = (x > 136.0 ? 1 : 0) + (y > 200.0 ? 2 : 0);
            const int wanted[4][3] = {
                {200, 120, 60}, {255, 255, 255}, {60, 200, 120}, {120, 60, 200}};
            ++seen[square];
            for (int channel = 0; channel < 3; ++channel)
                ASSERT_EQ(
                    image.data(static_cast<unsigned>(column), static_cast<unsigned>(row))[channel],
                    wanted[square][channel])
                    << longitude << ", " << latitude;
        }
    for (const int count : seen)
        EXPECT_GT(count, 0);
}

// Expected: two layers side by side of 1300 posts each are more than one tile has, and are paged;
// their extent is theirs together, and what is missing beside them is left out with its line.
TEST(MapLayers, LayersThatAreLargeTogetherArePaged)
{
    const auto write = [](double west, double height)
    {
        MemoryRaster made;
        made.width = 1300;
        made.height = 20;
        made.transform = {west, 10, 0, 4000200, 0, -10};
        made.values.assign(std::size_t(made.width) * std::size_t(made.height), height);
        return made.write();
    };
    const std::string xml = "<map>\n<GDALElevation name='a' url='" + write(500000, 100) +
                            "'/>\n<GDALElevation name='b' url='" + write(513000, 300) +
                            "'/>\n<GDALElevation name='c' url='none.tif'/>\n</map>";
    const Result<EarthMap> map = parseEarth(xml, "m.earth");
    ASSERT_TRUE(map) << map.error().message;
    const Result<TerrainModel> model = loadMap(*map, testFolder().string(), "m.earth");
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->warnings.size(), 1u);
    EXPECT_NE(model->warnings[0].find("m.earth:4: left out"), std::string::npos)
        << model->warnings[0];
    std::string notes;
    for (const std::string& note : model->notes)
        notes += note + "\n";
    EXPECT_NE(notes.find("2 layers of heights make one of 2600 x 20 posts"), std::string::npos)
        << notes;
    EXPECT_EQ(notes.find("averaged"), std::string::npos) << notes;
    ASSERT_GT(model->node->getNumChildren(), 0u);
    EXPECT_TRUE(dynamic_cast<const osg::PagedLOD*>(model->node->getChild(0)));
    EXPECT_NEAR(model->terrain.xMax() - model->terrain.xMin(), 25990.0, 20.0);
    EXPECT_NEAR(model->terrain.zMin(), 100.0, 1.0);
    EXPECT_NEAR(model->terrain.zMax(), 300.0, 1.0);
}
