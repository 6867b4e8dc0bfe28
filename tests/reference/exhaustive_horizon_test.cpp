#include "reference/ExhaustiveHorizon.h"

#include "core/SyntheticTerrain.h"
#include "support/AnalyticTerrain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

using namespace osgTerrainLight;
using reference::exhaustiveHorizon;
using reference::Horizon;
using reference::HorizonOptions;

namespace
{
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double pi = 3.14159265358979323846;

/// Compass directions: the axes, the diagonals, beside them, and anywhere.
const std::vector<double> compass = {0,
                                     45,
                                     90,
                                     135,
                                     180,
                                     225,
                                     270,
                                     315,
                                     1e-7,
                                     44.9999999,
                                     89.999999,
                                     13,
                                     77,
                                     101.5,
                                     199,
                                     251,
                                     340,
                                     26.56505117707799,
                                     116.56505117707799,
                                     359.9999999};

double slopeAt(const DemTile& tile, int column, int row, const MapDirection& direction)
{
    return exhaustiveHorizon(tile, column, row, direction).slope;
}

/// The oracle's oracle: the surface sampled 500 times per cell along the ray, then refined about
/// the best sample, and every crossing looked up on its own. No increments, no closed form.
double denseHorizon(const DemTile& tile, int column, int row, const MapDirection& direction)
{
    const double xStep = direction.east / tile.nominalEastSpacing();
    const double yStep = direction.north / tile.northSpacing;
    const double ratio = std::hypot(xStep * tile.eastSpacing(row), yStep * tile.northSpacing);
    // Columns and rows are counted from the receiver, so that nothing cancels close to it.
    const auto valid = [&](double c, double r)
    {
        const int i = column + static_cast<int>(c);
        const int j = row + static_cast<int>(r);
        return i >= 0 && j >= 0 && i < tile.width() && j < tile.height() && tile.isValid(i, j);
    };
    const auto heightAt = [&](double c, double r)
    { return double(tile.heightAt(column + static_cast<int>(c), row + static_cast<int>(r))); };
    const double origin = heightAt(0, 0);
    // −∞ where there is no surface. `snap`: fraction of a cell within which a point is on a grid
    // line.
    const auto slope = [&](double t, double snap = 0.0)
    {
        const auto split = [snap](double v, double& base)
        {
            const bool onLine = std::abs(v - std::round(v)) <= snap;
            base = onLine ? std::round(v) : std::floor(v);
            return onLine ? 0.0 : v - base;
        };
        double c;
        double r;
        const double u = split(t * xStep, c);
        const double v = split(t * yStep, r);
        double z = 0.0;
        for (int dy = 0; dy <= (v > 0.0); ++dy)
            for (int dx = 0; dx <= (u > 0.0); ++dx)
            {
                if (!valid(c + dx, r + dy))
                    return -infinity;
                z += (dx ? u : 1.0 - u) * (dy ? v : 1.0 - v) * (heightAt(c + dx, r + dy) - origin);
            }
        return z / (t * ratio);
    };
    const double cells = std::hypot(tile.width(), tile.height());
    const double perCell = 1.0 / std::max(std::abs(xStep), std::abs(yStep));
    const double step = perCell / 500.0;
    double best = std::max(slope(1e-7 * perCell), -infinity);
    double bestAt = 0.0;
    for (int k = 1; k * step < 2.0 * cells * perCell; ++k)
        if (slope(k * step) > best)
        {
            best = slope(k * step);
            bestAt = k * step;
        }
    double low = std::max(bestAt - step, 1e-7 * perCell);
    double high = bestAt + step;
    for (int k = 0; k < 100; ++k)
    {
        const double a = low + (high - low) / 3.0;
        const double b = high - (high - low) / 3.0;
        best = std::max({best, slope(a), slope(b)});
        if (slope(a) < slope(b))
            low = a;
        else
            high = b;
    }
    for (int k = 1; k < tile.width() + tile.height(); ++k)
    {
        if (xStep != 0.0)
            best = std::max(best, slope(k / std::abs(xStep), 1e-9));
        if (yStep != 0.0)
            best = std::max(best, slope(k / std::abs(yStep), 1e-9));
    }
    return best;
}

DemTile randomTile(int width, int height, unsigned seed, double voidShare)
{
    std::mt19937 random(seed);
    const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
    DemTile tile(width, height, 30.0);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
        {
            const double h = 40.0 * unit();
            if (unit() >= voidShare)
                tile.setHeight(column, row, static_cast<float>(h));
        }
    return tile;
}

void compareWithDense(const DemTile& tile, int postStep)
{
    for (int post = 0; post < tile.width() * tile.height(); post += postStep)
    {
        const int column = post % tile.width();
        const int row = post / tile.width();
        if (!tile.isValid(column, row))
            continue;
        for (double degrees : compass)
        {
            const MapDirection d = directionOfCompass(degrees);
            const Horizon found = exhaustiveHorizon(tile, column, row, d);
            const double expected = denseHorizon(tile, column, row, d);
            if (expected == -infinity)
            {
                EXPECT_EQ(found.slope, -infinity) << column << "," << row << " to " << degrees;
                continue;
            }
            // The first sample is 1e-7 of a cell from the receiver, where the slope is still up to
            // 4e-7 short of its limit. Elsewhere crossings snap to posts by 1e-9 of a cell, on up
            // to 40 m in 17 m.
            const double bound = found.distance == 0.0 ? 1e-6 : 3e-9;
            EXPECT_NEAR(found.slope, expected, bound) << column << "," << row << " to " << degrees;
        }
    }
}
} // namespace

