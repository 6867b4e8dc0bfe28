#include "terrain/Globe.h"

#include "io/EarthFile.h"
#include "scene/LitTile.h"
#include "scene/TerrainTileReader.h"
#include "support/GlContext.h"
#include "support/MemoryRaster.h"
#include "terrain/PagedTerrain.h"
#include "terrain/TerrainModel.h"

#include <gtest/gtest.h>

#include <osg/NodeVisitor>
#include <osg/Transform>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

using namespace osgTerrainLight;

namespace
{
constexpr double radians = 3.14159265358979323846 / 180.0;

/// In degrees, 0.01 apart, posts from 10 east and 47 north on to the south.
MemoryRaster inDegrees(int side, const std::function<double(int column, int row)>& heightAt)
{
    MemoryRaster raster;
    raster.width = raster.height = side;
    raster.crs = "EPSG:4326";
    raster.transform = {9.995, 0.01, 0.0, 47.005, 0.0, -0.01};
    raster.noData = -9999.0;
    raster.values.clear();
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column)
            raster.values.push_back(heightAt(column, row));
    return raster;
}

std::unique_ptr<OverviewSource> sourceOf(const std::string& path, int cellsLog2)
{
    auto source = OverviewSource::open(path, {}, cellsLog2);
    EXPECT_TRUE(source) << source.error().message;
    return std::move(*source);
}

/// Paged terrain of a raster on its globe, in tiles of 2^cellsLog2 cells.
std::pair<Globe, osg::ref_ptr<PagedTerrain>> onGlobe(const std::string& path, int cellsLog2)
{
    auto source = sourceOf(path, cellsLog2);
    const Result<Globe> globe = Globe::under(*source, path);
    EXPECT_TRUE(globe) << globe.error().message;
    return {*globe, new PagedTerrain(std::move(source), {}, HorizonQuality::Normal, *globe)};
}

/// What is drawn below a node, in geocentric coordinates, and the tiles.
struct Drawn : osg::NodeVisitor
{
    explicit Drawn(osg::Node& scene) : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN)
    {
        scene.accept(*this);
    }
    void apply(osg::Transform& transform) override { traverse(transform); }
    void apply(osg::Group& group) override
    {
        if (auto* tile = dynamic_cast<osgTerrain::TerrainTile*>(&group))
            tiles.push_back(tile);
        traverse(group);
    }
    void apply(osg::Geometry& geometry) override
    {
        const osg::Matrixd toWorld = osg::computeLocalToWorld(getNodePath());
        const auto& vertices = dynamic_cast<const osg::Vec3Array&>(*geometry.getVertexArray());
        for (const osg::Vec3& vertex : vertices)
            places.push_back(osg::Vec3d(vertex) * toWorld);
        coordinates = coordinates && geometry.getTexCoordArray(ShadingTexture::coordinateSet);
    }
    std::vector<osgTerrain::TerrainTile*> tiles;
    std::vector<osg::Vec3d> places;
    bool coordinates = true; ///< of the tile, at all vertices
};

/// By PROJ: degrees and metres above WGS 84 to geocentric coordinates.
class ToGeocentric
{
public:
    ToGeocentric()
    {
        OGRSpatialReference from, to;
        EXPECT_EQ(from.importFromEPSG(4979), OGRERR_NONE);
        EXPECT_EQ(to.importFromEPSG(4978), OGRERR_NONE);
        from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        _way.reset(OGRCreateCoordinateTransformation(&from, &to));
    }
    osg::Vec3d operator()(double longitude, double latitude, double height) const
    {
        osg::Vec3d place(longitude, latitude, height);
        EXPECT_TRUE(_way->Transform(1, &place.x(), &place.y(), &place.z()));
        return place;
    }

private:
    std::unique_ptr<OGRCoordinateTransformation> _way;
};
} // namespace

// Expected: PROJ's geocentric coordinates of every post. The vertices are floats within 20 km of
// the middle of their tile, so a millimetre is what they can tell.
TEST(Globe, PostsStandOnTheEllipsoid)
{
    const auto heightAt = [](int column, int row)
    { return 500.0 + 300.0 * std::sin(0.3 * column) * std::cos(0.2 * row); };
    const std::string path = inDegrees(33, heightAt).write();
    const auto [globe, terrain] = onGlobe(path, 5);
    const auto root = terrain->root();
    ASSERT_TRUE(root) << root.error().message;
    Drawn drawn(*globe.around(**root));
    EXPECT_TRUE(drawn.coordinates);
    const ToGeocentric toGeocentric;
    double worst = 0.0;
    for (int row = 0; row < 33; ++row)
        for (int column = 0; column < 33; ++column)
        {
            const osg::Vec3d expected =
                toGeocentric(10.0 + 0.01 * column, 47.0 - 0.01 * row, heightAt(column, row));
            double nearest = 1.0e9;
            for (const osg::Vec3d& place : drawn.places)
                nearest = std::min(nearest, (place - expected).length());
            worst = std::max(worst, nearest);
        }
    EXPECT_LT(worst, 2.0e-3); // and half a millimetre of the height's own float
}

