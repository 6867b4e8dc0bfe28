#include "terrain/DrawnTile.h"

#include <osg/Geometry>
#include <osg/Image>
#include <osg/NodeVisitor>
#include <osg/Notify>
#include <osg/Shape>
#include <osg/Transform>
#include <osgTerrain/GeometryTechnique>
#include <osgTerrain/Layer>
#include <osgTerrain/Locator>
#include <osgTerrain/ValidDataOperator>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <mutex>

namespace osgTerrainLight
{

namespace
{
/// Of a void post in a height field: no valid height of a DemTile is as low.
constexpr float voidHeight = -2.0e6f;

/// The stock technique, which says "Not computing normal" once per void post, without saying it.
class QuietTechnique : public osgTerrain::GeometryTechnique
{
public:
    QuietTechnique() = default;
    QuietTechnique(const QuietTechnique& other, const osg::CopyOp& copyop)
        : osgTerrain::GeometryTechnique(other, copyop)
    {
    }
    osg::Object* cloneType() const override { return new QuietTechnique; }
    osg::Object* clone(const osg::CopyOp& copyop) const override
    {
        return new QuietTechnique(*this, copyop);
    }
    // Files name it as the stock technique.

protected:
    void generateGeometry(BufferData& buffer, osgTerrain::Locator* masterLocator,
                          const osg::Vec3d& centre) override
    {
        // The level is the process's: one thread at a time lowers it and puts it back.
        static std::mutex mutex;
        const std::lock_guard<std::mutex> lock(mutex);
        const osg::NotifySeverity level = osg::getNotifyLevel();
        osg::setNotifyLevel(std::min(level, osg::WARN));
        GeometryTechnique::generateGeometry(buffer, masterLocator, centre);
        osg::setNotifyLevel(level);
    }
};

/// lift: what is added to its heights [m].
osg::ref_ptr<osg::HeightField> heightFieldOf(const DemTile& tile, double lift)
{
    osg::ref_ptr<osg::HeightField> field = new osg::HeightField;
    field->allocate(static_cast<unsigned>(tile.width()), static_cast<unsigned>(tile.height()));
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column)
            field->setHeight(
                static_cast<unsigned>(column), static_cast<unsigned>(row),
                tile.isValid(column, row)
                    ? static_cast<float>(static_cast<double>(tile.heightAt(column, row)) + lift)
                    : voidHeight);
    return field;
}

/// Layers over white, as large as the largest of them.
osg::ref_ptr<osg::Image> composed(const std::vector<ColourImage>& layers)
{
    int width = 0, height = 0;
    for (const ColourImage& layer : layers)
    {
        width = std::max(width, layer.width);
        height = std::max(height, layer.height);
    }
    osg::ref_ptr<osg::Image> image = new osg::Image;
    image->allocateImage(width, height, 1, GL_RGB, GL_UNSIGNED_BYTE);
    std::fill_n(image->data(), image->getTotalSizeInBytes(), static_cast<unsigned char>(255));
    for (const ColourImage& layer : layers)
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
            {
                const int fromX = static_cast<int>(static_cast<long long>(x) * layer.width / width);
                const int fromY =
                    static_cast<int>(static_cast<long long>(y) * layer.height / height);
                const std::uint8_t* from =
                    layer.pixels.data() +
                    4 * (static_cast<std::ptrdiff_t>(fromY) * layer.width + fromX);
                unsigned char* to = image->data(static_cast<unsigned>(x), static_cast<unsigned>(y));
                const int alpha = from[3];
                for (int c = 0; c < 3; ++c)
                    to[c] = static_cast<unsigned char>(
                        (from[c] * alpha + to[c] * (255 - alpha) + 127) / 255);
            }
    return image;
}
} // namespace

osg::ref_ptr<osgTerrain::TerrainTile> drawnTile(const DemTile& tile, double eastSpacing,
                                                DemData* data,
                                                const std::vector<ColourImage>& colours,
                                                osgTerrain::Locator* globe)
{
    assert(tile.width() > 1 && tile.height() > 1);
    const double halfWidth = 0.5 * (tile.width() - 1) * eastSpacing;
    const double halfHeight = 0.5 * (tile.height() - 1) * tile.northSpacing;
    osg::ref_ptr<osgTerrain::Locator> locator = globe ? globe : new osgTerrain::Locator;
    if (!globe)
    {
        locator->setCoordinateSystemType(osgTerrain::Locator::PROJECTED);
        locator->setTransformAsExtents(-halfWidth, -halfHeight, halfWidth, halfHeight);
    }

    const osg::ref_ptr<osg::HeightField> field =
        heightFieldOf(tile, globe ? tile.heightOrigin : 0.0);
    osg::ref_ptr<osgTerrain::HeightFieldLayer> heights = new osgTerrain::HeightFieldLayer(field);
    heights->setLocator(locator);
    heights->setValidDataOperator(new osgTerrain::NoDataValue(voidHeight));

    osg::ref_ptr<osgTerrain::TerrainTile> terrain = new osgTerrain::TerrainTile;
    terrain->setUserData(data);
    terrain->setLocator(locator);
    terrain->setElevationLayer(heights);
    if (tile.validCount() < tile.postCount())
        terrain->setTerrainTechnique(new QuietTechnique);
    else
        terrain->setTerrainTechnique(new osgTerrain::GeometryTechnique);
    if (!colours.empty())
    {
        osg::ref_ptr<osgTerrain::ImageLayer> layer = new osgTerrain::ImageLayer(composed(colours));
        layer->setLocator(locator);
        terrain->setColorLayer(0, layer);
    }
    return terrain;
}

