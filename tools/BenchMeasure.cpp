#include "BenchMeasure.h"

#include "core/Luminance.h"

#include <osg/GLObjects>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace osgTerrainLight::tool::bench
{
namespace
{

double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

/// What a row's rounds took [ms].
struct Times
{
    std::vector<std::vector<double>> byStage;
    std::vector<double> gpu, wall;
};

/// Reads back all that errors are of. Bounces are read one by one: the sum in the shading has lost
/// them to the rounding of the direct light.
Found readBack(const Gpu& gpu, const Truth& truth, const LightingSettings& settings,
               const TileLight& lighting)
{
    Found found;
    found.indirect.resize(truth.indirect.size());
    for (int bounce = 1; bounce <= settings.bounces; ++bounce)
    {
        const Raster<osg::Vec4f> light = lighting.readBounce(gpu.state(), bounce);
        for (std::size_t i = 0; i < found.indirect.size(); ++i)
        {
            const osg::Vec4f& c = light.at(truth.posts[i].column, truth.posts[i].row);
            found.indirect[i] += luminance({c.r(), c.g(), c.b()});
        }
    }
    if (settings.bounceMethod == BounceMethod::Slices)
    {
        found.horizons = lighting.readHorizons(gpu.state());
        found.sky = lighting.readSkyView(gpu.state());
    }
    found.direct = lighting.readDirect(gpu.state());
    return found;
}

/// Runs a row's settings twice, and times the second. In the first round finds its errors, too.
Status measure(const Gpu& gpu, const DemTile& tile, const Truth& truth, const SkyLight& sky,
               Row& row, Times& times, std::vector<std::string>& stages)
{
    const osg::ref_ptr<TileLight> lighting = new TileLight(tile, row.settings, sky);
    lighting->setTimed(true);
    // Twice, if there is room: the first time compiles and allocates. Where it takes long, that is
    // too little of it to do all again.
    constexpr std::chrono::seconds longTime(20);
    std::chrono::duration<double, std::milli> took{};
    for (int i = 0; i < 2 && row.skipped.empty() && took < longTime; ++i)
    {
        lighting->touch();
        const auto start = std::chrono::steady_clock::now();
        if (Status done = lighting->update(gpu.state()); !done)
            return done;
        if (const Status done = gpu.finish(); !done)
            row.skipped = done.error().message;
        took = std::chrono::steady_clock::now() - start;
    }
    if (row.skipped.empty())
    {
        // What the bench's light has; the others do not run.
        stages = {"horizon", "sky", "sun", "shade"};
        if (row.settings.bounces > 0)
            stages.insert(stages.end(), {"pyramid", "bounce"});
        times.byStage.resize(stages.size());
        for (std::vector<double>& stage : times.byStage)
            stage.push_back(0.0);
        times.wall.push_back(took.count());
        times.gpu.push_back(0.0);
        for (const StageCost& cost : lighting->costs())
        {
            // What is sent and what is added are parts of bounces.
            const bool isPart = cost.name == "sent" || cost.name == "compose";
            const auto stage =
                std::find(stages.begin(), stages.end(), isPart ? "bounce" : cost.name);
            if (stage == stages.end())
                continue;
            times.byStage[static_cast<std::size_t>(stage - stages.begin())].back() +=
                cost.gpuMilliseconds;
            times.gpu.back() += cost.gpuMilliseconds;
        }
    }
    row.bytes = lighting->bytes();
    if (row.skipped.empty() && row.errors.empty() && !truth.posts.empty())
    {
        Found found = readBack(gpu, truth, row.settings, *lighting);
        for (const Quantity& quantity : directQuantities())
            row.errors.push_back(statisticsOf(quantity.compare(truth, found)));
        row.indirect = std::move(found.indirect);
    }
    lighting->releaseGLObjects(&gpu.state());
    osg::flushAllDeletedGLObjects(gpu.state().getContextID());
    return Nothing{};
}

} // namespace

Status measureAll(const Gpu& gpu, const DemTile& tile, const Truth& truth, Report& report,
                  Progress& progress)
{
    // Time goes mostly with azimuths, the sun's included.
    double expected = 0.0;
    for (const Row& row : report.rows)
        expected += (row.settings.azimuths + 1) * report.repeats;
    double spent = 0.0;
    const double end = report.settings.bounces > 0 ? measureEnd : 1.0;
    std::vector<Times> times(report.rows.size());
    for (int round = 0; round < report.repeats; ++round)
        for (std::size_t i = 0; i < report.rows.size(); ++i)
        {
            Row& row = report.rows[i];
            if (row.skipped.empty())
                if (Status done =
                        measure(gpu, tile, truth, report.sky, row, times[i], report.stages);
                    !done)
                    return done;
            spent += row.settings.azimuths + 1;
            progress.reach(truthEnd + (end - truthEnd) * spent / expected);
        }
    for (std::size_t i = 0; i < report.rows.size(); ++i)
    {
        Row& row = report.rows[i];
        if (!row.skipped.empty())
            continue;
        for (const std::vector<double>& milliseconds : times[i].byStage)
            row.stageMilliseconds.push_back(median(milliseconds));
        row.gpuMilliseconds = median(times[i].gpu);
        row.wallMilliseconds = median(times[i].wall);
    }
    return Nothing{};
}

Status measureIndirect(const Options& options, const Truth& truth, IndirectTruth& indirect,
                       Report& report, Progress& progress)
{
    report.indirectPosts = truth.indirect.size();
    std::vector<Row*> rows;
    for (Row& row : report.rows)
        if (row.skipped.empty())
            rows.push_back(&row);
    for (Row* row : rows)
        row->errors.emplace_back();
    constexpr double noisePerError = 0.2;
    // What is asked for is traced at once.
    const auto most = static_cast<double>(options.paths > 0 ? 1 : IndirectTruth::mostPaths);
    double needed = static_cast<double>(IndirectTruth::firstPaths);
    for (bool enough = rows.empty(); !enough;)
    {
        const auto before = static_cast<double>(indirect.paths());
        const double more = before > 0.0 ? before : static_cast<double>(IndirectTruth::firstPaths);
        const auto reach = [&](double fraction)
        {
            const double done = options.paths > 0
                                    ? fraction
                                    : (before + more * fraction) / std::max(needed, before + more);
            // Until the first estimates are there, nobody knows how far it is.
            if (before > 0.0 || options.paths > 0)
                progress.reach(measureEnd + (1.0 - measureEnd) * done);
        };
        if (Status done = indirect.refine(
                options.paths > 0 ? options.paths : IndirectTruth::firstPaths, reach);
            !done)
            return done;
        double smallest = std::numeric_limits<double>::infinity();
        double noise = 0.0;
        for (Row* row : rows)
        {
            Found found;
            found.indirect = row->indirect;
            row->errors.back() = statisticsOf(indirectQuantity().compare(truth, found));
            noise = row->errors.back().relativeNoise; // the same in all rows
            smallest = std::min(smallest, row->errors.back().relativeRms);
        }
        const auto traced = static_cast<double>(indirect.paths());
        enough = traced >= most || noise == 0.0 ||
                 (std::isfinite(smallest) && noise <= noisePerError * smallest);
        const double ratio = noise / (noisePerError * smallest);
        needed = std::isfinite(ratio) ? std::min(traced * ratio * ratio, most) : most;
    }
    report.paths = indirect.paths();
    return Nothing{};
}

} // namespace osgTerrainLight::tool::bench
