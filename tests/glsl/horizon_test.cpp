#include "reference/ExhaustiveHorizon.h"
#include "support/FramedHeights.h"
#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

using namespace osgTerrainLight;

namespace
{
template <class Real>
class HorizonFunctions : public testing::Test
{
};
TYPED_TEST_SUITE(HorizonFunctions, Precisions);

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Along an axis, the diagonal, through posts, and beside them. No ray of these passes a post,
/// within 32 steps, so closely that float and double could disagree on which side.
const std::vector<double> tangents = {0.0, 1.0, 0.5, 0.25, 0.75, 0.6180339, 0.123, 0.9371};

/// Slopes below this are those of nothing, or of a void: the caller's −90°.
constexpr double nothing = -1e9;

DemTile randomTile(int width, int height, double level, double relief, double voidShare,
                   unsigned seed)
{
    DemTile tile(width, height, 1.0);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
        {
            const double z = level + relief * uniform(random);
            if (uniform(random) >= voidShare)
                tile.setHeight(x, y, static_cast<float>(z));
        }
    return tile;
}

constexpr int frame = 52;

/// Which way a ray goes: its major axis and the two signs.
struct Octant
{
    bool north = false;
    int look = 1;
    int drift = 1;

    glm::ivec2 major() const { return north ? glm::ivec2(0, look) : glm::ivec2(look, 0); }
    glm::ivec2 minor() const { return north ? glm::ivec2(drift, 0) : glm::ivec2(0, drift); }
};

std::vector<Octant> octants()
{
    std::vector<Octant> all;
    for (const bool north : {false, true})
        for (const int look : {1, -1})
            for (const int drift : {1, -1})
                all.push_back({north, look, drift});
    return all;
}

/// nearHorizon of every valid post, in blocks of eight as the pass does it.
template <class Real>
void forEachHorizon(const DemTile& tile, const Octant& octant, Real tangent, int reach,
                    const std::function<void(int column, int row, double slope)>& use)
{
    using G = CheckedGlsl<Real>;
    G glsl;
    const Raster<Real> heights = framedHeights<Real>(tile, frame);
    const int breadth = octant.north ? tile.width() : tile.height();
    const int along = octant.north ? tile.height() : tile.width();
    for (int block = 0; block < breadth; block += G::NEAR_POSTS)
        for (int i = 0; i < along && !testing::Test::HasFatalFailure(); ++i)
        {
            const int start = octant.drift < 0 ? block + 7 : block;
            const glm::ivec2 first = octant.north ? glm::ivec2(start, i) : glm::ivec2(i, start);
            typename G::NearRays rays;
            rays.first = first + frame;
            rays.major = octant.major();
            rays.minor = octant.minor();
            rays.tangent = tangent;
            const auto found = glsl.nearHorizon(heights, rays, reach);
            for (int k = 0; k < G::NEAR_POSTS; ++k)
            {
                const glm::ivec2 post = first + rays.minor * k;
                if (post.x >= 0 && post.y >= 0 && post.x < tile.width() && post.y < tile.height() &&
                    tile.isValid(post.x, post.y))
                    use(post.x, post.y, static_cast<double>(found.slopes[k]));
            }
        }
}

/// The surface sampled along one ray, in double: every crossing, and 100 places and a search within
/// each cell. It looks posts up one by one and shares no algebra with nearHorizon.
class DenseRay
{
public:
    DenseRay(const DemTile& tile, int column, int row, const Octant& octant, double tangent)
        : _tile(tile), _column(column), _row(row), _octant(octant), _tangent(tangent)
    {
    }

