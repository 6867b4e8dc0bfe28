// Horizons of the GPU path against closed forms. Expected values come from AnalyticTerrain.h.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/Horizons.h"

#include "core/Raster.h"
#include "io/DemReader.h"
#include "lighting/TileLight.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{
constexpr double degrees = 180.0 / 3.14159265358979323846;

const HorizonQuality allQualities[] = {HorizonQuality::Draft, HorizonQuality::Normal,
                                       HorizonQuality::Best};

/// Index of the azimuth that looks east (0), north (m/4), west, south in turn.
int quarter(const HorizonMap& map, int quarters)
{
    return map.azimuthCount() / 4 * quarters;
}
} // namespace

TEST(HorizonClosedForm, PlaneIsLevelToTheLastBit)
{
    OTL_NEED_GL(context);
    for (HorizonQuality quality : allQualities)
        for (double height : {0.0, 4000.0, -11000.0})
        {
            const DemTile tile = analytic::plane(97, 61, 30.0, height);
            const HorizonMap map = gpuHorizons(context->state(), tile, 32, quality);
            for (int k = 0; k < 32; ++k)
                for (int y = 1; y < 60; ++y)
                    for (int x = 1; x < 96; ++x)
                        ASSERT_EQ(map.codeAt(x, y, k), HorizonMap::levelCode)
                            << x << ' ' << y << ' ' << k << ' ' << height;
        }
}

TEST(HorizonClosedForm, OffsetsOfMapAndDatumDoNotChangeABit)
{
    OTL_NEED_GL(context);
    // The way of a user: rasters in double, one near the origin, one at UTM coordinates and 1e6 m
    // up. Heights are multiples of 1/8 m, so both are exact in what the file holds.
    std::vector<HorizonMap> maps;
    for (const auto& [east, north, up] :
         {std::array{0.0, 0.0, 0.0}, std::array{512340.0, 9812340.0, 5.0e5}})
    {
        const std::string path = "/vsimem/offset.tif";
        GDALAllRegister();
        GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
        GDALDataset* raster = driver->Create(path.c_str(), 80, 70, 1, GDT_Float64, nullptr);
        ASSERT_NE(raster, nullptr);
        double transform[] = {east, 30.0, 0.0, north, 0.0, -30.0};
        raster->SetGeoTransform(transform);
        std::vector<double> heights;
        for (int y = 0; y < 70; ++y)
            for (int x = 0; x < 80; ++x)
                heights.push_back(up + 0.125 * ((x * x * 7 + y * 131 + x * y * 3) % 1999));
        ASSERT_EQ(raster->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, 80, 70, heights.data(), 80, 70,
                                                     GDT_Float64, 0, 0),
                  CE_None);
        GDALClose(raster);
        Result<DemFile> file = readDem(path);
        VSIUnlink(path.c_str());
        ASSERT_TRUE(file) << file.error().message;
        maps.push_back(gpuHorizons(context->state(), file->tile, 32, HorizonQuality::Best));
    }
    EXPECT_EQ(maps[0].codes(), maps[1].codes());
}

TEST(HorizonClosedForm, BeyondTheDataIsOpen)
{
    OTL_NEED_GL(context);
    const HorizonMap map = gpuHorizons(context->state(), analytic::plane(20, 30, 10.0, 0.0), 8,
                                       HorizonQuality::Normal);
    EXPECT_EQ(map.elevationAt(19, 15, quarter(map, 0)), -90.0); // eastern edge, looking east
    EXPECT_EQ(map.elevationAt(5, 29, quarter(map, 1)), -90.0);
    EXPECT_EQ(map.elevationAt(0, 15, quarter(map, 2)), -90.0);
    EXPECT_EQ(map.elevationAt(5, 0, quarter(map, 3)), -90.0);
    EXPECT_EQ(map.elevationAt(5, 0, quarter(map, 1)), 0.0);
}

TEST(HorizonClosedForm, RampRisesWithItsSlopeInEveryDirection)
{
    OTL_NEED_GL(context);
    const AzimuthSet azimuths(32);
    for (HorizonQuality quality : allQualities)
        for (const auto& [east, north] : {std::pair{1.0, 0.0}, {0.0, -1.0}, {0.5, 0.25}})
        {
            const DemTile tile = analytic::ramp(129, 117, 30.0, east, north);
            const HorizonMap map = gpuHorizons(context->state(), tile, 32, quality);
            for (int k = 0; k < 32; ++k)
            {
                const double expected =
                    std::atan(analytic::rampHorizon(east, north, azimuths.direction(k))) * degrees;
                // One code is 0.00275 degrees; heights are float of up to 4e3 m: 2.4e-4 m per 30 m.
                ASSERT_NEAR(map.elevationAt(64, 58, k), expected, 0.0014 + 0.0006)
                    << k << ' ' << east << ' ' << north;
            }
        }
}

