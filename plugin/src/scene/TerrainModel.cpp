#include "scene/TerrainModel.h"

#include "io/CompositeDem.h"
#include "io/MapPlace.h"
#include "scene/TerrainTileReader.h"
#include <osgTerrainLight/Environment.h>

#include <osg/Image>
#include <osg/MatrixTransform>
#include <osg/Notify>
#include <osg/Shape>
#include <osgDB/FileNameUtils>
#include <osgTerrain/GeometryTechnique>
#include <osgTerrain/Layer>
#include <osgTerrain/Locator>
#include <osgTerrain/TerrainTile>
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

std::string baseName(const std::string& path)
{
    return osgDB::getSimpleFileName(path);
}

} // namespace

osg::ref_ptr<osg::Node> createTerrain(const DemTile& tile, const std::vector<ColourImage>& colours)
{
    assert(tile.width() > 1 && tile.height() > 1);
    const double halfWidth = 0.5 * (tile.width() - 1) * tile.nominalEastSpacing();
    const double halfHeight = 0.5 * (tile.height() - 1) * tile.northSpacing;
    osg::ref_ptr<osgTerrain::Locator> locator = new osgTerrain::Locator;
    locator->setCoordinateSystemType(osgTerrain::Locator::PROJECTED);
    locator->setTransformAsExtents(-halfWidth, -halfHeight, halfWidth, halfHeight);

    osg::ref_ptr<osgTerrain::HeightFieldLayer> heights =
        new osgTerrain::HeightFieldLayer(heightFieldOf(tile));
    heights->setLocator(locator);
    heights->setValidDataOperator(new osgTerrain::NoDataValue(voidHeight));

    osg::ref_ptr<osgTerrain::TerrainTile> terrain = new osgTerrain::TerrainTile;
    terrain->setUserData(new DemData(tile));
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
    osg::ref_ptr<osg::MatrixTransform> placed =
        new osg::MatrixTransform(osg::Matrix::translate(0.0, 0.0, tile.heightOrigin));
    placed->addChild(terrain);
    return placed;
}

std::string resolved(const std::string& url, const std::string& folder)
{
    const bool whole = osgDB::isAbsolutePath(url) || url.compare(0, 4, "/vsi") == 0;
    return whole || folder.empty() ? url : osgDB::concatPaths(folder, url);
}

osg::BoundingBoxd extentOf(const DemTile& tile)
{
    osg::BoundingBoxd box;
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column)
            if (tile.isValid(column, row))
                box.expandBy((column - 0.5 * (tile.width() - 1)) * tile.nominalEastSpacing(),
                             (row - 0.5 * (tile.height() - 1)) * tile.northSpacing,
                             tile.heightOrigin + static_cast<double>(tile.heightAt(column, row)));
    return box;
}

osg::ref_ptr<TerrainLighting> createLighting(const LightParameters& light,
                                             const std::string& folder,
                                             std::vector<std::string>& warnings)
{
    osg::ref_ptr<TerrainLighting> node = new TerrainLighting;
    SkyLight sky = light.sky;
    std::string problem;
    const std::shared_ptr<const Environment> environment =
        light.skyFile.empty() ? nullptr : readEnvironment(resolved(light.skyFile, folder), problem);
    if (environment)
    {
        const bool withoutSun = !sky.sunEnabled;
        sky.setEnvironment(environment, sky.environmentHeading, sky.environmentGain);
        if (withoutSun)
            sky.sunEnabled = false;
    }
    else if (!light.skyFile.empty())
        warnings.push_back("left out the sky: " + problem);
    node->setSkyLight(sky);
    node->setSettings(light.settings);
    node->setLightEnabled(light.lightEnabled);
    return node;
}

Status setTimeAndPlace(TerrainLighting& node, const LightParameters& light,
                       const std::optional<DemTile>& tile)
{
    if (light.time && node.getSkyLight().environment)
        return Error{ErrorCode::Invalid, "time = " + toString(*light.time) +
                                             ": the sun is that of " + light.skyFile +
                                             ": needs another sky, or no time"};
    const Result<EarthPlace> place =
        placeInstead(light.place, tile ? tile->crs : "", placeOf(tile.value_or(DemTile())));
    if (place)
        node.setPlace(*place);
    else if (light.time)
        return Error{place.error().code, "time = " + toString(*light.time) + ": " +
                                             place.error().message +
                                             ": needs place, LONGITUDE,LATITUDE"};
    if (light.time)
        node.setTime(*light.time);
    return Nothing{};
}

Result<TerrainModel> loadRaster(const std::string& path, const DemReadOptions& read,
                                const LightParameters& light)
{
    const Result<DemFile> file = readDrawn(path, read, mostDrawnPosts);
    if (!file)
        return file.error();
    TerrainModel model;
    model.node = createLighting(light, "", model.warnings);
    osg::ref_ptr<osg::Node> terrain = createTerrain(file->tile);
    terrain->setName(baseName(path));
    model.node->addChild(terrain);
    model.terrain = extentOf(file->tile);
    if (const Status set = setTimeAndPlace(*model.node, light, file->tile); !set)
        return Error{set.error().code, path + ": " + set.error().message};
    for (const std::string& note : file->notes)
        model.notes.push_back(path + ": " + note);
    return model;
}

} // namespace osgTerrainLight
