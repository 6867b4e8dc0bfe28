#include "BenchFiles.h"
#include "BenchMeasure.h"
#include "BenchObjects.h"
#include "core/SyntheticTerrain.h"

#include <cpl_conv.h>

#include <algorithm>
#include <ctime>
#include <iostream>
#include <memory>
#include <optional>

namespace osgTerrainLight::tool
{
namespace
{

using namespace bench;

constexpr double readEnd = 0.05; // where the reading ends on the progress line

std::string now()
{
    const std::time_t time = std::time(nullptr);
    char buffer[32];
    std::strftime(buffer, sizeof(buffer), "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&time));
    return buffer;
}

/// Finds out what will be measured, and its size, without the heights.
Status describeTerrain(const Options& options, Report& report)
{
    if (!options.generated.empty())
    {
        report.terrain =
            "generated " + options.generated + ", seed " + std::to_string(options.terrainSeed);
        report.width = options.width;
        report.height = options.height;
        return Nothing{};
    }
    const Result<DemInfo> info = describeDem(options.input, options.read);
    if (Status known = checkProj(options.input, info); !known)
        return known;
    if (!info)
        return info.error();
    for (const std::string& note : info->notes)
        warn(options.input + ": " + note);
    report.terrain = CPLGetFilename(options.input.c_str());
    report.width = info->window.width;
    report.height = info->window.height;
    return Nothing{};
}

Result<DemTile> readTerrain(const Options& options, Progress& progress)
{
    if (!options.generated.empty())
    {
        TerrainKind kind = TerrainKind::Fractal;
        fromString(options.generated, kind);
        return generateTerrain(kind, options.width, options.height, options.spacing,
                               options.terrainSeed);
    }
    DemReadOptions read = options.read;
    read.progress = [&progress](double fraction)
    {
        progress.reach(readEnd * fraction);
        return true;
    };
    Result<DemFile> dem = readDem(options.input, read);
    if (!dem)
        return dem.error();
    return std::move(dem->tile);
}

/// A row for each method and number of azimuths.
std::vector<Row> planRows(const Options& options)
{
    std::vector<Row> rows;
    for (const Method* method : options.methods)
        for (const int azimuths : options.azimuths)
        {
            if (method->ofBounces && options.settings.bounces == 0)
                continue;
            Row row;
            row.method = method->name;
            row.settings = options.settings;
            row.settings.azimuths = azimuths;
            method->apply(row.settings);
            rows.push_back(std::move(row));
        }
    return rows;
}

/// Mistakes in the command line that show only in several options together.
void checkOptions(const Options& options)
{
    if (options.input.empty() && options.generated.empty())
        throw CLI::ValidationError("INPUT", "needed: a DEM, --generate KIND, or --objects");
    if (options.posts == 0 && !options.plot.empty())
        throw CLI::ValidationError("--plot", "draws errors: needs --posts 1 or more");
    if (options.settings.bounces > 0 && options.settings.albedo == Rgb{})
        throw CLI::ValidationError("--albedo", "0 in all channels: nothing bounces");
}

/// What will be measured, on what, without the heights.
Result<Report> plan(const Options& options, const Gpu& gpu)
{
    Report report;
    report.date = now();
    report.device = gpu.capabilities;
    report.sky = options.sky;
    report.settings = options.settings;
    if (options.posts > 0)
        report.quantities = directQuantities();
    if (options.posts > 0 && options.settings.bounces > 0)
        report.quantities.push_back(indirectQuantity());
    report.seed = options.seed;
    report.repeats = options.repeats;
    if (Status described = describeTerrain(options, report); !described)
        return described.error();
    if (Status fits = checkFits(gpu, report.width, report.height); !fits)
        return Error{fits.error().code, report.terrain + ": " + fits.error().message};
    report.rows = planRows(options);
    if (report.rows.empty())
        throw CLI::ValidationError("--methods", "what they differ in are bounces: needs --bounces");
    return report;
}

/// The path tracer takes one distance between posts in all rows.
Status checkSpacing(const Options& options, const Report& report, const DemTile& tile)
{
    if (options.posts > 0 && options.settings.bounces > 0 &&
        std::any_of(tile.eastSpacings.begin(), tile.eastSpacings.end(),
                    [&](double spacing) { return spacing != tile.eastSpacings.front(); }))
        return Error{ErrorCode::NotSupported,
                     report.terrain +
                         ": --bounces needs posts as far apart in every row, for the path tracer; "
                         "this raster is in degrees. One in metres does (gdalwarp -t_srs)"};
    return Nothing{};
}

/// Finds the truth, and measures cost and error of every row.
Status fill(Report& report, const Options& options, const Gpu& gpu, const DemTile& tile,
            Progress& progress)
{
    Truth truth;
    std::optional<IndirectTruth> indirect;
    if (options.posts > 0)
        truth = findTruth(tile, options.sky, options.azimuths, options.posts, options.seed,
                          [&](double fraction)
                          { progress.reach(readEnd + (truthEnd - readEnd) * fraction); });
    report.skyPosts = truth.skyPosts;
    report.sunPosts = truth.posts.size();
    if (options.posts > 0 && options.settings.bounces > 0)
    {
        Result<IndirectTruth> built = IndirectTruth::build(tile, options.sky, options.settings,
                                                           options.seed, options.posts, truth);
        if (!built)
            return Error{built.error().code, report.terrain + ": " + built.error().message};
        indirect.emplace(std::move(*built));
    }
    if (Status measured = measureAll(gpu, tile, truth, report, progress); !measured)
        return measured;
    if (indirect)
        if (Status measured = measureIndirect(options, truth, *indirect, report, progress);
            !measured)
            return measured;
    if (std::none_of(report.rows.begin(), report.rows.end(),
                     [](const Row& row) { return row.skipped.empty(); }))
        return Error{ErrorCode::NotSupported,
                     report.terrain + ": nothing was measured: " + report.rows.front().skipped};
    markFronts(report);
    return Nothing{};
}

void checkPicture(const Options& options)
{
    if (!options.plot.empty() && !EQUAL(CPLGetExtension(options.plot.c_str()), "svg"))
        throw CLI::ValidationError("--plot", options.plot + ": needs a name that ends in .svg");
}

Status run(const Options& options)
{
    checkPicture(options);
    if (options.objects)
        return runObjects(options, now());
    checkOptions(options);
    if (Status writable = checkOutputs(options); !writable)
        return writable;
    const Result<Gpu> gpu = openGpu();
    if (!gpu)
        return gpu.error();
    Result<Report> report = plan(options, *gpu);
    if (!report)
        return report.error();
    Progress progress(options.quiet);
    progress.reach(0.0);
    const Result<DemTile> tile = readTerrain(options, progress);
    if (!tile)
        return tile.error();
    progress.reach(readEnd);
    report->validPosts = tile->validCount();
    report->eastSpacing = tile->nominalEastSpacing();
    report->northSpacing = tile->northSpacing;
    if (Status even = checkSpacing(options, *report, *tile); !even)
        return even;
    if (Status filled = fill(*report, options, *gpu, *tile, progress); !filled)
        return filled;
    progress.reach(1.0);
    std::cout << (options.quiet ? "" : "\n") << tableOf(*report) << std::flush;
    return writeFiles(options, *report);
}

} // namespace

Mode addBench(CLI::App& tool)
{
    CLI::App* app = tool.add_subcommand(
        "bench",
        "Speed against error: what each method and number of azimuths costs here, and how wrong it "
        "is on this terrain. As a table; as CSV, JSON and a picture where asked for. Rows marked * "
        "are the Pareto front of GPU time against an error: no other row is at least as good in "
        "both and better in one; that of the shading's luminance is the one for all light "
        "together");
    app->footer("Examples:\n"
                "  terrainlight bench dem.tif\n"
                "  terrainlight bench dem.tif --azimuths 16,32 --csv bench.csv --plot bench.svg\n"
                "  terrainlight bench --generate cliffs,7 --size 512 --sun 90,10\n"
                "  terrainlight bench --objects --csv objects.csv");
    const auto options = std::make_shared<Options>();
    addOptions(*app, *options);
    return {app, [options] { return run(*options); }};
}

} // namespace osgTerrainLight::tool