    double horizon(int reach, int insideReach) const
    {
        std::vector<double> crossings;
        for (int k = 1; k <= reach; ++k)
            crossings.push_back(k);
        for (int k = 1; _tangent > 0.0 && k / _tangent <= reach; ++k)
            crossings.push_back(k / _tangent);
        std::sort(crossings.begin(), crossings.end());
        double best = -infinity;
        double last = 0.0;
        for (const double s : crossings)
        {
            best = std::max(best, crossing(s));
            if (s - last > 1e-9 && last < insideReach)
                best = std::max(best, inside(last, s));
            last = s;
        }
        return best;
    }

private:
    /// Post at `along` steps of the ray's major axis and `across` of its minor axis.
    bool post(double along, double across, double& height) const
    {
        const int i = static_cast<int>(along);
        const int j = static_cast<int>(across);
        const int x = _column + _octant.major().x * i + _octant.minor().x * j;
        const int y = _row + _octant.major().y * i + _octant.minor().y * j;
        if (x < 0 || y < 0 || x >= _tile.width() || y >= _tile.height() || !_tile.isValid(x, y))
            return false;
        height = double(_tile.heightAt(x, y)) - double(_tile.heightAt(_column, _row));
        return true;
    }

    double crossing(double s) const
    {
        const auto snapped = [](double v)
        { return std::abs(v - std::round(v)) < 1e-9 ? std::round(v) : v; };
        const double u = snapped(s);
        const double v = snapped(_tangent * s);
        double sum = 0.0;
        for (const double i : {std::floor(u), std::ceil(u)})
            for (const double j : {std::floor(v), std::ceil(v)})
            {
                // Where floor and ceil agree, the same post is met twice with half the weight.
                const double weight = (u == std::floor(u) ? 0.5 : 1.0 - std::abs(u - i)) *
                                      (v == std::floor(v) ? 0.5 : 1.0 - std::abs(v - j));
                double z = 0.0;
                if (!post(i, j, z))
                    return -infinity;
                sum += weight * z;
            }
        return sum / s;
    }

    double inside(double s0, double s1) const
    {
        const double i = std::floor(0.5 * (s0 + s1));
        const double j = std::floor(0.5 * (s0 + s1) * _tangent);
        double z00 = 0.0, z10 = 0.0, z01 = 0.0, z11 = 0.0;
        if (!post(i, j, z00) || !post(i + 1, j, z10) || !post(i, j + 1, z01) ||
            !post(i + 1, j + 1, z11))
            return -infinity;
        const auto slope = [&](double s)
        {
            const double u = s - i;
            const double v = s * _tangent - j;
            // At the receiver z00 is 0 and the quotient is taken by hand.
            if (i == 0.0 && j == 0.0)
                return z10 + z01 * _tangent + (z11 - z10 - z01) * _tangent * s;
            return (z00 * (1 - u) * (1 - v) + z10 * u * (1 - v) + z01 * (1 - u) * v + z11 * u * v) /
                   s;
        };
        const int count = 100;
        const double step = (s1 - s0) / count;
        int top = 0;
        for (int k = 1; k <= count; ++k)
            if (slope(s0 + step * k) > slope(s0 + step * top))
                top = k;
        double low = s0 + step * std::max(top - 1, 0);
        double high = s0 + step * std::min(top + 1, count);
        for (int k = 0; k < 60; ++k)
        {
            const double a = low + (high - low) / 3.0;
            const double b = high - (high - low) / 3.0;
            (slope(a) < slope(b) ? low : high) = slope(a) < slope(b) ? a : b;
        }
        return std::max({slope(s0), slope(s1), slope(0.5 * (low + high))});
    }

    const DemTile& _tile;
    int _column, _row;
    Octant _octant;
    double _tangent;
};

/// Slopes in heights of at most `height`, with `relief` about it, seen over `reach` steps. A
/// crossing's height is rounded three times (twice relief, then height), the receiver's not at all;
/// the maximum inside a cell moves by no more than twice what its two ends move, and adds b −
/// 2·√(ac), whose parts are 2·relief·reach large. A crossing's place is rounded twice, `reach`
/// large, and moves the height by relief times that.
template <class Real>
double slopeBound(double height, double relief, int reach)
{
    return roundoff<Real> * (4.0 * height + 24.0 * relief * reach);
}

double slopesAgree(double a, double b, double bound)
{
    return (a < nothing && b < nothing) || std::abs(a - b) <= bound;
}
} // namespace

