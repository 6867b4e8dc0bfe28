// Heights that are brought to another vertical datum.
#include "io/HeightShift.h"

#include "io/CompositeDem.h"
#include "io/DemReader.h"
#include "support/GeoidGrid.h"
#include "support/MemoryRaster.h"
#include "support/TestFolder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

using namespace osgTerrainLight;

namespace
{
const std::string jacksboro = OTL_SOURCE_DIR "/samples/data/jacksboro_90m.tif";
const VerticalDatum ellipsoid = verticalDatumByName("ellipsoid");

/// A grid over the sample, as a datum.
template <class At>
VerticalDatum geoid(const char* name, const At& at)
{
    const std::filesystem::path path = testFolder() / name;
    writeGeoidGrid(path, -85.0, 36.0, 0.5, 4, 4, at);
    return verticalDatumByName(path.string());
}

RasterFrame frameOf(const std::string& path)
{
    const Result<DemInfo> info = describeDem(path);
    EXPECT_TRUE(info) << (info ? "" : info.error().message);
    return info ? info->frame : RasterFrame();
}

std::shared_ptr<const HeightShift> shiftOf(const VerticalDatum& from, const VerticalDatum& to,
                                           const std::string& path)
{
    const Result<HeightShift> shift = HeightShift::between(from, to, frameOf(path));
    EXPECT_TRUE(shift) << (shift ? "" : shift.error().message);
    return shift ? std::make_shared<HeightShift>(*shift) : nullptr;
}

double heightOf(const DemTile& tile, int column, int row)
{
    return tile.heightOrigin + double(tile.heightAt(column, row));
}
} // namespace

// Expected: what the grid's formula says at each post. A grid is bilinear between its nodes, and
// so is what is read of it, which is no error for a linear formula. Heights and nodes are floats:
// 1e-4 m.
TEST(HeightShift, HeightsMoveByTheGrid)
{
    const auto level = [](double, double) { return -30.25; };
    const auto ramp = [](double longitude, double latitude)
    { return 4.0 * (longitude + 84.0) - 8.0 * (latitude - 36.0); };
    const VerticalDatum low = geoid("level.gtx", level);
    const VerticalDatum tilted = geoid("ramp.gtx", ramp);
    const Result<DemFile> before = readDem(jacksboro);
    ASSERT_TRUE(before);
    const DemTile& plain = before->tile;
    struct Way
    {
        VerticalDatum from, to;
        double levels, ramps;
    };
    for (const Way& way : {Way{low, ellipsoid, 1.0, 0.0}, Way{ellipsoid, low, -1.0, 0.0},
                           Way{tilted, ellipsoid, 0.0, 1.0}, Way{tilted, low, -1.0, 1.0}})
    {
        DemReadOptions options;
        options.shift = shiftOf(way.from, way.to, jacksboro);
        ASSERT_TRUE(options.shift);
        const Result<DemFile> after = readDem(jacksboro, options);
        ASSERT_TRUE(after) << after.error().message;
        ASSERT_EQ(after->tile.postCount(), plain.postCount());
        for (int row = 0; row < plain.height(); ++row)
            for (int column = 0; column < plain.width(); ++column)
            {
                const double longitude = plain.mapOriginX + column * plain.mapStepX;
                const double latitude = plain.mapOriginY + row * plain.mapStepY;
                const double moved =
                    way.levels * level(longitude, latitude) + way.ramps * ramp(longitude, latitude);
                ASSERT_NEAR(heightOf(after->tile, column, row),
                            heightOf(plain, column, row) + moved, 1.0e-4)
                    << column << ", " << row;
            }
    }
}

// Expected: a raster that is read coarser, one in metres of a map, and the layers of a composite
// move by the same constant.
TEST(HeightShift, HoweverTheRasterIsRead)
{
    const VerticalDatum low = geoid("level.gtx", [](double, double) { return -30.25; });
    const std::string cone = OTL_SOURCE_DIR "/earth_files/data/cone.tif";
    for (const std::string& path : {jacksboro, cone})
    {
        DemReadOptions options;
        options.shift = shiftOf(low, ellipsoid, path);
        for (const int side : {50, 2048})
        {
            const Result<DemFile> before = readDemReduced(path, {}, side);
            const Result<DemFile> after = readDemReduced(path, options, side);
            ASSERT_TRUE(before && after);
            ASSERT_EQ(after->tile.validity(), before->tile.validity());
            EXPECT_NEAR(after->lowest, before->lowest - 30.25, 1.0e-4);
            EXPECT_NEAR(after->highest, before->highest - 30.25, 1.0e-4);
        }
    }
    DemReadOptions options;
    options.shift = shiftOf(low, ellipsoid, cone);
    const CompositeDem before = readComposite({{jacksboro, {}}, {cone, {}}}, 2048);
    const CompositeDem after = readComposite({{jacksboro, {}}, {cone, options}}, 2048);
    ASSERT_TRUE(before.tile && after.tile);
    int moved = 0, stayed = 0;
    for (int row = 0; row < before.tile->height(); ++row)
        for (int column = 0; column < before.tile->width(); ++column)
        {
            ASSERT_EQ(after.tile->isValid(column, row), before.tile->isValid(column, row));
            if (!before.tile->isValid(column, row))
                continue;
            const double by =
                heightOf(*after.tile, column, row) - heightOf(*before.tile, column, row);
            ASSERT_TRUE(std::abs(by) < 1.0e-3 || std::abs(by + 30.25) < 1.0e-3)
                << by << " of " << heightOf(*before.tile, column, row) << " at " << column << ", "
                << row;
            ++(by < -1.0 ? moved : stayed);
        }
    EXPECT_GT(moved, 1000); // the cone covers a circle of 2000 m
    EXPECT_GT(stayed, 10000);
}