// Expected: on level ground the irradiance of a sun is its strength times the cosine between it and
// the vertical of the place, by vectors in geocentric coordinates.
TEST(Globe, TheSunStandsAsItDoesOverEachTile)
{
    OTL_NEED_GL(context);
    constexpr int side = 321; // 3.2 degrees
    const std::string path = inDegrees(side, [](int, int) { return 0.0; }).write();
    const auto [globe, terrain] = onGlobe(path, 6);
    auto read = terrain->readNode("1/1/1", nullptr);
    ASSERT_TRUE(read.validNode());

    auto light = std::make_shared<SceneLight>();
    light->sky.skyEnabled = false;
    light->sky.sunAzimuth = 100.0;
    light->sky.sunElevation = 5.0;
    light->sky.sunIrradiance = {1.0f, 1.0f, 1.0f};
    light->settings.bodyRadius = globe.radius(); // as the viewer has it
    const auto axes = [](double longitude, double latitude)
    {
        const double a = longitude * radians, b = latitude * radians;
        return std::array<osg::Vec3d, 3>{
            osg::Vec3d(-std::sin(a), std::cos(a), 0.0),
            {-std::sin(b) * std::cos(a), -std::sin(b) * std::sin(a), std::cos(b)},
            {std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b)}};
    };
    const auto middle = axes(11.6, 45.4);
    const double azimuth = 100.0 * radians, elevation = 5.0 * radians;
    const osg::Vec3d sun = middle[0] * (std::sin(azimuth) * std::cos(elevation)) +
                           middle[1] * (std::cos(azimuth) * std::cos(elevation)) +
                           middle[2] * std::sin(elevation);
    Drawn drawn(*read.getNode());
    ASSERT_EQ(drawn.tiles.size(), 4u);
    int lightedPosts = 0; // the southern tiles have one row
    for (osgTerrain::TerrainTile* tile : drawn.tiles)
    {
        const Result<TerrainHeights> heights = readTerrainTile(*tile, osg::Matrixd());
        ASSERT_TRUE(heights) << heights.error().message;
        ASSERT_TRUE(heights->turn);
        const osg::ref_ptr<LitTile> lit =
            new LitTile("tile", heights->windows, light, heights->turn);
        ASSERT_TRUE(lit->update(context->state(), light, nullptr));
        const Raster<osg::Vec4f> shading = lit->lighting().readShading(context->state());
        const osg::Matrixd& extent = tile->getLocator()->getTransform();
        for (int row = 1; row < 64; row += 9)
            for (int column = 1; column < 64; column += 9)
                if (heights->dem.isValid(column, row) && heights->dem.isValid(column, row - 1) &&
                    heights->dem.isValid(column + 1, row))
                {
                    const osg::Vec3d place =
                        osg::Vec3d(column / 64.0, row / 64.0, 0.0) * extent; // radians
                    const double expected =
                        sun * axes(place.x() / radians, place.y() / radians)[2] / (180.0 * radians);
                    EXPECT_NEAR(static_cast<double>(shading.at(column, row).x()), expected, 2.0e-4)
                        << column << ", " << row;
                    ++lightedPosts;
                }
        lit->lighting().releaseGLObjects(&context->state());
    }
    EXPECT_GT(lightedPosts, 50);
}