TYPED_TEST(HorizonFunctions, IntervalHoldsItsProducts)
{
    CheckedGlsl<TypeParam> glsl;
    const auto interval = glsl.intervalBetween(TypeParam(2), TypeParam(2.5));
    EXPECT_EQ(interval.near, TypeParam(2));
    EXPECT_EQ(interval.far, TypeParam(2.5));
    EXPECT_EQ(interval.inverseNear, TypeParam(0.5));
    EXPECT_EQ(interval.product, TypeParam(5));
    EXPECT_EQ(interval.steepness, TypeParam(10));
}

TYPED_TEST(HorizonFunctions, InsideMaximumIsTheHighestSample)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    int inner = 0;
    for (int trial = 0; trial < 3000; ++trial)
    {
        const double s1 = 1.0 + 15.0 * uniform(random);
        const double s2 = s1 + 0.05 + 0.95 * uniform(random);
        const double c = 8.0 * (uniform(random) - 0.7);
        // Half of the trials have their stationary point about the interval.
        const double at = s1 + (s2 - s1) * (1.5 * uniform(random) - 0.25);
        const double a = trial % 2 == 0 ? c * at * at : 300.0 * (uniform(random) - 0.5);
        const double b = 4.0 * (uniform(random) - 0.5);
        const auto g = [&](double s) { return a / s + b + c * s; };
        const TypeParam found = glsl.insideMaximum(
            glsl.intervalBetween(static_cast<TypeParam>(s1), static_cast<TypeParam>(s2)),
            static_cast<TypeParam>(g(s1)), static_cast<TypeParam>(g(s2)),
            static_cast<TypeParam>(c));

        const double ends = std::max(g(s1), g(s2));
        double highest = ends;
        const int count = 500;
        const double step = (s2 - s1) / count;
        for (int k = 1; k < count; ++k)
            highest = std::max(highest, g(s1 + step * k));
        // Between samples g rises by at most |g''|·step²/8 = |a|/(4·s1³)·step². Rounding: the ends'
        // slopes (with what s1 and s2 themselves round to) twice over, and the four terms of g.
        const double sampling = std::abs(a) / (4.0 * s1 * s1 * s1) * step * step;
        const double size =
            std::abs(g(s1)) + std::abs(g(s2)) + std::abs(a) / s1 + std::abs(b) + std::abs(c) * s2;
        const double rounding = 16.0 * roundoff<TypeParam> * size * s2 / (s2 - s1);
        const double top = std::max(ends, static_cast<double>(found));
        EXPECT_GE(top, highest - rounding);
        EXPECT_LE(top, highest + sampling + rounding);
        if (highest > ends + sampling + rounding)
        {
            ++inner;
            EXPECT_GT(found, G::NO_HORIZON);
        }
        if (c >= 0.0)
        {
            EXPECT_EQ(found, G::NO_HORIZON);
        }
    }
    EXPECT_GT(inner, 300);
}

