#include "io/RasterBand.h"

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

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

std::optional<Error> readType(const std::string& path, GDALRasterBand& band, int index, int count,
                              BandFacts& facts, std::vector<std::string>& notes)
{
    const GDALDataType type = band.GetRasterDataType();
    const std::string place = path + ": band " + std::to_string(index);
    facts.dataType = GDALGetDataTypeName(type);
    if (GDALDataTypeIsComplex(type))
        return Error{ErrorCode::NotSupported,
                     place + " holds complex numbers (" + facts.dataType + "); needed heights"};
    const char* pixelType = band.GetMetadataItem("PIXELTYPE", "IMAGE_STRUCTURE");
    facts.signedBytes = type == GDT_Byte && pixelType && EQUAL(pixelType, "SIGNEDBYTE");
    if (facts.signedBytes)
        facts.dataType = "Int8";
    facts.integer = GDALDataTypeIsInteger(type) != FALSE;
    facts.fitsFloat = type == GDT_Float32 || (facts.integer && GDALGetDataTypeSizeBits(type) <= 16);

    const GDALColorInterp colour = band.GetColorInterpretation();
    if (colour != GCI_Undefined && colour != GCI_GrayIndex && colour != GCI_PaletteIndex)
        return Error{ErrorCode::NotSupported, place + " of " + std::to_string(count) +
                                                  " is a picture's (" +
                                                  GDALGetColorInterpretationName(colour) +
                                                  "), not a DEM; needed a band of heights"};
    facts.hasColourTable = colour == GCI_PaletteIndex || band.GetColorTable() != nullptr;
    if (facts.hasColourTable)
        notes.push_back("the band has a colour table: its pixel values are taken as heights");
    return std::nullopt;
}

std::optional<double> readNoData(GDALRasterBand& band, const BandFacts& facts)
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

std::optional<Error> readScale(const std::string& path, GDALRasterBand& band, BandFacts& facts)
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

/// The unit of the CRS's vertical axis, or else, where the map itself is not in metres, the map's:
/// most heights come in the unit of their map, and gdaldem takes them so.
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
    facts.heightUnit = name ? name : "";
    facts.metresPerHeightUnit = metres;
    notes.push_back("no height unit is known: heights are taken in the map's, " + facts.heightUnit +
                    " (" + number(metres) + " m); --unit m tells of metres");
}

/// Some planetary products give radii in kilometres and no unit; their offset is the body's radius.
bool isRadiusInKilometres(const BandFacts& facts, const OGRSpatialReference* crs)
{
    return crs && (crs->IsProjected() || crs->IsGeographic()) && facts.offset > 0.0 &&
           std::abs(1000.0 * facts.offset / crs->GetSemiMajor() - 1.0) < 0.01;
}

std::optional<Error> readUnit(const std::string& path, GDALRasterBand& band,
                              const OGRSpatialReference* crs, const std::string& given,
                              BandFacts& facts, std::vector<std::string>& notes)
{
    facts.heightUnit = given.empty() ? band.GetUnitType() : given;
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

/// The band's own word, which netCDF's climate and forecast conventions have, goes before the
/// CRS's.
bool pointsDown(GDALRasterBand& band, const OGRSpatialReference* crs)
{
    if (const char* positive = band.GetMetadataItem("positive"))
        return EQUAL(positive, "down");
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

void readMask(GDALDataset& dataset, GDALRasterBand& band, BandFacts& facts)
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
    std::string key;
    for (const char c : name)
        if (std::isalnum(static_cast<unsigned char>(c)))
            key += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    struct Unit
    {
        const char* name;
        double metres;
    };
    constexpr double foot = 0.3048;
    constexpr double surveyFoot = 1200.0 / 3937.0;
    static const Unit units[] = {{"m", 1.0},
                                 {"metre", 1.0},
                                 {"metres", 1.0},
                                 {"meter", 1.0},
                                 {"meters", 1.0},
                                 {"ft", foot},
                                 {"foot", foot},
                                 {"feet", foot},
                                 {"internationalfoot", foot},
                                 {"internationalfeet", foot},
                                 {"footinternational", foot},
                                 {"ftus", surveyFoot},
                                 {"usft", surveyFoot},
                                 {"footus", surveyFoot},
                                 {"usfoot", surveyFoot},
                                 {"usfeet", surveyFoot},
                                 {"surveyfoot", surveyFoot},
                                 {"surveyfeet", surveyFoot},
                                 {"ussurveyft", surveyFoot},
                                 {"ussurveyfoot", surveyFoot},
                                 {"ussurveyfeet", surveyFoot},
                                 {"footussurvey", surveyFoot},
                                 {"km", 1000.0},
                                 {"kilometre", 1000.0},
                                 {"kilometer", 1000.0},
                                 {"dm", 0.1},
                                 {"decimetre", 0.1},
                                 {"decimeter", 0.1},
                                 {"cm", 0.01},
                                 {"centimetre", 0.01},
                                 {"centimeter", 0.01},
                                 {"yd", 0.9144},
                                 {"yard", 0.9144},
                                 {"yards", 0.9144},
                                 {"fath", 1.8288},
                                 {"fathom", 1.8288},
                                 {"fathoms", 1.8288},
                                 {"kilometres", 1000.0},
                                 {"kilometers", 1000.0},
                                 {"decimetres", 0.1},
                                 {"decimeters", 0.1},
                                 {"centimetres", 0.01},
                                 {"centimeters", 0.01},
                                 {"millimetres", 0.001},
                                 {"millimeters", 0.001},
                                 {"mm", 0.001},
                                 {"millimetre", 0.001},
                                 {"millimeter", 0.001}};
    for (const Unit& unit : units)
        if (key == unit.name)
            return unit.metres;
    return std::nullopt;
}

Result<BandFacts> readBandFacts(const std::string& path, GDALDataset& dataset, int band,
                                const std::string& givenUnit, std::vector<std::string>& notes)
{
    BandFacts facts;
    GDALRasterBand& asked = *dataset.GetRasterBand(band);
    const OGRSpatialReference* crs = dataset.GetSpatialRef();
    if (auto error = readType(path, asked, band, dataset.GetRasterCount(), facts, notes))
        return *error;
    if (auto error = readScale(path, asked, facts))
        return *error;
    if (auto error = readUnit(path, asked, crs, givenUnit, facts, notes))
        return *error;
    facts.depths = pointsDown(asked, crs);
    if (facts.depths)
        notes.push_back("the vertical axis points down: depths become heights below 0");
    facts.noData = readNoData(asked, facts);
    readMask(dataset, asked, facts);
    facts.statistics = readStatistics(asked);
    return facts;
}

} // namespace osgTerrainLight
