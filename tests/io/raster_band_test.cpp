#include "io/RasterBand.h"

#include "support/DemHeights.h"
#include "support/MemoryRaster.h"

#include <gtest/gtest.h>

// What GDAL says of a band, and what becomes of it: the rows of docs/INPUTS.md.

using namespace osgTerrainLight;

namespace
{
constexpr double surveyFoot = 1200.0 / 3937.0; // of the US Metric Law of 1866
constexpr double foot = 0.3048;

DemFile expectHeights(const MemoryRaster& raster, const std::vector<double>& expected,
                      const DemReadOptions& options = {})
{
    const Result<DemFile> read = readDem(raster.write(), options);
    EXPECT_TRUE(read) << (read ? "" : read.error().message);
    if (!read)
        return {};
    osgTerrainLight::expectHeights(*read, expected);
    return *read;
}

MemoryRaster onMap(const std::string& crs)
{
    MemoryRaster raster;
    raster.crs = crs;
    raster.transform = {980000, 100, 0, 200000, 0, -100};
    return raster;
}
} // namespace

TEST(RasterBand, AUnitOfTheBandGoesBeforeTheMaps)
{
    MemoryRaster raster = onMap("EPSG:2263"); // US survey feet
    for (const auto& [name, metres] :
         std::vector<std::pair<std::string, double>>{{"m", 1.0},
                                                     {"METERS", 1.0},
                                                     {"foot", foot},
                                                     {"us-ft", surveyFoot},
                                                     {"US survey foot", surveyFoot},
                                                     {"fathoms", 1.8288},
                                                     {"kilometre", 1000.0}})
    {
        raster.unit = name;
        const DemFile file = expectHeights(raster, {metres, 2 * metres, 3 * metres, 4 * metres});
        EXPECT_TRUE(file.notes.empty()) << file.notes.front();
    }
    for (const auto& [name, metres] :
         std::vector<std::pair<std::string, double>>{{"Feet (US survey)", surveyFoot},
                                                     {"feet US", surveyFoot},
                                                     {"U.S. survey ft", surveyFoot},
                                                     {"ft (international)", foot},
                                                     {"[ft_i]", foot}, // UCUM, as [ft_us]
                                                     {"[ft_us]", surveyFoot},
                                                     {"'", foot},
                                                     {"\u2032", foot}})
        EXPECT_EQ(metresPerHeightUnit(name), metres) << name;
    // Micrometres by either sign are no metres.
    for (const char* name : {"furlongs of old", "\u00b5m", "\u03bcm"})
    {
        raster.unit = name;
        EXPECT_NE(noteWith(expectHeights(raster, {1, 2, 3}), "is not known").find("as metres"),
                  std::string::npos)
            << name;
    }
}

TEST(RasterBand, AVerticalCrsHasTheUnit)
{
    EXPECT_TRUE(expectHeights(onMap("EPSG:2263+5703"), {1, 2, 3}).notes.empty()) << "metres";
    EXPECT_TRUE(expectHeights(onMap("EPSG:2263+6360"), {surveyFoot, 2 * surveyFoot}).notes.empty());
    EXPECT_TRUE(expectHeights(onMap("EPSG:32618+8228"), {foot, 2 * foot}).notes.empty())
        << "feet on a map in metres";
}

