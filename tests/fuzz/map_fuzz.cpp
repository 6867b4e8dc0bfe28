// Damaged .earth maps, through the parser and the plugin, and damaged heads of rasters (VRT,
// AAIGrid, GeoTIFF, ENVI, PDS), through our readers: whatever comes in, what comes out is an error
// that names the file, or terrain of finite heights. Plain mutation, no guidance by coverage; meant
// for the build with sanitizers.
// Usage: map_fuzz [--seed N] [--runs N | --seconds N] [--keep]
// The file at hand is input.earth, .dat or .hdr, in a folder that the first line names. It is there
// after a crash, and after a clean run with --keep.
#include "Mutation.h"
#include "io/EarthFile.h"
#include "io/GdalErrors.h"
#include "io/MapReader.h"
#include "osgdb/Register.h"

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <osg/Notify>
#include <osgDB/Registry>

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
key_lights="0,10,5,20;90,20,1,2,3"/></Earth>)",
            R"(<map><CompositeElevation><layers><GDALElevation url="input.tif" vdatum="egm96"/>
<GDALElevation url="input.tif" z_factor="2"/></layers></CompositeElevation><image driver="composite"
opacity="0.5"><image driver="gdal" url="a\b.tif" opacity="1"/></image><XYZImage profile="geodetic"
url="t/{z}/{x}/{y}.png" invert_y="true"/><TMSImage url="tms.xml"/><options><sky hours="15.5"
date_time="2024-06-21"/></options><viewpoints><viewpoint name="v" heading="45deg" pitch="-30"
range="5km" srs="EPSG:32633" x="500000" y="4000000" z="10"/></viewpoints></map>)",
            R"(<map><elevation driver="gdal" url="input.tif"/><model name="a" driver="simple"
url="box.osgt"><location>500100 4999900 1</location><orientation>30 2 1</orientation><scale x="2"/>
</model><Annotations><Model min_range="1" max_range="5km"><position srs="EPSG:32633" x="500100"
y="4999900" hat="3ft"/><style>m { model: "box.osgt"; model-scale: 2; model-heading: 9 }</style>
</Model><label text="t"><position lat="45.1" long="15" mode="relative"/></label></Annotations></map>)"};
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

/// A header of ENVI; its pixels are input.img beside it, 60 bytes.
std::string enviHeader()
{
    return "ENVI\ndescription = {heights}\nsamples = 6\nlines = 5\nbands = 1\nheader offset = 0\n"
           "file type = ENVI Standard\ndata type = 2\ninterleave = bsq\nbyte order = 0\n"
           "map info = {UTM, 1, 1, 500000, 5000000, 30, 30, 33, North, WGS-84}\n"
           "data ignore value = -9999\nband names = {heights}\n";
}

/// A label of PDS 3, and its pixels.
std::string planetaryImage()
{
    std::string text =
        "PDS_VERSION_ID = PDS3\r\nRECORD_TYPE = FIXED_LENGTH\r\nRECORD_BYTES = 12\r\n"
        "^IMAGE = 101\r\nOBJECT = IMAGE\r\n LINES = 5\r\n LINE_SAMPLES = 6\r\n"
        " SAMPLE_TYPE = LSB_INTEGER\r\n SAMPLE_BITS = 16\r\n UNIT = METER\r\n"
        " SCALING_FACTOR = 0.5\r\n OFFSET = 1737400\r\n MISSING_CONSTANT = -32768\r\n"
        "END_OBJECT = IMAGE\r\nOBJECT = IMAGE_MAP_PROJECTION\r\n"
        " MAP_PROJECTION_TYPE = \"SIMPLE CYLINDRICAL\"\r\n TARGET_NAME = MOON\r\n"
        " A_AXIS_RADIUS = 1737.4 <KM>\r\n B_AXIS_RADIUS = 1737.4 <KM>\r\n"
        " C_AXIS_RADIUS = 1737.4 <KM>\r\n CENTER_LATITUDE = 0 <DEG>\r\n"
        " CENTER_LONGITUDE = 0 <DEG>\r\n MAP_RESOLUTION = 4 <PIX/DEG>\r\n"
        " MAP_SCALE = 7.58 <KM/PIX>\r\n LINE_PROJECTION_OFFSET = 2.5\r\n"
        " SAMPLE_PROJECTION_OFFSET = 3\r\nEND_OBJECT = IMAGE_MAP_PROJECTION\r\nEND\r\n";
    require(text.size() <= 1200, "a label of more than 100 records");
    text.resize(1200, ' ');
    for (char i = 0; i < 30; ++i)
        text += {i, '\0'};
    return text;
}

