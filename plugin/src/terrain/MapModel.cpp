#include "terrain/TerrainModel.h"

#include "io/AngularCrs.h"
#include "io/CompositeDem.h"
#include "io/CompositeRaster.h"
#include "io/HeightShift.h"
#include "io/LocalFrame.h"
#include "io/TileRaster.h"
#include "terrain/PlacedModels.h"

#include <osg/Math>
#include <osg/MatrixTransform>
#include <osgDB/FileUtils>

#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

namespace osgTerrainLight
{

namespace
{
/// C:/data/dem.tif
bool namesDrive(const std::string& url)
{
    return url.size() > 2 && std::isalpha(static_cast<unsigned char>(url[0])) && url[1] == ':' &&
           url[2] == '/';
}

/// Makes the scene of a map, layer by layer.
class MapLoader
{
public:
    MapLoader(const EarthMap& map, const std::string& folder, const std::string& source)
        : _map(map), _folder(folder), _source(source), _leftOut(map.leftOut)
    {
        _model.node = createLighting(map.light, folder, _model.warnings);
        _model.node->setName(map.name);
        _model.warnings.insert(_model.warnings.end(), map.warnings.begin(), map.warnings.end());
        _model.notes = map.notes;
    }

    Result<TerrainModel> load()
    {
        readElevations();
        for (const EarthLayer& layer : _map.images)
            if (const Status drawn = readImage(layer); !drawn)
                leaveOut(layer, drawn.error());
        const std::vector<osg::ref_ptr<osg::Node>> models = placeModels();
        if (_paged)
            addPagedTerrain();
        else if (_tile)
        {
            osg::ref_ptr<osg::Node> terrain = createTerrain(*_tile, _colours);
            terrain->setName(_map.name);
            _model.node->addChild(terrain);
            _model.terrain = extentOf(*_tile);
            placeViewpoints(localFrameOf(*_tile));
        }
        for (const osg::ref_ptr<osg::Node>& model : models)
            _model.node->addChild(model);
        if (_map.geocentric && !_model.globe)
            _model.notes.push_back(_source + ": is drawn on a plane: a geocentric map needs an "
                                             "elevation in longitude and latitude");
        if (_model.globe && !models.empty())
            _model.notes.push_back(_source + ": models on a geocentric map are drawn unlit, and "
                                             "change no light");
        if (!_model.terrain.valid() && !_isMissing)
            return Error{ErrorCode::Invalid,
                         _source + ": no layer could be read, left out: " + _leftOut};
        if (!_model.terrain.valid())
            _model.warnings.push_back(_source + ": no layer could be read; the map is empty");
        if (const Status set = setTimeAndPlace(*_model.node, _map.light, _tile); !set)
            _model.warnings.push_back(_source + ": " + set.error().message);
        return _model;
    }

private:
    void leaveOut(const EarthLayer& layer, const Error& reason)
    {
        const std::string line = std::to_string(layer.line);
        const std::string why = explained(reason, layer.url);
        _model.warnings.push_back(_source + ":" + line + ": left out " + layer.what + ": " + why);
        _leftOut +=
            (_leftOut.empty() ? "" : ", ") + layer.what + " (line " + line + ": " + why + ")";
        _isMissing = _isMissing && reason.code == ErrorCode::NotFound;
    }

    static std::string explained(const Error& reason, const std::string& url)
    {
        return reason.message + (reason.code == ErrorCode::NotFound && namesDrive(url)
                                     ? "; the path names a drive of Windows, and a path relative "
                                       "to the map is found on every computer"
                                     : "");
    }

    /// The path that GDAL reads the layer by.
    Result<std::string> pathOf(const EarthLayer& layer)
    {
        std::string path = resolved(layer.url, _folder);
        if (layer.driver != "tms" && layer.driver != "xyz")
            return path;
        const Result<TileRaster> raster =
            layer.driver == "tms" ? TileRaster::ofTileMap(path)
                                  : TileRaster::ofPattern(path, layer.profile, layer.fromSouth);
        if (!raster)
            return raster.error();
        _tiles.push_back(*raster);
        return raster->path();
    }