// Expected: the check values that NGA gave with EGM96 (F477); PROJ's grid of 15' is bilinear
// between its nodes, which is within 0.3 m at these.
TEST(HeightShift, Egm96AtItsCheckPoints)
{
    const std::array<double, 3> checks[] = {{-90.220845, 38.6281550, -31.628},
                                            {102.4487290, 46.8743190, -43.575},
                                            {133.8747120, -23.6174460, 15.871},
                                            {-0.0005, 38.6254730, 50.066}};
    for (const auto& [longitude, latitude, undulation] : checks)
    {
        MemoryRaster raster;
        raster.crs = "EPSG:4326";
        raster.transform = {longitude - 1.5e-6, 1.0e-6, 0.0, latitude + 1.0e-6, 0.0, -1.0e-6};
        const Result<HeightShift> shift =
            HeightShift::between(verticalDatumByName("EGM96"), ellipsoid, frameOf(raster.write()));
        if (!shift)
            GTEST_SKIP() << "skipped: PROJ has no grid of EGM96 here: " << shift.error().message;
        EXPECT_NEAR(shift->at(longitude, latitude), undulation, 0.3) << longitude;
    }
}

// Expected: the names of one datum are one, in any case, and a compound CRS names its own.
TEST(HeightShift, NamesOfDatums)
{
    EXPECT_EQ(verticalDatumByName("EGM96").known, verticalDatumByName("epsg:5773").known);
    EXPECT_EQ(verticalDatumByName("WGS84").known, verticalDatumByName("ellipsoid").known);
    EXPECT_NE(verticalDatumByName("egm96").known, verticalDatumByName("egm2008").known);
    EXPECT_FALSE(verticalDatumByName("").isNamed());
    MemoryRaster raster;
    raster.crs = "EPSG:32633+5773";
    raster.creation = {"GEOTIFF_VERSION=1.1"};
    const VerticalDatum own = verticalDatumOfCrs(frameOf(raster.write()).crs);
    EXPECT_EQ(own.known, verticalDatumByName("egm96").known);
    EXPECT_EQ(own.name, "EGM96 height");
    raster.crs = "EPSG:32633";
    EXPECT_FALSE(verticalDatumOfCrs(frameOf(raster.write()).crs).isNamed());
}

// Expected: never 0 in place of a grid that is missing; the message says what is missing.
TEST(HeightShift, WhatCannotBeConvertedIsSaid)
{
    const VerticalDatum far =
        verticalDatumByName((testFolder() / "far.gtx").string()); // beside the sample
    writeGeoidGrid(testFolder() / "far.gtx", 10.0, 48.0, 0.5, 4, 4,
                   [](double, double) { return 40.0; });
    MemoryRaster noCrs;
    noCrs.crs = "";
    const struct
    {
        VerticalDatum datum;
        std::string path;
        const char* said;
    } wrongs[] = {
        {verticalDatumByName("no_such.gtx"), jacksboro,
         "PROJ finds no grid of the geoid of no_such"},
        {verticalDatumByName("epsg:999999"), jacksboro, "PROJ knows no vertical datum epsg:999999"},
        {verticalDatumByName("msl"), jacksboro, "PROJ knows no vertical datum msl"},
        {far, jacksboro, "does not cover longitude -84.4133, latitude 36.4467"},
        {geoid("level.gtx", [](double, double) { return 1.0; }), noCrs.write(), "has no CRS"}};
    for (const auto& [datum, path, said] : wrongs)
        for (const bool back : {false, true})
        {
            const Result<HeightShift> shift = HeightShift::between(
                back ? ellipsoid : datum, back ? datum : ellipsoid, frameOf(path));
            ASSERT_FALSE(shift) << said;
            EXPECT_NE(shift.error().message.find(said), std::string::npos) << shift.error().message;
        }
}