// Longitudes of 0 to 360 degrees, and of rasters across the 180th meridian: a vertex has the place
// on the tile that its post has.
TEST(Globe, VerticesFindTheirPlaceBeyondTheDateLine)
{
    for (const double west : {170.0, 179.9, 200.0, 359.0, -181.0})
    {
        MemoryRaster raster = inDegrees(65, [](int column, int) { return 1.0 * column; });
        raster.transform[0] = west - 0.005;
        const std::string path = raster.write();
        const auto [globe, terrain] = onGlobe(path, 5);
        auto read = terrain->readNode("1/0/0", nullptr);
        ASSERT_TRUE(read.validNode());
        struct Places : osg::NodeVisitor
        {
            Places() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
            void apply(osg::Geometry& geometry) override
            {
                const auto& coordinates = dynamic_cast<const osg::Vec2Array&>(
                    *geometry.getTexCoordArray(ShadingTexture::coordinateSet));
                for (const osg::Vec2& place : coordinates)
                {
                    low = std::min(low, std::min(place.x(), place.y()));
                    high = std::max(high, std::max(place.x(), place.y()));
                    ++count;
                }
            }
            float low = 1.0e9f, high = -1.0e9f;
            int count = 0;
        } places;
        read.getNode()->accept(places);
        EXPECT_GE(places.count, 4 * 33 * 33) << west;
        EXPECT_NEAR(places.low, 0.0f, 1.0e-4f) << west;
        EXPECT_NEAR(places.high, 1.0f, 1.0e-4f) << west;
    }
}

TEST(Globe, NeedsLongitudeAndLatitude)
{
    MemoryRaster raster;
    raster.width = raster.height = 9;
    raster.values.assign(81, 100.0);
    const std::string path = raster.write();
    const Result<TerrainModel> model = loadRaster(path, {}, {}, true);
    ASSERT_FALSE(model);
    EXPECT_NE(model.error().message.find("needs longitude and latitude"), std::string::npos)
        << model.error().message;
    EXPECT_NE(model.error().message.find(path), std::string::npos);
}

TEST(Globe, MapsAreGeocentricWhereTheySaySo)
{
    const std::string path = inDegrees(65, [](int column, int) { return 10.0 * column; }).write();
    const auto load = [](const std::string& type, const std::string& url)
    {
        const Result<EarthMap> map = parseEarth(
            "<map type=\"" + type + "\"><elevation driver=\"gdal\" url=\"" + url +
                "\"/><viewpoints><viewpoint name=\"v\" long=\"10.5\" lat=\"46.5\" "
                "height=\"500\" heading=\"0\" pitch=\"-90\" range=\"1000\"/></viewpoints>"
                "</map>",
            "map");
        EXPECT_TRUE(map) << map.error().message;
        const Result<TerrainModel> model = loadMap(*map, "", "map");
        EXPECT_TRUE(model) << model.error().message;
        return *model;
    };
    const TerrainModel round = load("Geocentric", path), flat = load("projected", path);
    ASSERT_TRUE(round.globe);
    EXPECT_FALSE(flat.globe);
    EXPECT_TRUE(round.terrain.valid());
    // Expected: PROJ's, in the frame of the middle.
    ASSERT_EQ(round.viewpoints.size(), 1u);
    const Viewpoint& view = round.viewpoints[0];
    const osg::ref_ptr<osg::Group> scene = new osg::Group;
    const osg::ref_ptr<osg::CoordinateSystemNode> world = round.globe->around(*scene);
    const osg::Vec3d place = osg::Vec3d(view.x, view.y, view.z) * scene->getWorldMatrices().at(0);
    EXPECT_LT((place - ToGeocentric()(10.5, 46.5, 500.0)).length(), 0.01);
    // It looks straight down there, which is not straight down in the middle.
    const double heading = view.heading * radians, pitch = view.pitch * radians;
    const osg::Vec3d ahead =
        osg::Matrixd::transform3x3(osg::Vec3d(std::sin(heading) * std::cos(pitch),
                                              std::cos(heading) * std::cos(pitch), std::sin(pitch)),
                                   scene->getWorldMatrices().at(0));
    osg::Vec3d down = ToGeocentric()(10.5, 46.5, 0.0) - ToGeocentric()(10.5, 46.5, 1000.0);
    down.normalize();
    EXPECT_LT((ahead - down).length(), 1.0e-6);
    EXPECT_GT(view.pitch, -89.9);

    MemoryRaster raster;
    raster.width = raster.height = 9;
    raster.values.assign(81, 100.0);
    const Result<EarthMap> map =
        parseEarth("<map type=\"geocentric\"><elevation driver=\"gdal\" url=\"" + raster.write() +
                       "\"/></map>",
                   "map");
    ASSERT_TRUE(map);
    const Result<TerrainModel> onPlane = loadMap(*map, "", "map");
    ASSERT_TRUE(onPlane) << onPlane.error().message;
    EXPECT_FALSE(onPlane->globe);
    EXPECT_NE(std::find_if(onPlane->notes.begin(), onPlane->notes.end(),
                           [](const std::string& note)
                           { return note.find("drawn on a plane") != std::string::npos; }),
              onPlane->notes.end());
}