TEST(ExhaustiveHorizon, IsTheSupremumOfADenselySampledSurface)
{
    compareWithDense(randomTile(13, 9, 1, 0.0), 1);
    compareWithDense(*generateTerrain(TerrainKind::Fractal, 40, 33, 30.0, 5), 101);
    compareWithDense(*generateTerrain(TerrainKind::Cliffs, 33, 40, 30.0, 5), 101);
}

TEST(ExhaustiveHorizon, VoidsNeitherCastNorBridge)
{
    compareWithDense(randomTile(12, 11, 2, 0.3), 1);
    compareWithDense(randomTile(12, 11, 3, 0.8), 1);
}

TEST(ExhaustiveHorizon, DistancesFollowTheSpacings)
{
    DemTile tile = randomTile(11, 12, 4, 0.1);
    tile.northSpacing = 17.0;
    compareWithDense(tile, 3);
    tile.eastSpacings.clear();
    for (int row = 0; row < tile.height(); ++row)
        tile.eastSpacings.push_back(40.0 - 2.0 * row);
    compareWithDense(tile, 1);
}

TEST(ExhaustiveHorizon, InsideMaximumIsAboveTheCrossings)
{
    const DemTile tile = *generateTerrain(TerrainKind::Fractal, 64, 64, 30.0, 1);
    HorizonOptions crossings;
    crossings.insideCells = false;
    int higher = 0;
    for (int k = 0; k < 500; ++k)
    {
        const MapDirection d = directionOfCompass(7.0 * k);
        const double all = slopeAt(tile, 32, 20, d);
        const double some = exhaustiveHorizon(tile, 32, 20, d, crossings).slope;
        EXPECT_GE(all, some);
        higher += all > some;
    }
    EXPECT_GT(higher, 50);
}

TEST(ExhaustiveHorizon, AKnownHighestPostChangesNothing)
{
    const DemTile tile = *generateTerrain(TerrainKind::Cliffs, 70, 50, 30.0, 3);
    HorizonOptions bounded;
    bounded.highest = reference::highestPost(tile);
    for (int k = 0; k < 2000; ++k)
    {
        const int column = k * 7 % 70;
        const int row = k * 11 % 50;
        const MapDirection d = directionOfCompass(1.7 * k);
        const Horizon a = exhaustiveHorizon(tile, column, row, d);
        const Horizon b = exhaustiveHorizon(tile, column, row, d, bounded);
        EXPECT_EQ(a.slope, b.slope);
        EXPECT_EQ(a.distance, b.distance);
    }
}

