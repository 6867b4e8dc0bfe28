#include "terrain/TerrainModel.h"

#include "io/CompositeDem.h"
#include "io/MapPlace.h"
#include "scene/TerrainTileReader.h"
#include "terrain/DrawnTile.h"
#include <osgTerrainLight/Environment.h>

#include <osg/MatrixTransform>
#include <osgDB/FileNameUtils>

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
std::string baseName(const std::string& path)
{
    return osgDB::getSimpleFileName(path);
}

} // namespace

osg::ref_ptr<osg::Node> createTerrain(const DemTile& tile, const std::vector<ColourImage>& colours)
{
    osg::ref_ptr<osg::MatrixTransform> placed =
        new osg::MatrixTransform(osg::Matrix::translate(0.0, 0.0, tile.heightOrigin));
    placed->addChild(drawnTile(tile, tile.nominalEastSpacing(), new DemData(tile), colours));
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

namespace
{
Result<TerrainModel> loadPagedRaster(const std::string& path, const DemReadOptions& read,
                                     const LightParameters& light, bool geocentric)
{
    Result<std::unique_ptr<OverviewSource>> source = OverviewSource::open(path, read);
    if (!source)
        return source.error();
    TerrainModel model;
    if (geocentric)
    {
        Result<Globe> globe = Globe::under(**source, path);
        if (!globe)
            return globe.error();
        model.globe = std::move(*globe);
    }
    model.node = createLighting(light, "", model.warnings);
    model.node->setName(baseName(path));
    for (const std::string& note : (*source)->notes())
        model.notes.push_back(path + ": " + note);
    const DemTile corners = (*source)->cornersOf(0, (*source)->terrain());
    if (const Status set = setTimeAndPlace(*model.node, light, corners); !set)
        return Error{set.error().code, path + ": " + set.error().message};
    if (const Status added = addPaged(model, std::move(*source), {}, light); !added)
        return added.error();
    return model;
}
} // namespace

bool isPaged(const std::string& path, const DemReadOptions& read)
{
    const Result<DemInfo> info = describeDem(path, read);
    return info && std::max(info->rasterWidth, info->rasterHeight) > mostDrawnPosts;
}

Status addPaged(TerrainModel& model, std::unique_ptr<OverviewSource> source,
                std::vector<DrapedColour> colours, const LightParameters& light)
{
    if (model.globe && !(light.settings.bodyRadius > 0.0))
    {
        LightingSettings settings = model.node->getSettings();
        settings.bodyRadius = model.globe->radius();
        model.node->setSettings(settings);
    }
    const osg::ref_ptr<PagedTerrain> paged = new PagedTerrain(std::move(source), std::move(colours),
                                                              light.settings.quality, model.globe);
    const Result<osg::ref_ptr<osg::Node>> root = paged->root();
    if (!root)
        return root.error();
    model.node->addChild(*root);
    model.terrain = paged->extent();
    return Nothing{};
}

Result<TerrainModel> loadRaster(const std::string& path, const DemReadOptions& read,
                                const LightParameters& light, bool geocentric)
{
    if (geocentric || isPaged(path, read))
        return loadPagedRaster(path, read, light, geocentric);
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
