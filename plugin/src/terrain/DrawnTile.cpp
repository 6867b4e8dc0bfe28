#include "terrain/DrawnTile.h"

#include <osg/Image>
#include <osg/Notify>
#include <osg/Shape>
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

osg::ref_ptr<osg::HeightField> heightFieldOf(const DemTile& tile)
{
    osg::ref_ptr<osg::HeightField> field = new osg::HeightField;
    field->allocate(static_cast<unsigned>(tile.width()), static_cast<unsigned>(tile.height()));
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column)
            field->setHeight(static_cast<unsigned>(column), static_cast<unsigned>(row),
                             tile.isValid(column, row) ? tile.heightAt(column, row) : voidHeight);
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
                                                float skirt)
{
    assert(tile.width() > 1 && tile.height() > 1);
    const double halfWidth = 0.5 * (tile.width() - 1) * eastSpacing;
    const double halfHeight = 0.5 * (tile.height() - 1) * tile.northSpacing;
    osg::ref_ptr<osgTerrain::Locator> locator = new osgTerrain::Locator;
    locator->setCoordinateSystemType(osgTerrain::Locator::PROJECTED);
    locator->setTransformAsExtents(-halfWidth, -halfHeight, halfWidth, halfHeight);

    const osg::ref_ptr<osg::HeightField> field = heightFieldOf(tile);
    field->setSkirtHeight(skirt);
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

} // namespace osgTerrainLight
