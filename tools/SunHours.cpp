#include "Pipeline.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace osgTerrainLight::tool
{
namespace
{

constexpr double millisecondsPerMinute = 6e4;
constexpr double mostSteps = 1e6;

struct Options : RasterOptions
{
    SkyLight sky;
    SunTime sun; ///< its place; the time runs
    UtcTime from, to;
    double step = 10.0; ///< minutes
};

/// Suns that are up, by the midpoint rule: each step, the last one may be shorter, has the sun of
/// its middle.
struct Steps
{
    Steps(const Options& options, const EarthPlace& where) : place(where), sky(options.sky)
    {
        const auto all = static_cast<double>((options.to - options.from).count());
        const double length = options.step * millisecondsPerMinute;
        for (double start = 0.0; start < all; start = length * ++count)
        {
            const double end = std::min(start + length, all);
            const UtcTime middle =
                options.from + std::chrono::milliseconds(std::llround(0.5 * (start + end)));
            if (TileLight::needsSun(skyAt(middle)))
                sunny.emplace_back(middle, (end - start) / (60.0 * millisecondsPerMinute));
        }
    }
    SkyLight skyAt(UtcTime time) const
    {
        SkyLight then = sky;
        then.setSunAt(time, place);
        return then;
    }

    EarthPlace place;
    SkyLight sky;
    int count = 0;
    std::vector<std::pair<UtcTime, double>> sunny; ///< middles, and how long they stand for [h]
};

/// The sum of the sun's visible fraction over all steps, by post.
Result<std::vector<double>> sumOf(const Steps& steps, LitTile& lit, const Fraction& progress)
{
    std::vector<double> hours(lit.tile().postCount(), 0.0);
    std::size_t done = 0;
    for (const auto& [time, length] : steps.sunny)
    {
        const SkyLight sky = steps.skyAt(time);
        if (!lit.lighting)
            lit.lighting = lit.newLight(lit.settings, sky, SkyViewDefinition::Surface);
        lit.lighting->setSky(sky);
        if (Status updated = lit.lighting->update(lit.state()); !updated)
            return updated.error();
        if (Status finished = lit.gpu->finish(); !finished)
            return finished.error();
        const Raster<osg::Vec4f> shading = lit.lighting->readShading(lit.state());
        for (std::size_t i = 0; i < hours.size(); ++i)
            hours[i] += length * static_cast<double>(shading.values()[i].w());
        progress(static_cast<double>(++done) / static_cast<double>(steps.sunny.size()));
    }
    return hours;
}

Status run(const Options& options)
{
    const double minutes =
        static_cast<double>((options.to - options.from).count()) / millisecondsPerMinute;
    if (!(minutes > 0.0))
        throw CLI::ValidationError("--to", toString(options.to) + " is not after --from " +
                                               toString(options.from));
    if (minutes / options.step > mostSteps)
        throw CLI::ValidationError("--step", text(std::ceil(minutes / options.step)) +
                                                 " steps: needs at most " + text(mostSteps));
    const Result<EarthPlace> place = placeOf(options, options.sun);
    if (!place)
        return place.error();
    const Steps steps(options, *place);
    std::vector<double> hours;
    Product product;
    product.mode = "sunhours";
    product.sky = options.sky;
    product.bands = {
        {"hours of direct sun from " + toString(options.from) + " to " + toString(options.to),
         "h"}};
    product.work = std::to_string(steps.count) + (steps.count == 1 ? " step, " : " steps, ") +
                   std::to_string(steps.sunny.size()) + " with the sun up";
    product.compute = [&](LitTile& lit, const Fraction& progress) -> Status
    {
        Result<std::vector<double>> sum = sumOf(steps, lit, progress);
        if (!sum)
            return sum.error();
        hours = std::move(*sum);
        return Nothing{};
    };
    product.values = [&hours](LitTile& lit)
    {
        return [&lit, &hours](int)
        {
            Raster<float> result(lit.tile().width(), lit.tile().height());
            for (std::size_t i = 0; i < result.size(); ++i)
                result.values()[i] = lit.tile().validity()[i]
                                         ? static_cast<float>(hours[i])
                                         : std::numeric_limits<float>::quiet_NaN();
            return result;
        };
    };
    product.metadata = [&](const LitTile& lit)
    {
        Metadata metadata = describe("sunhours", lit, false);
        add(metadata, "FROM", toString(options.from));
        add(metadata, "TO", toString(options.to));
        add(metadata, "STEP_MINUTES", text(options.step));
        addPlace(metadata, *place);
        addSetting(metadata, "sun-radius", options.sky);
        return metadata;
    };
    return process(options, product);
}

} // namespace

Mode addSunHours(CLI::App& tool)
{
    CLI::App* app = tool.add_subcommand(
        "sunhours", "Hours of direct sun over a period. The visible fraction of the sun's disc, "
                    "summed over steps, each with the sun of its middle; clouds are not known");
    app->footer("Examples:\n"
                "  terrainlight sunhours dem.tif day.tif --from 2024-06-21T00:00+02:00 "
                "--to 2024-06-22T00:00+02:00\n"
                "  terrainlight sunhours dem.tif year.tif --from 2024-01-01T00:00 "
                "--to 2025-01-01T00:00 --step 30");
    const auto options = std::make_shared<Options>();
    options->sky.skyEnabled = false;
    addRasterOptions(*app, *options, false);
    addTime(*app, "--from", "Start of the period: YYYY-MM-DDThh:mm[:ss], UTC or with a zone +hh:mm",
            [options](UtcTime time) { options->from = time; })
        ->required();
    addTime(*app, "--to", "Its end", [options](UtcTime time) { options->to = time; })->required();
    addLimitedNumbers(*app, "--step", "MINUTES", {{"step", 0.1, 1440.0, false}},
                      "Minutes from sun to sun, 0.1 ... 1440; default 10",
                      [options](const auto& v) { options->step = v[0]; });
    addPlace(*app, options->sun);
    addSetting(*app, "sun-radius", options->sky);
    return {app, [options] { return run(*options); }};
}

} // namespace osgTerrainLight::tool
