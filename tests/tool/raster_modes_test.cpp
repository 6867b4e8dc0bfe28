// horizon, svf, shadow and shade: what they write, read back with GDAL and OpenEXR.
#include "ToolRun.h"

#include "core/SyntheticTerrain.h"
#include "io/ExrFile.h"
#include "reference/ExhaustiveHorizon.h"

#include <algorithm>
#include <cmath>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{

constexpr float noData = -9999.0f;
const std::string quick = " --quality draft --azimuths 8";

std::pair<float, float> rangeOf(const std::vector<float>& values)
{
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return {*low, *high};
}

/// Checks the progress line: "0...10...20 … 100 - done.", once each, in order.
void expectProgress(const std::string& out)
{
    EXPECT_EQ(out.substr(0, out.find('\n')),
              "0...10...20...30...40...50...60...70...80...90...100 - done.");
}

using RasterModes = GlToolTest;

TEST_F(RasterModes, HorizonHasABandPerAzimuth)
{
    const ToolRun result = run("horizon " + jacksboro + " h.tif --body-radius 0" + quick);
    ASSERT_EQ(result.status, 0) << result.err;
    expectProgress(result.out);
    EXPECT_NE(result.out.find("horizon: 138632 posts, 8 azimuths, "), std::string::npos);
    EXPECT_NE(result.out.find(" million pixel-azimuths/s"), std::string::npos);
    EXPECT_EQ(result.err, "");

    const ReadRaster raster(path("h.tif"));
    expectSamePlace(raster, ReadRaster(jacksboro));
    ASSERT_EQ(raster.count, 8);
    EXPECT_EQ(raster.description(1), "horizon elevation at azimuth 0 degrees clockwise from north");
    EXPECT_EQ(raster.description(4),
              "horizon elevation at azimuth 135 degrees clockwise from north");
    for (int band = 1; band <= 8; ++band)
    {
        EXPECT_STREQ(raster.dataset->GetRasterBand(band)->GetUnitType(), "degree");
        EXPECT_EQ(raster.dataset->GetRasterBand(band)->GetRasterDataType(), GDT_Float32);
        EXPECT_EQ(raster.dataset->GetRasterBand(band)->GetNoDataValue(), double(noData));
        const auto [low, high] = rangeOf(raster.bands[static_cast<std::size_t>(band - 1)]);
        EXPECT_GE(low, -90.0f);
        EXPECT_LT(low, 0.0f) << "on a ridge the horizon lies below the horizontal";
        EXPECT_GT(high, 20.0f);
        EXPECT_LT(high, 60.0f);
    }
    EXPECT_EQ(raster.metadata("TERRAINLIGHT_MODE"), "horizon");
    EXPECT_EQ(raster.metadata("TERRAINLIGHT_AZIMUTHS"), "8");
    EXPECT_EQ(raster.metadata("TERRAINLIGHT_QUALITY"), "draft");
    EXPECT_EQ(raster.metadata("TERRAINLIGHT_VERSION"), OSGTERRAINLIGHT_VERSION);
    EXPECT_EQ(raster.metadata("TIFFTAG_SOFTWARE"), "osgTerrainLight " OSGTERRAINLIGHT_VERSION);
    EXPECT_EQ(left(), std::set<std::string>{"h.tif"});
}