TEST(HorizonClosedForm, WallRisesByHeightOverDistance)
{
    OTL_NEED_GL(context);
    const DemTile tile = analytic::wall(301, 301, 10.0, 250, 200.0);
    const AzimuthSet azimuths(64);
    for (HorizonQuality quality : allQualities)
    {
        const HorizonMap map = gpuHorizons(context->state(), tile, 64, quality);
        for (int column : {30, 150, 240, 249})
            for (int k : {0, 3, 61}) // within 17 degrees of east
            {
                const double expected = std::atan(analytic::wallHorizon(
                                            200.0, (250 - column) * 10.0, azimuths.direction(k))) *
                                        degrees;
                EXPECT_NEAR(map.elevationAt(column, 150, k), expected, 0.1) << column << ' ' << k;
            }
    }
}

TEST(HorizonClosedForm, HillockCornerSeesItsDiagonalCrest)
{
    OTL_NEED_GL(context);
    const int centre = 60, foot = 40;
    const DemTile tile = analytic::hillock(121, 121, 5.0, centre, centre, foot, 10);
    for (HorizonQuality quality : allQualities)
    {
        const HorizonMap map = gpuHorizons(context->state(), tile, 8, quality);
        const double expected = std::atan(analytic::hillockCornerHorizon()) * degrees;
        EXPECT_NEAR(expected, 35.264, 0.001);
        EXPECT_NEAR(map.elevationAt(centre - foot, centre - foot, 1), expected, 0.05);
        EXPECT_NEAR(map.elevationAt(centre + foot, centre - foot, 3), expected, 0.05);
        EXPECT_NEAR(map.elevationAt(centre + foot, centre + foot, 5), expected, 0.05);
        EXPECT_NEAR(map.elevationAt(centre - foot, centre + foot, 7), expected, 0.05);
    }
}

TEST(HorizonClosedForm, ConeAndValleyWithinHalfAPercent)
{
    OTL_NEED_GL(context);
    for (HorizonQuality quality : {HorizonQuality::Normal, HorizonQuality::Best})
    {
        const DemTile cone = analytic::cone(301, 301, 10.0, 150, 150, 600.0, 800.0);
        const HorizonMap coneMap = gpuHorizons(context->state(), cone, 32, quality);
        const AzimuthSet set(32);
        for (const auto& [column, row] :
             {std::pair{60, 150}, {30, 150}, {10, 150}, {70, 80}, {190, 40}})
            for (int k = 0; k < 32; ++k)
            {
                const double x = (150 - column) * 10.0, y = (150 - row) * 10.0;
                const MapDirection d = set.direction(k);
                const double offset =
                    std::atan2(d.east * y - d.north * x, d.east * x + d.north * y);
                if (std::abs(offset) > 0.35) // near the cone's rim a ray only grazes it
                    continue;
                const double expected =
                    std::atan(analytic::coneHorizon(600.0, 800.0, std::hypot(x, y), offset)) *
                    degrees;
                EXPECT_NEAR(coneMap.elevationAt(column, row, k), expected, 0.005 * expected)
                    << column << ' ' << row << ' ' << k;
            }
        const DemTile valley = analytic::valley(201, 301, 20.0, 100, 0.6);
        const HorizonMap valleyMap = gpuHorizons(context->state(), valley, 32, quality);
        const AzimuthSet azimuths(32);
        for (int k : {0, 2, 5, 13, 16, 18})
        {
            const double expected =
                std::atan(analytic::valleyHorizon(0.6, azimuths.direction(k))) * degrees;
            EXPECT_NEAR(valleyMap.elevationAt(100, 150, k), expected, 0.005 * expected) << k;
        }
    }
}

TEST(HorizonClosedForm, VoidsNeitherCastNorReceive)
{
    OTL_NEED_GL(context);
    DemTile tile = analytic::wall(120, 60, 10.0, 80, 300.0);
    const HorizonMap whole = gpuHorizons(context->state(), tile, 16, HorizonQuality::Normal);
    EXPECT_GT(whole.elevationAt(20, 30, 0), 20.0);
    for (int y = 0; y < 60; ++y)
        for (int x = 80; x < 120; ++x)
            tile.setVoid(x, y);
    const HorizonMap cut = gpuHorizons(context->state(), tile, 16, HorizonQuality::Normal);
    for (int k = 0; k < 16; ++k)
    {
        EXPECT_LE(cut.elevationAt(20, 30, k), 0.0) << k;
        EXPECT_EQ(cut.codeAt(100, 30, k), HorizonMap::voidCode);
    }
}

