#include "support/Tiles.h"

#include "core/AzimuthSet.h"
#include "core/MemorySource.h"
#include "lighting/FarLight.h"
#include "reference/ExhaustiveHorizon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace osgTerrainLight::testing
{

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

std::vector<float> shadingOf(osg::State& state, TileLight& light)
{
    std::vector<float> values;
    const Raster<osg::Vec4f> shading = light.readShading(state);
    for (const osg::Vec4f& post : shading.values())
        values.insert(values.end(), {post.x(), post.y(), post.z()});
    return values;
}

std::vector<float> bouncedOf(osg::State& state, TileLight& light)
{
    std::vector<float> values(light.tile().postCount(), 0.0f);
    for (int bounce = 1; bounce <= light.bounces(); ++bounce)
    {
        const Raster<osg::Vec4f> read = light.readBounce(state, bounce);
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] += read.values()[i].y();
    }
    return values;
}

std::vector<float> sunOf(osg::State& state, TileLight& light)
{
    std::vector<float> values;
    const Raster<osg::Vec4f> shading = light.readShading(state);
    for (const osg::Vec4f& post : shading.values())
        values.push_back(post.w());
    return values;
}

std::vector<float> skyViewOf(osg::State& state, TileLight& light)
{
    std::vector<float> values = light.readSkyView(state).values();
    for (float& value : values)
        value = std::isnan(value) ? 0.0f : value;
    return values;
}

TileCase underSky(int azimuths, HorizonQuality quality)
{
    TileCase lit;
    lit.sky.sunEnabled = false;
    lit.settings.azimuths = azimuths;
    lit.settings.quality = quality;
    return lit;
}

TileCase inTheAfternoon(int azimuths, int bounces)
{
    TileCase lit = underSky(azimuths);
    lit.sky.sunEnabled = true;
    lit.sky.sunAzimuth = 247.0;
    lit.sky.sunElevation = 25.0;
    lit.settings.bounces = bounces;
    lit.settings.albedo = {0.5f, 0.5f, 0.5f};
    return lit;
}

namespace
{
std::vector<float> valuesOf(osg::State& state, TileLight& light, const ReadTile& read)
{
    const Status done = light.update(state);
    EXPECT_TRUE(done) << done.error().message;
    std::vector<float> values = read(state, light);
    light.releaseGLObjects(&state);
    return values;
}
} // namespace

std::vector<float> inOnePiece(osg::State& state, const DemTile& tile, const TileCase& lit,
                              const ReadTile& read)
{
    const osg::ref_ptr<TileLight> light = new TileLight(tile, lit.settings, lit.sky);
    return valuesOf(state, *light, read);
}

std::vector<float> inTiles(osg::State& state, const DemTile& tile, const TileCase& lit, int side,
                           const ReadTile& read)
{
    MemorySource source(tile);
    MemoryRadiance radiance;
    const int margin = lit.settings.bounces > 0 ? bounceMargin : 0;
    const bool hasFarLight = margin > 0 && lit.farLight;
    if (hasFarLight)
    {
        FarLighting far;
        far.settings = lit.settings;
        far.sky = lit.sky;
        EXPECT_TRUE(lightLevels(state, source, far, radiance));
    }
    std::vector<float> all;
    for (int tileIndex = 0; tileIndex < side * side; ++tileIndex)
    {
        PostRect place;
        place.column = tile.width() * (tileIndex % side) / side;
        place.row = tile.height() * (tileIndex / side) / side;
        place.width = tile.width() * (tileIndex % side + 1) / side - place.column;
        place.height = tile.height() * (tileIndex / side + 1) / side - place.row;
        const PostRect grown = place.grownBy(margin).clippedTo(source.extent(0));
        const auto windows = readWindows(source, 0, grown, lit.settings.quality);
        EXPECT_TRUE(windows);
        const osg::ref_ptr<TileLight> light = new TileLight(*windows, lit.settings, lit.sky);
        if (hasFarLight)
            light->setFarLight(readFarLight(radiance, 0, lit.settings.bounces, **windows).value());
        const std::vector<float> values = valuesOf(state, *light, read);
        const std::size_t count = values.size() / light->tile().postCount();
        all.resize(tile.postCount() * count);
        const auto texel = [count](int column, int row, int width)
        { return static_cast<std::ptrdiff_t>(count) * (std::ptrdiff_t(row) * width + column); };
        for (int row = 0; row < place.height; ++row)
            std::copy_n(values.begin() + texel(place.column - grown.column,
                                               place.row - grown.row + row, grown.width),
                        static_cast<std::size_t>(place.width) * count,
                        all.begin() + texel(place.column, place.row + row, tile.width()));
    }
    return all;
}

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