// Bands, columns and rows are where the reference says: a crater off a symmetric size, so that a
// swapped axis or a wrong sense of azimuths shows.
TEST_F(RasterModes, HorizonBandsAgreeWithTheReference)
{
    ASSERT_EQ(run("generate crater c.tif --size 61,43 -q").status, 0);
    ASSERT_EQ(run("horizon c.tif h.tif --azimuths 12 --quality best -q").status, 0);
    const DemTile tile = generateTerrain(TerrainKind::Crater, 61, 43, 30.0, 1).value();
    const ReadRaster raster(path("h.tif"));
    ASSERT_EQ(raster.count, 12);
    double sum = 0.0;
    int count = 0;
    for (int band = 1; band <= 12; ++band)
        for (int row = 1; row < 42; row += 5)
            for (int column = 1; column < 60; column += 5)
            {
                const double expected =
                    reference::exhaustiveHorizon(tile, column, 42 - row,
                                                 directionOfCompass((band - 1) * 30.0))
                        .elevationDegrees();
                sum += std::abs(double(raster.at(band, column, row)) - expected);
                ++count;
            }
    // The crater is smooth; a mirrored or turned result is wrong by several degrees on average.
    EXPECT_LT(sum / count, 0.05);
}

TEST_F(RasterModes, SkyViewInThreeDefinitions)
{
    // A ramp of 45 degrees up to the north: CONVENTIONS has what an infinite one gives.
    const int size = 33;
    std::vector<float> heights;
    for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column)
            heights.push_back(static_cast<float>((size - 1 - row) * 10));
    writeRaster("ramp.tif", size, size, heights, {0, 10, 0, 0, 0, -10});
    const struct
    {
        const char* definition;
        double expected;
    } cases[] = {{"surface", 0.8536}, {"horizontal", 0.8536}, {"solid-angle", 0.75}};
    for (const auto& c : cases)
    {
        const ToolRun result =
            run(std::string("svf ramp.tif s.tif --azimuths 64 --definition ") + c.definition);
        ASSERT_EQ(result.status, 0) << result.err;
        const ReadRaster raster(path("s.tif"));
        EXPECT_EQ(raster.description(1), std::string("sky-view factor (") + c.definition + ")");
        EXPECT_EQ(raster.metadata("TERRAINLIGHT_DEFINITION"), c.definition);
        // However short the ramp, the horizon is its slope. 64 azimuths err by a few 1e-4.
        EXPECT_NEAR(raster.at(1, size / 2, size / 2), c.expected, 0.001) << c.definition;
    }
}

TEST_F(RasterModes, SkyViewOfRealTerrain)
{
    ASSERT_EQ(run("svf " + jacksboro + " s.tif -q" + quick).status, 0);
    const ReadRaster raster(path("s.tif"));
    expectSamePlace(raster, ReadRaster(jacksboro));
    ASSERT_EQ(raster.count, 1);
    const auto [low, high] = rangeOf(raster.bands[0]);
    EXPECT_GT(low, 0.6f);
    EXPECT_LE(high, 1.0001f);
}

