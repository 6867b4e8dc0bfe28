#include "io/EarthModel.h"

#include "io/EarthXml.h"

#include <algorithm>
#include <initializer_list>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace osgTerrainLight
{
namespace
{
using Keys = std::set<std::string>;

const KeyNeed anyAngle{degreesOf, -720.0, 720.0, "degrees, -720 ... 720"};
const KeyNeed anyHeight{metresOf, -1.0e7, 1.0e9, "a height in metres, or with a unit"};
const KeyNeed anyRange{metresOf, 0.0, 1.0e30, "a length of 0 or more, in metres or with a unit"};
const KeyNeed anyScale{numberOf, 1.0e-6, 1.0e6, "a number, 1e-6 ... 1e6, or three"};

const Keys placeKeys = {"long", "lon", "longitude", "x", "lat", "latitude",
                        "y",    "srs", "alt",       "z", "hat", "mode"};
const Keys scaleKeys = {"x", "y", "z"};

/// Numbers that stand in one text, separated by blanks or commas.
std::vector<std::string> partsOf(const std::string& text)
{
    std::vector<std::string> parts;
    std::string part;
    for (const char c : text + " ")
        if (std::string(" \t\r\n,;").find(c) == std::string::npos)
            part += c;
        else if (!part.empty())
            parts.push_back(std::exchange(part, std::string()));
    return parts;
}

/// The child of one of these names (lower case); null where there is none.
pugi::xml_node childOf(const pugi::xml_node& element, std::initializer_list<const char*> names)
{
    for (const char* name : names)
        for (const pugi::xml_node& child : element.children())
            if (child.type() == pugi::node_element && lowerCase(child.name()) == name)
                return child;
    return {};
}

bool hasAny(const pugi::xml_node& element, const Keys& keys)
{
    const std::vector<std::string> all = keysOf(element);
    return std::any_of(all.begin(), all.end(),
                       [&](const std::string& key) { return keys.count(lowerCase(key)) != 0; });
}

/// Adds the keys of an element that are not among `read`.
void addUnread(const pugi::xml_node& element, const Keys& read, const std::string& prefix,
               std::string& unread)
{
    for (const std::string& key : keysOf(element))
        if (read.count(lowerCase(key)) == 0)
            append(unread, prefix + key);
}

/// Whether the place's height is absolute: by mode, else as osgEarth takes its keys. An absolute
/// height of 0, without mode, is one that somebody has left at that.
Status readMode(const std::string& mode, bool isByKey, EarthModel& model)
{
    const std::string word = lowerCase(mode);
    if (word.empty())
        model.isAbsolute = isByKey && model.height != 0.0;
    else if (word == "absolute")
        model.isAbsolute = true;
    else if (word == "relative" || word == "relative_to_terrain")
        model.isAbsolute = false;
    else
        return Error{ErrorCode::Invalid,
                     "mode = \"" + mode + "\": needs relative, relative_to_terrain or absolute"};
    return Nothing{};
}

/// <location>x y z</location>, of osgEarth 2.
Status readPlaceText(const std::string& text, EarthModel& model, bool& hasHeight)
{
    const std::vector<std::string> parts = partsOf(text);
    const Error wrong{ErrorCode::Invalid,
                      "location = \"" + text + "\": needs long and lat, or two or three numbers"};
    if (parts.size() != 2 && parts.size() != 3)
        return wrong;
    std::vector<double> numbers;
    for (const std::string& part : parts)
    {
        const std::optional<double> number = numberOf(part);
        if (!number || !(*number >= -1.0e9 && *number <= 1.0e9))
            return wrong;
        numbers.push_back(*number);
    }
    model.place = {numbers[0], numbers[1], true};
    hasHeight = numbers.size() == 3;
    if (hasHeight)
        model.height = numbers[2];
    return Nothing{};
}

/// From a child of its own, or from keys of the model itself.
Status readPlace(const pugi::xml_node& element, EarthModel& model)
{
    const pugi::xml_node child = childOf(element, {"location", "position", "place"});
    const bool isOwn = child && hasAny(child, placeKeys);
    const pugi::xml_node place = isOwn ? child : element;
    std::string text;
    for (const char* key : {"location", "position", "place"})
        if (text.empty())
            text = valueOf(element, key);
    bool hasHeight = false;
    if (!isOwn && !text.empty())
    {
        if (const Status read = readPlaceText(text, model, hasHeight); !read)
            return read;
    }
    else
    {
        const Result<EarthPoint> point = readPoint(place, true);
        if (!point)
            return point.error();
        model.place = *point;
    }
    const Result<bool> isHat = readKey(place, {"hat"}, anyHeight, model.height);
    if (!isHat)
        return isHat.error();
    if (!*isHat && !hasHeight)
    {
        const Result<bool> read = readKey(place, {"alt", "z"}, anyHeight, model.height);
        if (!read)
            return read.error();
        hasHeight = *read;
    }
    if (isOwn)
        addUnread(child, placeKeys, "location ", model.unread);
    std::string mode = valueOf(place, "mode");
    if (mode.empty())
        mode = valueOf(element, "mode");
    return readMode(mode, hasHeight && !*isHat, model);
}

Status readScales(const pugi::xml_node& element, EarthModel& model)
{
    if (const pugi::xml_node child = childOf(element, {"scale"}); child && hasAny(child, scaleKeys))
    {
        const char* const names[] = {"x", "y", "z"};
        for (std::size_t i = 0; i < model.scales.size(); ++i)
            if (const Result<bool> read = readKey(child, {names[i]}, anyScale, model.scales[i]);
                !read)
                return Error{ErrorCode::Invalid, "scale " + read.error().message};
        addUnread(child, scaleKeys, "scale ", model.unread);
        return Nothing{};
    }
    const std::string text = valueOf(element, "scale");
    const std::vector<std::string> parts = partsOf(text);
    if (!parts.empty() && parts.size() != 1 && parts.size() != 3)
        return Error{ErrorCode::Invalid, "scale = \"" + text + "\": needs " + anyScale.words};
    for (std::size_t i = 0; !parts.empty() && i < model.scales.size(); ++i)
    {
        const Result<double> scale =
            valueByNeed("scale", parts[parts.size() == 1 ? 0 : i], anyScale);
        if (!scale)
            return scale.error();
        model.scales[i] = *scale;
    }
    return Nothing{};
}

/// orientation="heading pitch roll", of osgEarth 3; keys of their own count more.
Status readAngles(const pugi::xml_node& element, EarthModel& model)
{
    double* const angles[] = {&model.heading, &model.pitch, &model.roll};
    const std::string text = valueOf(element, "orientation");
    const std::vector<std::string> parts = partsOf(text);
    if (parts.size() > 3)
        return Error{ErrorCode::Invalid,
                     "orientation = \"" + text + "\": needs heading, pitch and roll"};
    for (std::size_t i = 0; i < parts.size(); ++i)
    {
        const Result<double> angle = valueByNeed("orientation", parts[i], anyAngle);
        if (!angle)
            return angle.error();
        *angles[i] = *angle;
    }
    const char* const names[] = {"heading", "pitch", "roll"};
    for (std::size_t i = 0; i < 3; ++i)
        if (const Result<bool> read = readKey(element, {names[i]}, anyAngle, *angles[i]); !read)
            return read.error();
    return Nothing{};
}

/// Without the marks around it.
std::string unquoted(const std::string& text)
{
    const bool isQuoted = text.size() > 1 && (text.front() == '"' || text.front() == '\'') &&
                          text.back() == text.front();
    return isQuoted ? text.substr(1, text.size() - 2) : text;
}

/// <style>model: "house.osgb"; model-scale: 2;</style>
Status readStyle(const pugi::xml_node& element, EarthModel& model)
{
    std::string text = valueOf(element, "style");
    if (const std::size_t open = text.find('{'); open != std::string::npos)
        text = text.substr(open + 1, text.find('}', open) - open - 1);
    std::size_t next = 0;
    for (std::size_t at = 0; at < text.size(); at = next + 1)
    {
        next = std::min(text.find(';', at), text.size());
        const std::string item = text.substr(at, next - at);
        const std::size_t colon = item.find(':');
        if (colon == std::string::npos)
            continue;
        const std::string key = lowerCase(trimmed(item.substr(0, colon)));
        const std::string value = unquoted(trimmed(item.substr(colon + 1)));
        const std::map<std::string, double*> angles = {{"model-heading", &model.heading},
                                                       {"model-pitch", &model.pitch},
                                                       {"model-roll", &model.roll}};
        if (key == "model")
            model.url = withSlashes(value);
        else if (key == "model-scale" && lowerCase(value) != "auto")
        {
            const Result<double> scale = valueByNeed(key, value, anyScale);
            if (!scale)
                return scale.error();
            model.scales.fill(*scale);
        }
        else if (const auto angle = angles.find(key); angle != angles.end())
        {
            const Result<double> degrees = valueByNeed(key, value, anyAngle);
            if (!degrees)
                return degrees.error();
            *angle->second = *degrees;
        }
        else
            append(model.unread, "style " + item.substr(item.find_first_not_of(" \t\r\n")));
    }
    return Nothing{};
}

Status readRanges(const pugi::xml_node& element, EarthModel& model)
{
    if (const Result<bool> read = readKey(element, {"min_range"}, anyRange, model.minRange); !read)
        return read.error();
    const Result<bool> read = readKey(element, {"max_range"}, anyRange, model.maxRange);
    if (!read)
        return read.error();
    if (!(model.maxRange > model.minRange))
        return Error{ErrorCode::Invalid, "max_range = \"" + valueOf(element, "max_range") +
                                             "\": needs more than min_range"};
    return Nothing{};
}
} // namespace

Result<EarthModel> readModel(const pugi::xml_node& element)
{
    EarthModel model;
    model.name = valueOf(element, "name");
    for (const auto read : {readStyle, readPlace, readScales, readAngles, readRanges})
        if (const Status status = read(element, model); !status)
            return status.error();
    if (const std::string url = valueOf(element, "url"); !url.empty())
        model.url = withSlashes(url);
    Keys read = {"name",     "driver",   "open",  "enabled", "visible",   "url",
                 "location", "position", "place", "mode",    "scale",     "orientation",
                 "heading",  "pitch",    "roll",  "style",   "min_range", "max_range"};
    if (!childOf(element, {"location", "position", "place"}))
        read.insert(placeKeys.begin(), placeKeys.end());
    addUnread(element, read, "", model.unread);
    return model;
}

} // namespace osgTerrainLight