    void readElevations()
    {
        std::vector<DemLayer> dems;
        std::vector<const EarthLayer*> layers;
        for (const EarthLayer& layer : _map.elevations)
            if (const Result<std::string> path = pathOf(layer))
            {
                dems.push_back({*path, layer.read});
                layers.push_back(&layer);
            }
            else
                leaveOut(layer, path.error());
        bringToOneDatum(dems, layers);
        // On a globe all terrain is paged, as its tiles are what is bent.
        if (std::optional<CompositeRaster> large =
                openComposite(dems, _map.geocentric && isInDegrees(dems) ? 1 : mostDrawnPosts))
            return takePaged(*large, layers);
        CompositeDem composite = readComposite(dems, mostDrawnPosts);
        for (const auto& [number, reason] : composite.leftOut)
            leaveOut(*layers[number], reason);
        _model.notes.insert(_model.notes.end(), composite.notes.begin(), composite.notes.end());
        _tile = std::move(composite.tile);
    }

    /// Whether the layer that gives the map its grid has longitude and latitude.
    bool isInDegrees(const std::vector<DemLayer>& dems)
    {
        for (const DemLayer& dem : dems)
            if (const Result<DemInfo> info = describeDem(dem.path, dem.read))
                return angularCrs(info->frame.crs).has_value();
        return false;
    }

    /// Of _tile there are then corners only.
    void takePaged(CompositeRaster& large, const std::vector<const EarthLayer*>& layers)
    {
        for (const auto& [number, reason] : large.leftOut)
            leaveOut(*layers[number], reason);
        if (!large.source)
            return;
        auto heightAt = large.source->coarseHeights();
        if (!heightAt)
            return leaveOut(*layers[0], heightAt.error());
        _model.notes.insert(_model.notes.end(), large.notes.begin(), large.notes.end());
        if (_map.geocentric)
            if (Result<Globe> globe = Globe::under(*large.source, _source))
                _model.globe = std::move(*globe);
        _tile = large.source->cornersOf(0, large.source->terrain());
        LocalFrame frame = localFrameOf(*_tile);
        frame.heightAt = *heightAt;
        placeViewpoints(frame);
        _paged = std::move(large.source);
    }

    void addPagedTerrain()
    {
        if (const Status added =
                addPaged(_model, std::move(_paged), std::move(_draped), _map.light);
            !added)
            _model.warnings.push_back(_source + ": left out the terrain: " + added.error().message);
    }

    /// A file of a geoid's grid is relative to the map, or one of PROJ's own.
    VerticalDatum datumOf(const std::string& name) const
    {
        const std::string path = resolved(name, _folder);
        const bool isFile = name.find('.') != std::string::npos && osgDB::fileExists(path);
        VerticalDatum datum = verticalDatumByName(isFile ? path : name);
        datum.name = name;
        return datum;
    }

