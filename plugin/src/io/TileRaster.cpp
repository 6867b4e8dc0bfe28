#include "io/TileRaster.h"

#include "io/EarthXml.h"
#include "io/GdalErrors.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

namespace osgTerrainLight
{
namespace
{
constexpr std::size_t mostTiles = 1024;
constexpr long long mostPixels = 1 << 20; ///< a side, of a raster with gaps

/// Where tiles lie on the map.
struct TileGrid
{
    std::string crs;
    double west = 0.0, edge = 0.0; ///< edge: from which rows count, south or north
    bool fromSouth = true;
};

/// The two profiles that have names; nothing for others.
std::optional<TileGrid> gridOf(const std::string& profile, bool fromSouth)
{
    constexpr double halfOfMercator = 20037508.342789244; // pi times the radius of WGS 84
    for (const char* name : {"spherical-mercator", "global-mercator", "mercator"})
        if (profile == name)
            return TileGrid{"EPSG:3857", -halfOfMercator,
                            fromSouth ? -halfOfMercator : halfOfMercator, fromSouth};
    for (const char* name : {"global-geodetic", "geodetic", "wgs84"})
        if (profile == name)
            return TileGrid{"EPSG:4326", -180.0, fromSouth ? -90.0 : 90.0, fromSouth};
    return std::nullopt;
}

struct Tile
{
    long long x = 0, y = 0;
    std::string path;
};

std::optional<long long> indexOf(const std::string& text)
{
    long long index = 0;
    const char* end = text.data() + text.size();
    const auto [stop, failed] = std::from_chars(text.data(), end, index);
    constexpr long long most = 1LL << 40;
    return failed == std::errc() && stop == end && index >= 0 && index < most
               ? std::optional<long long>(index)
               : std::nullopt;
}

std::vector<std::string> entriesOf(const std::string& folder)
{
    const CPLStringList names(VSIReadDir(folder.c_str()));
    std::vector<std::string> entries;
    for (int i = 0; i < names.size(); ++i)
        entries.emplace_back(names[i]);
    std::sort(entries.begin(), entries.end());
    return entries;
}

/// Of a level; one more than mostTiles where there are more.
std::vector<Tile> tilesIn(const std::string& folder, const std::string& extension)
{
    std::vector<Tile> tiles;
    for (const std::string& column : entriesOf(folder))
        if (const std::optional<long long> x = indexOf(column))
            for (const std::string& file : entriesOf(folder + "/" + column))
            {
                if (tiles.size() > mostTiles)
                    return tiles;
                const std::optional<long long> y = indexOf(CPLGetBasename(file.c_str()));
                if (y && EQUAL(CPLGetExtension(file.c_str()), extension.c_str()))
                    tiles.push_back({*x, *y, folder + "/" + column + "/" + file});
            }
    return tiles;
}

std::string escaped(const std::string& text)
{
    char* escapedText = CPLEscapeString(text.c_str(), -1, CPLES_XML);
    const std::string result = escapedText;
    CPLFree(escapedText);
    return result;
}

std::string number(double value)
{
    return CPLSPrintf("%.17g", value);
}

/// The tiles of a level as a virtual raster.
class Mosaic
{
public:
    Mosaic(const TileGrid& grid, const std::vector<Tile>& tiles) : _grid(grid), _tiles(tiles)
    {
        const auto byX = [](const Tile& a, const Tile& b) { return a.x < b.x; };
        const auto byY = [](const Tile& a, const Tile& b) { return a.y < b.y; };
        const auto x = std::minmax_element(tiles.begin(), tiles.end(), byX);
        const auto y = std::minmax_element(tiles.begin(), tiles.end(), byY);
        _firstX = x.first->x;
        _firstY = y.first->y;
        _columns = x.second->x - _firstX + 1;
        _rows = y.second->y - _firstY + 1;
    }