TEST(ExhaustiveHorizon, NothingAheadIsOpen)
{
    const DemTile tile = analytic::plane(5, 1, 10.0, 3.0);
    EXPECT_EQ(slopeAt(tile, 4, 0, {1.0, 0.0}), -infinity);
    EXPECT_EQ(slopeAt(tile, 2, 0, {0.0, 1.0}), -infinity);
    EXPECT_EQ(slopeAt(tile, 2, 0, {0.6, 0.8}), -infinity);
    EXPECT_EQ(exhaustiveHorizon(tile, 4, 0, {1.0, 0.0}).elevationDegrees(), -90.0);
    EXPECT_EQ(slopeAt(tile, 0, 0, {1.0, 0.0}), 0.0);

    const DemTile post = analytic::plane(1, 1, 10.0, 3.0);
    EXPECT_EQ(slopeAt(post, 0, 0, {0.6, -0.8}), -infinity);
    const DemTile allVoid(3, 3, 1.0);
    EXPECT_EQ(slopeAt(allVoid, 1, 1, {1.0, 0.0}), -infinity);
    EXPECT_EQ(reference::highestPost(allVoid), -infinity);
}

TEST(ExhaustiveHorizon, AxesAndDiagonalsMeetPostsOnly)
{
    // Only posts on the rays are valid: no cell is complete, no crossing has two.
    DemTile axes(9, 9, 10.0);
    DemTile diagonals(9, 9, 10.0);
    for (int k = 0; k < 9; ++k)
    {
        const float h = static_cast<float>(std::abs(k - 4));
        axes.setHeight(k, 4, h);
        axes.setHeight(4, k, h);
        diagonals.setHeight(k, k, h);
        diagonals.setHeight(k, 8 - k, h);
    }
    for (int k = 0; k < 4; ++k)
    {
        EXPECT_NEAR(slopeAt(axes, 4, 4, directionOfCompass(90.0 * k)), 0.1, 1e-15);
        EXPECT_NEAR(slopeAt(diagonals, 4, 4, directionOfCompass(90.0 * k + 45.0)),
                    0.1 / std::sqrt(2.0), 1e-15);
        EXPECT_EQ(slopeAt(axes, 4, 4, directionOfCompass(90.0 * k + 45.0)), -infinity);
        EXPECT_EQ(slopeAt(diagonals, 4, 4, directionOfCompass(90.0 * k)), -infinity);
        EXPECT_EQ(slopeAt(axes, 4, 4, directionOfCompass(90.0 * k + 1.0)), -infinity);
    }
}

TEST(ExhaustiveHorizon, PlaneAndRamp)
{
    const DemTile plane = analytic::plane(21, 17, 30.0, 812.0);
    const DemTile ramp = analytic::ramp(21, 17, 30.0, 0.5, -0.25); // exact in float
    for (double degrees : compass)
    {
        const MapDirection d = directionOfCompass(degrees);
        EXPECT_EQ(slopeAt(plane, 9, 7, d), 0.0);
        EXPECT_NEAR(slopeAt(ramp, 9, 7, d), analytic::rampHorizon(0.5, -0.25, d), 1e-12);
    }
}

TEST(ExhaustiveHorizon, Wall)
{
    const DemTile tile = analytic::wall(60, 41, 10.0, 40, 75.0);
    for (double degrees : {90.0, 70.0, 45.0 + 60.0, 85.0})
    {
        const MapDirection d = directionOfCompass(degrees);
        const Horizon h = exhaustiveHorizon(tile, 30, 20, d);
        EXPECT_NEAR(h.slope, analytic::wallHorizon(75.0, 100.0, d), 1e-13);
        EXPECT_NEAR(h.distance, 100.0 / d.east, 1e-9);
    }
    EXPECT_EQ(slopeAt(tile, 30, 20, directionOfCompass(270.0)), 0.0);
    EXPECT_EQ(slopeAt(tile, 30, 20, directionOfCompass(0.0)), 0.0);
}

TEST(ExhaustiveHorizon, SquareHillock)
{
    const DemTile tile = analytic::hillock(61, 51, 10.0, 30, 25, 12, 4);
    const auto degrees = [&](int column, int row, double azimuth) {
        return exhaustiveHorizon(tile, column, row, directionOfCompass(azimuth)).elevationDegrees();
    };
    const double corner = std::atan(analytic::hillockCornerHorizon()) * 180.0 / pi;
    EXPECT_NEAR(corner, 35.2643896828, 1e-9);
    EXPECT_NEAR(degrees(18, 13, 45.0), corner, 1e-9);
    EXPECT_NEAR(degrees(42, 13, 315.0), corner, 1e-9);
    EXPECT_NEAR(degrees(42, 37, 225.0), corner, 1e-9);
    EXPECT_NEAR(degrees(18, 37, 135.0), corner, 1e-9);
    EXPECT_NEAR(degrees(18, 25, 90.0), 45.0, 1e-9);
    EXPECT_NEAR(degrees(30, 37, 180.0), 45.0, 1e-9);
    EXPECT_NEAR(degrees(30, 25, 33.0), 0.0, 1e-9);
}