TEST_F(RasterModes, ShadowFallsAwayFromTheSun)
{
    // A plain with one wall, 100 m high, in column 30 of 61; cells of 10 m.
    const auto wall = [](bool southUp)
    {
        std::vector<float> heights(61 * 41, 0.0f);
        for (int row = 0; row < 41; ++row)
            heights[static_cast<std::size_t>(row * 61 + 30)] = 100.0f;
        // A second bump that tells north from south: a wall across, near the northern edge.
        const int north = southUp ? 35 : 5;
        for (int column = 0; column < 20; ++column)
            heights[static_cast<std::size_t>(north * 61 + column)] = 100.0f;
        return heights;
    };
    writeRaster("north.tif", 61, 41, wall(false), {0, 10, 0, 410, 0, -10});
    writeRaster("south.tif", 61, 41, wall(true), {0, 10, 0, 0, 0, 10});
    for (const bool southUp : {false, true})
    {
        const std::string name = southUp ? "south.tif" : "north.tif";
        // tan 45° = 1: shadows are 10 posts long.
        ASSERT_EQ(run("shadow " + name + " east.tif --sun 90,45 -q").status, 0);
        const ReadRaster east(path("east.tif"));
        expectSamePlace(east, ReadRaster(path(name)));
        EXPECT_EQ(east.at(1, 25, 20), 0.0f) << "west of the wall";
        EXPECT_EQ(east.at(1, 35, 20), 1.0f) << "east of the wall";
        EXPECT_EQ(east.at(1, 15, 20), 1.0f) << "beyond the shadow";
        ASSERT_EQ(run("shadow " + name + " n.tif --sun 0,45 -q").status, 0);
        const ReadRaster north(path("n.tif"));
        const int inShadow = southUp ? 30 : 10;
        const int northOfIt = southUp ? 38 : 2;
        EXPECT_EQ(north.at(1, 10, inShadow), 0.0f) << "south of the wall across";
        EXPECT_EQ(north.at(1, 10, northOfIt), 1.0f) << "north of it";
        EXPECT_EQ(north.metadata("TERRAINLIGHT_SUN_AZIMUTH"), "0");
        EXPECT_EQ(north.metadata("TERRAINLIGHT_SUN_ELEVATION"), "45");
        EXPECT_EQ(north.metadata("TERRAINLIGHT_SUN_RADIUS"), "0.2666");
        EXPECT_EQ(north.metadata("TERRAINLIGHT_AZIMUTHS"), "");
    }
    ASSERT_EQ(run("shadow north.tif night.tif --sun 90,-5 -q").status, 0);
    EXPECT_EQ(rangeOf(ReadRaster(path("night.tif")).bands[0]), std::make_pair(0.0f, 0.0f));
    // A larger disc makes a half-shadow: more posts between 0 and 1.
    ASSERT_EQ(run("shadow north.tif soft.tif --sun 90,45 --sun-radius 8 -q").status, 0);
    const auto between = [](const std::vector<float>& values)
    {
        return std::count_if(values.begin(), values.end(),
                             [](float v) { return v > 0.01f && v < 0.99f; });
    };
    EXPECT_GT(between(ReadRaster(path("soft.tif")).bands[0]),
              between(ReadRaster(path("east.tif")).bands[0]) + 30);
}

// A level plain under a uniform sky of radiance L has shading L; the sun adds E sin(elevation) /
// pi.
TEST_F(RasterModes, ShadeOfAPlainIsTheClosedForm)
{
    writeRaster("plain.tif", 20, 10, std::vector<float>(200, 7.0f), {0, 10, 0, 0, 0, -10});
    const auto shade = [&](const std::string& options)
    {
        const ToolRun result = run("shade plain.tif s.tif -q --azimuths 8 --sky-radiance "
                                   "0.25,0.5,1 --sun-irradiance 3,2,1 " +
                                   options);
        EXPECT_EQ(result.status, 0) << result.err;
        const ReadRaster raster(path("s.tif"));
        EXPECT_EQ(raster.count, 4);
        return std::vector<float>{raster.at(1, 9, 4), raster.at(2, 9, 4), raster.at(3, 9, 4),
                                  raster.at(4, 9, 4)};
    };
    const auto expect = [](const std::vector<float>& found, const std::vector<double>& expected)
    {
        for (std::size_t i = 0; i < 4; ++i) // half floats: 11 bits
            EXPECT_NEAR(found[i], expected[i], 1e-3) << "band " << i + 1;
    };
    const double sun = 0.5 / 3.14159265358979; // sin 30° / pi
    expect(shade("--no-sun"), {0.25, 0.5, 1.0, 1.0});
    expect(shade("--sun 100,30 --sky none"), {3 * sun, 2 * sun, sun, 1.0});
    expect(shade("--sun 100,30"), {0.25 + 3 * sun, 0.5 + 2 * sun, 1.0 + sun, 1.0});
    expect(shade("--sun 100,-30"), {0.25, 0.5, 1.0, 0.0});
}

