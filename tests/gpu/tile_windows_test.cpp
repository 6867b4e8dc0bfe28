// One terrain as many tiles, each with nested windows around it, against the same terrain in one
// piece: horizons, sky view and light. The bounds are those that the project promises
// (docs/methods/tiles.md has what was measured).
#include "support/GlContext.h"
#include "support/Horizons.h"
#include "support/SharedData.h"

#include "core/MemorySource.h"
#include "core/SyntheticTerrain.h"
#include "lighting/TileLight.h"
#include "lighting/TileWindows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{

/// Values of a post, `count` of them, of a whole terrain.
struct Whole
{
    int width = 0, height = 0, count = 0;
    std::vector<float> values;

    float* at(int column, int row)
    {
        return &values[(static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(column)) *
                       static_cast<std::size_t>(count)];
    }
};

using Read = std::function<std::vector<float>(TileLight&, int column, int row)>;

struct Case
{
    LightingSettings settings;
    SkyLight sky;
};

SkyLight uniformSky()
{
    SkyLight sky;
    sky.sunEnabled = false;
    return sky;
}

std::vector<float> horizonsOf(osg::State& state, TileLight& light)
{
    const HorizonMap map = light.readHorizons(state);
    std::vector<float> all;
    for (int row = 0; row < map.height(); ++row)
        for (int column = 0; column < map.width(); ++column)
            for (int azimuth = 0; azimuth < map.azimuthCount(); ++azimuth)
                all.push_back(static_cast<float>(
                    map.isValid(column, row)
                        ? std::max(0.0, static_cast<double>(map.elevationAt(column, row, azimuth)))
                        : 0.0));
    return all;
}

struct Differences
{
    double median = 0.0, mean = 0.0, p99 = 0.0, worst = 0.0;
};

Differences differencesOf(const std::vector<float>& a, const std::vector<float>& b)
{
    EXPECT_EQ(a.size(), b.size());
    std::vector<double> differences;
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
    {
        differences.push_back(std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
        sum += differences.back();
    }
    const auto at = [&](double share)
    {
        const auto place =
            static_cast<std::ptrdiff_t>(share * static_cast<double>(differences.size() - 1));
        std::nth_element(differences.begin(), differences.begin() + place, differences.end());
        return differences[static_cast<std::size_t>(place)];
    };
    return {at(0.5), sum / static_cast<double>(a.size()), at(0.99), at(1.0)};
}

std::vector<float> inOnePiece(osg::State& state, const DemTile& tile, const Case& lit,
                              const std::function<std::vector<float>(TileLight&)>& read)
{
    const osg::ref_ptr<TileLight> light = new TileLight(tile, lit.settings, lit.sky);
    EXPECT_TRUE(light->update(state));
    std::vector<float> values = read(*light);
    light->releaseGLObjects(&state);
    return values;
}

/// side × side tiles.
std::vector<float> inTiles(osg::State& state, const DemTile& tile, const Case& lit, int side,
                           const std::function<std::vector<float>(TileLight&)>& read,
                           const WindowScheme& scheme = {})
{
    MemorySource source(tile);
    std::vector<float> all;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
        {
            PostRect place;
            place.column = tile.width() * x / side;
            place.row = tile.height() * y / side;
            place.width = tile.width() * (x + 1) / side - place.column;
            place.height = tile.height() * (y + 1) / side - place.row;
            const auto windows = readWindows(source, 0, place, scheme);
            EXPECT_TRUE(windows);
            const osg::ref_ptr<TileLight> light = new TileLight(*windows, lit.settings, lit.sky);
            const Status done = light->update(state);
            EXPECT_TRUE(done) << done.error().message;
            const std::vector<float> values = read(*light);
            light->releaseGLObjects(&state);
            const std::size_t count = values.size() / light->tile().postCount();
            all.resize(tile.postCount() * count);
            for (int row = 0; row < place.height; ++row)
                std::copy_n(
                    values.begin() + static_cast<std::ptrdiff_t>(
                                         static_cast<std::size_t>(row * place.width) * count),
                    static_cast<std::size_t>(place.width) * count,
                    all.begin() + static_cast<std::ptrdiff_t>(
                                      static_cast<std::size_t>((place.row + row) * tile.width() +
                                                               place.column) *
                                      count));
        }
    return all;
}

Differences measureHorizons(osg::State& state, const DemTile& tile, HorizonQuality quality,
                            int side, const char* name, const WindowScheme& scheme = {})
{
    Case lit;
    lit.sky = uniformSky();
    lit.settings.azimuths = 32;
    lit.settings.quality = quality;
    const auto read = [&](TileLight& light) { return horizonsOf(state, light); };
    const Differences found = differencesOf(inOnePiece(state, tile, lit, read),
                                            inTiles(state, tile, lit, side, read, scheme));
    std::printf("%-10s %-6s %2d tiles: median %.5f mean %.5f p99 %.4f worst %.2f degrees\n", name,
                toString(quality), side * side, found.median, found.mean, found.p99, found.worst);
    return found;
}

DemTile fractal(int side)
{
    return generateTerrain(TerrainKind::Fractal, side, side, 30.0, 7).value();
}

} // namespace

TEST(TileWindows, OneTileWithNothingAroundItIsTheSame)
{
    OTL_NEED_GL(context);
    const Differences found =
        measureHorizons(context->state(), fractal(300), HorizonQuality::Normal, 1, "fractal");
    EXPECT_LE(found.worst, 0.003); // two elevation codes
}

TEST(TileWindows, HorizonsOfTilesAreThoseOfOnePiece)
{
    OTL_NEED_GL(context);
    for (const HorizonQuality quality : {HorizonQuality::Normal, HorizonQuality::Best})
        for (const int side : {2, 4})
        {
            const Differences found =
                measureHorizons(context->state(), fractal(1025), quality, side, "fractal");
            EXPECT_LE(found.median, 0.001);
            EXPECT_LE(found.p99, quality == HorizonQuality::Best ? 0.05 : 0.15);
        }
}
