#include "reference/ReferenceLight.h"

#include "support/AnalyticTerrain.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;
using namespace osgTerrainLight::reference;

namespace
{
constexpr double pi = 3.14159265358979323846;

void expectSkyView(const DemTile& tile, int column, int row, const analytic::SkyView& expected,
                   double bound)
{
    const HorizonRing ring = horizonRing(tile, column, row);
    const Vector3 normal = surfaceNormal(tile, column, row);
    EXPECT_NEAR(skyViewFactor(ring, SkyViewDefinition::SolidAngle, normal), expected.solidAngle,
                bound);
    EXPECT_NEAR(skyViewFactor(ring, SkyViewDefinition::Horizontal, normal), expected.horizontal,
                bound);
    EXPECT_NEAR(skyViewFactor(ring, SkyViewDefinition::Surface, normal), expected.surface, bound);
}
} // namespace

TEST(ReferenceNormal, IsTheRampsOwnAndNeedsOneCell)
{
    const DemTile tile = analytic::ramp(9, 7, 30.0, 0.5, -0.25);
    const double length = std::sqrt(1.0 + 0.25 + 0.0625);
    for (const auto& [column, row] : {std::pair{4, 3}, {0, 0}, {8, 0}, {8, 6}, {0, 3}})
    {
        const Vector3 n = surfaceNormal(tile, column, row);
        EXPECT_NEAR(n[0], -0.5 / length, 1e-15);
        EXPECT_NEAR(n[1], 0.25 / length, 1e-15);
        EXPECT_NEAR(n[2], 1.0 / length, 1e-15);
    }
    DemTile holed = tile;
    holed.setVoid(3, 3);
    EXPECT_NEAR(surfaceNormal(holed, 4, 3)[0], -0.5 / length, 1e-15);
    holed.setVoid(5, 3);
    EXPECT_EQ(surfaceNormal(holed, 4, 3), (Vector3{0.0, 0.0, 1.0}));
    EXPECT_EQ(surfaceNormal(analytic::ramp(9, 1, 30.0, 0.5, 0.0), 4, 0), (Vector3{0.0, 0.0, 1.0}));
}

TEST(ReferenceNormal, UsesItsRowsSpacing)
{
    DemTile tile = analytic::ramp(5, 5, 1.0, 1.0, 0.0);
    tile.eastSpacings = {1.0, 2.0, 4.0, 2.0, 1.0};
    const Vector3 n = surfaceNormal(tile, 2, 2);
    EXPECT_NEAR(n[0] / n[2], -0.25, 1e-15);
    EXPECT_NEAR(n[1], 0.0, 1e-15);
}

TEST(ReferenceSkyView, Plane)
{
    expectSkyView(analytic::plane(9, 8, 10.0, 100.0), 4, 3, {1.0, 1.0, 1.0}, 1e-12);
}

TEST(ReferenceSkyView, RampOf45Degrees)
{
    const analytic::SkyView expected = analytic::rampSkyView(1.0);
    EXPECT_NEAR(expected.solidAngle, 0.75, 1e-15);
    EXPECT_NEAR(expected.surface, 0.8536, 1e-4);
    // 720 azimuths meet the corner of the horizon where it passes 0: error 1/720².
    expectSkyView(analytic::ramp(9, 8, 1.0, 1.0, 0.0), 4, 3, expected, 1e-5);
    expectSkyView(analytic::ramp(9, 8, 1.0, 0.0, -1.0), 4, 3, expected, 1e-5);
    expectSkyView(analytic::ramp(9, 8, 1.0, 0.6, 0.8), 4, 3, expected, 1e-5);
    expectSkyView(analytic::ramp(9, 8, 1.0, 3.0, 4.0), 4, 3, analytic::rampSkyView(5.0), 1e-4);
}

TEST(ReferenceSkyView, RampUnderASkyAllAround)
{
    // Downhill the whole half-space before the ramp is sky, uphill too: nothing but the ramp bounds
    // it.
    const DemTile tile = analytic::ramp(9, 8, 1.0, 1.0, 0.0);
    EXPECT_NEAR(skyViewFactor(horizonRing(tile, 4, 3), SkyViewDefinition::Surface,
                              surfaceNormal(tile, 4, 3), SkyExtent::DownToHorizon),
                1.0, 1e-7);
}

