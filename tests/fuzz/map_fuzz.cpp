// Damaged .earth maps, and damaged heads of rasters (VRT, AAIGrid, GeoTIFF), through our readers:
// whatever comes in, what comes out is an error that names the file, or terrain of finite heights.
// Plain mutation, no guidance by coverage; meant for the build with sanitizers.
// Usage: map_fuzz [--seed N] [--runs N | --seconds N] [--keep FOLDER]
// The file at hand is FOLDER/input.*, so it is there after a crash.
#include "Mutation.h"
#include "io/EarthFile.h"
#include "io/GdalErrors.h"
#include "io/MapReader.h"

#include <gdal_priv.h>

#include <cmath>
#include <memory>

using namespace osgTerrainLight;

namespace
{
/// Small, so that heads are a good part of a file.
constexpr std::size_t maxPosts = 1 << 14;

std::vector<std::string> maps()
{
    return {R"(<map name="m"><elevation driver="gdal" name="a"><url>input.tif</url></elevation>
<image driver="gdal" url="input.tif" open="false"/><GDALImage name="b"><url>c.tif</url></GDALImage>
<options><x/></options><terrain_light sun_azimuth="300" sky_radiance="1 2 3" quality="best"
time="2024-06-21 12:00+02:00" place="11.5,48.1"><key_light azimuth="90" width="10" lowest="0"
highest="20" radiance="1 2 3"/><albedo>0.3</albedo><exposure>1</exposure></terrain_light></map>)",
            R"(<Earth><GdalElevation Enabled="No" Url="a"/><HEIGHTFIELD driver="GDAL"><url> a.tif
</url></HEIGHTFIELD><terrain_light sky="clear" turbidity="4" sky_harmonics="1,2,3,4"
key_lights="0,10,5,20;90,20,1,2,3"/></Earth>)"};
}

std::string asciiGrid()
{
    std::string text = "ncols 6\nnrows 5\nxllcorner 500000\nyllcorner 5000000\ncellsize 30\n"
                       "NODATA_value -9999\n";
    for (int i = 0; i < 30; ++i)
        text += std::to_string(i % 7 * 10) + (i % 6 == 5 ? "\n" : " ");
    return text;
}

std::string virtualRaster()
{
    return R"(<VRTDataset rasterXSize="6" rasterYSize="5"><SRS>EPSG:4326</SRS>
<GeoTransform>7, 0.001, 0, 46, 0, -0.001</GeoTransform><Metadata><MDI key="AREA_OR_POINT">Point</MDI>
</Metadata><VRTRasterBand dataType="Int16" band="1">
<UnitType>ft</UnitType><Offset>10</Offset><Scale>0.5</Scale><ColorInterp>Gray</ColorInterp>
</VRTRasterBand></VRTDataset>)";
}

/// With unit, scale, nodata, CRS and a palette or a mask.
std::string geoTiff(const std::string& path, GDALDataType type, const char* compression)
{
    const char* options[] = {compression, nullptr};
    GDALDriver& driver = *GetGDALDriverManager()->GetDriverByName("GTiff");
    {
        const std::unique_ptr<GDALDataset> file(
            driver.Create(path.c_str(), 12, 9, 1, type, const_cast<char**>(options)));
        double place[] = {500000.0, 30.0, 0.0, 5000000.0, 0.0, -30.0};
        file->SetGeoTransform(place);
        OGRSpatialReference crs;
        crs.importFromEPSG(32633);
        file->SetSpatialRef(&crs);
        GDALRasterBand& band = *file->GetRasterBand(1);
        band.SetNoDataValue(-9999.0);
        band.SetScale(0.1);
        band.SetUnitType("m");
        std::vector<float> values(12 * 9);
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<float>(i % 13 * 10);
        require(band.RasterIO(GF_Write, 0, 0, 12, 9, values.data(), 12, 9, GDT_Float32, 0, 0,
                              nullptr) == CE_None,
                "no GeoTIFF");
    }
    return bytesOf(path);
}

bool namesFile(const Error& error, const std::string& path)
{
    return error.message.find(path) != std::string::npos;
}

bool tryMap(const std::string& bytes)
{
    const Result<EarthMap> map = parseEarth(bytes, "input.earth");
    if (!map)
    {
        require(map.error().message.rfind("input.earth:", 0) == 0, "an error without its file");
        return false;
    }
    require(!map->elevations.empty() || !map->images.empty(), "a map of nothing");
    require(complaint(map->light.sky).empty() && complaint(map->light.settings).empty(),
            "light out of its range");
    return true;
}

bool tryRaster(const std::string& path)
{
    DemReadOptions options;
    options.maxPosts = maxPosts;
    const Result<DemInfo> info = describeDem(path, options);
    if (!info)
    {
        require(namesFile(info.error(), path), "an error without its file");
        return false;
    }
    require(info->rasterWidth > 0 && info->rasterHeight > 0, "a raster of nothing");
    if (static_cast<std::size_t>(info->rasterWidth) * static_cast<std::size_t>(info->rasterHeight) >
        maxPosts)
        return false;
    const Result<DemFile> small = readDemReduced(path, options, 4);
    require(small.ok() || namesFile(small.error(), path), "an error without its file");
    const Result<DemFile> file = readDem(path, options);
    if (!file)
    {
        require(namesFile(file.error(), path), "an error without its file");
        return false;
    }
    const DemTile& tile = file->tile;
    require(tile.northSpacing > 0.0 && std::isfinite(tile.northSpacing), "a spacing of nothing");
    for (const double spacing : tile.eastSpacings)
        require(spacing > 0.0 && std::isfinite(spacing), "a spacing of nothing");
    require(std::isfinite(tile.mapOriginX) && std::isfinite(tile.mapOriginY), "no place");
    const Result<ColourImage> colours = readColour(path, tile, 64);
    require(colours.ok() || namesFile(colours.error(), path), "an error without its file");
    const Result<DemTile> level = levelTileUnder(path);
    require(level.ok() || namesFile(level.error(), path), "an error without its file");
    return true;
}
} // namespace

int main(int count, char** arguments)
{
    const FuzzOptions options(count, arguments, "map_fuzz");
    const std::string path = options.file("input.dat"); // GDAL goes by what is in a file
    const GdalErrors quiet;
    std::vector<std::string> files = maps();
    files.push_back(asciiGrid());
    files.push_back(virtualRaster());
    for (const GDALDataType type : {GDT_Byte, GDT_Int16, GDT_Float32})
        for (const char* compression : {"COMPRESS=NONE", "COMPRESS=DEFLATE", "COMPRESS=LZW"})
            files.push_back(geoTiff(path, type, compression));
    return fuzz(options, files,
                [&](const std::string& bytes)
                {
                    std::ofstream(path, std::ios::binary) << bytes;
                    const std::size_t first = bytes.find_first_not_of(" \r\n\t");
                    const bool isXml = first != std::string::npos && bytes[first] == '<';
                    const bool isMap = isXml && bytes.find("VRTDataset") == std::string::npos;
                    return isMap ? tryMap(bytes) : tryRaster(path);
                });
}
