#include "BenchReport.h"

#include "core/Luminance.h"
#include "core/SyntheticTerrain.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_multiproc.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <osg/GLObjects>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <system_error>

namespace osgTerrainLight::tool
{
namespace
{

using namespace bench;

/// Settings that are measured under a name, at each number of azimuths.
struct Method
{
    std::string name;
    std::string meaning;
    void (*apply)(LightingSettings&);
    bool ofBounces = false; ///< it differs from another in bounces alone
    bool byDefault = true;  ///< false: only where --methods names it
};

/// A new method is a line here.
const std::vector<Method> methods = {
    {"sweep-draft", "--quality draft",
     [](LightingSettings& s) { s.quality = HorizonQuality::Draft; }},
    {"sweep-normal", "--quality normal",
     [](LightingSettings& s) { s.quality = HorizonQuality::Normal; }},
    {"sweep-best", "--quality best", [](LightingSettings& s) { s.quality = HorizonQuality::Best; }},
    {"subsampled-2", "--subsampling 2", [](LightingSettings& s) { s.subsampling = 2; }, true},
    {"legendre", "--bounce-method legendre",
     [](LightingSettings& s) { s.bounceMethod = BounceMethod::Legendre; }, true},
    {"legendre-bspline", "--bounce-method legendre-bspline",
     [](LightingSettings& s) { s.bounceMethod = BounceMethod::LegendreBSpline; }, true, false},
    {"subsampled-4", "--subsampling 4", [](LightingSettings& s) { s.subsampling = 4; }, true,
     false},
    {"legendre-2", "legendre with --subsampling 2",
     [](LightingSettings& s)
     {
         s.bounceMethod = BounceMethod::Legendre;
         s.subsampling = 2;
     },
     true, false},
    {"legendre-4", "legendre with --subsampling 4",
     [](LightingSettings& s)
     {
         s.bounceMethod = BounceMethod::Legendre;
         s.subsampling = 4;
     },
     true, false},
};

struct Options
{
    std::string input;
    DemReadOptions read;
    std::string generated; ///< name of a kind; empty: input
    std::uint32_t terrainSeed = 1;
    int width = 1024, height = 1024;
    double spacing = 30.0;
    std::vector<const Method*> methods;
    std::vector<int> azimuths = {8, 16, 32, 64};
    SkyLight sky;
    LightingSettings settings; ///< bounces and albedo
    std::uint64_t paths = 0;   ///< per post; 0: as many as it takes
    std::size_t posts = 4000;
    std::uint32_t seed = 1;
    int repeats = 5;
    std::string csv, json, plot;
    bool quiet = false;
};

// Where the reading, the search for the truth, and, if paths follow, the measuring end on the
// progress line.
constexpr double readEnd = 0.05;
constexpr double truthEnd = 0.3;
constexpr double measureEnd = 0.5;

std::string now()
{
    const std::time_t time = std::time(nullptr);
    char buffer[32];
    std::strftime(buffer, sizeof(buffer), "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&time));
    return buffer;
}

double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

std::filesystem::path placeOf(const std::string& path)
{
    std::error_code ignored;
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, ignored), ignored);
}

/// Finds out before the work which files cannot be written, or are asked for twice.
Status checkOutputs(const Options& options)
{
    namespace fs = std::filesystem;
    std::vector<std::pair<std::string, std::string>> used;
    if (!options.input.empty())
        used.emplace_back("INPUT", options.input);
    for (const auto& [option, path] : {std::pair<std::string, std::string>{"--csv", options.csv},
                                       {"--json", options.json},
                                       {"--plot", options.plot}})
    {
        if (path.empty())
            continue;
        std::error_code ignored;
        for (const auto& [otherOption, other] : used)
            // The one sees links, the other files that do not exist yet.
            if (fs::equivalent(path, other, ignored) || placeOf(path) == placeOf(other))
                throw CLI::ValidationError(option, path + " is the file of " + otherOption +
                                                       ": needs another name");
        used.emplace_back(option, path);
        // The format matters not: what is found out is whether a file can be made there.
        OutputOptions output;
        output.path = path;
        output.format = "GTiff";
        if (Status writable = checkOutput(output, 0); !writable)
            return writable;
    }
    return options.plot.empty() ? Status(Nothing{}) : checkPlotter();
}

/// The file appears under its name when it is complete.
Status writeText(const std::string& path, const std::string& content)
{
    const DeferredSignals deferred;
    const std::string partial = CPLFormFilename(
        CPLGetPath(path.c_str()),
        CPLSPrintf(".%s.partial-%d", CPLGetFilename(path.c_str()), int(CPLGetCurrentProcessID())),
        nullptr);
    const CPLErrorHandlerPusher quiet(CPLQuietErrorHandler);
    VSILFILE* file = VSIFOpenL(partial.c_str(), "wb");
    bool written = file && VSIFWriteL(content.data(), 1, content.size(), file) == content.size();
    written = file && VSIFCloseL(file) == 0 && written;
    if (written && VSIRename(partial.c_str(), path.c_str()) == 0)
        return Nothing{};
    const std::string reason = std::generic_category().message(errno);
    VSIUnlink(partial.c_str());
    return Error{ErrorCode::Failed, path + ": cannot be written: " + reason};
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

/// What a row's rounds took [ms].
struct Times
{
    std::vector<std::vector<double>> byStage;
    std::vector<double> gpu, wall;
};

/// Reads back all that errors are of. Bounces are read one by one: the sum in the shading has lost
/// them to the rounding of the direct light.
Result<Found> readBack(const Gpu& gpu, const Truth& truth, const LightingSettings& settings,
                       TileLight& lighting)
{
    Found found;
    found.indirect.resize(truth.indirect.size());
    LightingSettings fewer = settings;
    for (; fewer.bounces > 0; --fewer.bounces)
    {
        lighting.setSettings(fewer); // as they are, the first time
        if (Status done = lighting.update(gpu.state()); !done)
            return done.error();
        const Raster<osg::Vec4f> light = lighting.readLastBounce(gpu.state());
        for (std::size_t i = 0; i < found.indirect.size(); ++i)
        {
            const osg::Vec4f& c = light.at(truth.posts[i].column, truth.posts[i].row);
            found.indirect[i] += luminance({c.r(), c.g(), c.b()});
        }
    }
    lighting.setSettings(fewer);
    if (Status done = lighting.update(gpu.state()); !done)
        return done.error();
    if (fewer.bounceMethod == BounceMethod::Slices)
    {
        found.horizons = lighting.readHorizons(gpu.state());
        found.sky = lighting.readSkyView(gpu.state());
    }
    found.shading = lighting.readShading(gpu.state());
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
        times.wall.push_back(took.count());
        times.gpu.push_back(0.0);
        for (const StageCost& cost : lighting->costs())
        {
            const auto stage = std::find(stages.begin(), stages.end(), cost.name);
            if (stage == stages.end())
                continue;
            times.byStage[static_cast<std::size_t>(stage - stages.begin())].push_back(
                cost.gpuMilliseconds);
            times.gpu.back() += cost.gpuMilliseconds;
        }
    }
    row.bytes = lighting->bytes();
    if (row.skipped.empty() && row.errors.empty() && !truth.posts.empty())
    {
        Result<Found> found = readBack(gpu, truth, row.settings, *lighting);
        if (!found)
            return found.error();
        for (const Quantity& quantity : directQuantities())
            row.errors.push_back(statisticsOf(quantity.compare(truth, *found)));
        row.indirect = std::move(found->indirect);
    }
    lighting->releaseGLObjects(&gpu.state());
    osg::flushAllDeletedGLObjects(gpu.state().getContextID());
    return Nothing{};
}

/// Measures the rows in rounds, all rows in each, so that a machine that is busy for a while slows
/// them all, and not the one whose turn it was.
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

/// Traces paths, as many as options say or until their noise is below a fifth of the smallest
/// error, and finds all rows' errors of indirect light.
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

Status run(const Options& options)
{
    if (options.input.empty() && options.generated.empty())
        throw CLI::ValidationError("INPUT", "needed: a DEM, or --generate KIND");
    if (!options.plot.empty() && !EQUAL(CPLGetExtension(options.plot.c_str()), "svg"))
        throw CLI::ValidationError("--plot", options.plot + ": needs a name that ends in .svg");
    if (options.posts == 0 && !options.plot.empty())
        throw CLI::ValidationError("--plot", "draws errors: needs --posts 1 or more");
    if (options.settings.bounces > 0 && options.settings.albedo == Rgb{})
        throw CLI::ValidationError("--albedo", "0 in all channels: nothing bounces");
    if (Status writable = checkOutputs(options); !writable)
        return writable;
    Result<Gpu> gpu = openGpu();
    if (!gpu)
        return gpu.error();

    Report report;
    report.date = now();
    report.device = gpu->capabilities;
    report.sky = options.sky;
    report.settings = options.settings;
    if (options.posts > 0)
        report.quantities = directQuantities();
    if (options.posts > 0 && options.settings.bounces > 0)
        report.quantities.push_back(indirectQuantity());
    report.seed = options.seed;
    report.repeats = options.repeats;
    if (Status described = describeTerrain(options, report); !described)
        return described;
    if (Status fits = checkFits(*gpu, report.width, report.height); !fits)
        return Error{fits.error().code, report.terrain + ": " + fits.error().message};
    report.rows = planRows(options);
    if (report.rows.empty())
        throw CLI::ValidationError("--methods", "what they differ in are bounces: needs --bounces");
    Progress progress(options.quiet);
    progress.reach(0.0);
    const Result<DemTile> tile = readTerrain(options, progress);
    if (!tile)
        return tile.error();
    progress.reach(readEnd);
    report.validPosts = tile->validCount();
    report.eastSpacing = tile->nominalEastSpacing();
    report.northSpacing = tile->northSpacing;

    const bool errors = options.posts > 0;
    if (errors && options.settings.bounces > 0 &&
        std::any_of(tile->eastSpacings.begin(), tile->eastSpacings.end(),
                    [&](double spacing) { return spacing != tile->eastSpacings.front(); }))
        return Error{ErrorCode::NotSupported,
                     report.terrain +
                         ": --bounces needs posts as far apart in every row, for the path tracer; "
                         "this raster is in degrees. One in metres does (gdalwarp -t_srs)"};

    Truth truth;
    if (errors)
        truth = findTruth(*tile, options.sky, options.azimuths, options.posts, options.seed,
                          [&](double fraction)
                          { progress.reach(readEnd + (truthEnd - readEnd) * fraction); });
    report.skyPosts = truth.skyPosts;
    report.sunPosts = truth.posts.size();

    std::optional<IndirectTruth> indirect;
    if (errors && options.settings.bounces > 0)
    {
        Result<IndirectTruth> built = IndirectTruth::build(*tile, options.sky, options.settings,
                                                           options.seed, options.posts, truth);
        if (!built)
            return Error{built.error().code, report.terrain + ": " + built.error().message};
        indirect.emplace(std::move(*built));
    }

    if (Status measured = measureAll(*gpu, *tile, truth, report, progress); !measured)
        return measured;
    if (indirect)
        if (Status measured = measureIndirect(options, truth, *indirect, report, progress);
            !measured)
            return measured;
    progress.reach(1.0);
    if (std::none_of(report.rows.begin(), report.rows.end(),
                     [](const Row& row) { return row.skipped.empty(); }))
        return Error{ErrorCode::NotSupported,
                     report.terrain + ": nothing was measured: " + report.rows.front().skipped};
    markFronts(report);

    std::cout << (options.quiet ? "" : "\n") << tableOf(report) << std::flush;
    // All contents before the first file, so that a failure to draw leaves none.
    std::vector<std::pair<std::string, std::string>> files;
    if (!options.csv.empty())
        files.emplace_back(options.csv, csvOf(report));
    if (!options.json.empty())
        files.emplace_back(options.json, jsonOf(report));
    if (!options.plot.empty())
    {
        Result<std::string> svg = svgOf(report);
        if (!svg)
            return Error{svg.error().code, options.plot + ": " + svg.error().message};
        files.emplace_back(options.plot, *svg);
    }
    for (const auto& [path, content] : files)
        if (Status written = writeText(path, content); !written)
            return written;
    return Nothing{};
}

std::string listOfMethods()
{
    std::string list;
    for (const Method& method : methods)
        list += (list.empty() ? "" : ", ") + method.name + " (" + method.meaning + ")";
    return list;
}

void addMethods(CLI::App& app, std::vector<const Method*>& chosen)
{
    for (const Method& method : methods)
        if (method.byDefault)
            chosen.push_back(&method);
    const auto read = [&chosen](const std::string& given)
    {
        chosen.clear();
        for (const std::string& name : CLI::detail::split(given, ','))
        {
            const auto found = std::find_if(methods.begin(), methods.end(),
                                            [&](const Method& m) { return m.name == name; });
            if (found == methods.end())
                throw CLI::ValidationError("--methods",
                                           "'" + name + "' is no method: needs " + listOfMethods());
            if (std::find(chosen.begin(), chosen.end(), &*found) == chosen.end())
                chosen.push_back(&*found);
        }
    };
    app.add_option_function<std::string>(
           "--methods", read,
           "Methods, separated by commas; default all but the last three: " + listOfMethods())
        ->type_name("LIST");
}

void addAzimuthList(CLI::App& app, std::vector<int>& azimuths)
{
    const auto read = [&azimuths](const std::string& given)
    {
        azimuths.clear();
        for (const std::string& part : CLI::detail::split(given, ','))
        {
            double value = 0.0;
            if (!CLI::detail::lexical_cast(part, value))
                throw CLI::ValidationError("--azimuths", "'" + given + "': needs numbers, LIST");
            if (const std::string wrong = ParameterRange::find("azimuths")->complaint(value);
                !wrong.empty())
                throw CLI::ValidationError("--azimuths", wrong);
            azimuths.push_back(static_cast<int>(value));
        }
        std::sort(azimuths.begin(), azimuths.end());
        azimuths.erase(std::unique(azimuths.begin(), azimuths.end()), azimuths.end());
    };
    app.add_option_function<std::string>(
           "--azimuths", read,
           "Numbers of azimuths, each a multiple of 4, 4 ... 256; default 8,16,32,64")
        ->type_name("LIST");
}

/// --bounces, --albedo, --paths.
void addIndirect(CLI::App& app, Options& options)
{
    CLI::Option* bounces = addNumbers(
        app, "--bounces", "N", {"bounces"},
        "Diffuse bounces of light from terrain to terrain, 0 ... 8, which are measured too; "
        "default 0",
        [&options](const auto& v) { options.settings.bounces = static_cast<int>(v[0]); });
    const auto readAlbedo = [&options](const std::string& given)
    {
        std::vector<double> values;
        for (const std::string& part : CLI::detail::split(given, ','))
        {
            values.emplace_back();
            if (!CLI::detail::lexical_cast(part, values.back()))
                throw CLI::ValidationError("--albedo", "'" + given + "': needs numbers, V|R,G,B");
            if (const std::string wrong = ParameterRange::find("albedo")->complaint(values.back());
                !wrong.empty())
                throw CLI::ValidationError("--albedo", wrong);
        }
        if (values.size() != 1 && values.size() != 3)
            throw CLI::ValidationError("--albedo", "'" + given + "': needs one number or three");
        for (std::size_t c = 0; c < 3; ++c)
            options.settings.albedo[c] = static_cast<float>(values[values.size() == 3 ? c : 0]);
    };
    app.add_option_function<std::string>(
           "--albedo", readAlbedo,
           "Part of the light that the ground reflects, 0 ... 1; default 0.5")
        ->type_name("V|R,G,B")
        ->needs(bounces);
    addLimitedNumbers(app, "--paths", "N", {{"paths", 64.0, 67108864.0, true}},
                      "Paths per post that the light of bounces is compared with, rounded up to a "
                      "power of 2; default: until their noise is a fifth of the smallest error, at "
                      "most " +
                          std::to_string(IndirectTruth::mostPaths),
                      [&options](const auto& v)
                      { options.paths = static_cast<std::uint64_t>(v[0]); })
        ->needs(bounces);
}

CLI::Option* addGenerated(CLI::App& app, Options& options)
{
    const auto read = [&options](const std::string& given)
    {
        const std::vector<std::string> parts = CLI::detail::split(given, ',');
        TerrainKind kind = TerrainKind::Fractal;
        double seed = 1.0;
        if (parts.size() > 2 || !fromString(parts[0], kind) ||
            (parts.size() == 2 && !CLI::detail::lexical_cast(parts[1], seed)))
            throw CLI::ValidationError("--generate", "'" + given +
                                                         "': needs fractal, crater, cliffs or "
                                                         "spikes, and a seed where wanted");
        if (const std::string wrong = Limits{"seed", 0.0, 4294967295.0, true}.complaint(seed);
            !wrong.empty())
            throw CLI::ValidationError("--generate", wrong);
        options.generated = parts[0];
        options.terrainSeed = static_cast<std::uint32_t>(seed);
    };
    return app
        .add_option_function<std::string>(
            "--generate", read, "Measures a generated terrain: fractal, crater, cliffs or spikes")
        ->type_name("KIND[,SEED]");
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
                "  terrainlight bench --generate cliffs,7 --size 512 --sun 90,10");
    const auto options = std::make_shared<Options>();
    CLI::Option* input =
        app->add_option("INPUT", options->input, "DEM: any raster that GDAL reads")->type_name("");
    addReadOptions(*app, options->read);
    CLI::Option* generate = addGenerated(*app, *options)->excludes(input);
    addSize(*app, options->width, options->height,
            "Posts of the generated terrain; one number: a square; default 1024");
    CLI::Option* spacing =
        addLimitedNumbers(*app, "--spacing", "METRES", {{"spacing", 0.001, 10000.0, false}},
                          "Distance between generated posts, 0.001 ... 10000; default 30",
                          [options](const auto& v) { options->spacing = v[0]; });
    for (CLI::Option* option : {app->get_option("--size"), spacing})
        option->needs(generate);
    for (const char* option : {"--srcwin", "--band", "--cell-size"})
        app->get_option(option)->excludes(generate);
    addMethods(*app, options->methods);
    addSettings(*app, options->settings, false);
    addAzimuthList(*app, options->azimuths);
    addSun(*app, options->sky);
    addSunRadius(*app, options->sky);
    app->add_flag_function(
        "--no-sun", [options](std::int64_t) { options->sky.sunEnabled = false; }, "Sky light only");
    addIndirect(*app, *options);
    addLimitedNumbers(
        *app, "--posts", "N", {{"posts", 0.0, 1000000.0, true}},
        "Random posts at which the error is measured (the sun's at 10 N, that of bounces "
        "at N/10); 0: cost alone; default " +
            std::to_string(options->posts),
        [options](const auto& v) { options->posts = static_cast<std::size_t>(v[0]); });
    addLimitedNumbers(
        *app, "--seed", "N", {{"seed", 0.0, 4294967295.0, true}}, "Which random posts; default 1",
        [options](const auto& v) { options->seed = static_cast<std::uint32_t>(v[0]); });
    addLimitedNumbers(
        *app, "--repeats", "N", {{"repeats", 1.0, 1000.0, true}},
        "Rounds, in each of which every row runs twice, the first time to warm up (once "
        "where that takes 20 s); times are medians; default 5",
        [options](const auto& v) { options->repeats = static_cast<int>(v[0]); });
    app->add_option("--csv", options->csv, "Table to write, a line per row")->type_name("FILE");
    app->add_option("--json", options->json, "The same with device, date and terrain")
        ->type_name("FILE");
    app->add_option("--plot", options->plot, "Picture to write; needs the program gnuplot")
        ->type_name("FILE.svg");
    app->add_flag("-q,--quiet", options->quiet, "No progress; the table stays");
    addConfig(*app);
    return {app, [options] { return run(*options); }};
}

} // namespace osgTerrainLight::tool
