#include "io/RasterBand.h"

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>

namespace osgTerrainLight
{
namespace
{

std::string number(double value)
{
    return CPLSPrintf("%.10g", value);
}

std::optional<Error> readType(const std::string& path, GDALRasterBand& band, int index,
                              PixelFacts& facts)
{
    const GDALDataType type = band.GetRasterDataType();
    facts.dataType = GDALGetDataTypeName(type);
    if (GDALDataTypeIsComplex(type))
        return Error{ErrorCode::NotSupported, path + ": band " + std::to_string(index) +
                                                  " holds complex numbers (" + facts.dataType +
                                                  "); needed real ones"};
    const char* pixelType = band.GetMetadataItem("PIXELTYPE", "IMAGE_STRUCTURE");
    facts.signedBytes = type == GDT_Byte && pixelType && EQUAL(pixelType, "SIGNEDBYTE");
    if (facts.signedBytes)
        facts.dataType = "Int8";
    facts.integer = GDALDataTypeIsInteger(type) != FALSE;
    facts.fitsFloat = type == GDT_Float32 || (facts.integer && GDALGetDataTypeSizeBits(type) <= 16);
    facts.hasColourTable =
        band.GetColorInterpretation() == GCI_PaletteIndex || band.GetColorTable() != nullptr;
    return std::nullopt;
}

std::optional<Error> checkHeights(const std::string& path, GDALRasterBand& band, int index,
                                  int count, const BandFacts& facts,
                                  std::vector<std::string>& notes)
{
    const GDALColorInterp colour = band.GetColorInterpretation();
    if (colour != GCI_Undefined && colour != GCI_GrayIndex && colour != GCI_PaletteIndex)
        return Error{ErrorCode::NotSupported, path + ": band " + std::to_string(index) + " of " +
                                                  std::to_string(count) + " is a picture's (" +
                                                  GDALGetColorInterpretationName(colour) +
                                                  "), not a DEM; needed a band of heights"};
    if (facts.hasColourTable)
        notes.push_back("the band has a colour table: its pixel values are taken as heights");
    if (CSLCount(band.GetCategoryNames()) > 0)
        notes.push_back("the band has names of categories: its pixel values are taken as heights");
    return std::nullopt;
}

std::optional<double> readNoData(GDALRasterBand& band, const PixelFacts& facts)
{
    int found = FALSE;
    double value = 0.0;
    switch (band.GetRasterDataType())
    {
    case GDT_Int64:
        value = static_cast<double>(band.GetNoDataValueAsInt64(&found));
        break;
    case GDT_UInt64:
        value = static_cast<double>(band.GetNoDataValueAsUInt64(&found));
        break;
    default:
        value = band.GetNoDataValue(&found);
    }
    if (!found)
        return std::nullopt;
    // Some files count signed bytes as GDAL reads them.
    return facts.signedBytes && value > 127.0 ? value - 256.0 : value;
}

std::optional<Error> readScale(const std::string& path, GDALRasterBand& band, PixelFacts& facts)
{
    int found = FALSE;
    facts.scale = band.GetScale(&found);
    if (!found)
        facts.scale = 1.0;
    facts.offset = band.GetOffset(&found);
    if (!found)
        facts.offset = 0.0;
    if (!std::isfinite(facts.scale) || facts.scale == 0.0 || !std::isfinite(facts.offset))
        return Error{ErrorCode::Invalid, path + ": band scale " + number(facts.scale) +
                                             " and offset " + number(facts.offset) +
                                             "; needed finite ones, scale not 0"};
    return std::nullopt;
}

struct VerticalAxis
{
    std::string unit;
    double metres = 1.0; ///< of the unit
    bool down = false;
};

/// Of a CRS with heights: compound, vertical, or with three axes.
std::optional<VerticalAxis> verticalAxisOf(const OGRSpatialReference& crs)
{
    const bool isPart = crs.IsCompound() || crs.IsVertical();
    if (!isPart && (crs.IsGeocentric() || crs.GetAxesCount() != 3))
        return std::nullopt;
    OGRAxisOrientation orientation = OAO_Other;
    VerticalAxis axis;
    // Of a part GDAL knows the unit by another way than of a third axis.
    crs.GetAxis(isPart ? "VERT_CS" : nullptr, isPart ? 0 : 2, &orientation, &axis.metres);
    axis.down = orientation == OAO_Down;
    const char* name = nullptr;
    if (isPart)
        axis.metres = crs.GetTargetLinearUnits("VERT_CS", &name);
    axis.unit = name ? name : number(axis.metres) + " m";
    return axis;
}

/// The unit of the CRS's vertical axis, or else, where the map itself is in feet, the map's: most
/// heights come in the feet of their map, and gdaldem takes them so. Kilometres, links and yards
/// are units of maps alone.
void readUnitOfCrs(const OGRSpatialReference& crs, BandFacts& facts,
                   std::vector<std::string>& notes)
{
    if (const std::optional<VerticalAxis> axis = verticalAxisOf(crs))
    {
        if (!(std::isfinite(axis->metres) && axis->metres > 0.0))
            return;
        facts.heightUnit = axis->unit;
        facts.metresPerHeightUnit = axis->metres;
        return;
    }
    const char* name = nullptr;
    if (!crs.IsProjected() && !crs.IsLocal())
        return;
    const double metres = crs.GetTargetLinearUnits(crs.IsLocal() ? "LOCAL_CS" : "PROJCS", &name);
    if (!(std::isfinite(metres) && metres > 0.0) || metres == 1.0)
        return;
    const std::string unit = (name ? name : "") + (" (" + number(metres) + " m)");
    constexpr double foot = 0.3048; // those of all countries differ by less than 0.01 %
    if (std::abs(metres / foot - 1.0) > 0.001)
    {
        notes.push_back("no height unit is known, and the map is in another than metres, " + unit +
                        ": heights are taken as metres");
        return;
    }
    facts.heightUnit = name ? name : "";
    facts.metresPerHeightUnit = metres;
    notes.push_back("no height unit is known: heights are taken in the map's, " + unit +
                    "; --unit m tells of metres");
}

/// Some planetary products give radii in kilometres and no unit; their offset is the body's radius.
bool isRadiusInKilometres(const BandFacts& facts, const OGRSpatialReference* crs)
{
    return crs && (crs->IsProjected() || crs->IsGeographic()) && facts.offset > 0.0 &&
           std::abs(1000.0 * facts.offset / crs->GetSemiMajor() - 1.0) < 0.01;
}

/// The band's own unit; empty where it has none, or a word that says as much.
std::string unitOf(GDALRasterBand& band)
{
    std::string unit = band.GetUnitType();
    const char* item = band.GetMetadataItem("units"); // of netCDF, also in its copies
    if (unit.empty() && item)
        unit = item;
    for (const char* none : {"unknown", "undefined", "unspecified", "none", "unitless",
                             "dimensionless", "n/a", "na", "dn", "1", "-"})
        if (EQUAL(unit.c_str(), none))
            return "";
    return unit;
}

std::optional<Error> readUnit(const std::string& path, GDALRasterBand& band,
                              const OGRSpatialReference* crs, const std::string& given,
                              BandFacts& facts, std::vector<std::string>& notes)
{
    facts.heightUnit = given.empty() ? unitOf(band) : given;
    const std::optional<double> metres = metresPerHeightUnit(facts.heightUnit);
    if (metres)
        facts.metresPerHeightUnit = *metres;
    else if (!given.empty())
        return Error{ErrorCode::Invalid, path + ": height unit \"" + given +
                                             "\" is not known; needed one such as m, ft or us-ft"};
    else if (!facts.heightUnit.empty())
        notes.push_back("height unit \"" + facts.heightUnit +
                        "\" is not known: heights are taken as metres");
    else if (isRadiusInKilometres(facts, crs))
    {
        facts.heightUnit = "km";
        facts.metresPerHeightUnit = 1000.0;
        notes.push_back("the band's offset is the body's radius in kilometres: so are its heights");
    }
    else if (crs)
        readUnitOfCrs(*crs, facts, notes);
    return std::nullopt;
}

/// The band's own words, which netCDF's climate and forecast conventions have, go before the
/// CRS's. Standard names of depths are depth, depth_below_geoid and
/// sea_floor_depth_below_sea_surface and its like.
bool pointsDown(GDALRasterBand& band, const OGRSpatialReference* crs)
{
    if (const char* positive = band.GetMetadataItem("positive"))
        return EQUAL(positive, "down");
    const char* name = band.GetMetadataItem("standard_name");
    if (name &&
        (EQUAL(name, "depth") || std::string(name).find("depth_below") != std::string::npos))
        return true;
    const std::optional<VerticalAxis> axis =
        crs ? verticalAxisOf(*crs) : std::optional<VerticalAxis>();
    return axis && axis->down;
}

/// GDAL makes a mask of an alpha band only of one or three other bands, and of whole numbers
/// without a sign. 0: there is none.
int alphaBandOf(GDALDataset& dataset)
{
    for (int i = 1; i <= dataset.GetRasterCount(); ++i)
        if (dataset.GetRasterBand(i)->GetColorInterpretation() == GCI_AlphaBand)
            return i;
    return 0;
}

void readMask(GDALDataset& dataset, GDALRasterBand& band, PixelFacts& facts)
{
    const int flags = band.GetMaskFlags();
    const bool masked = (flags & GMF_ALL_VALID) == 0 && flags != GMF_NODATA;
    facts.alphaBand = masked ? 0 : alphaBandOf(dataset);
    facts.hasMask = masked || facts.alphaBand != 0;
}

std::optional<std::array<double, 2>> readStatistics(GDALRasterBand& band)
{
    // Stored ones only: nothing is computed.
    const char* lowest = band.GetMetadataItem("STATISTICS_MINIMUM");
    const char* highest = band.GetMetadataItem("STATISTICS_MAXIMUM");
    if (!lowest || !highest)
        return std::nullopt;
    return std::array<double, 2>{CPLAtof(lowest), CPLAtof(highest)};
}

} // namespace

std::optional<double> metresPerHeightUnit(const std::string& name)
{
    if (name == "'" || name == "\u2032")
        return 0.3048;
    std::string key;
    for (const char c : name)
        // Beyond ASCII nothing is left out: micrometres, whose sign is there, are no metres.
        if (std::isalnum(static_cast<unsigned char>(c)) || static_cast<unsigned char>(c) > 0x7f)
            key += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    struct Unit
    {
        double metres;
        std::vector<const char*> names;
    };
    static const Unit units[] = {
        {1.0, {"m", "metre", "metres", "meter", "meters"}},
        {0.3048,
         {"ft", "foot", "feet", "internationalft", "internationalfoot", "internationalfeet",
          "intlft", "intlfoot", "intlfeet", "ftinternational", "footinternational",
          "feetinternational", "ftintl", "footintl", "feetintl", "fti"}},
        {1200.0 / 3937.0,
         {"ftus", "footus", "feetus", "usft", "usfoot", "usfeet", "surveyft", "surveyfoot",
          "surveyfeet", "ussurveyft", "ussurveyfoot", "ussurveyfeet", "ftussurvey", "footussurvey",
          "feetussurvey", "ftsurvey", "footsurvey", "feetsurvey"}},
        {1000.0, {"km", "kilometre", "kilometres", "kilometer", "kilometers"}},
        {0.1, {"dm", "decimetre", "decimetres", "decimeter", "decimeters"}},
        {0.01, {"cm", "centimetre", "centimetres", "centimeter", "centimeters"}},
        {0.001, {"mm", "millimetre", "millimetres", "millimeter", "millimeters"}},
        {0.9144, {"yd", "yard", "yards"}},
        {1.8288, {"fath", "fathom", "fathoms"}}};
    for (const Unit& unit : units)
        if (std::find(unit.names.begin(), unit.names.end(), key) != unit.names.end())
            return unit.metres;
    return std::nullopt;
}

Result<PixelFacts> readPixelFacts(const std::string& path, GDALDataset& dataset, int band)
{
    PixelFacts facts;
    GDALRasterBand& asked = *dataset.GetRasterBand(band);
    if (auto error = readType(path, asked, band, facts))
        return *error;
    if (auto error = readScale(path, asked, facts))
        return *error;
    facts.noData = readNoData(asked, facts);
    readMask(dataset, asked, facts);
    return facts;
}

bool readPixels(GDALDataset& dataset, int band, const PixelFacts& facts, int column, int row,
                int width, PixelRow& pixels)
{
    const auto read = [&](GDALRasterBand& from, std::vector<float>& to)
    {
        to.resize(static_cast<std::size_t>(width));
        return from.RasterIO(GF_Read, column, row, width, 1, to.data(), width, 1, GDT_Float32, 0, 0,
                             nullptr) == CE_None;
    };
    GDALRasterBand& asked = *dataset.GetRasterBand(band);
    std::vector<float> mask;
    if (!read(asked, pixels.values))
        return false;
    if (facts.hasMask &&
        !read(facts.alphaBand != 0 ? *dataset.GetRasterBand(facts.alphaBand) : *asked.GetMaskBand(),
              mask))
        return false;
    pixels.isVoid.assign(pixels.values.size(), false);
    for (std::size_t i = 0; i < pixels.values.size(); ++i)
    {
        float& value = pixels.values[i];
        if (facts.signedBytes && value > 127.0f)
            value -= 256.0f;
        const bool isNoData = facts.noData && (std::isnan(*facts.noData)
                                                   ? std::isnan(value)
                                                   : value == static_cast<float>(*facts.noData));
        pixels.isVoid[i] = isNoData || (!mask.empty() && !(mask[i] > 0.0f));
        value = static_cast<float>(static_cast<double>(value) * facts.scale + facts.offset);
    }
    return true;
}

Result<BandFacts> readBandFacts(const std::string& path, GDALDataset& dataset, int band,
                                const std::string& givenUnit, std::vector<std::string>& notes)
{
    Result<PixelFacts> pixels = readPixelFacts(path, dataset, band);
    if (!pixels)
        return pixels.error();
    BandFacts facts;
    static_cast<PixelFacts&>(facts) = std::move(*pixels);
    GDALRasterBand& asked = *dataset.GetRasterBand(band);
    const OGRSpatialReference* crs = dataset.GetSpatialRef();
    if (auto error = checkHeights(path, asked, band, dataset.GetRasterCount(), facts, notes))
        return *error;
    if (auto error = readUnit(path, asked, crs, givenUnit, facts, notes))
        return *error;
    facts.depths = pointsDown(asked, crs);
    if (facts.depths)
        notes.push_back("the vertical axis points down: depths become heights below 0");
    facts.statistics = readStatistics(asked);
    return facts;
}

} // namespace osgTerrainLight