// Asked of a data set in memory, since GeoTIFF keeps no axis of its own making.
TEST(RasterBand, TheThirdAxisOfACrsCounts)
{
    const auto crsWith = [](const std::string& axis, const std::string& unit)
    {
        return "GEOGCRS[\"3D\",DATUM[\"d\",ELLIPSOID[\"GRS 1980\",6378137,298.257222101]],"
               "CS[ellipsoidal,3],AXIS[\"latitude\",north,ANGLEUNIT[\"degree\",0.0174532925199433]]"
               ","
               "AXIS[\"longitude\",east,ANGLEUNIT[\"degree\",0.0174532925199433]],AXIS[\"h\"," +
               axis + ",LENGTHUNIT[" + unit + "]]]";
    };
    const struct
    {
        std::string crs;
        double metresOfOne;
    } kinds[] = {{crsWith("up", "\"metre\",1"), 1.0},
                 {crsWith("up", "\"foot\",0.3048"), foot},
                 {crsWith("up", "\"US survey foot\",0.304800609601219"), surveyFoot},
                 {crsWith("down", "\"foot\",0.3048"), -foot},
                 {"EPSG:4979", 1.0},
                 {"EPSG:4269+6360", surveyFoot}, // degrees and NAVD88 in US survey feet
                 {"EPSG:4326+5831", -1.0}};      // depth below the tide
    GDALAllRegister();
    for (const auto& kind : kinds)
    {
        SCOPED_TRACE(kind.crs);
        const GDALDatasetUniquePtr dataset(GetGDALDriverManager()->GetDriverByName("MEM")->Create(
            "", 2, 2, 1, GDT_Float32, nullptr));
        OGRSpatialReference crs;
        ASSERT_EQ(crs.SetFromUserInput(kind.crs.c_str()), OGRERR_NONE);
        dataset->SetSpatialRef(&crs);
        std::vector<std::string> notes;
        const Result<BandFacts> facts = readBandFacts("a", *dataset, 1, "", notes);
        ASSERT_TRUE(facts) << facts.error().message;
        EXPECT_NEAR(facts->metresOf(1.0), kind.metresOfOne, 1e-12);
        EXPECT_EQ(notes.size(), kind.metresOfOne < 0.0 ? 1u : 0u);
    }
}

TEST(RasterBand, AMapInFeetHasHeightsInFeetAndSaysSo)
{
    const struct
    {
        const char* crs;
        double metres;
        const char* name;
    } maps[] = {{"EPSG:2222", foot, "foot"}, // Arizona, international feet
                {"EPSG:2225", surveyFoot, "US survey foot"},
                {"EPSG:3361", foot, "foot"}}; // South Carolina
    for (const auto& map : maps)
    {
        const MemoryRaster raster = onMap(map.crs);
        const DemFile file = expectHeights(raster, {map.metres, 2 * map.metres});
        EXPECT_NE(noteWith(file, "no height unit is known").find(map.name), std::string::npos);
        DemReadOptions options;
        options.heightUnit = "m";
        EXPECT_TRUE(expectHeights(raster, {1, 2, 3}, options).notes.empty());
    }
    EXPECT_TRUE(expectHeights(onMap("EPSG:32618"), {1, 2, 3}).notes.empty()) << "metres";
}

// Nobody measures heights in them, so a map in such a unit says nothing of its heights.
TEST(RasterBand, AMapInKilometresLinksOrYardsHasHeightsInMetresAndSaysSo)
{
    for (const auto& [crs, unit] : std::vector<std::pair<const char*, const char*>>{
             {"+proj=laea +lat_0=45 +lon_0=15 +ellps=WGS84 +units=km", "kilometre (1000 m)"},
             {"EPSG:30200", "Clarke's link"}, // Trinidad
             {"EPSG:24370", "Indian yard"}})
    {
        const DemFile file = expectHeights(onMap(crs), {1, 2, 3});
        EXPECT_NE(noteWith(file, "no height unit is known").find(unit), std::string::npos);
    }
}

// A tile holds 1e6 m on either side of its middle height; 1 … 6 m times a factor.
TEST(RasterBand, AFactorThatLeadsBeyondATileIsSaid)
{
    MemoryRaster raster;
    DemReadOptions options;
    options.heightFactor = 3e5; // 3e5 … 18e5, the middle is 10.5e5
    EXPECT_TRUE(expectHeights(raster, {3e5, 6e5, 9e5, 12e5, 15e5, 18e5}, options).notes.empty());
    options.heightFactor =
        5e5; // 5e5 … 30e5, the middle is 17.5e5: the first and last lie 12.5e5 off
    const Result<DemFile> some = readDem(raster.write(), options);
    ASSERT_TRUE(some) << some.error().message;
    EXPECT_EQ(some->tile.validCount(), 4u);
    EXPECT_NE(noteWith(*some, "2 posts more than 1e6 m from the middle"), "");
    options.heightFactor = 1e8;
    const Result<DemFile> none = readDem(raster.write(), options);
    ASSERT_FALSE(none);
    EXPECT_NE(none.error().message.find("all heights lie more than 1e6 m"), std::string::npos)
        << none.error().message;
}

