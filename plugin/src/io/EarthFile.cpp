#include "io/EarthFile.h"

#include "io/EarthLayers.h"
#include "io/EarthLight.h"
#include "io/EarthXml.h"
#include "io/InputFiles.h"
#include "io/ReadOption.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

namespace osgTerrainLight
{

namespace
{
/// Elements of a map that are no layer and draw nothing. Whatever else osgEarth finds in a map
/// is a layer, of dozens of kinds, or an extension that may draw.
bool drawsNothing(const std::string& tag)
{
    static const std::set<std::string> names = {"options", "libraries", "profile", "extensions",
                                                "name",    "type",      "version"};
    return names.count(tag) != 0;
}

/// Of layers that are read.
bool isDriver(const std::string& name)
{
    static const std::set<std::string> names = {"gdal", "mbtiles", "tms", "xyz", "composite"};
    return names.count(name) != 0;
}

/// Keys of <terrain_light> that place the sun.
bool setsSun(const std::string& key)
{
    return key == "sun_azimuth" || key == "sun_elevation" || key == "time";
}

/// One file being read.
class Parser
{
public:
    Parser(const std::string& text, const std::string& source) : _text(text), _xml(text, source) {}

    Result<EarthMap> parse()
    {
        pugi::xml_document document;
        const pugi::xml_parse_result parsed =
            document.load_buffer(_text.data(), _text.size(), pugi::parse_default);
        if (!parsed)
            return _xml.error(_xml.lineAt(static_cast<std::size_t>(parsed.offset)),
                              std::string("is no well-formed XML: ") + parsed.description());
        const pugi::xml_node root = document.document_element();
        if (lowerCase(root.name()) != "map" && lowerCase(root.name()) != "earth")
            return _xml.error(_xml.lineOf(root), std::string("the outermost element is <") +
                                                     root.name() + ">; needs <map>");

        _map.name = valueOf(root, "name");
        const std::string type = lowerCase(valueOf(root, "type"));
        _map.geocentric = type == "geocentric" || type == "round";
        for (const pugi::xml_node& element : root.children())
        {
            if (element.type() != pugi::node_element)
                continue;
            Status read = readElement(element);
            if (!read)
                return read.error();
        }
        followSky();
        beginAtHome();
        if (_map.elevations.empty() && _map.images.empty())
            return _xml.error(_xml.lineOf(root),
                              "holds no layer that can be drawn" +
                                  (_map.leftOut.empty() ? "" : ", left out: " + _map.leftOut) +
                                  "; needs <elevation driver=\"gdal\"> or "
                                  "<image driver=\"gdal\"> with a url");
        if (!_missed.empty())
            _map.warnings.push_back(_xml.source() + ": left out: " + _missed);
        if (!_skipped.empty())
            _map.notes.push_back(_xml.source() + ": skipped: " + _skipped);
        return _map;
    }

private:
    std::string lineText(const pugi::xml_node& node) const
    {
        return "line " + std::to_string(_xml.lineOf(node));
    }
    /// isMissed: somebody may look for it in the picture.
    void leaveOut(const pugi::xml_node& element, const std::string& what, const std::string& why,
                  bool isMissed)
    {
        const std::string item = what + " (" + lineText(element) + ": " + why + ")";
        append(_map.leftOut, item);
        append(isMissed ? _missed : _skipped, item);
    }

    Status readElement(const pugi::xml_node& element)
    {
        const std::string tag = lowerCase(element.name());
        if (tag == "terrain_light")
        {
            for (const std::string& key : keysOf(element))
                _hasSun = _hasSun || setsSun(lowerCase(key));
            const Status read = readTerrainLight(_xml, element, _map.light);
            _map.light.skyFile = withSlashes(_map.light.skyFile);
            return read;
        }
        if (readPart(element))
            return Nothing{};
        if (tag == "options" || tag == "extensions" || tag == "external")
        {
            readParts(element);
            return Nothing{};
        }
        if (isModel(element))
        {
            readModelLayer(element);
            return Nothing{};
        }
        return readLayer(element, nullptr);
    }