float skirtOf(const DemTile& tile)
{
    constexpr int cells = 4;
    float deepest = 0.0f;
    const auto alongEdge = [&](int count, auto&& post)
    {
        for (int i = 0; i < count; ++i)
            for (int j = i + 1; j <= std::min(i + cells, count - 1); ++j)
            {
                const auto [column, row] = post(i);
                const auto [otherColumn, otherRow] = post(j);
                if (tile.isValid(column, row) && tile.isValid(otherColumn, otherRow))
                    deepest = std::max(deepest, std::abs(tile.heightAt(column, row) -
                                                         tile.heightAt(otherColumn, otherRow)));
            }
    };
    for (const int row : {0, tile.height() - 1})
        alongEdge(tile.width(), [row](int i) { return std::pair<int, int>(i, row); });
    for (const int column : {0, tile.width() - 1})
        alongEdge(tile.height(), [column](int i) { return std::pair<int, int>(column, i); });
    return deepest;
}

void addSkirt(osgTerrain::TerrainTile& tile, const DemTile& dem, float depth)
{
    struct Finder : osg::NodeVisitor
    {
        Finder() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
        void apply(osg::Geode& geode) override
        {
            found = &geode;
            toTile = osg::computeLocalToWorld(getNodePath());
        }
        osg::Geode* found = nullptr;
        osg::Matrixd toTile;
    } finder;
    tile.accept(finder);
    if (!finder.found || !(depth > 0.0f))
        return;
    const auto& layer =
        dynamic_cast<const osgTerrain::HeightFieldLayer&>(*tile.getElevationLayer());
    const osgTerrain::Locator& locator = *tile.getLocator();
    const osg::Matrixd fromTile = osg::Matrixd::inverse(finder.toTile);
    const osg::ref_ptr<osg::Vec3Array> vertices = new osg::Vec3Array;
    const osg::ref_ptr<osg::Vec3Array> normals = new osg::Vec3Array;
    const osg::ref_ptr<osg::Vec2Array> places = new osg::Vec2Array;
    const osg::ref_ptr<osg::DrawElementsUShort> triangles =
        new osg::DrawElementsUShort(GL_TRIANGLES);
    // Of a post: the two vertices on the edge and below it.
    const auto hang = [&](int column, int row)
    {
        const osg::Vec3d post(
            double(column) / (dem.width() - 1), double(row) / (dem.height() - 1),
            double(layer.getHeightField()->getHeight(unsigned(column), unsigned(row))));
        osg::Vec3d edge, below;
        locator.convertLocalToModel(post, edge);
        locator.convertLocalToModel(post - osg::Vec3d(0.0, 0.0, double(depth)), below);
        osg::Vec3d up = edge - below;
        up.normalize();
        for (const osg::Vec3d& place : {edge, below})
        {
            vertices->push_back(osg::Vec3(place * fromTile));
            normals->push_back(osg::Vec3(up));
            places->push_back(osg::Vec2(float(post.x()), float(post.y())));
        }
    };
    // Anticlockwise, so that walls face outwards; none beside a void.
    const auto wall = [&](int count, auto&& post)
    {
        bool isBefore = false;
        for (int i = 0; i < count; ++i)
        {
            const auto [column, row] = post(i);
            const bool isValid = dem.isValid(column, row);
            if (isValid)
                hang(column, row);
            if (isValid && isBefore)
            {
                const auto next = static_cast<GLushort>(vertices->size() - 2);
                for (const int corner : {-2, -1, 1, -2, 1, 0})
                    triangles->push_back(static_cast<GLushort>(next + corner));
            }
            isBefore = isValid;
        }
    };
    using Post = std::pair<int, int>;
    const int east = dem.width() - 1, north = dem.height() - 1;
    wall(dem.width(), [](int i) { return Post(i, 0); });
    wall(dem.height(), [east](int i) { return Post(east, i); });
    wall(dem.width(), [east, north](int i) { return Post(east - i, north); });
    wall(dem.height(), [north](int i) { return Post(0, north - i); });
    if (triangles->empty())
        return;
    const osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
    geometry->setVertexArray(vertices);
    geometry->setNormalArray(normals, osg::Array::BIND_PER_VERTEX);
    geometry->setTexCoordArray(0, places);
    geometry->addPrimitiveSet(triangles);
    const osg::ref_ptr<osg::Vec4Array> white = new osg::Vec4Array(1);
    white->front().set(1.0f, 1.0f, 1.0f, 1.0f);
    geometry->setColorArray(white, osg::Array::BIND_OVERALL);
    finder.found->addDrawable(geometry);
}

} // namespace osgTerrainLight