TEST(RasterBand, UnitAndFactorGiven)
{
    MemoryRaster raster;
    raster.unit = "ft";
    DemReadOptions options;
    options.heightUnit = "us-ft";
    expectHeights(raster, {surveyFoot, 2 * surveyFoot}, options);
    options.heightFactor = 2.5;
    expectHeights(raster, {2.5 * surveyFoot, 5 * surveyFoot}, options);
    options.heightFactor = -1.0;
    const DemFile turned = expectHeights(raster, {-surveyFoot, -2 * surveyFoot}, options);
    EXPECT_NEAR(turned.lowest, -6 * surveyFoot, 1e-9);
    EXPECT_NEAR(turned.highest, -surveyFoot, 1e-9);
    options.heightUnit = "parsecs";
    const Result<DemFile> unknown = readDem(raster.write(), options);
    ASSERT_FALSE(unknown);
    EXPECT_NE(unknown.error().message.find("such as m, ft or us-ft"), std::string::npos);
    options.heightUnit = "";
    options.heightFactor = 0.0;
    EXPECT_FALSE(readDem(raster.write(), options));

    // A 16-bit picture of heights: no unit, no place, 65536 levels over 2000 m.
    raster = MemoryRaster();
    raster.type = GDT_UInt16;
    raster.transform.clear();
    raster.crs = "";
    raster.values = {0, 65535, 32768, 1, 2, 3};
    options.heightFactor = 2000.0 / 65535.0;
    options.cellSize = 30.0;
    expectHeights(raster, {0, 2000, 2000.0 * 32768 / 65535}, options);
}

TEST(RasterBand, AnAxisThatPointsDownMakesDepths)
{
    const DemFile file = expectHeights(onMap("EPSG:32618+5715"), {-1, -2, -3, -4});
    EXPECT_FALSE(noteWith(file, "points down").empty());
    expectHeights(onMap("EPSG:2263+6358"), {-surveyFoot, -2 * surveyFoot});
    MemoryRaster raster;
    raster.metadata = {{"positive", "down"}};
    raster.noData = 3;
    raster.offset = 10;
    expectHeights(raster, {-11, -12, missing, -14});
    raster = onMap("EPSG:32618+5715");
    raster.metadata = {{"positive", "up"}}; // the band's own word holds
    expectHeights(raster, {1, 2, 3});
}

// The standard names of the climate and forecast conventions whose values count downwards.
TEST(RasterBand, AStandardNameOfDepthsMakesDepths)
{
    MemoryRaster raster;
    for (const char* name : {"depth", "sea_floor_depth_below_sea_surface", "depth_below_geoid",
                             "sea_floor_depth_below_mean_sea_level"})
    {
        raster.metadata = {{"standard_name", name}};
        EXPECT_FALSE(noteWith(expectHeights(raster, {-1, -2, -3}), "points down").empty()) << name;
    }
    raster.metadata.push_back({"positive", "up"});
    expectHeights(raster, {1, 2, 3});
    raster.metadata = {{"standard_name", "height_above_mean_sea_level"}};
    EXPECT_TRUE(expectHeights(raster, {1, 2, 3}).notes.empty());
}

TEST(RasterBand, AWordForNoUnitIsNone)
{
    MemoryRaster feet = onMap("EPSG:2263");
    MemoryRaster metres;
    for (const char* word : {"unknown", "1", "none", "DN", "Unspecified", ""})
    {
        SCOPED_TRACE(word);
        feet.unit = metres.unit = word;
        EXPECT_FALSE(
            noteWith(expectHeights(feet, {surveyFoot, 2 * surveyFoot}), "no height unit").empty());
        EXPECT_TRUE(expectHeights(metres, {1, 2, 3}).notes.empty());
    }
}