TYPED_TEST(HorizonFunctions, NearHorizonIsTheHighestSampleOfTheSurface)
{
    const double relief = 40.0;
    const DemTile tile = randomTile(21, 13, -20.0, relief, 0.0, 1);
    std::vector<double> all = tangents;
    all.insert(all.end(), {1e-7, 1.0 - 1e-6, 0.3337, 0.087});
    for (const double wanted : all)
    {
        const TypeParam tangent = static_cast<TypeParam>(wanted);
        // Cells that a ray crosses in less than 1e-3 steps are not looked into; g rises by at most
        // |c|·1e-6/s1 there, and c is 2·relief at most.
        const double grazing = 2.0 * relief * 1e-6;
        const double bound = slopeBound<TypeParam>(relief, relief, 12) + grazing;
        for (const int reach : {12, 5, 1})
            forEachHorizon<TypeParam>(
                tile, Octant{}, tangent, reach,
                [&](int x, int y, double slope)
                {
                    const double expected =
                        DenseRay(tile, x, y, Octant{}, static_cast<double>(tangent))
                            .horizon(reach, reach);
                    ASSERT_TRUE(slopesAgree(slope, expected, bound))
                        << "tangent " << tangent << " post " << x << ' ' << y << " reach " << reach
                        << ": " << slope << ", sampled " << expected;
                });
    }
}

TYPED_TEST(HorizonFunctions, HorizonAlongRayIsTheHighestSampleOfTheSurface)
{
    CheckedGlsl<TypeParam> glsl;
    const double relief = 40.0;
    const int reach = 20;
    for (const double voids : {0.0, 0.1})
    {
        const DemTile tile = randomTile(21, 13, -20.0, relief, voids, 2);
        const Raster<TypeParam> heights = framedHeights<TypeParam>(tile, frame);
        for (const Octant& octant : octants())
            for (const double wanted : tangents)
            {
                const TypeParam tangent = static_cast<TypeParam>(wanted);
                // As for nearHorizon: grazed cells, and rounding.
                const double bound = slopeBound<TypeParam>(relief, relief, reach) + 2e-6 * relief;
                for (int y = 0; y < tile.height(); ++y)
                    for (int x = 0; x < tile.width(); ++x)
                    {
                        if (!tile.isValid(x, y))
                            continue;
                        const double slope = static_cast<double>(
                            glsl.horizonAlongRay(heights, glm::ivec2(x, y) + frame, octant.major(),
                                                 octant.minor(), tangent, reach));
                        const double expected =
                            DenseRay(tile, x, y, octant, static_cast<double>(tangent))
                                .horizon(reach, reach);
                        ASSERT_TRUE(slopesAgree(slope, expected, bound))
                            << "tangent " << tangent << " post " << x << ' ' << y << ": " << slope
                            << ", sampled " << expected;
                    }
            }
    }
}

TYPED_TEST(HorizonFunctions, SlopeAtStepMeetsEveryColumnAndRow)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    const double relief = 40.0;
    const int reach = 20;
    const double bound = slopeBound<TypeParam>(relief, relief, reach);
    for (const double voids : {0.0, 0.1})
    {
        const DemTile tile = randomTile(21, 13, -20.0, relief, voids, 3);
        const Raster<TypeParam> heights = framedHeights<TypeParam>(tile, frame);
        for (const Octant& octant : octants())
            for (const double wanted : tangents)
            {
                const TypeParam tangent = static_cast<TypeParam>(wanted);
                for (int y = 0; y < tile.height(); ++y)
                    for (int x = 0; x < tile.width(); ++x)
                    {
                        if (!tile.isValid(x, y))
                            continue;
                        // All steps together see what a scan without cells' insides sees.
                        TypeParam slope = G::NO_HORIZON;
                        const auto turn = tangent * static_cast<TypeParam>(octant.drift);
                        const auto columnAt = [&](int away)
                        {
                            return glsl.rayColumn(heights, glm::ivec2(x, y) + frame, octant.major(),
                                                  octant.minor() * octant.drift, turn, away);
                        };
                        for (int away = 1; away <= reach; ++away)
                            slope = std::max(
                                slope, glsl.slopeAtStep(columnAt(away - 1), columnAt(away),
                                                        static_cast<TypeParam>(tile.heightAt(x, y)),
                                                        turn, away));
                        const double expected =
                            DenseRay(tile, x, y, octant, static_cast<double>(tangent))
                                .horizon(reach, 0);
                        ASSERT_TRUE(slopesAgree(static_cast<double>(slope), expected, bound))
                            << "tangent " << tangent << " post " << x << ' ' << y << ": " << slope
                            << ", sampled " << expected;
                    }
            }
    }
}