    /// Heights above another vertical datum than that of the map, which is that of the first layer
    /// where the map names none, are converted where PROJ can. That is said, or why not.
    void bringToOneDatum(std::vector<DemLayer>& dems, const std::vector<const EarthLayer*>& layers)
    {
        const auto called = [](const VerticalDatum& datum)
        {
            return datum.isNamed() ? "the vertical datum " + datum.name
                                   : std::string("a vertical datum that is not named");
        };
        VerticalDatum common = datumOf(_map.verticalDatum);
        std::string whose = "those of the map";
        bool areAllAlike = true, isFirst = true;
        for (std::size_t i = 0; i < dems.size(); ++i)
        {
            const Result<DemInfo> info = describeDem(dems[i].path, dems[i].read);
            if (!info)
                continue; // left out later
            const EarthLayer& layer = *layers[i];
            const VerticalDatum own = layer.verticalDatum.empty()
                                          ? verticalDatumOfCrs(info->frame.crs)
                                          : datumOf(layer.verticalDatum);
            if (isFirst && !common.isNamed())
            {
                common = own;
                whose = "those of " + layer.what;
            }
            isFirst = false;
            if (own.known == common.known)
                continue;
            areAllAlike = false;
            const std::string start = _source + ":" + std::to_string(layer.line) +
                                      ": the heights of " + layer.what + " are ";
            const Result<HeightShift> shift =
                own.isNamed() && common.isNamed()
                    ? HeightShift::between(own, common, info->frame)
                    : Result<HeightShift>(Error{ErrorCode::NotFound, "needs vdatum for both"});
            if (shift)
            {
                char range[64];
                std::snprintf(range, sizeof range, "%.2f ... %.2f m", shift->lowest(),
                              shift->highest());
                dems[i].read.shift = std::make_shared<HeightShift>(*shift);
                _model.notes.push_back(start + "converted from " + called(own) + " to " +
                                       called(common) + ", by " + range);
            }
            else
                _model.warnings.push_back(start + "above " + called(own) + ", " + whose +
                                          " above " + called(common) +
                                          "; they are not converted: " + shift.error().message);
        }
        if (areAllAlike && !isFirst && common.isNamed())
            _model.notes.push_back(_source + ": all heights are above " + called(common));
    }

    /// Over those before; where there is no elevation, the first one gives the terrain's extent.
    Status readImage(const EarthLayer& layer)
    {
        const Result<std::string> path = pathOf(layer);
        if (!path)
            return path.error();
        if (!_tile)
        {
            const Result<DemTile> level = levelTileUnder(*path);
            if (!level)
                return level.error();
            _tile = *level;
            _model.notes.push_back(_source + ": no elevation, so the terrain is level");
        }
        // Of paged terrain only what is wrong with it is asked here.
        constexpr int glimpse = 64;
        Result<ColourImage> colour =
            _paged ? readColour(*path, *_tile, glimpse) : readColour(*path, *_tile);
        if (!colour)
            return colour.error();
        if (_paged)
        {
            _draped.push_back({*path, layer.opacity});
            return Nothing{};
        }
        for (std::size_t alpha = 3; alpha < colour->pixels.size(); alpha += 4)
            colour->pixels[alpha] =
                static_cast<std::uint8_t>(std::lround(layer.opacity * colour->pixels[alpha]));
        _colours.push_back(std::move(*colour));
        return Nothing{};
    }

    void placeViewpoints(const LocalFrame& frame)
    {
        for (const EarthViewpoint& viewpoint : _map.viewpoints)
        {
            const std::string start = _source + ":" + std::to_string(viewpoint.line) + ": ";
            std::vector<std::string> notes;
            if (const Result<Viewpoint> placed = placeViewpoint(viewpoint, frame, notes))
                _model.viewpoints.push_back(_model.globe ? onGlobe(*placed, frame) : *placed);
            else
                _model.warnings.push_back(start + "left out " + viewpoint.what + ": " +
                                          placed.error().message);
            for (const std::string& note : notes)
                _model.notes.push_back(start + viewpoint.what + ": " + note);
        }
    }

    /// Its direction is that of the axes at its place. Its picture is level with the middle of the
    /// terrain.
    Viewpoint onGlobe(const Viewpoint& flat, const LocalFrame& frame) const
    {
        const double mapX = frame.mapX + flat.x / frame.metresPerX;
        const double mapY = frame.mapY + flat.y / frame.metresPerY;
        const osg::Vec3d place = _model.globe->at(mapX, mapY, flat.z);
        const double heading = osg::DegreesToRadians(flat.heading);
        const double pitch = osg::DegreesToRadians(flat.pitch);
        const osg::Vec3d ahead = osg::Matrixd::transform3x3(
            osg::Vec3d(std::sin(heading) * std::cos(pitch), std::cos(heading) * std::cos(pitch),
                       std::sin(pitch)),
            _model.globe->axesAt(mapX, mapY));
        Viewpoint bent = flat;
        bent.x = place.x();
        bent.y = place.y();
        bent.z = place.z();
        bent.heading = osg::RadiansToDegrees(std::atan2(ahead.x(), ahead.y()));
        bent.pitch = osg::RadiansToDegrees(std::atan2(ahead.z(), std::hypot(ahead.x(), ahead.y())));
        return bent;
    }

