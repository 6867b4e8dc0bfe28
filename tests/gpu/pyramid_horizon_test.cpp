// Horizons from a pyramid of heights: closed forms, and how far they are from the exhaustive
// reference in double.
#include "core/SyntheticTerrain.h"
#include "gpu/Textures.h"
#include "lighting/nodes/HorizonNode.h"
#include "lighting/nodes/PyramidHorizonNode.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/Horizons.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

using namespace osgTerrainLight;
using osgTerrainLight::testing::compareWithReference;
using osgTerrainLight::testing::HorizonError;

namespace
{
using Join = PyramidHorizonNode::Join;
constexpr double degrees = 180.0 / 3.14159265358979323846;

HorizonMap horizonsOf(osg::State& state, const DemTile& tile, const BounceScheme& scheme,
                      int azimuths, Join join)
{
    const osg::ref_ptr<TileSurface> surface = new TileSurface(tile, HorizonNode::frame);
    const osg::ref_ptr<PyramidNode> pyramid = new PyramidNode(*surface);
    const osg::ref_ptr<PyramidHorizonNode> scan =
        new PyramidHorizonNode(*pyramid, scheme, azimuths, join);
    WorkGraph graph;
    Status done = graph.declare({pyramid, scan});
    if (done)
        done = graph.run(state);
    EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
    EXPECT_EQ(takeGlErrors(), "");
    HorizonMap map(tile.width(), tile.height(), azimuths);
    map.codes() = readUnorm16(state, *scan->horizon()->texture());
    return map;
}
} // namespace

TEST(PyramidHorizon, SlopesOfPlanesAndValleysAreExact)
{
    OTL_NEED_GL(context);
    const AzimuthSet set(16);
    const DemTile ramp = analytic::ramp(40, 33, 10.0, 0.3, -0.2);
    const DemTile valley = analytic::valley(65, 65, 10.0, 32, 0.5);
    for (const Join join : {Join::BSpline, Join::None})
    {
        const HorizonMap found = horizonsOf(context->state(), ramp, {4.0, 8.0}, 16, join);
        const HorizonMap side = horizonsOf(context->state(), valley, {4.0, 8.0}, 16, join);
        for (int k = 0; k < 16; ++k)
        {
            // A code is 0.0027 degrees.
            EXPECT_NEAR(found.elevationAt(20, 16, k),
                        std::atan(analytic::rampHorizon(0.3, -0.2, set.direction(k))) * degrees,
                        0.01);
            EXPECT_NEAR(side.elevationAt(32, 32, k),
                        std::atan(analytic::valleyHorizon(0.5, set.direction(k))) * degrees, 0.01);
        }
    }
}

TEST(PyramidHorizon, VoidsNeitherCastNorReceive)
{
    OTL_NEED_GL(context);
    DemTile tile = analytic::plane(20, 17, 10.0, 5.0);
    for (int y = 0; y < 17; ++y)
        tile.setVoid(12, y);
    tile.setHeight(12, 8, 1000.0f);
    tile.setVoid(12, 8);
    const HorizonMap map = horizonsOf(context->state(), tile, {4.0, 0.0}, 8, Join::None);
    for (int y = 0; y < 17; ++y)
        for (int x = 0; x < 20; ++x)
            for (int k = 0; k < 8; ++k)
            {
                EXPECT_EQ(map.isValid(x, y), x != 12);
                EXPECT_TRUE(x == 12 || map.elevationAt(x, y, k) <= 0.01);
            }
}

TEST(PyramidHorizon, NothingAheadIsStraightDown)
{
    OTL_NEED_GL(context);
    const DemTile tile = analytic::plane(1, 5, 10.0, 5.0);
    const HorizonMap map = horizonsOf(context->state(), tile, {4.0, 2.0}, 4, Join::BSpline);
    EXPECT_EQ(map.elevationAt(0, 2, 0), -90.0); // east
    EXPECT_NEAR(map.elevationAt(0, 2, 1), 0.0, 0.01);
}

TEST(PyramidHorizon, ErrorFallsWithTheOffset)
{
    OTL_NEED_GL(context);
    const DemTile tile = generateTerrain(TerrainKind::Fractal, 128, 128, 30.0, 1).value();
    std::printf("Horizons of a fractal of 128 x 128 posts, 32 azimuths [degrees]\n");
    const auto measure = [&](double k, double o, Join join)
    {
        const HorizonError error =
            compareWithReference(tile, horizonsOf(context->state(), tile, {k, o}, 32, join), 600);
        std::printf("k %2.0f o %2.0f %-8s mean %.3f p99 %.2f bias %+.3f\n", k, o,
                    join == Join::BSpline ? "b-spline" : "samples", error.mean, error.p99,
                    error.bias);
        return error;
    };
    for (const Join join : {Join::BSpline, Join::None})
        for (const double k : {4.0, 8.0})
        {
            double last = 90.0;
            for (const double o : {0.0, 1.0, 2.0, 3.0, 4.0, 6.0})
            {
                const HorizonError error = measure(k, o, join);
                EXPECT_LT(error.mean, last) << "a greater offset blurs less";
                last = error.mean;
            }
        }
}
