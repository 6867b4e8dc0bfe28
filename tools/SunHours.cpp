#include "Pipeline.h"

#include <cpl_string.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <limits>

namespace osgTerrainLight::tool
{
namespace
{

constexpr double millisecondsPerMinute = 6e4;
constexpr double mostSteps = 1e6;
// Where reading and computing end on the progress line.
constexpr double readEnd = 0.1;
constexpr double computeEnd = 0.9;

struct Options : RasterOptions
{
    SkyLight sky;
    SunTime sun; ///< its place; the time runs
    UtcTime from, to;
    double step = 10.0; ///< minutes
};

/// Sums the sun's visible fraction over the period.
class Sum
{
public:
    Sum(const Options& options, const EarthPlace& place, LitDem& lit)
        : _options(options), _place(place), _lit(lit), _hours(lit.dem.tile.postCount(), 0.0)
    {
    }

    /// The midpoint rule: each step, the last one may be shorter, has the sun of its middle.
    Status run(Progress& progress)
    {
        const auto all = static_cast<double>((_options.to - _options.from).count());
        const double step = _options.step * millisecondsPerMinute;
        for (double start = 0.0; start < all; start = step * ++_steps)
        {
            const double end = std::min(start + step, all);
            const UtcTime middle =
                _options.from + std::chrono::milliseconds(std::llround(0.5 * (start + end)));
            if (Status added = add(middle, (end - start) / (60.0 * millisecondsPerMinute)); !added)
                return added;
            progress.reach(readEnd + (computeEnd - readEnd) * end / all);
        }
        return Nothing{};
    }

    Raster<float> hours() const
    {
        Raster<float> result(_lit.dem.tile.width(), _lit.dem.tile.height());
        for (std::size_t i = 0; i < result.size(); ++i)
            result.values()[i] = _lit.dem.tile.validity()[i]
                                     ? static_cast<float>(_hours[i])
                                     : std::numeric_limits<float>::quiet_NaN();
        return result;
    }
    int steps() const { return _steps; }
    int lit() const { return _sunny; }

private:
    Status add(UtcTime time, double hours)
    {
        SkyLight sky = _options.sky;
        sky.setSunAt(time, _place);
        if (!TileLight::needsSun(sky))
            return Nothing{};
        ++_sunny;
        if (!_lit.lighting)
            _lit.lighting = new TileLight(_lit.dem.tile, _lit.settings, sky);
        _lit.lighting->setSky(sky);
        if (Status done = _lit.lighting->update(_lit.gpu.state()); !done)
            return done;
        if (Status done = _lit.gpu.finish(); !done)
            return done;
        const Raster<osg::Vec4f> shading = _lit.lighting->readShading(_lit.gpu.state());
        for (std::size_t i = 0; i < _hours.size(); ++i)
            _hours[i] += hours * static_cast<double>(shading.values()[i].w());
        return Nothing{};
    }

    const Options& _options;
    const EarthPlace& _place;
    LitDem& _lit;
    std::vector<double> _hours; ///< by post
    int _steps = 0, _sunny = 0;
};

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
    LitDem lit;
    std::size_t headNotes = 0;
    Progress progress(options.output.quiet);
    if (Status read = readTile(options, 1, lit, headNotes, progress); !read)
        return read;
    const auto start = std::chrono::steady_clock::now();
    Sum sum(options, *place, lit);
    if (Status computed = sum.run(progress); !computed)
        return Error{computed.error().code, options.input + ": " + computed.error().message};
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;

    Metadata metadata = describe("sunhours", lit, false);
    add(metadata, "FROM", toString(options.from));
    add(metadata, "TO", toString(options.to));
    add(metadata, "STEP_MINUTES", text(options.step));
    addPlace(metadata, *place);
    addSetting(metadata, "sun-radius", options.sky);
    if (Status written = writeBands(
            options.output, lit.dem.frame,
            {{"hours of direct sun from " + toString(options.from) + " to " + toString(options.to),
              "h"}},
            metadata, progress, [&](int) { return sum.hours(); });
        !written)
        return written;
    progress.reach(1.0);
    sayNotes(options.input, lit, headNotes);
    if (!options.output.quiet)
        std::cout << "sunhours: " << lit.dem.tile.postCount() << " posts, " << sum.steps()
                  << (sum.steps() == 1 ? " step, " : " steps, ") << sum.lit()
                  << " with the sun up, " << CPLSPrintf("%.3g s", took.count()) << std::endl;
    return Nothing{};
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