TEST(RasterBand, TheItemUnitsIsAUnit)
{
    MemoryRaster raster;
    raster.metadata = {{"units", "km"}};
    EXPECT_TRUE(expectHeights(raster, {1000, 2000, 3000}).notes.empty());
    raster.unit = "ft"; // goes first
    expectHeights(raster, {foot, 2 * foot});
    raster.unit = "";
    raster.metadata = {{"units", "1"}};
    EXPECT_TRUE(expectHeights(raster, {1, 2, 3}).notes.empty());
}

TEST(RasterBand, CategoriesAreTold)
{
    GDALAllRegister();
    const GDALDatasetUniquePtr dataset(
        GetGDALDriverManager()->GetDriverByName("MEM")->Create("", 2, 2, 1, GDT_Byte, nullptr));
    CPLStringList names;
    names.AddString("water");
    names.AddString("wood");
    dataset->GetRasterBand(1)->SetCategoryNames(names.List());
    std::vector<std::string> notes;
    ASSERT_TRUE(readBandFacts("a", *dataset, 1, "", notes));
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("names of categories"), std::string::npos);
}

// Neighbours at the end of a type's range: 1 m apart after the scale, about 0 after the offset. All
// is exact in double; float would lose the last bits of 32 and more.
TEST(RasterBand, PixelTypes)
{
    const struct
    {
        GDALDataType type;
        double end, inwards;
    } types[] = {{GDT_Byte, 255.0, -8.0},
                 {GDT_Byte, 0.0, 8.0},
                 {GDT_UInt16, 65535.0, -8.0},
                 {GDT_Int16, 32767.0, -8.0},
                 {GDT_Int16, -32766.0, 8.0}, // below are the customary voids
                 {GDT_UInt32, 4294967295.0, -8.0},
                 {GDT_Int32, 2147483647.0, -8.0},
                 {GDT_Int32, -2147483648.0, 8.0},
                 {GDT_UInt64, 9007199254740992.0, -8.0},
                 {GDT_Int64, -9007199254740992.0, 8.0},
                 {GDT_Float32, 16777216.0, -8.0},
                 {GDT_Float64, 9007199254740992.0, -8.0}};
    for (const auto& each : types)
    {
        SCOPED_TRACE(GDALGetDataTypeName(each.type));
        MemoryRaster raster;
        raster.type = each.type;
        raster.scale = 0.125;
        raster.offset = -0.125 * each.end;
        raster.values.clear();
        std::vector<double> expected;
        for (int i = 0; i < 6; ++i)
        {
            raster.values.push_back(each.end + i * each.inwards);
            expected.push_back(0.125 * i * each.inwards);
        }
        EXPECT_TRUE(expectHeights(raster, expected).notes.empty());
    }
    MemoryRaster raster;
    for (const GDALDataType type : {GDT_CInt16, GDT_CInt32, GDT_CFloat32, GDT_CFloat64})
    {
        raster.type = type;
        const Result<DemFile> read = readDem(raster.write());
        ASSERT_FALSE(read);
        EXPECT_NE(read.error().message.find("holds complex numbers"), std::string::npos);
    }
}

TEST(RasterBand, ChannelsOfAPictureAreRefused)
{
    const auto read = [](GDALColorInterp colour)
    {
        const GDALDatasetUniquePtr dataset(
            GetGDALDriverManager()->GetDriverByName("MEM")->Create("", 2, 2, 3, GDT_Byte, nullptr));
        dataset->GetRasterBand(2)->SetColorInterpretation(colour);
        std::vector<std::string> notes;
        return readBandFacts("a.tif", *dataset, 2, "", notes);
    };
    for (const GDALColorInterp colour : {GCI_RedBand, GCI_GreenBand, GCI_BlueBand, GCI_AlphaBand,
                                         GCI_HueBand, GCI_CyanBand, GCI_BlackBand, GCI_YCbCr_YBand})
    {
        const Result<BandFacts> facts = read(colour);
        ASSERT_FALSE(facts) << GDALGetColorInterpretationName(colour);
        EXPECT_EQ(facts.error().message, std::string("a.tif: band 2 of 3 is a picture's (") +
                                             GDALGetColorInterpretationName(colour) +
                                             "), not a DEM; needed a band of heights");
    }
    for (const GDALColorInterp colour : {GCI_Undefined, GCI_GrayIndex, GCI_PaletteIndex})
        EXPECT_TRUE(read(colour)) << GDALGetColorInterpretationName(colour);
}

