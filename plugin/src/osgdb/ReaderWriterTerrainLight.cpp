#include "osgdb/Register.h"

#include "io/EarthFile.h"
#include "io/LightParameters.h"
#include "io/ReadOption.h"
#include "osgdb/LostLight.h"
#include "scene/SkyDome.h"
#include "terrain/TerrainModel.h"
#include "viewer/FirstView.h"
#include <osgTerrainLight/LightingHandler.h>
#include <osgTerrainLight/TerrainLighting.h>

#include <osg/Notify>
#include <osgDB/FileNameUtils>
#include <osgDB/FileUtils>
#include <osgDB/ReadFile>
#include <osgDB/Registry>

#include <algorithm>
#include <exception>
#include <iterator>
#include <new>
#include <optional>
#include <sstream>

namespace osgTerrainLight
{

namespace
{
/// What stands in the option string, as name=value.
struct ReaderOptions
{
    LightParameters light;
    DemReadOptions read;
    bool geocentric = false;
    std::string word; ///< the first that is no name=value: another plugin's, if anyone's
};

Status setOption(ReaderOptions& options, const std::string& name, const std::string& value)
{
    if (name == "geocentric")
    {
        if (value != "0" && value != "1")
            return Error{ErrorCode::Invalid, "geocentric = \"" + value + "\": needs 0 or 1"};
        options.geocentric = value == "1";
        return Nothing{};
    }
    const bool ofReading =
        std::find(readOptionNames.begin(), readOptionNames.end(), name) != readOptionNames.end();
    return ofReading ? setReadOption(options.read, name, value)
                     : setLightParameter(options.light, name, value);
}

/// start: what the options change.
Result<ReaderOptions> parseOptions(const osgDB::Options* given, const LightParameters& start = {})
{
    ReaderOptions options;
    options.light = start;
    if (const auto* asked =
            given ? static_cast<const GivenLight*>(given->getPluginData(GivenLight::pluginData))
                  : nullptr)
    {
        for (const auto& change : asked->changes)
            change(options.light);
        options.read = asked->read;
        options.geocentric = asked->geocentric;
    }
    std::istringstream words(given ? given->getOptionString() : "");
    std::string word;
    while (words >> word)
    {
        const std::size_t equals = word.find('=');
        if (equals == std::string::npos)
        {
            if (options.word.empty())
                options.word = word;
            continue;
        }
        const Status set = setOption(options, word.substr(0, equals), word.substr(equals + 1));
        if (!set)
            return Error{set.error().code, "reader option " + set.error().message};
    }
    return options;
}

osg::ref_ptr<osgDB::Options> optionsAt(const osgDB::Options* given, const std::string& folder)
{
    osg::ref_ptr<osgDB::Options> options = given ? given->cloneOptions() : new osgDB::Options;
    if (!folder.empty())
        options->getDatabasePathList().push_front(folder);
    return options;
}
} // namespace

class ReaderWriterTerrainLight : public osgDB::ReaderWriter
{
public:
    ReaderWriterTerrainLight()
    {
        supportsExtension("terrainlight", "lights what the name before it is: DEM, scene or map");
        supportsExtension("earth", "map of GDAL layers, lit");
        for (const LightKey& key : lightKeys())
            supportsOption(key.key() + "=VALUE", key.meaning + " Needs " + key.needs() + ".");
        supportsOption("cell_size=METRES", "between posts of a raster without geotransform");
        supportsOption("unit=NAME", "of heights, instead of what the raster says");
        supportsOption("z_factor=NUMBER", "that heights are multiplied by");
        supportsOption("geocentric=1", "terrain in longitude and latitude lies on its ellipsoid");
    }

    const char* className() const override { return "Terrain lighting reader"; }

    ReadResult readObject(const std::string& name, const osgDB::Options* options) const override
    {
        return readNode(name, options);
    }

    ReadResult readNode(const std::string& name, const osgDB::Options* options) const override
    {
        return guarded(name, [&] { return readFile(name, options); });
    }

    /// The text of an .earth file.
    ReadResult readNode(std::istream& stream, const osgDB::Options* options) const override
    {
        return guarded("map",
                       [&]
                       {
                           const std::string text{std::istreambuf_iterator<char>(stream),
                                                  std::istreambuf_iterator<char>()};
                           const bool hasFolder =
                               options && !options->getDatabasePathList().empty();
                           return made(parseEarth(text, "map"),
                                       hasFolder ? options->getDatabasePathList().front() : "",
                                       "map", options);
                       });
    }

private:
    /// Nothing is thrown through the plugin's border: neither a want of memory nor what another
    /// plugin throws.
    template <class Read>
    static ReadResult guarded(const std::string& name, const Read& read)
    {
        try
        {
            return read();
        }
        catch (const std::bad_alloc&)
        {
            return failed(name + ": not enough memory");
        }
        catch (const std::exception& error)
        {
            return failed(name + ": cannot be read: " + error.what());
        }
    }

