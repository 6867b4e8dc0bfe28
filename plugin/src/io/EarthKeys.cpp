#include "io/EarthKeys.h"

#include "io/EarthXml.h"
#include "io/MapPlace.h"
#include "io/RasterBand.h"

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include <charconv>
#include <cmath>

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

/// Names of osgEarth that PROJ does not know.
std::string knownCrs(const std::string& srs)
{
    const std::string name = lowerCase(srs);
    for (const char* mercator : {"spherical-mercator", "global-mercator"})
        if (name == mercator)
            return "EPSG:3857";
    for (const char* degrees : {"global-geodetic", "geodetic", "plate-carree", "plate-carre"})
        if (name == degrees)
            return "WGS84";
    return srs;
}

/// x and y on a map, as longitude and latitude.
Result<EarthPoint> toDegrees(const std::string& srs, double x, double y)
{
    OGRSpatialReference crs;
    char* wkt = nullptr;
    if (crs.SetFromUserInput(knownCrs(srs).c_str(),
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
    return EarthPoint{place->longitude, place->latitude, false};
}
} // namespace

std::optional<double> numberOf(const std::string& text)
{
    const std::optional<Quantity> number = quantityOf(text);
    return number && number->unit.empty() ? std::optional<double>(number->value) : std::nullopt;
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

Result<double> valueByNeed(const std::string& key, const std::string& text, const KeyNeed& need)
{
    const std::optional<double> number = need.read(text);
    if (!number || *number < need.least || *number > need.most)
        return Error{ErrorCode::Invalid, key + " = \"" + text + "\": needs " + need.words};
    return *number;
}

Result<bool> readKey(const pugi::xml_node& element, std::initializer_list<const char*> keys,
                     const KeyNeed& need, double& value)
{
    for (const char* key : keys)
        if (const std::string text = valueOf(element, key); !text.empty())
        {
            const Result<double> number = valueByNeed(key, text, need);
            if (!number)
                return number.error();
            value = *number;
            return true;
        }
    return false;
}

std::string toString(const EarthPoint& point)
{
    return point.isPlain ? CPLSPrintf("x %.10g, y %.10g", point.x, point.y)
                         : CPLSPrintf("longitude %.8g, latitude %.8g", point.x, point.y);
}

Result<EarthPoint> readPoint(const pugi::xml_node& element, bool plain)
{
    const Error none{ErrorCode::Invalid, "has no place; needs long and lat, or x and y"};
    const std::string srs = valueOf(element, "srs");
    const bool hasX = !valueOf(element, "x").empty();
    bool hasLongitude = false;
    for (const char* key : {"long", "lon", "longitude"})
        hasLongitude = hasLongitude || !valueOf(element, key).empty();
    EarthPoint point;
    if (hasX && (!srs.empty() || (plain && !hasLongitude)))
    {
        const KeyNeed number{numberOf, -1.0e9, 1.0e9, "a number in units of the map"};
        const Result<bool> x = readKey(element, {"x"}, number, point.x);
        const Result<bool> y = readKey(element, {"y"}, number, point.y);
        if (!x || !y)
            return x ? y.error() : x.error();
        if (!*y)
            return none;
        point.isPlain = srs.empty();
        return point.isPlain ? Result<EarthPoint>(point) : toDegrees(srs, point.x, point.y);
    }
    const Result<bool> x = readKey(element, {"long", "lon", "longitude", "x"},
                                   {degreesOf, -360.0, 360.0, "degrees, -360 ... 360"}, point.x);
    const Result<bool> y = readKey(element, {"lat", "latitude", "y"},
                                   {degreesOf, -90.0, 90.0, "degrees, -90 ... 90"}, point.y);
    if (!x || !y)
        return x ? y.error() : x.error();
    return *x && *y ? Result<EarthPoint>(point) : Result<EarthPoint>(none);
}

} // namespace osgTerrainLight
