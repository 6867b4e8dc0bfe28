#include "core/SyntheticTerrain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace osgTerrainLight;

namespace
{
DemTile make(TerrainKind kind, int width, int height, double spacing = 30.0, std::uint32_t seed = 1)
{
    return generateTerrain(kind, width, height, spacing, seed).value();
}

/// Quantile of the slopes at cell centres [degrees].
double slopeQuantile(const DemTile& tile, double quantile)
{
    std::vector<double> slopes;
    for (int row = 0; row + 1 < tile.height(); ++row)
        for (int column = 0; column + 1 < tile.width(); ++column)
        {
            const auto h = [&](int dx, int dy)
            { return double(tile.heightAt(column + dx, row + dy)); };
            const double east =
                (h(1, 0) + h(1, 1) - h(0, 0) - h(0, 1)) / (2.0 * tile.eastSpacing(row));
            const double north =
                (h(0, 1) + h(1, 1) - h(0, 0) - h(1, 0)) / (2.0 * tile.northSpacing);
            slopes.push_back(std::atan(std::hypot(east, north)) * 180.0 / 3.14159265358979323846);
        }
    std::sort(slopes.begin(), slopes.end());
    return slopes[static_cast<std::size_t>(quantile * static_cast<double>(slopes.size() - 1))];
}

/// FNV-1a over the heights' bits.
std::uint32_t fingerprint(const DemTile& tile)
{
    std::uint32_t sum = 2166136261u;
    for (float h : tile.heights())
    {
        std::uint32_t bits;
        std::memcpy(&bits, &h, sizeof bits);
        for (int shift = 0; shift < 32; shift += 8)
            sum = (sum ^ ((bits >> shift) & 255u)) * 16777619u;
    }
    return sum;
}
} // namespace

TEST(SyntheticTerrain, NamesRoundTrip)
{
    EXPECT_EQ(allTerrainKinds().size(), 4u);
    for (TerrainKind kind : allTerrainKinds())
    {
        TerrainKind read = TerrainKind::Fractal;
        EXPECT_TRUE(fromString(toString(kind), read));
        EXPECT_EQ(read, kind);
    }
    TerrainKind kept = TerrainKind::Cliffs;
    EXPECT_FALSE(fromString("hills", kept));
    EXPECT_EQ(kept, TerrainKind::Cliffs);
}

TEST(SyntheticTerrain, AnySize)
{
    for (TerrainKind kind : allTerrainKinds())
        for (const auto& [width, height] : {std::pair{1, 1}, {1, 17}, {33, 1}, {7, 5}, {64, 31}})
        {
            const DemTile tile = make(kind, width, height, 10.0);
            EXPECT_EQ(tile.width(), width);
            EXPECT_EQ(tile.height(), height);
            EXPECT_EQ(tile.validCount(), tile.postCount());
            EXPECT_EQ(tile.northSpacing, 10.0);
            EXPECT_EQ(tile.nominalEastSpacing(), 10.0);
        }
}

TEST(SyntheticTerrain, RefusesWhatItCannotMake)
{
    for (const auto& [width, height, spacing] : {std::tuple{0, 5, 30.0},
                                                 {5, -1, 30.0},
                                                 {1 << 20, 1 << 20, 30.0},
                                                 {5, 5, 0.0},
                                                 {5, 5, -1.0},
                                                 {5, 5, 1e5},
                                                 {5, 5, std::nan("")}})
    {
        const Result<DemTile> tile =
            generateTerrain(TerrainKind::Crater, width, height, spacing, 1);
        ASSERT_FALSE(tile.ok());
        EXPECT_EQ(tile.error().code, ErrorCode::Invalid);
        EXPECT_FALSE(tile.error().message.empty());
    }
}

