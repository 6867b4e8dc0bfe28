#include "io/HeightShift.h"

#include "io/Bilinear.h"
#include "io/EarthXml.h"
#include "io/GdalErrors.h"

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace osgTerrainLight
{
namespace
{
using Transformation = std::unique_ptr<OGRCoordinateTransformation>;

constexpr int mostNodes = 129; // a side

struct Places
{
    std::vector<double> longitudes, latitudes; ///< WGS 84 [degrees]
};

bool endsIn(const std::string& text, const std::string& end)
{
    return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

bool isGridFile(const std::string& datum)
{
    const std::string lower = lowerCase(datum);
    return endsIn(lower, ".gtx") || endsIn(lower, ".tif");
}

OGRSpatialReference reference(const std::string& crs, bool& isThere)
{
    OGRSpatialReference result;
    isThere = result.SetFromUserInput(crs.c_str()) == OGRERR_NONE;
    result.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return result;
}

/// Of the nodes of a lattice over the raster.
Result<Places> placesOf(const RasterFrame& raster, const std::vector<double>& xs,
                        const std::vector<double>& ys)
{
    Places places{xs, ys};
    bool isThere = false;
    OGRSpatialReference map = reference(raster.crs, isThere);
    if (raster.crs.empty() || !isThere)
        return Error{ErrorCode::NotSupported, "the raster has no CRS"};
    map.StripVertical();
    const OGRSpatialReference wgs84 = reference("OGC:CRS84", isThere);
    const Transformation toDegrees(OGRCreateCoordinateTransformation(&map, &wgs84));
    if (!toDegrees || !toDegrees->Transform(static_cast<int>(xs.size()), places.longitudes.data(),
                                            places.latitudes.data()))
        return Error{ErrorCode::NotSupported, "the CRS of the raster has no way to WGS 84"};
    return places;
}

/// Heights of the datum above the ellipsoid [m]. Where PROJ has no grid its own answer would be 0,
/// which it calls a ballpark.
Result<std::vector<double>> undulations(const VerticalDatum& datum, const Places& places)
{
    std::vector<double> heights(places.longitudes.size(), 0.0);
    if (datum.known == "ellipsoid")
        return heights;
    if (datum.crs.empty())
        return Error{ErrorCode::NotSupported, "PROJ knows no vertical datum " + datum.name};
    const GdalErrors errors;
    bool isThere = false;
    const OGRSpatialReference above = reference(datum.crs, isThere);
    if (!isThere)
        return Error{ErrorCode::NotSupported, "PROJ knows no vertical datum " + datum.name};
    const OGRSpatialReference ellipsoid = reference("EPSG:4979", isThere);
    OGRCoordinateTransformationOptions exactly;
    exactly.SetBallparkAllowed(false);
    const Transformation up(OGRCreateCoordinateTransformation(&above, &ellipsoid, exactly));
    const Error noGrid{ErrorCode::NotFound, "PROJ finds no grid of the geoid of " + datum.name +
                                                " here (PROJ's program projsync installs more)"};
    if (!up)
        return noGrid;
    Places moved = places;
    std::vector<int> good(heights.size(), 0);
    up->Transform(static_cast<int>(heights.size()), moved.longitudes.data(), moved.latitudes.data(),
                  heights.data(), nullptr, good.data());
    const auto bad = std::find(good.begin(), good.end(), 0);
    if (bad == good.end())
        return heights;
    VSIStatBufL stat;
    const bool isFile = isGridFile(datum.known) && VSIStatL(datum.known.c_str(), &stat) == 0;
    if (!isFile && std::find(good.begin(), good.end(), 1) == good.end())
        return noGrid;
    const auto i = static_cast<std::size_t>(bad - good.begin());
    return Error{
        ErrorCode::NotSupported,
        "the grid of the geoid of " + datum.name + " does not cover " +
            CPLSPrintf("longitude %.6g, latitude %.6g", places.longitudes[i], places.latitudes[i])};
}
} // namespace

VerticalDatum verticalDatumByName(const std::string& name)
{
    static const std::pair<const char*, const char*> names[] = {
        {"egm84", "epsg:5798"},       {"egm96", "epsg:5773"},   {"egm2008", "epsg:3855"},
        {"ellipsoid", "ellipsoid"},   {"wgs84", "ellipsoid"},   {"hae", "ellipsoid"},
        {"ellipsoidal", "ellipsoid"}, {"geodetic", "ellipsoid"}};
    VerticalDatum datum;
    datum.name = name;
    const std::string lower = lowerCase(name);
    if (isGridFile(name))
    {
        datum.known = name;
        datum.crs = "+proj=longlat +datum=WGS84 +geoidgrids=\"" + name + "\" +no_defs +type=crs";
        return datum;
    }
    datum.known = lower;
    for (const auto& [given, known] : names)
        if (lower == given)
            datum.known = known;
    if (datum.known.rfind("epsg:", 0) == 0)
        datum.crs = "EPSG:4326+" + datum.known.substr(5);
    return datum;
}

VerticalDatum verticalDatumOfCrs(const std::string& wkt)
{
    const GdalErrors errors;
    bool isThere = false;
    const OGRSpatialReference crs = reference(wkt, isThere);
    if (wkt.empty() || !isThere || !crs.IsCompound())
        return {};
    const char* name = crs.GetAttrValue("VERT_CS");
    const char* authority = crs.GetAuthorityName("VERT_CS");
    const char* code = crs.GetAuthorityCode("VERT_CS");
    VerticalDatum datum;
    if (authority && code && EQUAL(authority, "EPSG"))
        datum = verticalDatumByName("epsg:" + std::string(code));
    datum.name = name ? name : datum.name;
    if (datum.known.empty())
        datum.known = lowerCase(datum.name);
    return datum;
}

Result<HeightShift> HeightShift::between(const VerticalDatum& from, const VerticalDatum& to,
                                         const RasterFrame& raster)
{
    HeightShift shift;
    shift._columns = std::min(raster.width, mostNodes);
    shift._rows = std::min(raster.height, mostNodes);
    const auto postOf = [](int node, int nodes, int posts)
    { return nodes > 1 ? double(node) * (posts - 1) / (nodes - 1) : 0.5 * (posts - 1); };
    std::vector<double> xs, ys;
    for (int row = 0; row < shift._rows; ++row)
        for (int column = 0; column < shift._columns; ++column)
        {
            xs.push_back(raster.mapX(postOf(column, shift._columns, raster.width)));
            ys.push_back(raster.mapY(postOf(row, shift._rows, raster.height)));
        }
    shift._west = xs.front();
    shift._south = ys.front();
    if (shift._columns > 1)
        shift._perColumn = (shift._columns - 1) / (xs.back() - shift._west);
    if (shift._rows > 1)
        shift._perRow = (shift._rows - 1) / (ys.back() - shift._south);

    const GdalErrors errors;
    const Result<Places> places = placesOf(raster, xs, ys);
    if (!places)
        return places.error();
    Result<std::vector<double>> up = undulations(from, *places);
    const Result<std::vector<double>> down =
        up ? undulations(to, *places) : Result<std::vector<double>>(up.error());
    if (!down)
        return down.error();
    shift._values = std::move(*up);
    for (std::size_t i = 0; i < shift._values.size(); ++i)
        shift._values[i] -= (*down)[i];
    const auto [lowest, highest] = std::minmax_element(shift._values.begin(), shift._values.end());
    shift._lowest = *lowest;
    shift._highest = *highest;
    return shift;
}

double HeightShift::at(double mapX, double mapY) const
{
    const double column = std::clamp((mapX - _west) * _perColumn, 0.0, _columns - 1.0);
    const double row = std::clamp((mapY - _south) * _perRow, 0.0, _rows - 1.0);
    return bilinear(
        column, row, _columns, _rows,
        [this](int x, int y)
        {
            return _values[static_cast<std::size_t>(y) * static_cast<std::size_t>(_columns) +
                           static_cast<std::size_t>(x)];
        });
}

} // namespace osgTerrainLight