    /// Upright at its place, where there is a globe.
    osg::ref_ptr<osg::Node> onGlobe(osg::Node& flat, const ModelPlace& place,
                                    const LocalFrame& frame) const
    {
        if (!_model.globe)
            return &flat;
        const osg::ref_ptr<osg::MatrixTransform> bent =
            new osg::MatrixTransform(osg::Matrixd::translate(-place.x, -place.y, 0.0) *
                                     _model.globe->axesAt(frame.mapX + place.x / frame.metresPerX,
                                                          frame.mapY + place.y / frame.metresPerY));
        bent->addChild(&flat);
        return bent;
    }

    /// Of the terrain at full resolution, whatever is drawn of it.
    LocalFrame frameOfPosts()
    {
        LocalFrame frame = localFrameOf(*_tile);
        if (_paged)
            frame.heightAt = [this](double x, double y)
            {
                const Result<double> height = _paged->heightAt(x, y);
                if (!height)
                    _unread = height.error();
                return height ? *height : std::numeric_limits<double>::quiet_NaN();
            };
        return frame;
    }

    /// Those that can be read and have a place on the terrain.
    std::vector<osg::ref_ptr<osg::Node>> placeModels()
    {
        std::vector<osg::ref_ptr<osg::Node>> nodes;
        if (_map.models.empty() || !_tile)
            return nodes;
        const LocalFrame frame = frameOfPosts();
        ModelReader reader;
        for (const EarthModel& model : _map.models)
        {
            const std::string start = _source + ":" + std::to_string(model.line) + ": ";
            const auto leave = [&](const Error& reason)
            {
                _model.warnings.push_back(start + "left out " + model.what + ": " +
                                          explained(reason, model.url));
            };
            _unread.reset();
            const Result<ModelPlace> place = placeModel(model, frame);
            if (_unread || !place)
            {
                leave(_unread ? *_unread : place.error());
                continue;
            }
            const Result<osg::ref_ptr<osg::Node>> node = reader.read(resolved(model.url, _folder));
            if (!node)
            {
                leave(node.error());
                continue;
            }
            const osg::ref_ptr<osg::Node> placed = placedModel(model, *place, **node);
            nodes.push_back(onGlobe(*placed, *place, frame));
            if (model.minRange > 0.0)
                _model.notes.push_back(start + model.what +
                                       " takes no light from the ground, since its min_range is "
                                       "more than 0");
            const osg::BoundingSphere& bound = placed->getBound();
            const double top = double(bound.center().z()) + double(bound.radius());
            if (place->ground && top < *place->ground)
                _model.warnings.push_back(start + model.what + " is hidden, " +
                                          std::to_string(std::lround(*place->ground - top)) +
                                          " m below the ground; mode=\"relative\" counts its "
                                          "height from there");
        }
        return nodes;
    }

    const EarthMap& _map;
    const std::string _folder, _source;
    TerrainModel _model;
    std::string _leftOut;
    bool _isMissing = true;         ///< whatever was left out here
    std::vector<TileRaster> _tiles; ///< read as long as they are kept
    std::optional<DemTile> _tile;
    std::unique_ptr<OverviewSource> _paged; ///< null where the terrain is one tile
    std::optional<Error> _unread;           ///< why the last height was not read
    std::vector<DrapedColour> _draped;      ///< over paged terrain
    std::vector<ColourImage> _colours;
};
} // namespace

Result<TerrainModel> loadMap(const EarthMap& map, const std::string& folder,
                             const std::string& source)
{
    return MapLoader(map, folder, source).load();
}

} // namespace osgTerrainLight