    /// Those of other drivers make models of features.
    static bool isModel(const pugi::xml_node& element)
    {
        const std::string tag = lowerCase(element.name());
        const std::string driver = lowerCase(valueOf(element, "driver"));
        return (tag == "model" || tag == "modellayer") && (driver.empty() || driver == "simple");
    }

    void readModelLayer(const pugi::xml_node& element)
    {
        const std::string what = whatOf(element);
        if (isSwitchedOff(element, what))
            return;
        Result<EarthModel> model = readModel(element);
        if (!model)
            return leaveOut(element, what, model.error().message, true);
        const std::size_t scheme = model->url.find("://"); // one letter is a drive
        const bool isRemote = scheme != std::string::npos && scheme > 1;
        if (model->url.empty() || isRemote)
            return leaveOut(element, what,
                            isRemote ? "its model is on a network; needs a file" : "has no url",
                            true);
        model->what = what;
        model->line = _xml.lineOf(element);
        if (!model->unread.empty())
            append(_skipped, "keys of " + what + " (" + lineText(element) +
                                 ": not read here: " + model->unread + ")");
        _map.models.push_back(std::move(*model));
    }

    /// Models of the annotations; labels, icons and shapes are not drawn.
    void readAnnotations(const pugi::xml_node& element)
    {
        if (isSwitchedOff(element, whatOf(element)))
            return;
        for (const pugi::xml_node& child : element.children())
            if (isModel(child))
                readModelLayer(child);
            else if (child.type() == pugi::node_element && lowerCase(child.name()) != "name")
                leaveOut(child, whatOf(child), "of a kind that is not known here", true);
    }

    /// Parts that osgEarth 3 has in the map itself, and osgEarth 2 in others. False where it is
    /// none.
    bool readPart(const pugi::xml_node& element)
    {
        const std::string tag = lowerCase(element.name());
        if (tag == "viewpoints")
            readViewpoints(element);
        else if (tag == "annotations")
            readAnnotations(element);
        else if (tag == "sky")
            readSky(element);
        else if (tag == "profile" && !valueOf(element, "vdatum").empty())
        {
            _map.verticalDatum = datumName(valueOf(element, "vdatum"));
            nameUnread(element, whatOf(element), {"vdatum"});
        }
        else
            return false;
        return true;
    }

    void readParts(const pugi::xml_node& element)
    {
        bool hasParts = false;
        bool hasOthers = false;
        for (const pugi::xml_node& child : element.children())
            if (child.type() == pugi::node_element)
                (readPart(child) ? hasParts : hasOthers) = true;
        if (hasOthers || !hasParts)
            leaveOut(element, whatOf(element),
                     hasParts ? "only its sky, viewpoints, annotations and vertical datum are read"
                              : "of a kind that is not known here",
                     !drawsNothing(lowerCase(element.name())));
    }

    void readSky(const pugi::xml_node& element)
    {
        const std::string what = whatOf(element);
        if (isSwitchedOff(element, what))
            return;
        const Result<std::optional<UtcTime>> time = readSkyTime(element);
        if (!time)
            warnOf(element, time.error());
        else if (!*time)
            leaveOut(element, what, "has neither hours nor date_time", false);
        else
        {
            _sky = {element, **time};
            nameUnread(element, what, {skyKeys.begin(), skyKeys.end()});
        }
    }

    /// The sun by the time of <sky>, where <terrain_light> has none.
    void followSky()
    {
        if (!_sky)
            return;
        const auto& [element, time] = *_sky;
        if (_hasSun || !_map.light.skyFile.empty())
            append(_skipped, whatOf(element) + " (" + lineText(element) +
                                 ": the sun is that of <terrain_light>)");
        else
            _map.light.time = time;
    }

    void warnOf(const pugi::xml_node& element, const Error& reason)
    {
        _map.warnings.push_back(
            _xml.error(_xml.lineOf(element), "left out " + whatOf(element) + ": " + reason.message)
                .message);
    }