// A plain gets L from an environment of radiance L, and 7/9 of an overcast sky's zenith (Moon and
// Spencer 1942). A clear sky is brighter than none, and dark at night.
TEST_F(RasterModes, ShadeOfAPlainUnderOtherSkies)
{
    writeRaster("plain.tif", 20, 10, std::vector<float>(200, 7.0f), {0, 10, 0, 0, 0, -10});
    ExrImage panorama;
    panorama.width = 16;
    panorama.height = 8;
    panorama.channels = {{"R", std::vector<float>(128, 0.25f)},
                         {"G", std::vector<float>(128, 0.5f)},
                         {"B", std::vector<float>(128, 1.0f)}};
    ASSERT_TRUE(writeExr(path("even sky.exr"), panorama).ok());
    const auto shade = [&](const std::string& options)
    {
        const ToolRun result = run("shade plain.tif s.tif -q --azimuths 32 " + options);
        EXPECT_EQ(result.status, 0) << result.err;
        return ReadRaster(path("s.tif"));
    };
    const auto expect = [](const ReadRaster& found, const std::vector<double>& expected)
    {
        for (int band = 1; band <= 3; ++band)
            EXPECT_NEAR(static_cast<double>(found.at(band, 9, 4)) / expected[std::size_t(band - 1)],
                        1.0, 2e-3)
                << band;
    };
    const ReadRaster even = shade("--sky 'even sky.exr' --sky-heading 33");
    expect(even, {0.25, 0.5, 1.0});
    EXPECT_EQ(even.metadata("TERRAINLIGHT_SKY"), "even sky.exr");
    EXPECT_EQ(even.metadata("TERRAINLIGHT_SUN"), "no");
    expect(shade("--sky 'even sky.exr' --sky-gain 3 --bounces 1"), {0.75, 1.5, 3.0});
    expect(shade("--sky overcast --no-sun --sky-radiance 0.9,1.8,2.7"), {0.7, 1.4, 2.1});
    const ReadRaster clear = shade("--sky clear --turbidity 4 --sun 100,40 --no-sun");
    EXPECT_EQ(clear.metadata("TERRAINLIGHT_TURBIDITY"), "4");
    EXPECT_EQ(clear.metadata("TERRAINLIGHT_SUN_ELEVATION"), "40");
    EXPECT_GT(clear.at(3, 9, 4), 0.05f);
    EXPECT_GT(clear.at(3, 9, 4), clear.at(1, 9, 4)); // blue
    EXPECT_LT(shade("--sky clear --sun 100,-30").at(2, 9, 4), 1e-4f);
    EXPECT_EQ(run("shade plain.tif t.tif -q --body-radius 1000").status, 1);
    EXPECT_EQ(shade("--body-radius 1737400 --sky none").metadata("TERRAINLIGHT_BODY_RADIUS"),
              "1737400");
    EXPECT_EQ(left(), (std::set<std::string>{"even sky.exr", "plain.tif", "s.tif"}));
}