TEST(ExhaustiveHorizon, Cone)
{
    const DemTile tile = analytic::cone(121, 121, 1.0, 70, 60, 40.0, 30.0);
    // Towards the apex the ray runs along posts; beside it the surface is bilinear, not a cone, by
    // up to d²/(8 r) = 1/8 m near the apex, at 45 m.
    EXPECT_NEAR(slopeAt(tile, 25, 60, {1.0, 0.0}), analytic::coneHorizon(40.0, 30.0, 45.0, 0.0),
                1e-6);
    for (int k = -50; k <= 50; ++k)
    {
        const double offset = 0.02 * k;
        const MapDirection d = {std::cos(offset), std::sin(offset)};
        EXPECT_NEAR(slopeAt(tile, 25, 60, d), analytic::coneHorizon(40.0, 30.0, 45.0, offset), 4e-3)
            << offset;
    }
}

TEST(ExhaustiveHorizon, Valley)
{
    const DemTile tile = analytic::valley(31, 23, 8.0, 14, 0.75);
    for (double degrees : compass)
    {
        const MapDirection d = directionOfCompass(degrees);
        EXPECT_NEAR(slopeAt(tile, 14, 9, d), analytic::valleyHorizon(0.75, d), 1e-12) << degrees;
    }
}

TEST(ExhaustiveHorizon, PitAndDome)
{
    const DemTile pit = analytic::pit(121, 131, 1.0, 60, 62, 50.0);
    const DemTile dome = analytic::dome(241, 161, 1.0, 90, 80, 50.0);
    // The rim is vertical, and the level ground begins at most a cell's diagonal outside it:
    // 50/51.4. Along the axes the rim is a post.
    EXPECT_NEAR(slopeAt(pit, 60, 62, {1.0, 0.0}), 1.0, 1e-12);
    EXPECT_NEAR(slopeAt(pit, 60, 62, {0.0, -1.0}), 1.0, 1e-12);
    for (double degrees : compass)
        EXPECT_NEAR(slopeAt(pit, 60, 62, directionOfCompass(degrees)), 1.0, 0.03) << degrees;
    // The dome's horizon is on its smooth side: bilinear chords lie 1/(8·50) m below it.
    for (int k = -12; k <= 12; ++k)
    {
        const double offset = 0.02 * k;
        const MapDirection d = {-std::cos(offset), std::sin(offset)};
        EXPECT_NEAR(slopeAt(dome, 220, 80, d), analytic::domeHorizon(50.0, 130.0, offset), 2e-4)
            << offset;
    }
}

TEST(ExhaustiveHorizon, Staircase)
{
    const DemTile tile = analytic::staircase(64, 33, 2.0, 8, 3.0);
    for (int column : {0, 3, 7, 8, 15})
        for (double degrees : {90.0, 60.0, 110.0})
        {
            const MapDirection d = directionOfCompass(degrees);
            EXPECT_NEAR(slopeAt(tile, column, 16, d),
                        analytic::staircaseHorizon(2.0, 8, 3.0, column, d), 1e-13);
        }
}

TEST(ExhaustiveHorizon, CheckerboardRisesWithinTheReceiversCell)
{
    const DemTile tile = analytic::checkerboard(9, 9, 2.0, 1.0);
    const Horizon h = exhaustiveHorizon(tile, 4, 4, directionOfCompass(45.0));
    EXPECT_NEAR(h.slope, analytic::checkerboardDiagonalHorizon(2.0, 1.0), 1e-14);
    EXPECT_EQ(h.distance, 0.0);
    EXPECT_NEAR(slopeAt(tile, 4, 4, {0.0, 1.0}), 0.5, 1e-15);
    HorizonOptions crossings;
    crossings.insideCells = false;
    EXPECT_EQ(exhaustiveHorizon(tile, 4, 4, directionOfCompass(45.0), crossings).slope, 0.0);
}