TEST(HorizonClosedForm, SmallTilesWork)
{
    OTL_NEED_GL(context);
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 2}, {1, 600}, {600, 1}, {7, 3}})
        for (HorizonQuality quality : allQualities)
        {
            const DemTile tile = analytic::ramp(width, height, 30.0, 0.5, 0.25);
            const HorizonMap map = gpuHorizons(context->state(), tile, 16, quality);
            const double east = std::atan(0.5) * degrees;
            const double north = std::atan(0.25) * degrees;
            EXPECT_NEAR(map.elevationAt(0, height - 1, 0), width > 1 ? east : -90.0, 0.002);
            EXPECT_NEAR(map.elevationAt(width - 1, 0, 4), height > 1 ? north : -90.0, 0.002);
            EXPECT_EQ(map.elevationAt(width - 1, height - 1, 2), -90.0);
        }
}

TEST(HorizonClosedForm, HalfSphereOverflowsTheHullWithinABound)
{
    OTL_NEED_GL(context);
    // The sweep's worst stack: every post of the dome is a vertex of its line's hull. Only the part
    // of a line that lies behind the receiver's own rise is ever asked for, so receivers stand on
    // the ground.
    const DemTile tile = analytic::dome(1024, 1024, 10.0, 512, 512, 4500.0);
    LightingSettings settings;
    settings.azimuths = 16;
    SkyLight sky;
    sky.sunEnabled = false;
    osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
    ASSERT_TRUE(lighting->update(context->state()));
    const HorizonMap map = lighting->readHorizons(context->state());
    EXPECT_GT(lighting->readDroppedVertices(context->state()), 0u);
    const AzimuthSet set(16);
    double worst = 0.0;
    for (const auto& [column, row] :
         {std::pair{20, 512}, {512, 30}, {100, 100}, {40, 300}, {900, 950}})
        for (int k = 0; k < 16; ++k)
        {
            const double x = (512 - column) * 10.0, y = (512 - row) * 10.0;
            const MapDirection d = set.direction(k);
            const double offset = std::atan2(d.east * y - d.north * x, d.east * x + d.north * y);
            const double slope = analytic::domeHorizon(4500.0, std::hypot(x, y), offset);
            if (std::abs(offset) > 0.6 || slope <= 0.0)
                continue;
            worst = std::max(
                worst, std::abs(map.elevationAt(column, row, k) - std::atan(slope) * degrees));
        }
    // Thinned once or twice, the hull keeps a vertex at least every 16 posts = 160 m of the dome. A
    // tangent that misses its point by s <= 80 m along a circle of radius 4500 m drops by s^2/2r =
    // 0.71 m; seen from at least 400 m (the nearest crest) that is 0.10 degrees.
    EXPECT_LE(worst, 0.10);
    std::printf("half sphere, hull overflown: worst %.4f degrees\n", worst);
}

TEST(HorizonClosedForm, RepeatIsBitEqual)
{
    OTL_NEED_GL(context);
    const DemTile tile = analytic::dome(150, 140, 10.0, 75, 70, 600.0);
    const HorizonMap first = gpuHorizons(context->state(), tile, 64, HorizonQuality::Normal);
    const HorizonMap again = gpuHorizons(context->state(), tile, 64, HorizonQuality::Normal);
    EXPECT_EQ(first.codes(), again.codes());
}

TEST(HorizonClosedForm, ShadowOfAWallIsAsLongAsItsSunSays)
{
    OTL_NEED_GL(context);
    for (HorizonQuality quality : {HorizonQuality::Normal, HorizonQuality::Best})
        for (double elevation : {1.0, 5.0, 45.0})
        {
            const double rise = elevation < 2.0 ? 20.0 : 100.0;
            const DemTile tile = analytic::wall(400, 40, 10.0, 350, rise);
            const Raster<float> fraction =
                gpuSunFraction(context->state(), tile, 90.0, elevation, quality);
            // Half of the disc stands above the edge where the horizon is the sun's elevation.
            int lit = 349;
            while (lit > 0 && fraction.at(lit, 20) < 0.5f)
                --lit;
            const double length = 350 - lit;
            EXPECT_NEAR(length, rise / std::tan(elevation / degrees) / 10.0, 1.0) << elevation;

            // A slanting sun: the shadow reaches cos(20) as far across the wall.
            const Raster<float> slanting =
                gpuSunFraction(context->state(), analytic::wall(400, 400, 10.0, 350, rise), 110.0,
                               elevation, quality);
            lit = 349;
            while (lit > 0 && slanting.at(lit, 350) < 0.5f)
                --lit;
            EXPECT_NEAR(350 - lit,
                        rise / std::tan(elevation / degrees) / 10.0 * std::cos(20.0 / degrees), 1.0)
                << elevation;
        }
}
