#include "BenchTruth.h"

#include "core/AzimuthSet.h"
#include "core/Luminance.h"
#include "reference/ReferenceLight.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <thread>

namespace osgTerrainLight::tool::bench
{
namespace
{

constexpr double pi = 3.14159265358979323846;

/// Different valid posts in random order: the first of a longer list are the shorter one's. mt19937
/// and the remainder, unlike the standard distributions, are the same everywhere.
std::vector<Post> randomPosts(const DemTile& tile, std::size_t count, std::uint32_t seed)
{
    std::vector<std::uint32_t> valid;
    for (std::size_t i = 0; i < tile.postCount(); ++i)
        if (tile.validity()[i])
            valid.push_back(static_cast<std::uint32_t>(i));
    std::mt19937 random(seed);
    std::vector<Post> posts;
    const auto width = static_cast<std::uint32_t>(tile.width());
    for (std::size_t i = 0; i < std::min(count, valid.size()); ++i)
    {
        std::swap(valid[i], valid[i + random() % (valid.size() - i)]);
        posts.push_back({static_cast<int>(valid[i] % width), static_cast<int>(valid[i] / width)});
    }
    return posts;
}

/// job(0) … job(count − 1) on all cores.
void inParallel(std::size_t count, const std::function<void(std::size_t)>& job,
                const std::function<void(double)>& progress)
{
    std::atomic<std::size_t> next{0};
    const auto work = [&](bool reports)
    {
        for (std::size_t i = next++; i < count; i = next++)
        {
            job(i);
            if (reports)
                progress(static_cast<double>(i) / static_cast<double>(count));
        }
    };
    std::vector<std::thread> others;
    for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i)
        others.emplace_back(work, false);
    work(true);
    for (std::thread& thread : others)
        thread.join();
}

std::vector<Compared> compareHorizons(const Truth& truth, const Found& found)
{
    std::vector<Compared> values;
    const int azimuths = found.horizons.azimuthCount();
    for (std::size_t i = 0; i < truth.skyPosts; ++i)
        for (int k = 0; k < azimuths; ++k)
            values.push_back(
                {std::max(found.horizons.elevationAt(truth.posts[i].column, truth.posts[i].row, k),
                          0.0),
                 truth.horizon(i, k, azimuths)});
    return values;
}

std::vector<Compared> compareSky(const Truth& truth, const Found& found)
{
    std::vector<Compared> values;
    for (std::size_t i = 0; i < truth.skyPosts; ++i)
        values.push_back(
            {static_cast<double>(found.sky.at(truth.posts[i].column, truth.posts[i].row)),
             truth.sky[i]});
    return values;
}

std::vector<Compared> compareSun(const Truth& truth, const Found& found)
{
    std::vector<Compared> values;
    for (std::size_t i = 0; i < truth.posts.size(); ++i)
        values.push_back(
            {static_cast<double>(found.shading.at(truth.posts[i].column, truth.posts[i].row).a()),
             truth.sun[i]});
    return values;
}

std::vector<Compared> compareLight(const Truth& truth, const Found& found)
{
    // A few posts would make the sun's rare and big errors chance; so all are compared, and those
    // without a sky of their own borrow the sky's error of one that has.
    std::vector<Compared> values;
    const auto skyView = [&](std::size_t i)
    { return static_cast<double>(found.sky.at(truth.posts[i].column, truth.posts[i].row)); };
    for (std::size_t i = 0; i < truth.posts.size(); ++i)
    {
        const std::size_t lender = i % truth.skyPosts;
        const double sky = skyView(i) - (skyView(lender) - truth.sky[lender]);
        const osg::Vec4f& c = found.shading.at(truth.posts[i].column, truth.posts[i].row);
        values.push_back({luminance({c.r(), c.g(), c.b()}),
                          truth.skyLuminance * sky + truth.sunlight[i] * truth.sun[i]});
    }
    return values;
}

} // namespace

double Truth::horizon(std::size_t post, int azimuth, int azimuths) const
{
    const auto& [count, elevations] =
        *std::find_if(horizons.begin(), horizons.end(),
                      [&](const auto& entry) { return entry.first % azimuths == 0; });
    return elevations[post * static_cast<std::size_t>(count) +
                      static_cast<std::size_t>(azimuth * (count / azimuths))];
}