TEST(RasterBand, SignedBytes)
{
    MemoryRaster raster;
    raster.type = GDT_Byte;
    raster.creation = {"PIXELTYPE=SIGNEDBYTE"};
    raster.values = {0, 127, 128, 255, 236, 1}; // as GDAL before 3.7 writes them
    expectHeights(raster, {0, 127, -128, -1, -20, 1});
    raster.noData = -128;
    expectHeights(raster, {0, 127, missing, -1, -20, 1});
    raster.noData = 255; // the same byte counted without a sign
    expectHeights(raster, {0, 127, -128, missing, -20, 1});
    raster.noData.reset();
    raster.scale = 0.5;
    raster.offset = 100;
    expectHeights(raster, {100, 163.5, 36, 99.5, 90, 100.5});
    EXPECT_EQ(describeDem(raster.write())->dataType, "Int8");
    raster.creation.clear();
    expectHeights(raster, {100, 163.5, 164, 227.5, 218, 100.5});
}

TEST(RasterBand, AColourTableIsForDisplay)
{
    const auto said = [](const DemFile& file)
    { return noteWith(file, "colour table").find("taken as heights") != std::string::npos; };
    MemoryRaster raster;
    raster.colourTable = true;
    for (const GDALDataType type : {GDT_Byte, GDT_UInt16})
    {
        raster.type = type;
        EXPECT_TRUE(said(expectHeights(raster, {1, 2, 3, 4, 5, 6})));
    }
    raster.scale = 10.0; // the rest of what the band says holds as well
    raster.offset = -5.0;
    raster.unit = "ft";
    raster.noData = 4;
    EXPECT_TRUE(said(expectHeights(raster, {5 * foot, 15 * foot, 25 * foot, missing, 45 * foot})));
    raster = MemoryRaster(); // values that the table has no colour for
    raster.type = GDT_UInt16;
    raster.colourTable = true;
    raster.values = {0, 9535, 1000, 2, 1, 300};
    EXPECT_TRUE(said(expectHeights(raster, raster.values)));
}

TEST(RasterBand, AScaleThatIsNoneIsRefused)
{
    const double infinite = std::numeric_limits<double>::infinity();
    for (const auto& [scale, offset] : std::vector<std::pair<double, double>>{
             {0.0, 0.0}, {0.0, 100.0}, {missing, 0.0}, {infinite, 0.0}, {1.0, missing}})
    {
        const GDALDatasetUniquePtr dataset(GetGDALDriverManager()->GetDriverByName("MEM")->Create(
            "", 2, 2, 1, GDT_Int16, nullptr));
        dataset->GetRasterBand(1)->SetScale(scale);
        dataset->GetRasterBand(1)->SetOffset(offset);
        std::vector<std::string> notes;
        const Result<BandFacts> facts = readBandFacts("a.tif", *dataset, 1, "", notes);
        ASSERT_FALSE(facts) << scale << ", " << offset;
        EXPECT_EQ(facts.error().message.rfind("a.tif: band scale ", 0), 0u);
    }
    MemoryRaster raster;
    raster.scale = -2.0; // turns heights over, as GDAL has it
    raster.offset = 100.0;
    expectHeights(raster, {98, 96, 94, 92, 90, 88});
}

TEST(RasterBand, MasksSayWhatIsVoid)
{
    MemoryRaster raster;
    raster.datasetMask = {255, 0, 255, 1, 255, 0};
    EXPECT_TRUE(expectHeights(raster, {1, missing, 3, 4, 5, missing}).notes.empty());
    EXPECT_TRUE(describeDem(raster.write())->hasMask);
    raster.noData = 3; // GDAL asks the mask alone then
    raster.type = GDT_Int16;
    raster.scale = 2.0;
    expectHeights(raster, {2, missing, missing, 8, 10, missing});
    raster.datasetMask = {1, 1, 1, 1, 1, 0};
    raster.noData.reset();
    raster.values = {10, -32768, 12, 13, 14, -32768}; // one below the mask, which is not counted
    const DemFile file = expectHeights(raster, {20, missing, 24, 26, 28, missing});
    EXPECT_EQ(noteWith(file, "-32768").rfind("1 post of", 0), 0u);
    EXPECT_FALSE(describeDem(MemoryRaster().write())->hasMask);
}

