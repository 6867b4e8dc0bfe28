#include "io/EarthViewpoint.h"

#include "io/EarthXml.h"
#include "io/MapPlace.h"
#include "io/RasterBand.h"

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include <charconv>
#include <cmath>
#include <initializer_list>
#include <optional>

namespace osgTerrainLight
{
namespace
{
constexpr double degreesPerRadian = 180.0 / 3.14159265358979323846;

/// A number, and what follows it.
struct Quantity
{
    double value = 0.0;
    std::string unit;
};

std::optional<Quantity> quantityOf(const std::string& text)
{
    Quantity quantity;
    const char* first = text.data() + (!text.empty() && text.front() == '+' ? 1 : 0);
    const char* end = text.data() + text.size();
    const auto [stop, failed] = std::from_chars(first, end, quantity.value);
    if (failed != std::errc() || !std::isfinite(quantity.value))
        return std::nullopt;
    quantity.unit = lowerCase(trimmed(std::string(stop, end)));
    return quantity;
}

std::optional<double> degreesOf(const std::string& text)
{
    const std::optional<Quantity> angle = quantityOf(text);
    if (!angle)
        return std::nullopt;
    for (const char* unit : {"", "deg", "degree", "degrees", "\u00b0"})
        if (angle->unit == unit)
            return angle->value;
    for (const char* unit : {"rad", "radian", "radians"})
        if (angle->unit == unit)
            return degreesPerRadian * angle->value;
    return std::nullopt;
}

std::optional<double> metresOf(const std::string& text)
{
    const std::optional<Quantity> length = quantityOf(text);
    if (!length || length->unit.empty())
        return length ? std::optional<double>(length->value) : std::nullopt;
    const std::optional<double> metres = metresPerHeightUnit(length->unit);
    return metres ? std::optional<double>(*metres * length->value) : std::nullopt;
}

std::optional<double> numberOf(const std::string& text)
{
    const std::optional<Quantity> number = quantityOf(text);
    return number && number->unit.empty() ? std::optional<double>(number->value) : std::nullopt;
}

/// What the key needs, in words and as numbers.
struct Need
{
    std::optional<double> (*read)(const std::string&);
    double least, most;
    const char* words;
};

/// The first key that is there, into `value`; whether one is.
Result<bool> readKey(const pugi::xml_node& element, std::initializer_list<const char*> keys,
                     const Need& need, double& value)
{
    for (const char* key : keys)
    {
        const std::string text = valueOf(element, key);
        if (text.empty())
            continue;
        const std::optional<double> number = need.read(text);
        if (!number || *number < need.least || *number > need.most)
            return Error{ErrorCode::Invalid,
                         std::string(key) + " = \"" + text + "\": needs " + need.words};
        value = *number;
        return true;
    }
    return false;
}

/// x and y on a map, as longitude and latitude.
Status toDegrees(const std::string& srs, double x, double y, EarthViewpoint& viewpoint)
{
    OGRSpatialReference crs;
    char* wkt = nullptr;
    if (crs.SetFromUserInput(srs.c_str(),
                             OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) !=
            OGRERR_NONE ||
        crs.exportToWkt(&wkt) != OGRERR_NONE)
    {
        CPLFree(wkt);
        return Error{ErrorCode::Invalid,
                     "srs = \"" + srs + "\": needs a CRS that PROJ knows, such as EPSG:32633"};
    }
    const std::string text = wkt;
    CPLFree(wkt);
    const Result<EarthPlace> place = placeOnMap(text, x, y);
    if (!place)
        return place.error();
    viewpoint.longitude = place->longitude;
    viewpoint.latitude = place->latitude;
    return Nothing{};
}

/// Errors where none is given.
Status readPlace(const pugi::xml_node& element, EarthViewpoint& viewpoint)
{
    const Error none{ErrorCode::Invalid, "has no place; needs long and lat, or x and y"};
    const std::string srs = valueOf(element, "srs");
    if (!srs.empty() && !valueOf(element, "x").empty())
    {
        const Need number{numberOf, -1.0e9, 1.0e9, "a number in units of the map"};
        double x = 0.0, y = 0.0;
        const Result<bool> hasX = readKey(element, {"x"}, number, x);
        const Result<bool> hasY = readKey(element, {"y"}, number, y);
        if (!hasX || !hasY)
            return hasX ? hasY.error() : hasX.error();
        return *hasY ? toDegrees(srs, x, y, viewpoint) : Status(none);
    }
    const Result<bool> hasLongitude =
        readKey(element, {"long", "lon", "longitude", "x"},
                {degreesOf, -360.0, 360.0, "degrees, -360 ... 360"}, viewpoint.longitude);
    const Result<bool> hasLatitude =
        readKey(element, {"lat", "latitude", "y"}, {degreesOf, -90.0, 90.0, "degrees, -90 ... 90"},
                viewpoint.latitude);
    if (!hasLongitude || !hasLatitude)
        return hasLongitude ? hasLatitude.error() : hasLongitude.error();
    return *hasLongitude && *hasLatitude ? Status(Nothing{}) : Status(none);
}
} // namespace

Result<EarthViewpoint> readViewpoint(const pugi::xml_node& element)
{
    EarthViewpoint viewpoint;
    viewpoint.name = valueOf(element, "name");
    if (const Status place = readPlace(element, viewpoint); !place)
        return place.error();
    double height = 0.0;
    const Result<bool> hasHeight =
        readKey(element, {"height", "alt", "z"},
                {metresOf, -1.0e7, 1.0e9, "a height in metres, or with a unit"}, height);
    if (!hasHeight)
        return hasHeight.error();
    if (*hasHeight)
        viewpoint.height = height;
    const struct
    {
        std::initializer_list<const char*> keys;
        Need need;
        double& value;
    } others[] = {
        {{"heading"}, {degreesOf, -720.0, 720.0, "degrees, -720 ... 720"}, viewpoint.heading},
        {{"pitch"}, {degreesOf, -90.0, 90.0, "degrees, -90 ... 90"}, viewpoint.pitch},
        {{"range"},
         {metresOf, 1.0e-3, 1.0e9, "a length more than 0, in metres or with a unit, as 5km"},
         viewpoint.range}};
    for (const auto& other : others)
        if (const Result<bool> read = readKey(element, other.keys, other.need, other.value); !read)
            return read.error();
    return viewpoint;
}

} // namespace osgTerrainLight