Truth findTruth(const DemTile& tile, const SkyLight& sky, const std::vector<int>& azimuthCounts,
                std::size_t skyPosts, std::uint32_t seed,
                const std::function<void(double)>& progress)
{
    Truth truth;
    truth.posts = randomPosts(tile, skyPosts * Truth::sunPostsPerSkyPost, seed);
    truth.skyPosts = std::min(skyPosts, truth.posts.size());
    truth.sun.resize(truth.posts.size());
    truth.sky.resize(truth.skyPosts);
    truth.sunlight.resize(truth.posts.size());
    truth.skyLuminance = luminance(sky.skyRadiance);
    for (const int count : azimuthCounts)
        if (std::none_of(azimuthCounts.begin(), azimuthCounts.end(),
                         [&](int other) { return other > count && other % count == 0; }))
            truth.horizons[count].resize(truth.skyPosts * static_cast<std::size_t>(count));

    reference::HorizonOptions options;
    options.highest = reference::highestPost(tile);
    const reference::Sun sun = {sky.sunAzimuth, sky.sunElevation, sky.sunAngularRadius};
    const std::array<double, 3> towardsSun = sky.sunDirection();
    const auto atPost = [&](std::size_t i)
    {
        const auto [column, row] = truth.posts[i];
        truth.sun[i] = reference::sunFraction(tile, column, row, sun, Truth::sunStrips,
                                              reference::SkyExtent::AboveHorizontal, options);
        const reference::Vector3 normal = reference::surfaceNormal(tile, column, row);
        const double facing =
            normal[0] * towardsSun[0] + normal[1] * towardsSun[1] + normal[2] * towardsSun[2];
        truth.sunlight[i] = luminance(sky.sunIrradiance) * std::max(facing, 0.0) / pi;
        if (i >= truth.skyPosts)
            return;
        truth.sky[i] = reference::skyViewFactor(
            reference::horizonRing(tile, column, row, Truth::skyAzimuths, 0.5, options),
            reference::SkyViewDefinition::Surface, normal);
        for (auto& [count, elevations] : truth.horizons)
        {
            const AzimuthSet azimuths(count);
            for (int k = 0; k < count; ++k)
                elevations[i * static_cast<std::size_t>(count) + static_cast<std::size_t>(k)] =
                    std::max(reference::exhaustiveHorizon(tile, column, row, azimuths.direction(k),
                                                          options)
                                 .elevationDegrees(),
                             0.0);
        }
    };
    inParallel(truth.posts.size(), atPost, progress);
    return truth;
}

ErrorStatistics statisticsOf(const std::vector<Compared>& values)
{
    ErrorStatistics result;
    std::vector<double> sizes;
    double squares = 0.0;
    double expectedSquares = 0.0;
    for (const Compared& value : values)
    {
        const double error = value.found - value.expected;
        sizes.push_back(std::abs(error));
        result.mean += std::abs(error);
        result.bias += error;
        squares += error * error;
        expectedSquares += value.expected * value.expected;
    }
    const double count = static_cast<double>(values.size());
    result.mean /= count;
    result.bias /= count;
    result.rms = std::sqrt(squares / count);
    result.relativeRms = expectedSquares > 0.0 ? std::sqrt(squares / expectedSquares)
                                               : std::numeric_limits<double>::quiet_NaN();
    std::sort(sizes.begin(), sizes.end());
    result.p99 = sizes[sizes.size() * 99 / 100];
    result.max = sizes.back();
    return result;
}

const std::vector<Quantity>& quantities()
{
    static const std::vector<Quantity> table = {
        {"horizon", "deg", "horizon elevation", &ErrorStatistics::mean, "mean error in degrees",
         compareHorizons},
        {"sky", "factor", "sky-view factor", &ErrorStatistics::relativeRms, "relative RMS error",
         compareSky},
        {"sun", "fraction", "visible fraction of the sun", &ErrorStatistics::rms, "RMS error",
         compareSun},
        {"light", "luminance", "luminance of the shading", &ErrorStatistics::relativeRms,
         "relative RMS error", compareLight}};
    return table;
}

} // namespace osgTerrainLight::tool::bench
