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

double luminance(const reference::LinearRgb& c)
{
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

std::vector<Compared> compareHorizons(const Truth& truth, const Found& found)
{
    std::vector<Compared> values;
    const int azimuths = found.horizons.azimuthCount(); // 0 where the method has no horizons
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
    for (std::size_t i = 0; found.sky.size() > 0 && i < truth.skyPosts; ++i)
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
            {static_cast<double>(found.direct.at(truth.posts[i].column, truth.posts[i].row).a()),
             truth.sun[i]});
    return values;
}

std::vector<Compared> compareLight(const Truth& truth, const Found& found)
{
    // A few posts would make the sun's rare and big errors chance; so all are compared, and those
    // without a sky of their own borrow the sky's error of one that has. A method that has no
    // sky-view factors is compared where the truth has one.
    std::vector<Compared> values;
    const auto skyView = [&](std::size_t i)
    { return static_cast<double>(found.sky.at(truth.posts[i].column, truth.posts[i].row)); };
    const bool lends = found.sky.size() > 0;
    for (std::size_t i = 0; i < (lends ? truth.posts.size() : truth.skyPosts); ++i)
    {
        const std::size_t lender = i % truth.skyPosts;
        const double sky =
            lends ? skyView(i) - (skyView(lender) - truth.sky[lender]) : truth.sky[i];
        const osg::Vec4f& c = found.direct.at(truth.posts[i].column, truth.posts[i].row);
        values.push_back({osgTerrainLight::luminance(Rgb{c.r(), c.g(), c.b()}),
                          truth.skyLuminance * sky + truth.sunlight[i] * truth.sun[i]});
    }
    return values;
}

std::vector<Compared> compareIndirect(const Truth& truth, const Found& found)
{
    std::vector<Compared> values;
    for (std::size_t i = 0; i < truth.indirect.size(); ++i)
        values.push_back({found.indirect[i], truth.indirect[i], truth.indirectVariance[i]});
    return values;
}

} // namespace

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
    truth.skyLuminance = osgTerrainLight::luminance(sky.skyRadiance);
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
        // Where it is off, the shading says 1.
        truth.sun[i] = sky.sunEnabled
                           ? reference::sunFraction(tile, column, row, sun, Truth::sunStrips,
                                                    reference::SkyExtent::AboveHorizontal, options)
                           : 1.0;
        const reference::Vector3 normal = reference::surfaceNormal(tile, column, row);
        const double facing =
            normal[0] * towardsSun[0] + normal[1] * towardsSun[1] + normal[2] * towardsSun[2];
        if (sky.sunEnabled)
            truth.sunlight[i] =
                osgTerrainLight::luminance(sky.sunIrradiance) * std::max(facing, 0.0) / pi;
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

Result<IndirectTruth> IndirectTruth::build(const DemTile& tile, const SkyLight& sky,
                                           const LightingSettings& settings, std::uint32_t seed,
                                           std::size_t skyPosts, Truth& truth)
{
    reference::SceneDescription scene;
    scene.tile = tile;
    scene.albedo = settings.albedo;
    Result<reference::PathTracer> tracer = reference::PathTracer::build(std::move(scene));
    if (!tracer)
        return tracer.error();
    IndirectTruth indirect(std::move(*tracer), truth);
    indirect._illumination.light = sky;
    indirect._bounces = settings.bounces;
    indirect._seed = seed;
    const std::size_t count =
        std::min(std::max<std::size_t>(skyPosts / skyPostsPerPost, 1), truth.posts.size());
    for (std::size_t i = 0; i < count; ++i)
        indirect._receivers.push_back({truth.posts[i].column, truth.posts[i].row});
    truth.indirect.assign(count, 0.0);
    truth.indirectVariance.assign(count, 0.0);
    return indirect;
}

Status IndirectTruth::refine(std::uint64_t paths, const std::function<void(double)>& progress)
{
    // Colours and bounces of a path depend on one another, so the standard error of their luminance
    // does not follow from theirs: it is that of independent runs.
    constexpr int runs = 32;
    reference::PathTracerOptions options;
    options.batches = 2;
    options.bounces = _bounces;
    options.samples =
        static_cast<int>(((_paths > 0 ? _paths : paths) + runs - 1) / static_cast<unsigned>(runs));
    std::vector<double> mean(_receivers.size()), squares(_receivers.size());
    std::uint64_t added = 0;
    for (int run = 0; run < runs; ++run)
    {
        options.seed = (_seed << 32) + _runs++;
        options.progress = [&](std::size_t done, std::size_t all)
        { progress((run + static_cast<double>(done) / static_cast<double>(all)) / runs); };
        const Result<std::vector<reference::ReceivedLight>> received =
            _tracer.trace(_illumination, _receivers, options);
        if (!received)
            return received.error();
        added += received->front().samples;
        for (std::size_t i = 0; i < _receivers.size(); ++i)
        {
            double light = 0.0;
            for (const reference::Estimate& bounce : (*received)[i].bounces)
                light += luminance(bounce.mean);
            const double difference = light - mean[i];
            mean[i] += difference / (run + 1);
            squares[i] += difference * (light - mean[i]);
        }
    }
    const double fresh = static_cast<double>(added) / static_cast<double>(_paths + added);
    for (std::size_t i = 0; i < _receivers.size(); ++i)
    {
        _truth.indirect[i] += fresh * (mean[i] - _truth.indirect[i]);
        _truth.indirectVariance[i] = (1.0 - fresh) * (1.0 - fresh) * _truth.indirectVariance[i] +
                                     fresh * fresh * squares[i] / (runs * (runs - 1.0));
    }
    _paths += added;
    return Nothing{};
}

ErrorStatistics statisticsOf(const std::vector<Compared>& values)
{
    ErrorStatistics result;
    std::vector<double> sizes;
    double squares = 0.0;
    double expectedSquares = 0.0;
    double variance = 0.0;
    for (const Compared& value : values)
    {
        const double error = value.found - value.expected;
        sizes.push_back(std::abs(error));
        result.mean += std::abs(error);
        result.bias += error;
        squares += error * error;
        expectedSquares += value.expected * value.expected;
        variance += value.variance;
    }
    // An estimate's square is too large by its variance, on average, and so is an error's.
    squares = std::max(squares - variance, 0.0);
    expectedSquares = std::max(expectedSquares - variance, 0.0);
    const double count = static_cast<double>(values.size());
    result.mean /= count;
    result.bias /= count;
    result.rms = std::sqrt(squares / count);
    result.relativeRms = expectedSquares > 0.0 ? std::sqrt(squares / expectedSquares)
                                               : std::numeric_limits<double>::quiet_NaN();
    if (variance > 0.0)
        result.relativeNoise = std::sqrt(variance / expectedSquares);
    std::sort(sizes.begin(), sizes.end());
    const double none = std::numeric_limits<double>::quiet_NaN();
    result.p99 = sizes.empty() ? none : sizes[sizes.size() * 99 / 100];
    result.max = sizes.empty() ? none : sizes.back();
    return result;
}

const std::vector<Quantity>& directQuantities()
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

const Quantity& indirectQuantity()
{
    static const Quantity quantity = {"indirect",
                                      "luminance",
                                      "luminance of the light that bounces",
                                      &ErrorStatistics::relativeRms,
                                      "relative RMS error",
                                      compareIndirect,
                                      true};
    return quantity;
}

} // namespace osgTerrainLight::tool::bench