TYPED_TEST(HorizonFunctions, NearHorizonStopsAtVoids)
{
    const double relief = 40.0;
    for (unsigned seed = 2; seed < 5; ++seed)
    {
        const DemTile tile = randomTile(17, 18, 30.0, relief, seed * 0.12, seed);
        for (const double wanted : tangents)
        {
            const TypeParam tangent = static_cast<TypeParam>(wanted);
            const double bound = slopeBound<TypeParam>(70.0, relief, 16) + 2.0 * relief * 1e-6;
            forEachHorizon<TypeParam>(tile, Octant{}, tangent, 16,
                                      [&](int x, int y, double slope)
                                      {
                                          const double expected =
                                              DenseRay(tile, x, y, Octant{},
                                                       static_cast<double>(tangent))
                                                  .horizon(16, 16);
                                          ASSERT_TRUE(slopesAgree(slope, expected, bound))
                                              << "tangent " << tangent << " post " << x << ' ' << y
                                              << ": " << slope << ", sampled " << expected;
                                      });
        }
    }
}

TYPED_TEST(HorizonFunctions, LevelGroundWithVoidsHasNoHorizonAboveIt)
{
    // Rays through posts: rounding puts some of their crossings a little beside them, and a void
    // there must neither cast nor hide the post's own height.
    for (const double level : {-5000.0, 0.0, 8000.0})
    {
        const DemTile tile = randomTile(26, 27, level, 0.0, 0.3, 9);
        for (int c = 1; c <= 32; ++c)
            for (int w = 0; w <= c; ++w)
                forEachHorizon<TypeParam>(tile, Octant{}, static_cast<TypeParam>(double(w) / c), 25,
                                          [&](int x, int y, double slope)
                                          {
                                              ASSERT_TRUE(slope == 0.0 || slope < nothing)
                                                  << w << '/' << c << " post " << x << ' ' << y
                                                  << " level " << level << ": " << slope;
                                          });
    }
}

TYPED_TEST(HorizonFunctions, MirroredRaysSeeTheMirroredTile)
{
    const DemTile tile = randomTile(16, 16, 100.0, 30.0, 0.1, 21);
    for (const Octant& octant : octants())
    {
        // The post of `tile` that stands, seen along the octant, where (i, j) stands seen
        // eastwards.
        const auto place = [&](int i, int j)
        {
            const int along = octant.look > 0 ? i : 15 - i;
            const int across = octant.drift > 0 ? j : 15 - j;
            return octant.north ? glm::ivec2(across, along) : glm::ivec2(along, across);
        };
        DemTile mirrored(16, 16, 1.0);
        for (int j = 0; j < 16; ++j)
            for (int i = 0; i < 16; ++i)
                if (const glm::ivec2 at = place(i, j); tile.isValid(at.x, at.y))
                    mirrored.setHeight(i, j, tile.heightAt(at.x, at.y));
        for (const double tangent : tangents)
        {
            Raster<double> expected(16, 16, 0.0);
            forEachHorizon<TypeParam>(mirrored, Octant{}, static_cast<TypeParam>(tangent), 9,
                                      [&](int i, int j, double slope)
                                      {
                                          const glm::ivec2 at = place(i, j);
                                          expected.at(at.x, at.y) = slope;
                                      });
            int count = 0;
            forEachHorizon<TypeParam>(tile, octant, static_cast<TypeParam>(tangent), 9,
                                      [&](int x, int y, double slope)
                                      {
                                          ++count;
                                          ASSERT_EQ(slope, expected.at(x, y));
                                      });
            EXPECT_EQ(count, static_cast<int>(tile.validCount()));
        }
    }
}