double relativeRms(const std::vector<float>& a, const std::vector<float>& b)
{
    double sum = 0.0, all = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
    {
        const double difference = static_cast<double>(b[i]) - static_cast<double>(a[i]);
        sum += difference * difference;
        all += static_cast<double>(a[i]) * static_cast<double>(a[i]);
    }
    return 100.0 * std::sqrt(sum / all);
}

Differences errorsOf(const DemTile& tile, const std::vector<float>& horizons)
{
    constexpr int count = 32;
    const AzimuthSet azimuths(count);
    reference::HorizonOptions options;
    options.highest = reference::highestPost(tile);
    std::mt19937 random(20261128);
    std::vector<float> exact, found;
    for (int i = 0; i < 500;)
    {
        const auto post = static_cast<int>(random() % tile.postCount());
        const int column = post % tile.width();
        const int row = post / tile.width();
        if (!tile.isValid(column, row))
            continue;
        ++i;
        for (int k = 0; k < count; ++k)
        {
            const auto horizon =
                reference::exhaustiveHorizon(tile, column, row, azimuths.direction(k), options);
            exact.push_back(static_cast<float>(std::max(0.0, horizon.elevationDegrees())));
            found.push_back(
                horizons[static_cast<std::size_t>(post) * count + static_cast<std::size_t>(k)]);
        }
    }
    return differencesOf(exact, found);
}

LightDifferences lightDifferences(osg::State& state, const DemTile& tile, const TileCase& lit,
                                  int side)
{
    const ReadTile both = [](osg::State& in, TileLight& light)
    {
        const std::vector<float> shading = shadingOf(in, light); // three of each post
        const std::vector<float> bounced = bouncedOf(in, light);
        std::vector<float> all;
        for (std::size_t i = 0; i < bounced.size(); ++i)
            all.insert(all.end(),
                       {shading[3 * i], shading[3 * i + 1], shading[3 * i + 2], bounced[i]});
        return all;
    };
    std::array<std::vector<float>, 2> shading, bounced;
    for (std::size_t way = 0; way < 2; ++way)
    {
        const std::vector<float> values =
            way == 0 ? inOnePiece(state, tile, lit, both) : inTiles(state, tile, lit, side, both);
        for (std::size_t i = 0; i < values.size(); ++i)
            (i % 4 == 3 ? bounced : shading)[way].push_back(values[i]);
    }
    return {differencesOf(shading[0], shading[1]),
            lit.settings.bounces > 0 ? relativeRms(bounced[0], bounced[1]) : 0.0};
}

double seamRatio(const std::vector<float>& values, int width, int height, int side)
{
    const auto at = [&](int column, int row)
    { return static_cast<double>(values[static_cast<std::size_t>(row * width + column)]); };
    double across = 0.0, inside = 0.0;
    for (int seam = 1; seam < side; ++seam)
    {
        const int column = width * seam / side; // the first beyond the seam
        for (int row = 0; row < height; ++row)
        {
            across += std::abs(at(column, row) - at(column - 1, row));
            inside += std::abs(at(column + 1, row) - at(column, row));
        }
        const int line = height * seam / side;
        for (int i = 0; i < width; ++i)
        {
            across += std::abs(at(i, line) - at(i, line - 1));
            inside += std::abs(at(i, line + 1) - at(i, line));
        }
    }
    return across / inside;
}

} // namespace osgTerrainLight::testing