enum class Beside
{
    Nothing,
    Palette,
    Mask
};

/// With unit, scale, nodata and CRS.
std::string geoTiff(const std::string& path, GDALDataType type, const char* compression,
                    Beside beside = Beside::Nothing)
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
        if (beside == Beside::Palette)
        {
            GDALColorTable palette;
            const GDALColorEntry green = {50, 200, 100, 255};
            palette.SetColorEntry(10, &green);
            band.SetColorTable(&palette);
        }
        require(band.RasterIO(GF_Write, 0, 0, 12, 9, values.data(), 12, 9, GDT_Float32, 0, 0,
                              nullptr) == CE_None,
                "no GeoTIFF");
        if (beside == Beside::Mask)
            require(band.CreateMaskBand(GMF_PER_DATASET) == CE_None &&
                        band.GetMaskBand()->RasterIO(GF_Write, 0, 0, 12, 9, values.data(), 12, 9,
                                                     GDT_Float32, 0, 0, nullptr) == CE_None,
                    "no mask");
    }
    return bytesOf(path);
}

bool namesFile(const Error& error, const std::string& path)
{
    return error.message.find(path) != std::string::npos;
}

bool tryMap(const std::string& bytes, const std::string& path)
{
    osgDB::ReaderWriter::ReadResult scene =
        osgDB::Registry::instance()->getReaderWriterForExtension("earth")->readNode(path, nullptr);
    require(scene.validNode() || scene.message().find(path) != std::string::npos,
            "an error of the plugin without its file");
    const Result<EarthMap> map = parseEarth(bytes, "input.earth");
    if (!map)
    {
        require(map.error().message.rfind("input.earth:", 0) == 0, "an error without its file");
        return false;
    }
    require(!map->elevations.empty() || !map->images.empty(), "a map of nothing");
    require(complaint(map->light.sky).empty() && complaint(map->light.settings).empty(),
            "light out of its range");
    return scene.validNode();
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
    GDALAllRegister();
    CPLSetConfigOption("GDAL_PAM_ENABLED", "NO"); // no files beside the one at hand
    CPLSetConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES");
    osg::setNotifyLevel(osg::ALWAYS);
    registerReader();
    const GdalErrors quiet;
    std::vector<std::string> files = maps();
    for (const std::string& file : {asciiGrid(), virtualRaster(), enviHeader(), planetaryImage()})
        files.push_back(file);
    const std::string path = options.file("input.dat"); // GDAL goes by what is in a file
    for (const GDALDataType type : {GDT_Byte, GDT_Int16, GDT_Float32})
        for (const char* compression : {"COMPRESS=NONE", "COMPRESS=DEFLATE", "COMPRESS=LZW"})
            files.push_back(geoTiff(path, type, compression));
    files.push_back(geoTiff(path, GDT_Byte, "COMPRESS=NONE", Beside::Palette));
    files.push_back(geoTiff(path, GDT_Int16, "COMPRESS=NONE", Beside::Mask));
    // What whole maps and the header name.
    for (const char* name : {"input.tif", "a.tif"})
        geoTiff(options.file(name), GDT_Float32, "COMPRESS=NONE");
    geoTiff(options.file("c.tif"), GDT_Byte, "COMPRESS=NONE", Beside::Palette);
    std::ofstream(options.file("box.osgt")) << "#Ascii Scene \n#Version 161 \n#Generator x "
                                               "\n\nosg::Geode {\n  UniqueID 1 \n  Drawables "
                                               "1 {\n    osg::ShapeDrawable {\n      UniqueID 2 \n "
                                               "     Shape TRUE {\n        osg::Box {\n"
                                               "          UniqueID 3 \n          HalfLengths 4 4 4 "
                                               "\n        }\n      }\n    }\n  }\n}\n";
    std::ofstream(options.file("input.img"), std::ios::binary) << std::string(60, '\1');
    return fuzz(options, files,
                [&](const std::string& bytes)
                {
                    const std::size_t first = bytes.find_first_not_of(" \r\n\t");
                    const bool isXml = first != std::string::npos && bytes[first] == '<';
                    const bool isMap = isXml && bytes.find("VRTDataset") == std::string::npos;
                    const bool isHeader = bytes.rfind("ENVI", 0) == 0;
                    const std::string file = isMap      ? options.file("input.earth")
                                             : isHeader ? options.file("input.hdr")
                                                        : path;
                    std::ofstream(file, std::ios::binary) << bytes;
                    return isMap ? tryMap(bytes, file)
                                 : tryRaster(isHeader ? options.file("input.img") : file);
                });
}