TYPED_TEST(HorizonFunctions, ReachEndsWhereItSays)
{
    for (const double tangent : {0.0, 1.0, 0.6180339})
        for (int distance = 1; distance <= 10; ++distance)
        {
            // A wall across the ray, as wide as the tile.
            DemTile tile(20, 30, 1.0);
            for (int y = 0; y < 30; ++y)
                for (int x = 0; x < 20; ++x)
                    tile.setHeight(x, y, x == 3 + distance ? 64.0f : 0.0f);
            for (int reach = 1; reach <= 12; ++reach)
                forEachHorizon<TypeParam>(tile, Octant{}, static_cast<TypeParam>(tangent), reach,
                                          [&](int x, int y, double slope)
                                          {
                                              if (x != 3 || y > 10)
                                                  return;
                                              // A row crossing of the column's cell sees part of
                                              // the wall's flank: less than the crest.
                                              const double crest = 64.0 / distance;
                                              if (reach >= distance)
                                              {
                                                  ASSERT_NEAR(slope, crest,
                                                              crest * 2.0 * roundoff<TypeParam>);
                                              }
                                              else
                                              {
                                                  ASSERT_EQ(slope, 0.0);
                                              }
                                          });
        }
}

TYPED_TEST(HorizonFunctions, BulgesCountWithinReach)
{
    // A checkerboard's bump: along the diagonal a cell whose other corners stand at 8 bulges to 2
    // half way, and its crossings are all 0. The bulge of column k counts with reach >= k.
    for (int column = 1; column <= 6; ++column)
    {
        DemTile tile(14, 14, 1.0);
        for (int y = 0; y < 14; ++y)
            for (int x = 0; x < 14; ++x)
                tile.setHeight(x, y, 0.0f);
        tile.setHeight(2 + column, 1 + column, 8.0f);
        for (int reach = 1; reach <= 8; ++reach)
            forEachHorizon<TypeParam>(
                tile, Octant{}, TypeParam(1), reach,
                [&](int x, int y, double slope)
                {
                    if (x != 2 || y != 2)
                        return;
                    // g = 8·u·(1 − u)/(column − 1 + u), highest at u = √(k(k+1)) − k, k = column
                    // − 1.
                    const double k = column - 1.0;
                    const double u = std::sqrt(k * (k + 1.0)) - k;
                    const double bulge = k > 0.0 ? 8.0 * u * (1.0 - u) / (k + u) : 8.0;
                    if (reach >= column)
                    {
                        ASSERT_NEAR(slope, bulge, slopeBound<TypeParam>(8.0, 8.0, 8));
                    }
                    else
                    {
                        ASSERT_EQ(slope, 0.0);
                    }
                });
    }
}

TYPED_TEST(HorizonFunctions, NearHorizonIsTheOraclesWhereReachCoversTheTile)
{
    std::vector<DemTile> tiles;
    tiles.push_back(randomTile(23, 14, 0.0, 100.0, 0.0, 31));
    tiles.push_back(randomTile(14, 23, 0.0, 100.0, 0.15, 32));
    tiles.push_back(randomTile(9, 17, 5000.0, 1.0, 0.0, 33));
    tiles.push_back(randomTile(17, 9, -5000.0, 1.0, 0.1, 34));
    tiles.push_back(randomTile(1, 1, 12.0, 0.0, 0.0, 35));
    tiles.push_back(randomTile(1, 9, 12.0, 10.0, 0.0, 36));
    for (const DemTile& tile : tiles)
    {
        const double high = reference::highestPost(tile);
        const double relief = std::abs(high) > 1000.0 ? 1.0 : 100.0;
        // In double the cells that a ray grazes are all that is left: none of these tangents has
        // any.
        const double bound =
            std::max(1e-9, slopeBound<TypeParam>(std::abs(high) + 1.0, relief, 23));
        for (const Octant& octant : octants())
            for (const double wanted : tangents)
            {
                const TypeParam tangent = static_cast<TypeParam>(wanted);
                const double t = static_cast<double>(tangent);
                const glm::ivec2 major = octant.major();
                const glm::ivec2 minor = octant.minor();
                const MapDirection direction{major.x + t * minor.x, major.y + t * minor.y};
                forEachHorizon<TypeParam>(
                    tile, octant, tangent, 23,
                    [&](int x, int y, double slope)
                    {
                        const double perMetre =
                            reference::exhaustiveHorizon(tile, x, y, direction).slope;
                        const double expected = perMetre * std::hypot(1.0, t);
                        ASSERT_TRUE(slopesAgree(slope, expected, bound))
                            << "tangent " << t << " post " << x << ' ' << y << ": " << slope
                            << ", oracle " << expected;
                    });
            }
    }
}