    ReadResult readFile(const std::string& name, const osgDB::Options* options) const
    {
        const std::string extension = osgDB::getLowerCaseFileExtension(name);
        if (!acceptsExtension(extension))
            return ReadResult::FILE_NOT_HANDLED;
        const std::string inner =
            extension == "terrainlight" ? osgDB::getNameLessExtension(name) : name;
        if (inner.empty())
            return ReadResult::FILE_NOT_HANDLED;
        const bool isMap = osgDB::getLowerCaseFileExtension(inner) == "earth";
        std::string path = osgDB::findDataFile(inner, options);
        if (path.empty() && inner.compare(0, 4, "/vsi") == 0)
            path = inner; // GDAL's own file systems
        if (isMap)
            return path.empty() ? ReadResult(ReadResult::FILE_NOT_FOUND) : readMap(path, options);
        return readTerrainOrScene(path.empty() ? inner : path, !path.empty(), options);
    }

    static ReadResult failed(const std::string& sentence)
    {
        return ReadResult(sentence); // an error with its message, which osgDB prints
    }

    static ReadResult readMap(const std::string& path, const osgDB::Options* options)
    {
        return made(readEarthFile(path), osgDB::getFilePath(path), path, options);
    }

    static ReadResult made(Result<EarthMap> map, const std::string& folder,
                           const std::string& source, const osgDB::Options* given)
    {
        if (!map)
            return failed(map.error().message);
        const Result<ReaderOptions> options = parseOptions(given, map->light);
        if (!options)
            return failed(source + ": " + options.error().message);
        if (!options->word.empty())
            return failed(source + ": reader option " + options->word + ": needs NAME=VALUE");
        map->light = options->light;
        map->geocentric = map->geocentric || options->geocentric;
        const Result<TerrainModel> model = loadMap(*map, folder, source);
        return model ? shown(*model) : failed(model.error().message);
    }

    static ReadResult readTerrainOrScene(const std::string& path, bool exists,
                                         const osgDB::Options* given)
    {
        const Result<ReaderOptions> options = parseOptions(given);
        if (!options)
            return failed(path + ": " + options.error().message);
        Error reason;
        if (exists)
        {
            const Result<TerrainModel> model =
                loadRaster(path, options->read, options->light, options->geocentric);
            if (model && !options->word.empty())
                return failed(path + ": reader option " + options->word + ": needs NAME=VALUE");
            if (model)
                return shown(*model);
            reason = model.error();
        }
        // No raster: perhaps a scene, or a name that another pseudo-loader takes apart.
        ReadResult scene =
            osgDB::Registry::instance()->readNode(path, optionsAt(given, osgDB::getFilePath(path)));
        if (scene.validNode())
        {
            if (options->geocentric)
                return failed(path + ": geocentric = 1: needs a raster or a map, and this is a "
                                     "scene, which has its place already");
            TerrainModel model;
            model.node = createLighting(options->light, "", model.warnings);
            if (const Status set = setTimeAndPlace(*model.node, options->light, std::nullopt); !set)
                return failed(path + ": " + set.error().message);
            model.node->addChild(scene.getNode());
            return shown(model);
        }
        if (!exists)
            return ReadResult::FILE_NOT_FOUND;
        return failed(scene.status() == ReadResult::ERROR_IN_READING_FILE
                          ? path + ": " + scene.message()
                          : reason.message);
    }

    static ReadResult shown(const TerrainModel& model)
    {
        for (const std::string& warning : model.warnings)
            OSG_WARN << "osgTerrainLight: " << warning << std::endl;
        for (const std::string& note : model.notes)
            OSG_NOTICE << "osgTerrainLight: " << note << std::endl;
        const osg::ref_ptr<LightingHandler> keys = new LightingHandler;
        keys->setViewpoints(model.viewpoints);
        model.node->addEventCallback(keys);
        // Terrain of ours: the scene of somebody else has a view and a sky of its own.
        if (model.terrain.valid())
        {
            model.node->addEventCallback(new FirstView(
                model.terrain, model.viewpoints.empty()
                                   ? std::optional<Viewpoint>()
                                   : std::optional<Viewpoint>(model.viewpoints.front())));
            // Seen from space there is no sky around the camera.
            if (!model.globe || model.terrain.radius() < 0.1 * model.globe->radius())
                addSkyDome(*model.node);
        }
        return model.globe ? ReadResult(model.globe->around(*model.node).get())
                           : ReadResult(model.node.get());
    }
};

void registerReader()
{
    static const osgDB::RegisterReaderWriterProxy<ReaderWriterTerrainLight> proxy;
    warnOfLostLight();
}

} // namespace osgTerrainLight