    bool isSwitchedOff(const pugi::xml_node& element, const std::string& what)
    {
        const std::string off = switchOf(element);
        if (!off.empty())
            leaveOut(element, what, off, false);
        return !off.empty();
    }

    void readViewpoints(const pugi::xml_node& element)
    {
        for (const pugi::xml_node& child : element.children())
        {
            if (lowerCase(child.name()) != "viewpoint")
                continue;
            const std::string what = whatOf(child);
            if (Result<EarthViewpoint> viewpoint = readViewpoint(child))
            {
                viewpoint->what = what;
                viewpoint->line = _xml.lineOf(child);
                _map.viewpoints.push_back(*viewpoint);
                nameUnread(child, what, {viewpointKeys.begin(), viewpointKeys.end()});
            }
            else
                warnOf(child, viewpoint.error());
        }
        nameUnread(element, whatOf(element), {"viewpoint", "home"});
        if (const std::string home = valueOf(element, "home"); !home.empty())
            _home = {element, home};
    }

    /// The home is the viewpoint that the key names, else the one that is called so, else the
    /// first. The others follow it in their order, around.
    void beginAtHome()
    {
        const auto find = [this](const std::string& name)
        {
            return std::find_if(_map.viewpoints.begin(), _map.viewpoints.end(),
                                [&name](const EarthViewpoint& viewpoint)
                                { return lowerCase(viewpoint.name) == lowerCase(name); });
        };
        auto home = find(_home ? _home->second : "home");
        if (_home && home == _map.viewpoints.end())
        {
            _map.warnings.push_back(_xml.error(_xml.lineOf(_home->first),
                                               whatOf(_home->first) + " home = \"" + _home->second +
                                                   "\": needs the name of a <viewpoint>")
                                        .message);
            home = find("home");
        }
        if (home != _map.viewpoints.end())
            std::rotate(_map.viewpoints.begin(), home, _map.viewpoints.end());
    }

    /// As messages call it.
    static std::string whatOf(const pugi::xml_node& element)
    {
        std::string what = std::string("<") + element.name();
        for (const char* key : {"driver", "name"})
            if (const std::string value = valueOf(element, key); !value.empty())
                what += std::string(" ") + key + "=\"" + value + "\"";
        return what + ">";
    }

    /// What a layer may be a part of.
    struct Composite
    {
        LayerKind kind;
        double opacity;
        int depth; ///< in other composites
    };

    /// composite: null where it is a part of none.
    Status readLayer(const pugi::xml_node& element, const Composite* composite)
    {
        const std::string what = whatOf(element);
        if (isSwitchedOff(element, what))
            return Nothing{};
        const std::optional<LayerKind> kind = layerKindOf(element);
        if (!kind || !isDriver(kind->driver))
        {
            leaveOut(element, what, "of a kind that is not known here",
                     composite || !drawsNothing(lowerCase(element.name())));
            return Nothing{};
        }
        if (composite && composite->kind.isElevation != kind->isElevation)
        {
            leaveOut(element, what,
                     composite->kind.isElevation ? "a part of a composite of elevations"
                                                 : "a part of a composite of images",
                     true);
            return Nothing{};
        }
        const Result<double> opacity = kind->isElevation ? 1.0 : opacityOf(element);
        if (!opacity)
            return _xml.error(_xml.lineOf(element),
                              "<" + std::string(element.name()) + "> " + opacity.error().message);
        const Composite here{*kind, *opacity * (composite ? composite->opacity : 1.0),
                             composite ? composite->depth + 1 : 0};
        return kind->driver == "composite" ? readComposite(element, what, here)
                                           : readRaster(element, what, here);
    }