// GDAL itself makes a mask of the alpha in two or four bands of Byte or UInt16 only.
TEST(RasterBand, AnAlphaBandOfAnyTypeSaysWhatIsVoid)
{
    for (const GDALDataType type :
         {GDT_Byte, GDT_UInt16, GDT_Int16, GDT_Int32, GDT_Float32, GDT_Float64})
        for (const int bands : {2, 3, 4, 5})
        {
            SCOPED_TRACE(std::string(GDALGetDataTypeName(type)) + " " + std::to_string(bands));
            MemoryRaster raster;
            raster.type = type;
            raster.bands = bands;
            raster.creation = {"PHOTOMETRIC=MINISBLACK", "ALPHA=YES"};
            raster.noData = 3; // GDAL asks this alone where both are there
            const std::string path = raster.write();
            {
                const GDALDatasetUniquePtr dataset(
                    GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
                for (int i = 2; i <= bands; ++i)
                    dataset->GetRasterBand(i)->SetColorInterpretation(i == bands ? GCI_AlphaBand
                                                                                 : GCI_Undefined);
                // A byte of a fraction would be 0.
                std::vector<double> alpha = {255, 0,  255, GDALDataTypeIsInteger(type) ? 1 : 0.25,
                                             0,   255};
                ASSERT_EQ(dataset->GetRasterBand(bands)->RasterIO(
                              GF_Write, 0, 0, 3, 2, alpha.data(), 3, 2, GDT_Float64, 0, 0, nullptr),
                          CE_None);
            }
            const Result<DemFile> file = readDem(path);
            ASSERT_TRUE(file) << file.error().message;
            osgTerrainLight::expectHeights(*file, {1, missing, missing, 4, missing, 6});
            EXPECT_TRUE(describeDem(path)->hasMask);
        }
}

TEST(RasterBand, StatisticsAreToldAndNotUsed)
{
    using Metadata = std::vector<std::pair<std::string, std::string>>;
    const struct
    {
        Metadata metadata;
        std::optional<std::array<double, 2>> told;
    } kinds[] = {
        {{{"STATISTICS_MINIMUM", "2.5"}, {"STATISTICS_MAXIMUM", "4.5"}}, {{2.5, 4.5}}}, // older
        {{{"STATISTICS_MINIMUM", "-9999"}, {"STATISTICS_MAXIMUM", "-9999"}}, {{-9999, -9999}}},
        {{{"STATISTICS_MINIMUM", "1"}, {"STATISTICS_MAXIMUM", "1e30"}}, {{1, 1e30}}},
        {{{"STATISTICS_MINIMUM", "1"}}, std::nullopt},
        {{{"STATISTICS_MEAN", "3"}}, std::nullopt}};
    for (const auto& kind : kinds)
    {
        MemoryRaster raster;
        raster.metadata = kind.metadata;
        EXPECT_TRUE(expectHeights(raster, {1, 2, 3, 4, 5, 6}).notes.empty());
        const Result<DemInfo> info = describeDem(raster.write());
        ASSERT_TRUE(info);
        EXPECT_EQ(info->statistics, kind.told);
    }
}

TEST(RasterBand, TheCoordinateEpochIsKept)
{
    MemoryRaster raster;
    raster.transform = {10, 0.001, 0, 50, 0, -0.001};
    raster.crs = "EPSG:9000"; // ITRF2014
    raster.epoch = 2021.5;
    EXPECT_EQ(readDem(raster.write())->frame.coordinateEpoch, 2021.5);
    EXPECT_EQ(readDemReduced(raster.write(), {}, 2)->frame.coordinateEpoch, 2021.5);
    DemReadOptions part;
    part.window = PixelWindow{1, 0, 2, 2};
    EXPECT_EQ(readDem(raster.write(), part)->frame.coordinateEpoch, 2021.5);
    raster.epoch = 0.0;
    EXPECT_EQ(readDem(raster.write())->frame.coordinateEpoch, 0.0);
    raster = onMap("EPSG:7849"); // GDA2020, zone 49
    raster.epoch = 2020.25;
    EXPECT_EQ(readDem(raster.write())->frame.coordinateEpoch, 2020.25);
}

// 1737.4 is the Moon's radius in kilometres. Three terrains of 1737 m that are none: not on the
// Moon, in metres by their unit, and with a height that no radius has.
TEST(RasterBand, RadiiInKilometresWithoutAUnit)
{
    MemoryRaster raster;
    raster.crs = "+proj=eqc +R=1737400 +units=m";
    raster.transform = {0, 100, 0, 4000, 0, -100};
    raster.type = GDT_Float64;
    raster.values = {1737.4, 1737.5, 1737.25, 1730, 1747, 1737.4};
    const DemFile file = expectHeights(raster, {0, 100, -150, -7400, 9600, 0});
    EXPECT_NE(noteWith(file, "kilometres").find("1737400 m come off"), std::string::npos);
    raster.unit = "m";
    EXPECT_TRUE(expectHeights(raster, raster.values).notes.empty());
    raster.unit = "";
    raster.values[3] = 800;
    EXPECT_TRUE(expectHeights(raster, raster.values).notes.empty());
    raster = MemoryRaster();
    raster.values.assign(6, 6378.0); // the Earth's mountains are as high as its radius in km
    EXPECT_TRUE(expectHeights(raster, raster.values).notes.empty());
}

TEST(RasterBand, VoidsAmongRadiiAreToldAsSuch)
{
    MemoryRaster raster;
    raster.crs = "+proj=eqc +R=1737400 +units=m";
    raster.transform = {0, 100, 0, 4000, 0, -100};
    raster.values = {1737400, 1737500, 0, 1737400, 1737400, 0};
    const DemFile file = expectHeights(raster, {0, 100, missing, 0, 0, missing});
    EXPECT_EQ(noteWith(file, "taken as void"),
              "2 posts that are no radii of the body, half to one and a half of its own: taken as "
              "void");
}

// Radii without a CRS that names their body, floats' ends for voids, a wrong unit, a customary
// void.
TEST(RasterBand, ARasterOfVoidsAloneSaysWhyTheyAreVoid)
{
    const auto errorOf = [](const std::vector<double>& values, const char* crs, const char* unit)
    {
        MemoryRaster raster;
        raster.type = GDT_Float64;
        raster.values = values;
        raster.crs = crs;
        DemReadOptions options;
        options.heightUnit = unit;
        const Result<DemFile> read = readDem(raster.write(), options);
        EXPECT_FALSE(read);
        return read ? "" : read.error().message;
    };
    for (const std::string& message :
         {errorOf({1737001, 1737002, 1737003, 1737004, 1737005, 1737006}, "", ""),
          errorOf({3e38, 3e38, 3e38, -3e38, -3e38, -3e38}, "EPSG:32633", ""),
          errorOf({1200, 1300, 1400, 1500, 1600, 1700}, "EPSG:32633", "km")})
        EXPECT_NE(message.find("all of 3 x 2 posts are void; 6 posts without a finite height "
                               "within ±1e6 m"),
                  std::string::npos)
            << message;
    EXPECT_NE(errorOf({-99999, -99999, -99999, -99999, -99999, -99999}, "EPSG:32633", "")
                  .find("void; 6 posts of -99999, which is no declared nodata value"),
              std::string::npos);
}

TEST(RasterBand, RadiiBecomeHeightsOfTheirBody)
{
    const auto body = [](double radius)
    { return "+proj=eqc +units=m +R=" + std::to_string(radius); };
    MemoryRaster raster;
    raster.crs = body(3396190);
    raster.transform = {0, 463, 0, 100000, 0, -463};
    raster.type = GDT_Int16;
    raster.offset = 3396000; // Mars, MOLA's sphere
    raster.values = {-4000, -100, 0, 100, 21000, 190};
    DemFile file = expectHeights(raster, {-4190, -290, -190, -90, 20810, 0});
    EXPECT_NE(noteWith(file, "radii").find("3396190 m come off"), std::string::npos);

    raster = MemoryRaster();
    raster.transform = {0, 100, 0, 1000, 0, -100};
    raster.crs = body(11100); // Phobos: no body's hills are higher for its size
    raster.values = {9000, 13100, 11100, 10000, 11000, 12000};
    expectHeights(raster, {-2100, 2000, 0, -1100, -100, 900});

    raster = MemoryRaster();
    raster.crs = "+proj=longlat +R=1737400";
    raster.transform = {10, 0.1, 0, 1, 0, -0.1};
    raster.type = GDT_Float64;
    raster.offset = 1737.4; // kilometres, without a word
    raster.values = {-2.5, 0, 1.25, 0.5, 0.25, 0};
    file = expectHeights(raster, {-2500, 0, 1250, 500, 250, 0});
    EXPECT_NE(noteWith(file, "kilometres").find("so are its heights"), std::string::npos);

    raster.offset = 0;
    raster.values = {1737500, 1737300, 0, 1737400, missing, 1737401}; // 0: outside the survey
    file = expectHeights(raster, {100, -100, missing, 0, missing, 1});

    raster.values = {1500, 1800, -200, 0, 900, 3000}; // heights of the Moon
    EXPECT_TRUE(expectHeights(raster, raster.values).notes.empty());
}

TEST(CustomaryVoids, AlwaysWhereNoTerrainLiesSoDeep)
{
    for (const double value : {-32768.0, -32767.0, -99999.0, -3.4e38})
        for (const std::optional<double> declared : {std::optional<double>(), std::optional(7.0)})
        {
            MemoryRaster raster;
            raster.values = {1, value, 3, 4, value + 1, 7};
            raster.noData = declared;
            const bool lone = value < -1e6; // float has no value + 1 beside it
            const DemFile file = expectHeights(
                raster, {1, missing, 3, 4, lone || value == -32768.0 ? missing : value + 1,
                         declared ? missing : 7});
            EXPECT_EQ(file.notes.empty(), false);
        }
    // Half metres, as of planets: deeper than any basin.
    MemoryRaster raster;
    raster.type = GDT_Int16;
    raster.scale = 0.5;
    raster.values = {100, -32768, 300, -32700, 500, 600};
    expectHeights(raster, {50, missing, 150, -16350, 250, 300});
}

TEST(CustomaryVoids, OthersWhereNothingElseIsNear)
{
    MemoryRaster raster;
    raster.type = GDT_Int32;
    raster.values = {200, -9999, 300, -9999, 500, 600};
    DemFile file = expectHeights(raster, {200, missing, 300, missing, 500, 600});
    EXPECT_NE(noteWith(file, "2 posts of -9999").find("taken as void"), std::string::npos);

    raster.values = {-8000, -9999, -9001, -10400, -9999, -9500}; // a trench
    file = expectHeights(raster, raster.values);
    EXPECT_NE(noteWith(file, "2 posts of -9999").find("taken as heights"), std::string::npos);

    raster.scale = 0.01; // centimetres of a shore
    raster.values = {-32000, -32768, -33500, -32767, -99999, 600};
    file = expectHeights(raster, {-320, -327.68, -335, -327.67, missing, 6});
    EXPECT_NE(noteWith(file, "1 post of -32768").find("taken as heights"), std::string::npos);
    EXPECT_NE(noteWith(file, "1 post of -99999").find("taken as void"), std::string::npos);

    raster.scale = 0.1;
    raster.values = {10, -32768, -32767, 20, -9999, 30}; // none of them speaks for another
    expectHeights(raster, {1, missing, missing, 2, missing, 3});

    raster = MemoryRaster();
    raster.unit = "ft"; // 9987 m
    raster.values = {-30000, -32768, -32600, -31000, -30500, -30400};
    expectHeights(raster, {-30000 * foot, -32768 * foot, -32600 * foot});
    raster.noData = -32768; // declared, so no custom is asked
    file = expectHeights(raster, {-30000 * foot, missing, -32600 * foot});
    EXPECT_TRUE(file.notes.empty());
}