TEST_F(RasterModes, ShadeMetadataAndCreationOptions)
{
    const ToolRun result = run("shade " + jacksboro +
                               " s.tif --sun 120,40 -co COMPRESS=DEFLATE -co TILED=YES "
                               "-srcwin 10 20 100 50" +
                               quick);
    ASSERT_EQ(result.status, 0) << result.err;
    expectProgress(result.out);
    EXPECT_NE(result.out.find("shade: 5000 posts, 11 azimuths, "), std::string::npos) << result.out;
    const ReadRaster raster(path("s.tif"));
    const ReadRaster input(jacksboro);
    EXPECT_EQ(raster.width, 100);
    EXPECT_EQ(raster.height, 50);
    EXPECT_DOUBLE_EQ(raster.transform[0], input.transform[0] + 10 * input.transform[1]);
    EXPECT_DOUBLE_EQ(raster.transform[3], input.transform[3] + 20 * input.transform[5]);
    EXPECT_STREQ(raster.dataset->GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE"), "DEFLATE");
    EXPECT_EQ(raster.metadata("TERRAINLIGHT_SKY"), "uniform");
    EXPECT_EQ(raster.metadata("TERRAINLIGHT_SKY_RADIANCE"), "0.21,0.26,0.35");
    EXPECT_EQ(raster.metadata("TERRAINLIGHT_SUN_AZIMUTH"), "120");
    EXPECT_EQ(raster.metadata("TERRAINLIGHT_SUN_IRRADIANCE"), "3,2.85,2.6");
    EXPECT_EQ(raster.description(4), "visible fraction of the sun");
}

TEST_F(RasterModes, ShadeByKeyLightsAndAHarmonicSky)
{
    const ToolRun result = run("shade " + jacksboro +
                               " s.tif --no-sun --key-light 300,30,20,50,6,4,2 "
                               "--key-light 10,40,-5,15 --sky-harmonics 1,0,0.2,0 "
                               "-srcwin 10 20 60 50" +
                               quick);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("shade: 3000 posts, 14 azimuths, "), std::string::npos) << result.out;
    const ReadRaster raster(path("s.tif"));
    EXPECT_EQ(raster.metadata("TERRAINLIGHT_SKY"), "harmonics");
    EXPECT_EQ(raster.metadata("TERRAINLIGHT_SKY_HARMONICS"), "1,1,1,0,0,0,0.2,0.2,0.2,0,0,0");
    EXPECT_EQ(raster.metadata("TERRAINLIGHT_SKY_RADIANCE"), "");
    EXPECT_EQ(raster.metadata("TERRAINLIGHT_KEY_LIGHTS"), "300,30,20,50,6,4,2;10,40,-5,15,1,1,1");
}

TEST_F(RasterModes, ShadeExrHasTheSameValuesNorthFirst)
{
    const std::string window = " -q -srcwin 0 0 60 40" + quick;
    ASSERT_EQ(run("shade " + jacksboro + " s.exr" + window).status, 0);
    ASSERT_EQ(run("shade " + jacksboro + " s.tif" + window).status, 0);
    const Result<ExrImage> exr = readExr(path("s.exr"));
    ASSERT_TRUE(exr.ok()) << exr.error().message;
    const ReadRaster tif(path("s.tif"));
    ASSERT_EQ(exr->width, 60);
    ASSERT_EQ(exr->height, 40);
    for (int band = 1; band <= 4; ++band)
    {
        const auto channel = std::find_if(exr->channels.begin(), exr->channels.end(),
                                          [&](const ExrChannel& c)
                                          { return c.name == std::string(1, "RGBA"[band - 1]); });
        ASSERT_NE(channel, exr->channels.end());
        EXPECT_EQ(channel->values, tif.bands[static_cast<std::size_t>(band - 1)]);
    }
    EXPECT_EQ(exr->text.at("TERRAINLIGHT_MODE"), "shade");
    EXPECT_EQ(left(), (std::set<std::string>{"s.exr", "s.tif"}));
}

TEST_F(RasterModes, ShadePictureIsExposedAndEncoded)
{
    writeRaster("plain.tif", 20, 10, std::vector<float>(200, 7.0f), {0, 10, 0, 0, 0, -10});
    const std::string light = " --no-sun --azimuths 8 -q --sky-radiance 0.25,0.25,0.25";
    // sRGB of 0.25 and 0.5 is 137 and 188 of 255; 0.25 · 2^3 is beyond white.
    const struct
    {
        const char* options;
        float expected;
    } cases[] = {{" p.png", 137},
                 {" p.png --exposure 1", 188},
                 {" p.png --exposure 3", 255},
                 {" p.png --exposure -20", 0},
                 {" p.jpg", 137}};
    for (const auto& c : cases)
    {
        ASSERT_EQ(run(std::string("shade plain.tif") + c.options + light).status, 0) << c.options;
        const std::string name = std::string(c.options).substr(1, 5);
        const ReadRaster picture(path(name));
        ASSERT_EQ(picture.count, 3);
        for (int band = 1; band <= 3; ++band)
            EXPECT_NEAR(picture.at(band, 9, 4), c.expected, name == "p.jpg" ? 2.0 : 1.0)
                << c.options;
    }
}