    Status readComposite(const pugi::xml_node& element, const std::string& what,
                         const Composite& composite)
    {
        constexpr int deepest = 16; // far more than people write, and no danger to the stack
        const std::vector<pugi::xml_node> parts = partsOf(element);
        if (parts.empty() || composite.depth == deepest)
        {
            leaveOut(element, what,
                     parts.empty() ? "has no layers" : "lies too deep in other composites", true);
            return Nothing{};
        }
        std::vector<std::string> read = {"layers"};
        for (const pugi::xml_node& part : parts)
        {
            if (Status status = readLayer(part, &composite); !status)
                return status;
            read.push_back(lowerCase(part.name()));
        }
        if (!composite.kind.isElevation)
            read.push_back("opacity");
        nameUnread(element, what, read);
        return Nothing{};
    }

    Status readRaster(const pugi::xml_node& element, const std::string& what, const Composite& kind)
    {
        EarthLayer layer;
        layer.what = what;
        for (const char* key : {"url", "filename"}) // the second of osgEarth's MBTiles
            if (layer.url.empty())
                layer.url = withSlashes(valueOf(element, key));
        layer.line = _xml.lineOf(element);
        layer.opacity = kind.opacity;
        layer.driver = kind.kind.driver;
        std::vector<std::string> read = {"url", "filename"};
        if (kind.kind.isElevation)
        {
            layer.verticalDatum = verticalDatumOf(element);
            read.push_back("vdatum");
            read.insert(read.end(), std::begin(readOptionNames), std::end(readOptionNames));
            for (const char* key : readOptionNames)
                if (const std::string value = valueOf(element, key); !value.empty())
                    if (const Status set = setReadOption(layer.read, key, value); !set)
                        return _xml.error(layer.line, "<" + std::string(element.name()) + "> " +
                                                          set.error().message);
        }
        else
            read.push_back("opacity");
        const bool isPyramid = layer.driver == "tms" || layer.driver == "xyz";
        if (layer.driver == "xyz")
        {
            layer.profile = lowerCase(valueOf(element, "profile"));
            layer.fromSouth = isYes(valueOf(element, "invert_y"));
            read.insert(read.end(), {"profile", "invert_y"});
        }
        const bool isRemote = isPyramid && layer.url.find("://") != std::string::npos;
        if (layer.url.empty() || isRemote)
        {
            leaveOut(element, what,
                     isRemote ? "its tiles are on a network; needs a folder" : "has no url", true);
            return Nothing{};
        }
        (kind.kind.isElevation ? _map.elevations : _map.images).push_back(layer);
        nameUnread(element, what, read);
        return Nothing{};
    }

    /// Keys of a layer that other readers of the format know, such as min_level and profile. read:
    /// those that are read here, but for those of all layers.
    void nameUnread(const pugi::xml_node& element, const std::string& what,
                    const std::vector<std::string>& read)
    {
        static const std::set<std::string> ofAll = {"name", "driver", "open", "enabled", "visible"};
        std::string unread;
        for (const std::string& key : keysOf(element))
            if (const std::string lower = lowerCase(key);
                ofAll.count(lower) == 0 && std::find(read.begin(), read.end(), lower) == read.end())
                append(unread, key);
        if (!unread.empty())
            append(_skipped, "keys of " + what + " (" + lineText(element) +
                                 ": not read here: " + unread + ")");
    }

    const std::string& _text;
    EarthXml _xml;
    EarthMap _map;
    bool _hasSun = false; ///< of <terrain_light>
    std::optional<std::pair<pugi::xml_node, UtcTime>> _sky;
    std::optional<std::pair<pugi::xml_node, std::string>> _home; ///< of <viewpoints>
    std::string _missed, _skipped; ///< what EarthMap::leftOut holds, in two parts
};
} // namespace

Result<EarthMap> parseEarth(const std::string& text, const std::string& source)
{
    return Parser(text, source).parse();
}

Result<EarthMap> readEarthFile(const std::string& path)
{
    if (const std::string wrong = complaintOfFile(path); !wrong.empty())
        return Error{ErrorCode::Invalid, path + ": " + wrong};
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (file.bad() || !file.is_open())
        return Error{ErrorCode::NotFound, path + ": cannot be read"};
    return parseEarth(text, path);
}

} // namespace osgTerrainLight