TEST(HorizonConditioning, FloatLosesOnlyTheLastDigitsOfHeights)
{
    // Small relief far from 0: what float loses is the rounding of heights near ±5000, not more.
    for (const double level : {-5000.0, 0.0, 5000.0})
    {
        const DemTile tile = randomTile(24, 24, level, 1.0, 0.0, 41);
        const double bound = slopeBound<float>(std::abs(level) + 1.0, 1.0, 16);
        for (double tangent = 0.0; tangent <= 1.0; tangent += 1.0 / 37.0)
        {
            Raster<double> expected(24, 24, 0.0);
            const float rounded = static_cast<float>(tangent);
            forEachHorizon<double>(tile, Octant{}, double(rounded), 16,
                                   [&](int x, int y, double slope) { expected.at(x, y) = slope; });
            forEachHorizon<float>(tile, Octant{}, rounded, 16,
                                  [&](int x, int y, double slope)
                                  {
                                      ASSERT_TRUE(slopesAgree(slope, expected.at(x, y), bound))
                                          << level << ' ' << tangent << ": " << slope << ", "
                                          << expected.at(x, y);
                                  });
        }
    }
}

TYPED_TEST(HorizonFunctions, HullComparesAsFractionsDo)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    using vec2 = typename G::vec2;
    std::mt19937 random(51);
    std::uniform_int_distribution<int> height(-30, 30);
    std::uniform_int_distribution<int> step(1, 12);
    int equal = 0;
    for (int trial = 0; trial < 20000; ++trial)
    {
        // Positions fall away from the eye; whole numbers, so that products are exact in float too.
        const std::int64_t eyeAt = 100;
        const std::int64_t nearAt = eyeAt - step(random);
        const std::int64_t farAt = nearAt - step(random);
        const std::int64_t eye = height(random);
        const std::int64_t nearer = height(random);
        const std::int64_t farther = height(random);
        // (farther − eye)/(eyeAt − farAt) >= (nearer − eye)/(eyeAt − nearAt), both divisors > 0.
        const std::int64_t left = (farther - eye) * (eyeAt - nearAt);
        const std::int64_t right = (nearer - eye) * (eyeAt - farAt);
        equal += left == right;
        const auto at = [](std::int64_t z, std::int64_t position)
        { return vec2(static_cast<TypeParam>(z), static_cast<TypeParam>(position)); };
        ASSERT_EQ(glsl.hidesOrEquals(at(eye, eyeAt), at(nearer, nearAt), at(farther, farAt)),
                  left >= right);
    }
    EXPECT_GT(equal, 20);
    // A vertex next to a void may be 1e12 below: it hides nothing.
    const vec2 eye(TypeParam(10), TypeParam(9));
    EXPECT_TRUE(glsl.hidesOrEquals(eye, vec2(TypeParam(-9e11), TypeParam(8)),
                                   vec2(TypeParam(3), TypeParam(1))));
    EXPECT_FALSE(glsl.hidesOrEquals(eye, vec2(TypeParam(3), TypeParam(8)),
                                    vec2(TypeParam(-9e11), TypeParam(1))));
}
