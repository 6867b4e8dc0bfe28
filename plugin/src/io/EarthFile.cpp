#include "io/EarthFile.h"

#include "io/InputFiles.h"
#include "io/ReadOption.h"

#include <pugixml.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

namespace osgTerrainLight
{

namespace
{
/// One file being read: the text is kept for line numbers, which pugixml does not count.
class Parser
{
public:
    Parser(const std::string& text, const std::string& source) : _text(text), _source(source) {}

    Result<EarthMap> parse()
    {
        pugi::xml_document document;
        const pugi::xml_parse_result parsed =
            document.load_buffer(_text.data(), _text.size(), pugi::parse_default);
        if (!parsed)
            return error(lineAt(static_cast<std::size_t>(parsed.offset)),
                         std::string("is no well-formed XML: ") + parsed.description());
        const pugi::xml_node root = document.document_element();
        if (lower(root.name()) != "map" && lower(root.name()) != "earth")
            return error(lineOf(root), std::string("the outermost element is <") + root.name() +
                                           ">; needs <map>");

        _map.name = valueOf(root, "name");
        for (const pugi::xml_node& element : root.children())
        {
            if (element.type() != pugi::node_element)
                continue;
            Status read = readElement(element);
            if (!read)
                return read.error();
        }
        if (_map.elevations.empty() && _map.images.empty())
            return error(lineOf(root),
                         "holds no layer that can be drawn" +
                             (_map.leftOut.empty() ? "" : ", left out: " + _map.leftOut) +
                             "; needs <elevation driver=\"gdal\"> or "
                             "<image driver=\"gdal\"> with a url");
        if (!_missed.empty())
            _map.warnings.push_back(_source + ": left out: " + _missed);
        if (!_skipped.empty())
            _map.notes.push_back(_source + ": skipped: " + _skipped);
        return _map;
    }

private:
    int lineAt(std::size_t offset) const
    {
        const std::size_t end = std::min(offset, _text.size());
        return 1 + static_cast<int>(std::count(
                       _text.begin(), _text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
    }
    int lineOf(const pugi::xml_node& node) const
    {
        return lineAt(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, node.offset_debug())));
    }
    /// Line of an attribute, which may stand below its element's name.
    int lineOf(const pugi::xml_node& node, const std::string& attribute) const
    {
        const std::size_t start = static_cast<std::size_t>(node.offset_debug());
        const std::size_t found = _text.find(attribute, start + std::string(node.name()).size());
        return lineAt(std::min(found, _text.size()));
    }
    Error error(int line, const std::string& sentence) const
    {
        return {ErrorCode::Invalid, _source + ":" + std::to_string(line) + ": " + sentence};
    }
    static void append(std::string& list, const std::string& item)
    {
        list += (list.empty() ? "" : ", ") + item;
    }
    /// isMissed: somebody may look for it in the picture.
    void leaveOut(const pugi::xml_node& element, const std::string& what, const std::string& why,
                  bool isMissed)
    {
        const std::string item =
            what + " (line " + std::to_string(lineOf(element)) + ": " + why + ")";
        append(_map.leftOut, item);
        append(isMissed ? _missed : _skipped, item);
    }

    /// osgEarth takes names of elements and keys in any case.
    static std::string lower(std::string text)
    {
        for (char& c : text)
            c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        return text;
    }

    /// Without blanks at its ends.
    static std::string trimmed(const std::string& text)
    {
        const char* blanks = " \t\r\n";
        const std::size_t first = text.find_first_not_of(blanks);
        if (first == std::string::npos)
            return {};
        return text.substr(first, text.find_last_not_of(blanks) + 1 - first);
    }

    /// The value of a key (lower case), which osgEarth lets stand as an attribute or as a child.
    static std::string valueOf(const pugi::xml_node& element, const char* key)
    {
        for (const pugi::xml_attribute& attribute : element.attributes())
            if (const std::string value = trimmed(attribute.value());
                lower(attribute.name()) == key && !value.empty())
                return value;
        for (const pugi::xml_node& child : element.children())
            if (const std::string value = trimmed(child.text().get());
                lower(child.name()) == key && !value.empty())
                return value;
        return {};
    }

    /// Elements of a map that are no layer and draw nothing. Whatever else osgEarth finds in a map
    /// is a layer, of dozens of kinds, or an extension that may draw.
    static bool drawsNothing(const std::string& tag)
    {
        static const std::set<std::string> names = {"options",    "libraries",  "profile",
                                                    "viewpoints", "extensions", "name",
                                                    "type",       "version"};
        return names.count(tag) != 0;
    }

