#include "scene/TerrainModel.h"

#include "io/CompositeDem.h"
#include "io/MapPlace.h"
#include "io/TileRaster.h"
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
#include <cctype>
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

/// C:/data/dem.tif
bool namesDrive(const std::string& url)
{
    return url.size() > 2 && std::isalpha(static_cast<unsigned char>(url[0])) && url[1] == ':' &&
           url[2] == '/';
}

std::string resolved(const std::string& url, const std::string& folder)
{
    const bool whole = osgDB::isAbsolutePath(url) || url.compare(0, 4, "/vsi") == 0;
    return whole || folder.empty() ? url : osgDB::concatPaths(folder, url);
}

/// The path that GDAL reads the layer by. tiles: keeps what is made for that.
Result<std::string> pathOf(const EarthLayer& layer, const std::string& folder,
                           std::vector<TileRaster>& tiles)
{
    std::string path = resolved(layer.url, folder);
    if (layer.driver != "tms" && layer.driver != "xyz")
        return path;
    const Result<TileRaster> raster =
        layer.driver == "tms" ? TileRaster::ofTileMap(path)
                              : TileRaster::ofPattern(path, layer.profile, layer.fromSouth);
    if (!raster)
        return raster.error();
    tiles.push_back(*raster);
    return raster->path();
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

Result<TerrainModel> loadMap(const EarthMap& map, const std::string& folder,
                             const std::string& source)
{
    TerrainModel model;
    model.node = createLighting(map.light, folder, model.warnings);
    model.node->setName(map.name);
    model.warnings.insert(model.warnings.end(), map.warnings.begin(), map.warnings.end());
    model.notes = map.notes;
    std::string leftOut = map.leftOut;
    bool isMissing = true; // whatever was left out here
    const auto leaveOut = [&](const EarthLayer& layer, const Error& reason)
    {
        const std::string line = std::to_string(layer.line);
        const std::string why =
            reason.message + (reason.code == ErrorCode::NotFound && namesDrive(layer.url)
                                  ? "; the path names a drive of Windows, and a path relative to "
                                    "the map is found on every computer"
                                  : "");
        model.warnings.push_back(source + ":" + line + ": left out " + layer.what + ": " + why);
        leftOut += (leftOut.empty() ? "" : ", ") + layer.what + " (line " + line + ": " + why + ")";
        isMissing = isMissing && reason.code == ErrorCode::NotFound;
    };

    std::vector<TileRaster> tiles;
    std::vector<DemLayer> dems;
    std::vector<const EarthLayer*> layersOfDems;
    for (const EarthLayer& layer : map.elevations)
        if (const Result<std::string> path = pathOf(layer, folder, tiles))
        {
            dems.push_back({*path, layer.read});
            layersOfDems.push_back(&layer);
        }
        else
            leaveOut(layer, path.error());
    CompositeDem composite = readComposite(dems, mostDrawnPosts);
    for (const auto& [number, reason] : composite.leftOut)
        leaveOut(*layersOfDems[number], reason);
    model.notes.insert(model.notes.end(), composite.notes.begin(), composite.notes.end());
    std::optional<DemTile> tile = std::move(composite.tile);
    std::vector<ColourImage> colours;
    for (const EarthLayer& layer : map.images)
    {
        const Result<std::string> path = pathOf(layer, folder, tiles);
        if (!path)
        {
            leaveOut(layer, path.error());
            continue;
        }
        if (!tile)
        {
            const Result<DemTile> level = levelTileUnder(*path);
            if (level)
            {
                tile = *level;
                model.notes.push_back(source + ": no elevation, so the terrain is level");
            }
            else
            {
                leaveOut(layer, level.error());
                continue;
            }
        }
        Result<ColourImage> colour = readColour(*path, *tile);
        if (!colour)
        {
            leaveOut(layer, colour.error());
            continue;
        }
        for (std::size_t alpha = 3; alpha < colour->pixels.size(); alpha += 4)
            colour->pixels[alpha] =
                static_cast<std::uint8_t>(std::lround(layer.opacity * colour->pixels[alpha]));
        colours.push_back(std::move(*colour));
    }
    if (tile)
    {
        osg::ref_ptr<osg::Node> terrain = createTerrain(*tile, colours);
        terrain->setName(map.name);
        model.node->addChild(terrain);
        model.terrain = extentOf(*tile);
    }
    else if (!isMissing)
        return Error{ErrorCode::Invalid, source + ": no layer could be read, left out: " + leftOut};
    else
        model.warnings.push_back(source + ": no layer could be read; the map is empty");
    if (const Status set = setTimeAndPlace(*model.node, map.light, tile); !set)
        model.warnings.push_back(source + ": " + set.error().message);
    return model;
}

} // namespace osgTerrainLight