TEST(ReferenceSkyView, WallAndValley)
{
    // The wall's end falls between two azimuths: half a slice at
    // both ends, of the 0.04 rad that the wall is high there: 0.04/720.
    const DemTile wall = analytic::wall(40, 401, 1.0, 30, 8.0);
    expectSkyView(wall, 20, 200, analytic::wallSkyView(8.0, 10.0, 200.0), 6e-5);
    expectSkyView(analytic::valley(21, 17, 2.0, 9, 0.75), 9, 8, analytic::valleySkyView(0.75),
                  1e-5);
}

TEST(ReferenceSkyView, HemisphericalPit)
{
    // The posts miss the vertical rim by up to a cell, of 150.
    const DemTile pit = analytic::pit(321, 321, 1.0, 160, 160, 150.0);
    expectSkyView(pit, 160, 160, analytic::pitBottomSkyView(), 4e-3);
    for (const auto& [column, row] : {std::pair{200, 160}, {160, 80}, {220, 230}, {100, 120}})
        EXPECT_NEAR(skyViewFactor(horizonRing(pit, column, row), SkyViewDefinition::Surface,
                                  surfaceNormal(pit, column, row)),
                    analytic::pitWallSurfaceSkyView(), 4e-3)
            << column << "," << row;
}

TEST(ReferenceSun, SegmentOfAFlatDisc)
{
    EXPECT_EQ(segmentFraction(10.0, 9.0, 0.25), 1.0);
    EXPECT_EQ(segmentFraction(10.0, 11.0, 0.25), 0.0);
    EXPECT_NEAR(segmentFraction(10.0, 10.0, 0.25), 0.5, 1e-15);
    // Half a radius above the centre: a third less √3/(4π).
    EXPECT_NEAR(segmentFraction(10.0, 10.125, 0.25), 1.0 / 3.0 - std::sqrt(3.0) / (4.0 * pi),
                1e-12);
}

TEST(ReferenceSun, BehindAWallTheDiscIsTheSegment)
{
    // At right angles to the wall its crest is straight to r²/2 across the disc, 1e-5 rad.
    const DemTile wall = analytic::wall(40, 41, 1.0, 30, 8.0);
    const double crest = std::atan(0.8) * 180.0 / pi;
    for (double above : {-0.5, -0.2, -0.1, 0.0, 0.1, 0.2, 0.5})
    {
        const Sun sun = {90.0, crest + above, 0.2666};
        EXPECT_NEAR(sunFraction(wall, 20, 20, sun),
                    segmentFraction(sun.elevation, crest, sun.angularRadius), 3e-3)
            << above;
    }
    EXPECT_EQ(sunFraction(wall, 20, 20, {270.0, 5.0, 0.2666}), 1.0);
}

TEST(ReferenceSun, TheHorizonMaySlopeAcrossTheDisc)
{
    // A plateau that ends to the north of a corner: its edge stands upright in the middle of a
    // large disc and hides one half. The end's face falls by 500 m in one cell, and is as high as
    // the disc's centre, 41 m, after 0.92 of it.
    const DemTile tile = analytic::makeTile(160, 160, 1.0,
                                            [](int column, int row)
                                            { return column >= 120 && row <= 70 ? 500.0 : 0.0; });
    const double edge = std::atan2(100.0, 50.92) * 180.0 / pi;
    EXPECT_NEAR(sunFraction(tile, 20, 20, {edge, 20.0, 8.0}, 400), 0.5, 0.01);
    EXPECT_EQ(sunFraction(tile, 20, 20, {edge - 9.5, 20.0, 8.0}), 1.0);
    EXPECT_EQ(sunFraction(tile, 20, 20, {edge + 9.5, 20.0, 8.0}), 0.0);
}

TEST(ReferenceSun, LevelGround)
{
    const DemTile tile = analytic::plane(9, 8, 10.0, 100.0);
    EXPECT_EQ(sunFraction(tile, 4, 3, {123.0, 90.0, 0.2666}), 1.0);
    EXPECT_EQ(sunFraction(tile, 4, 3, {123.0, 89.9, 0.2666}), 1.0);
    EXPECT_NEAR(sunFraction(tile, 4, 3, {123.0, 0.0, 0.2666}), 0.5, 1e-6);
    EXPECT_EQ(sunFraction(tile, 4, 3, {123.0, -5.0, 0.2666}), 0.0);
    // At the data's edge there is nothing ahead: what lies below the horizontal counts if asked
    // for.
    EXPECT_EQ(sunFraction(tile, 8, 3, {90.0, -5.0, 0.2666}), 0.0);
    EXPECT_EQ(sunFraction(tile, 8, 3, {90.0, -5.0, 0.2666}, 33, SkyExtent::DownToHorizon), 1.0);
}