    /// As osgEarth reads a flag: these words, in any case, are no; the rest leaves the layer in.
    static bool isNo(const std::string& value)
    {
        const std::string word = lower(value);
        return word == "false" || word == "no" || word == "off";
    }

    Status readElement(const pugi::xml_node& element)
    {
        const std::string tag = lower(element.name());
        if (tag == "terrain_light")
            return readLight(element);
        const std::string driver = valueOf(element, "driver");
        const bool isGdal = lower(driver) == "gdal";
        const bool elevation =
            tag == "gdalelevation" || ((tag == "elevation" || tag == "heightfield") && isGdal);
        const bool image = tag == "gdalimage" || (tag == "image" && isGdal);
        const std::string name = valueOf(element, "name");
        const std::string what = std::string("<") + element.name() +
                                 (driver.empty() ? "" : " driver=\"" + driver + "\"") +
                                 (name.empty() ? "" : " name=\"" + name + "\"") + ">";
        for (const char* key : {"open", "enabled", "visible"})
            if (isNo(valueOf(element, key)))
            {
                leaveOut(element, what, std::string(key) + " is " + valueOf(element, key), false);
                return Nothing{};
            }
        if (!elevation && !image)
        {
            leaveOut(element, what, "of a kind that is not known here", !drawsNothing(tag));
            return Nothing{};
        }
        EarthLayer layer{what, valueOf(element, "url"), lineOf(element), {}};
        for (const char* key : readOptionNames)
            if (const std::string value = valueOf(element, key); elevation && !value.empty())
                if (const Status set = setReadOption(layer.read, key, value); !set)
                    return error(layer.line,
                                 "<" + std::string(element.name()) + "> " + set.error().message);
        if (layer.url.empty())
        {
            leaveOut(element, what, "has no url", true);
            return Nothing{};
        }
        (elevation ? _map.elevations : _map.images).push_back(layer);
        nameUnread(element, what, elevation);
        return Nothing{};
    }

    /// Keys of a layer that other readers of the format know, such as vdatum and opacity.
    void nameUnread(const pugi::xml_node& element, const std::string& what, bool elevation)
    {
        std::vector<std::string> read = {"name", "driver", "url", "open", "enabled", "visible"};
        if (elevation)
            read.insert(read.end(), std::begin(readOptionNames), std::end(readOptionNames));
        std::vector<std::string> keys;
        for (const pugi::xml_attribute& attribute : element.attributes())
            keys.emplace_back(attribute.name());
        for (const pugi::xml_node& child : element.children())
            if (child.type() == pugi::node_element)
                keys.emplace_back(child.name());
        std::string unread;
        for (const std::string& key : keys)
            if (std::find(read.begin(), read.end(), lower(key)) == read.end())
                append(unread, key);
        if (!unread.empty())
            append(_skipped, "keys of " + what + " (line " + std::to_string(lineOf(element)) +
                                 ": not read here: " + unread + ")");
    }

    Status readLight(const pugi::xml_node& element)
    {
        for (const pugi::xml_attribute& attribute : element.attributes())
        {
            Status set = setLightParameter(_map.light, lower(attribute.name()), attribute.value());
            if (!set)
                return error(lineOf(element, attribute.name()),
                             "<terrain_light> " + set.error().message);
        }
        for (const pugi::xml_node& child : element.children())
        {
            if (child.type() != pugi::node_element)
                continue;
            const bool key = lower(child.name()) == "key_light";
            if (Status read = key ? readKeyLight(child) : Status(Nothing{}); !read)
                return read;
            if (key)
                continue;
            Status set =
                setLightParameter(_map.light, lower(child.name()), trimmed(child.text().get()));
            if (!set)
                return error(lineOf(child), "<terrain_light> " + set.error().message);
        }
        return Nothing{};
    }

    Status readKeyLight(const pugi::xml_node& element)
    {
        KeyLight key;
        for (const pugi::xml_attribute& attribute : element.attributes())
            if (Status set = setKeyLight(key, lower(attribute.name()), attribute.value()); !set)
                return error(lineOf(element, attribute.name()),
                             "<key_light> " + set.error().message);
        for (const pugi::xml_node& child : element.children())
        {
            if (child.type() != pugi::node_element)
                continue;
            if (Status set = setKeyLight(key, lower(child.name()), trimmed(child.text().get()));
                !set)
                return error(lineOf(child), "<key_light> " + set.error().message);
        }
        _map.light.sky.keyLights.push_back(key);
        if (const std::string wrong = complaint(_map.light.sky); !wrong.empty())
            return error(lineOf(element), "<key_light> " + wrong);
        return Nothing{};
    }

    const std::string& _text;
    const std::string& _source;
    EarthMap _map;
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