    /// tileSpan: width of a tile on the map; where it is 0, unitsPerPixel counts.
    Result<std::string> text(double tileSpan, double unitsPerPixel)
    {
        GdalErrors errors;
        const std::string& path = _tiles.front().path;
        const GDALDatasetUniquePtr first(
            GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_VERBOSE_ERROR));
        if (!first || first->GetRasterCount() == 0)
            return Error{ErrorCode::Invalid,
                         path + ": is no tile that GDAL reads (" + errors.first() + ")"};
        if (first->GetRasterBand(1)->GetColorTable())
            return Error{ErrorCode::NotSupported,
                         path + ": is a tile with a palette; needs grey or red, green and blue"};
        _width = first->GetRasterXSize();
        _height = first->GetRasterYSize();
        if (_columns * _width > mostPixels || _rows * _height > mostPixels)
            return Error{ErrorCode::Invalid, path + ": the tiles of its level lie too far apart"};
        const double pixel = tileSpan > 0.0 ? tileSpan / _width : unitsPerPixel;
        const double left = _grid.west + static_cast<double>(_firstX * _width) * pixel;
        const double top =
            _grid.fromSouth ? _grid.edge + static_cast<double>((_firstY + _rows) * _height) * pixel
                            : _grid.edge - static_cast<double>(_firstY * _height) * pixel;
        if (!std::isfinite(left) || !std::isfinite(top) || !std::isfinite(pixel))
            return Error{ErrorCode::Invalid, path + ": its TileMap leads to no finite place"};
        std::string xml = "<VRTDataset rasterXSize=\"" + std::to_string(_columns * _width) +
                          "\" rasterYSize=\"" + std::to_string(_rows * _height) + "\"><SRS>" +
                          escaped(_grid.crs) + "</SRS><GeoTransform>" + number(left) + "," +
                          number(pixel) + ",0," + number(top) + ",0," + number(-pixel) +
                          "</GeoTransform>";
        const int bands = first->GetRasterCount();
        for (int band = 1; band <= bands; ++band)
            addBand(xml, *first->GetRasterBand(band), band);
        const bool isPicture = first->GetRasterBand(1)->GetRasterDataType() == GDT_Byte;
        const bool hasAlpha =
            first->GetRasterBand(bands)->GetColorInterpretation() == GCI_AlphaBand;
        if (isPicture && !hasAlpha)
            addCover(xml, bands + 1);
        return xml + "</VRTDataset>";
    }

private:
    void addBand(std::string& xml, GDALRasterBand& like, int band) const
    {
        const GDALDataType type = like.GetRasterDataType();
        xml += "<VRTRasterBand dataType=\"" + std::string(GDALGetDataTypeName(type)) +
               "\" band=\"" + std::to_string(band) + "\"><ColorInterp>" +
               GDALGetColorInterpretationName(like.GetColorInterpretation()) + "</ColorInterp>";
        int isThere = 0;
        const double noData = like.GetNoDataValue(&isThere);
        // Of heights: what no tile covers.
        if (type != GDT_Byte)
            xml += "<NoDataValue>" +
                   number(isThere ? noData
                                  : GDALAdjustValueToDataType(type, -32768.0, nullptr, nullptr)) +
                   "</NoDataValue>";
        addSources(xml, "SimpleSource", band, "");
        xml += "</VRTRasterBand>";
    }

    /// An alpha band: 255 where there is a tile.
    void addCover(std::string& xml, int band) const
    {
        xml += "<VRTRasterBand dataType=\"Byte\" band=\"" + std::to_string(band) +
               "\"><ColorInterp>Alpha</ColorInterp>";
        addSources(xml, "ComplexSource", 1,
                   "<ScaleOffset>255</ScaleOffset><ScaleRatio>0</ScaleRatio>");
        xml += "</VRTRasterBand>";
    }

    void addSources(std::string& xml, const std::string& kind, int band,
                    const std::string& values) const
    {
        const std::string size =
            " xSize=\"" + std::to_string(_width) + "\" ySize=\"" + std::to_string(_height) + "\"/>";
        for (const Tile& tile : _tiles)
        {
            const long long row = _grid.fromSouth ? _firstY + _rows - 1 - tile.y : tile.y - _firstY;
            xml += "<" + kind + "><SourceFilename>" + escaped(tile.path) +
                   "</SourceFilename><SourceBand>" + std::to_string(band) +
                   "</SourceBand><SrcRect xOff=\"0\" yOff=\"0\"" + size + "<DstRect xOff=\"" +
                   std::to_string((tile.x - _firstX) * _width) + "\" yOff=\"" +
                   std::to_string(row * _height) + "\"" + size + values + "</" + kind + ">";
        }
    }