TEST_F(RasterModes, FormatOverridesExtension)
{
    ASSERT_EQ(
        run("shade " + jacksboro + " picture.dat -of PNG -q -srcwin 0 0 20 20" + quick).status, 0);
    const ReadRaster raster(path("picture.dat"));
    EXPECT_STREQ(raster.dataset->GetDriver()->GetDescription(), "PNG");
    EXPECT_EQ(raster.count, 3);
}

TEST_F(RasterModes, VoidsStayVoid)
{
    std::vector<float> heights(30 * 20);
    for (std::size_t i = 0; i < heights.size(); ++i)
        heights[i] = static_cast<float>(i % 7) * 3.0f;
    for (const std::size_t i : {0u, 31u, 299u, 599u})
        heights[i] = noData;
    writeRaster("v.tif", 30, 20, heights, {0, 10, 0, 0, 0, -10});
    for (const std::string mode : {"horizon", "svf", "shade", "shadow"})
    {
        const std::string azimuths = mode == "shadow" ? "" : " --azimuths 4";
        ASSERT_EQ(run(mode + " v.tif o.tif -q" + azimuths).status, 0) << mode;
        const ReadRaster raster(path("o.tif"));
        for (int band = 0; band < raster.count; ++band)
            for (std::size_t i = 0; i < heights.size(); ++i)
                ASSERT_EQ(raster.bands[static_cast<std::size_t>(band)][i] == noData,
                          heights[i] == noData)
                    << mode << " band " << band << " post " << i;
    }
    ASSERT_EQ(run("shade v.tif p.png -q --azimuths 4").status, 0);
    const ReadRaster picture(path("p.png"));
    ASSERT_EQ(picture.count, 4) << "voids need alpha";
    for (std::size_t i = 0; i < heights.size(); ++i)
        ASSERT_EQ(picture.bands[3][i], heights[i] == noData ? 0.0f : 255.0f);
    ASSERT_EQ(run("shade v.tif p.jpg -q --azimuths 4").status, 0);
    EXPECT_EQ(ReadRaster(path("p.jpg")).count, 3);
}

TEST_F(RasterModes, QuietSaysNothing)
{
    for (const std::string mode : {"horizon", "svf", "shade", "shadow"})
    {
        const ToolRun result =
            run(mode + " " + jacksboro + " o.tif -q --isolated -srcwin 0 0 50 50");
        EXPECT_EQ(result.status, 0);
        EXPECT_EQ(result.out + result.err, "");
    }
}

TEST_F(RasterModes, CellSizeStandsInForAMissingGeotransform)
{
    writeRaster("bare.tif", 8, 8, std::vector<float>(64, 1.0f), {});
    const ToolRun refused = run("svf bare.tif o.tif" + quick);
    EXPECT_EQ(refused.status, 1);
    EXPECT_TRUE(refused.complains("bare.tif: has no geotransform")) << refused.err;
    EXPECT_EQ(left(), std::set<std::string>{"bare.tif"});
    const ToolRun result = run("svf bare.tif o.tif --cell-size 30" + quick);
    EXPECT_EQ(result.status, 0);
    EXPECT_TRUE(result.complains("warning: bare.tif: no geotransform")) << result.err;
    double transform[6];
    EXPECT_NE(ReadRaster(path("o.tif")).dataset->GetGeoTransform(transform), CE_None);
}

TEST_F(RasterModes, SameResultTwice)
{
    for (const std::string name : {"a.tif", "b.tif"})
        ASSERT_EQ(run("shade " + jacksboro + " " + name + " -q -srcwin 0 0 120 80").status, 0);
    EXPECT_EQ(ReadRaster(path("a.tif")).bands, ReadRaster(path("b.tif")).bands);
}

} // namespace