TEST(SyntheticTerrain, IsTheSameEverywhere)
{
    // From the first build. A change here changes what every measured error refers to.
    EXPECT_EQ(fingerprint(make(TerrainKind::Fractal, 65, 43)), 3376532381u);
    EXPECT_EQ(fingerprint(make(TerrainKind::Crater, 65, 43)), 3640560011u);
    EXPECT_EQ(fingerprint(make(TerrainKind::Cliffs, 65, 43)), 1943930550u);
    EXPECT_EQ(fingerprint(make(TerrainKind::Spikes, 65, 43)), 597944625u);
}

TEST(SyntheticTerrain, SeedsDiffer)
{
    for (TerrainKind kind : allTerrainKinds())
        EXPECT_NE(make(kind, 32, 32, 30.0, 1).heights(), make(kind, 32, 32, 30.0, 2).heights());
}

TEST(SyntheticTerrain, ASmallTileIsACornerOfALargeOne)
{
    for (TerrainKind kind : {TerrainKind::Fractal, TerrainKind::Cliffs, TerrainKind::Spikes})
    {
        const DemTile large = make(kind, 90, 70);
        const DemTile small = make(kind, 33, 50);
        for (int row = 0; row < small.height(); ++row)
            for (int column = 0; column < small.width(); ++column)
                ASSERT_EQ(small.heightAt(column, row), large.heightAt(column, row));
    }
}

TEST(SyntheticTerrain, FractalHasAMedianSlopeOf22Degrees)
{
    // 600 posts is the longest wavelength, so 1024² holds few of them: 0.5° between seeds.
    for (std::uint32_t seed : {1u, 2u, 3u})
        EXPECT_NEAR(slopeQuantile(make(TerrainKind::Fractal, 1024, 1024, 30.0, seed), 0.5), 22.0,
                    1.0);
    EXPECT_NEAR(slopeQuantile(make(TerrainKind::Fractal, 256, 256, 30.0), 0.5),
                slopeQuantile(make(TerrainKind::Fractal, 256, 256, 1.0), 0.5), 1e-3);
}

TEST(SyntheticTerrain, CliffsAreTerracesFacesWallsAndSpikes)
{
    const DemTile tile = make(TerrainKind::Cliffs, 512, 512);
    EXPECT_LT(slopeQuantile(tile, 0.5), 5.0);
    EXPECT_GT(slopeQuantile(tile, 0.9), 55.0);
    EXPECT_GT(slopeQuantile(tile, 1.0), 80.0);
    // One-post spikes and walls stand out by at least one spacing above both neighbours.
    int spikes = 0;
    int walls = 0;
    for (int row = 1; row + 1 < tile.height(); ++row)
        for (int column = 1; column + 1 < tile.width(); ++column)
        {
            const auto above = [&](int dx, int dy)
            { return tile.heightAt(column, row) - tile.heightAt(column + dx, row + dy) > 29.0f; };
            const bool acrossEast = above(-1, 0) && above(1, 0);
            const bool acrossNorth = above(0, -1) && above(0, 1);
            spikes += acrossEast && acrossNorth;
            walls += acrossEast != acrossNorth;
        }
    EXPECT_GT(spikes, 100);
    EXPECT_GT(walls, 500);
}

TEST(SyntheticTerrain, CraterIsSmoothAndSpikesAreFew)
{
    EXPECT_LT(slopeQuantile(make(TerrainKind::Crater, 256, 200), 1.0), 45.0);
    EXPECT_LT(slopeQuantile(make(TerrainKind::Crater, 256, 200), 0.5), 5.0);
    const DemTile spikes = make(TerrainKind::Spikes, 200, 200);
    const auto level = std::count(spikes.heights().begin(), spikes.heights().end(), 0.0f);
    EXPECT_NEAR(static_cast<double>(level), 39600.0, 100.0);
    const auto [low, high] = std::minmax_element(spikes.heights().begin(), spikes.heights().end());
    EXPECT_LT(*low, -200.0f);
    EXPECT_GT(*high, 200.0f);
}