    const TileGrid& _grid;
    const std::vector<Tile>& _tiles;
    long long _firstX = 0, _firstY = 0, _columns = 0, _rows = 0;
    int _width = 0, _height = 0;
};

Error noTiles(const std::string& path)
{
    return {ErrorCode::NotFound, path + ": no level with 1 to " + std::to_string(mostTiles) +
                                     " tiles in folders level/x/y"};
}
} // namespace

TileRaster::TileRaster(const std::string& virtualRaster)
{
    static std::atomic<unsigned> counter{0};
    _path = std::shared_ptr<const std::string>(
        new std::string("/vsimem/osgTerrainLight/tiles_" + std::to_string(counter++) + ".vrt"),
        [](const std::string* path)
        {
            VSIUnlink(path->c_str());
            delete path;
        });
    VSILFILE* file = VSIFOpenL(_path->c_str(), "wb");
    VSIFWriteL(virtualRaster.data(), 1, virtualRaster.size(), file);
    VSIFCloseL(file);
}

Result<TileRaster> TileRaster::ofPattern(const std::string& pattern, const std::string& profile,
                                         bool fromSouth)
{
    const std::optional<TileGrid> grid =
        gridOf(profile.empty() ? "spherical-mercator" : profile, fromSouth);
    if (!grid)
        return Error{ErrorCode::NotSupported,
                     pattern + ": profile = \"" + profile +
                         "\": needs spherical-mercator or global-geodetic"};
    const std::string places = "/{z}/{x}/{y}.";
    const std::size_t at = pattern.find(places);
    if (at == std::string::npos)
        return Error{ErrorCode::NotSupported,
                     pattern + ": needs a path that ends in {z}/{x}/{y} and an extension"};
    const std::string folder = pattern.substr(0, at);
    const std::string extension = pattern.substr(at + places.size());
    constexpr int deepest = 30;
    for (int level = deepest; level >= 0; --level)
    {
        const std::vector<Tile> tiles = tilesIn(folder + "/" + std::to_string(level), extension);
        if (tiles.empty() || tiles.size() > mostTiles)
            continue;
        // One tile, or two of degrees, span the whole map on level 0.
        const double span = -grid->west / (grid->crs == "EPSG:3857" ? 0.5 : 1.0);
        const Result<std::string> text = Mosaic(*grid, tiles).text(std::ldexp(span, -level), 0.0);
        return text ? Result<TileRaster>(TileRaster(*text)) : text.error();
    }
    return noTiles(pattern);
}

Result<TileRaster> TileRaster::ofTileMap(const std::string& description)
{
    pugi::xml_document document;
    VSILFILE* file = VSIFOpenL(description.c_str(), "rb");
    if (!file)
        return Error{ErrorCode::NotFound, description + ": no such file"};
    std::string content;
    std::vector<char> part(1 << 16);
    while (const std::size_t count = VSIFReadL(part.data(), 1, part.size(), file))
        content.append(part.data(), count);
    VSIFCloseL(file);
    const pugi::xml_node map = document.load_buffer(content.data(), content.size())
                                   ? document.child("TileMap")
                                   : pugi::xml_node();
    const pugi::xml_node sets = map.child("TileSets");
    if (!sets)
        return Error{ErrorCode::Invalid, description + ": is no TileMap with TileSets"};
    const pugi::xml_node origin = map.child("Origin");
    const TileGrid grid = gridOf(lowerCase(sets.attribute("profile").value()), true)
                              .value_or(TileGrid{trimmed(map.child("SRS").text().get()),
                                                 origin.attribute("x").as_double(),
                                                 origin.attribute("y").as_double(), true});
    const std::string extension = map.child("TileFormat").attribute("extension").value();
    const std::string folder = CPLGetDirname(description.c_str());
    std::vector<Tile> best;
    double unitsPerPixel = 0.0;
    for (const pugi::xml_node& set : sets.children("TileSet"))
    {
        const double units = set.attribute("units-per-pixel").as_double();
        std::vector<Tile> tiles = tilesIn(folder + "/" + set.attribute("href").value(), extension);
        if (tiles.empty() || tiles.size() > mostTiles || !(units > 0.0) ||
            (!best.empty() && units >= unitsPerPixel))
            continue;
        best = std::move(tiles);
        unitsPerPixel = units;
    }
    if (best.empty())
        return noTiles(description);
    const Result<std::string> text = Mosaic(grid, best).text(0.0, unitsPerPixel);
    return text ? Result<TileRaster>(TileRaster(*text)) : text.error();
}

} // namespace osgTerrainLight
