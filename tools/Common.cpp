#include "Common.h"

#include "io/AlbedoFile.h"

#include "gpu/passes/HorizonPass.h"
#include "io/LightParameters.h"
#include "io/MapPlace.h"
#include <osgTerrainLight/Environment.h>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <osg/GL>

#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <optional>

namespace osgTerrainLight::tool
{
namespace
{

// Where reading and computing end on the progress line.
constexpr double readEnd = 0.1;
constexpr double trialEnd = 0.4;
constexpr double computeEnd = 0.8;

constexpr int signals[] = {SIGINT, SIGTERM};
volatile std::sig_atomic_t waitingSignal = 0;

void keepSignal(int signal)
{
    waitingSignal = signal;
}

std::optional<double> number(std::string_view text)
{
    if (!text.empty() && text.front() == '+')
        text.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        return std::nullopt;
    return value;
}

/// Numbers of an option, fewest … most; complaint(i, value) is empty where number i may be that.
CLI::Option* addCheckedNumbers(CLI::App& app, const std::string& option,
                               const std::string& typeName, std::size_t fewest, std::size_t most,
                               const std::string& help,
                               std::function<std::string(std::size_t, double)> complaint,
                               std::function<void(const std::vector<double>&)> set)
{
    const auto read = [=](const std::string& given)
    {
        std::vector<double> values;
        for (const std::string& part : CLI::detail::split(given, ','))
        {
            const std::optional<double> value = number(part);
            if (!value || values.size() == most)
                throw CLI::ValidationError(option, "'" + given + "': needs numbers, " + typeName);
            if (const std::string wrong = complaint(values.size(), *value); !wrong.empty())
                throw CLI::ValidationError(option, wrong);
            values.push_back(*value);
        }
        if (values.size() < fewest)
            throw CLI::ValidationError(option, "'" + given + "': needs numbers, " + typeName);
        set(values);
    };
    return app.add_option_function<std::string>(option, read, help)->type_name(typeName);
}

/// For people. azimuths: whether they matter.
std::string named(const LightingSettings& settings, bool azimuths)
{
    return std::string("quality ") + toString(settings.quality) +
           (azimuths ? ", " + std::to_string(settings.azimuths) + " azimuths" : "");
}

/// Where a budget is given: chooses lit.settings by measurement. An error where none meets it.
Status choose(LitTile& lit, const RasterOptions& options, const SkyLight& sky,
              SettingsTrial::Product product, SkyViewDefinition definition, Progress& progress)
{
    if (!options.maxError && !options.maxMilliseconds)
        return Nothing{};
    osg::State& state = lit.gpu.state();
    Result<SettingsTrial> trial =
        SettingsTrial::create(state, lit.dem.tile, sky, product, definition,
                              [&progress](double fraction)
                              { progress.reach(readEnd + (trialEnd - readEnd) * fraction); });
    if (!trial)
        return trial.error();
    const Result<SettingsChoice> choice =
        options.maxError ? trial->forMaxError(state, options.settings, *options.maxError)
                         : trial->forFrameTime(state, options.settings, *options.maxMilliseconds);
    if (!choice)
        return choice.error();
    if (!choice->met && options.maxError)
        return Error{ErrorCode::NotSupported,
                     "--max-error " + text(*options.maxError) +
                         ": the most exact settings tried (" +
                         named(choice->settings, sky.skyEnabled) +
                         CPLSPrintf(") reach %.3g on this terrain", choice->error)};
    if (!choice->met)
        return Error{ErrorCode::NotSupported,
                     "--max-ms " + text(*options.maxMilliseconds) +
                         ": the fastest settings tried (" +
                         named(choice->settings, sky.skyEnabled) +
                         CPLSPrintf(") need %.3g ms for this raster", choice->milliseconds)};
    lit.choice = *choice;
    lit.settings = choice->settings;
    return Nothing{};
}

/// Computes the light of lit.dem: what is not shared by all azimuths first, so that progress shows.
Status compute(LitTile& lit, const SkyLight& sky, SkyViewDefinition definition, Progress& progress)
{
    const auto start = std::chrono::steady_clock::now();
    SkyLight first = sky;
    first.sunEnabled = sky.sunEnabled && !sky.skyEnabled;
    LightingSettings direct = lit.settings;
    direct.bounces = 0;
    lit.lighting = new TileLighting(lit.dem.tile, direct, first, definition);
    lit.lighting->setAlbedo(lit.albedo);
    for (const bool last : {false, true})
    {
        if (last)
        {
            lit.lighting->setSky(sky);
            lit.lighting->setSettings(lit.settings);
        }
        if (Status done = lit.lighting->update(lit.gpu.state()); !done)
            return done;
        if (Status done = lit.gpu.finish(); !done)
            return done;
        progress.reach(0.5 * ((lit.choice ? trialEnd : readEnd) + computeEnd));
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    lit.seconds = took.count();
    for (const StageCost& cost : lit.lighting->costs())
        if (cost.dispatches > 0)
            lit.azimuths += cost.name == "horizon" ? lit.settings.azimuths
                            : cost.name == "sun"   ? TileLighting::sunAzimuths
                            : cost.name == "key"   ? TileLighting::keyAzimuths(sky, lit.settings)
                                                   : 0;
    progress.reach(computeEnd);
    return Nothing{};
}

void summarise(const std::string& mode, const LitTile& lit)
{
    const double posts = static_cast<double>(lit.dem.tile.postCount());
    if (lit.choice)
        std::cout << mode
                  << ": chosen: " << named(lit.settings, lit.azimuths > TileLighting::sunAzimuths)
                  << CPLSPrintf("; measured error at most %.2g, %.3g ms", lit.choice->error,
                                lit.choice->milliseconds)
                  << "\n";
    std::cout << mode << ": " << lit.dem.tile.postCount() << " posts, ";
    if (lit.azimuths > 0)
        std::cout << lit.azimuths << (lit.azimuths == 1 ? " azimuth, " : " azimuths, ")
                  << CPLSPrintf("%.3g million pixel-azimuths/s, ",
                                posts * lit.azimuths / lit.seconds * 1e-6);
    std::cout << CPLSPrintf("%.3g s", lit.seconds);
    if (const unsigned dropped = lit.lighting->readDroppedVertices(lit.gpu.state()))
        std::cout << ", " << dropped << " hull vertices dropped";
    std::cout << std::endl;
}

} // namespace

void sayNotes(const std::string& path, const LitTile& lit, std::size_t said)
{
    for (std::size_t i = said; i < lit.dem.notes.size(); ++i)
        warn(path + ": " + lit.dem.notes[i]);
}

bool isExr(const OutputOptions& output)
{
    return output.format.empty() ? EQUAL(CPLGetExtension(output.path.c_str()), "exr")
                                 : EQUAL(output.format.c_str(), "EXR");
}

std::string Limits::complaint(double value) const
{
    if (value >= minimum && value <= maximum && (!whole || value == std::floor(value)))
        return {};
    return name + " = " + text(value) + ": needs " + (whole ? "a whole number, " : "") +
           text(minimum) + " ... " + text(maximum);
}

std::string text(double value)
{
    return CPLSPrintf("%.10g", value);
}

std::string text(const Rgb& c)
{
    return CPLSPrintf("%.6g,%.6g,%.6g", static_cast<double>(c[0]), static_cast<double>(c[1]),
                      static_cast<double>(c[2]));
}

void complain(const std::string& sentence)
{
    // GDAL ends some of its messages with a line break.
    std::cerr << "terrainlight: " << sentence.substr(0, sentence.find_last_not_of(" \n") + 1)
              << std::endl;
}

void warn(const std::string& sentence)
{
    complain("warning: " + sentence);
}

CLI::Option* addNumbers(CLI::App& app, const std::string& option, const std::string& typeName,
                        const std::vector<std::string>& names, const std::string& help,
                        std::function<void(const std::vector<double>&)> set)
{
    return addCheckedNumbers(
        app, option, typeName, names.size(), names.size(), help,
        [names](std::size_t i, double value)
        { return ParameterRange::find(names[i])->complaint(value); },
        std::move(set));
}

CLI::Option* addLimitedNumbers(CLI::App& app, const std::string& option,
                               const std::string& typeName, const std::vector<Limits>& limits,
                               const std::string& help,
                               std::function<void(const std::vector<double>&)> set)
{
    return addCheckedNumbers(
        app, option, typeName, limits.size(), limits.size(), help,
        [limits](std::size_t i, double value) { return limits[i].complaint(value); },
        std::move(set));
}

void addSize(CLI::App& app, int& width, int& height, const std::string& help)
{
    const Limits limits = {"size", 1.0, 65536.0, true};
    addCheckedNumbers(
        app, "--size", "W[,H]", 1, 2, help,
        [limits](std::size_t, double value) { return limits.complaint(value); },
        [&](const auto& v)
        {
            width = static_cast<int>(v.front());
            height = static_cast<int>(v.back());
        });
}

void addConfig(CLI::App& app)
{
    const auto set = [](const std::vector<std::pair<std::string, std::string>>& options)
    {
        for (const auto& [key, value] : options)
            CPLSetConfigOption(key.c_str(), value.c_str());
    };
    app.add_option_function<std::vector<std::pair<std::string, std::string>>>(
           "--config", set, "GDAL configuration option; may be repeated")
        ->type_name("KEY VALUE")
        ->allow_extra_args(false);
}

void addQuiet(CLI::App& app, bool& quiet)
{
    app.add_flag("-q,--quiet", quiet, "No progress and no summary");
}

void addSettings(CLI::App& app, LightingSettings& settings, bool azimuths)
{
    if (azimuths)
        addNumbers(app, "--azimuths", "N", {"azimuths"},
                   "Azimuths of the horizons, a multiple of 4, 4 ... 256; default " +
                       std::to_string(settings.azimuths),
                   [&settings](const auto& v) { settings.azimuths = static_cast<int>(v[0]); });
    app.add_option_function<std::string>(
           "--quality",
           [&settings](const std::string& name) { fromString(name, settings.quality); },
           "Speed against error; default normal")
        ->check(CLI::IsMember({"draft", "normal", "best"}));
}

void addBounces(CLI::App& app, RasterOptions& options)
{
    addNumbers(app, "--bounces", "N", {"bounces"},
               "Bounces of light from terrain to terrain, 0 ... 8; default 0",
               [&options](const auto& v) { options.settings.bounces = static_cast<int>(v[0]); });
    app.add_option_function<std::string>(
           "--bounce-method",
           [&options](const std::string& name) { fromString(name, options.settings.bounceMethod); },
           "How bounces are gathered: slices, exactly; legendre or legendre-bspline: all light, "
           "direct light too, as Nowrouzezahrai and Snyder 2009; default slices")
        ->check(CLI::IsMember({"slices", "legendre", "legendre-bspline"}))
        ->type_name("NAME");
    addNumbers(
        app, "--subsampling", "N", {"subsampling"},
        "Gather bounces, and direct light by legendre, at every N-th post, 1, 2 or 4; default 1",
        [&options](const auto& v) { options.settings.subsampling = static_cast<int>(v[0]); });
    app.add_option_function<std::string>(
           "--albedo",
           [&options](const std::string& given)
           {
               if (given.empty())
                   throw CLI::ValidationError("--albedo", "needs one number, three, or a raster");
               std::vector<double> values;
               for (const std::string& part : CLI::detail::split(given, ','))
               {
                   double value = 0.0;
                   if (!CLI::detail::lexical_cast(part, value))
                   {
                       options.albedoFile = given;
                       return;
                   }
                   if (const std::string wrong = ParameterRange::find("albedo")->complaint(value);
                       !wrong.empty())
                       throw CLI::ValidationError("--albedo", wrong);
                   values.push_back(value);
               }
               if (values.size() != 1 && values.size() != 3)
                   throw CLI::ValidationError(
                       "--albedo", "'" + given + "': needs one number, three, or a raster");
               for (std::size_t c = 0; c < 3; ++c)
                   options.settings.albedo[c] =
                       static_cast<float>(values[values.size() == 3 ? c : 0]);
           },
           "What the ground reflects, for bounces: V or R,G,B, 0 ... 1; or a raster of the DEM's "
           "size "
           "(bytes are sRGB colours, else linear); default 0.5")
        ->type_name("V|R,G,B|RASTER")
        ->needs("--bounces");
}

Status checkOutput(const OutputOptions& output, int bands)
{
    if (isExr(output) && !output.creationOptions.empty())
        return Error{ErrorCode::NotSupported,
                     output.path + ": OpenEXR files have no creation options (-co)"};
    RasterFrame pixel;
    pixel.width = pixel.height = 1;
    OutputOptions options = output;
    if (isExr(output)) // not GDAL's to write: the folder is what matters
        options.format = "GTiff";
    const DeferredSignals deferred;
    {
        Result<RasterWriter> writer =
            RasterWriter::open(output.path, pixel, {{}}, writeOptions(options, {}));
        if (!writer)
            return writer.error();
    } // the writer goes, and what it made with it
    if (bands == 0)
        return Nothing{};

    const std::string parent = CPLGetPath(output.path.c_str());
    const std::string name = CPLGetFilename(output.path.c_str());
    const std::string folder = CPLFormFilename(
        parent.c_str(), CPLSPrintf(".%s.probe-%d", name.c_str(), int(CPLGetCurrentProcessID())),
        nullptr);
    const std::string path = folder + "/" + name;
    VSIMkdir(folder.c_str(), 0755);
    const std::vector<RasterBand> floats(static_cast<std::size_t>(bands),
                                         {{}, Raster<float>(1, 1)});
    Status written = writeRaster(path, pixel, floats, writeOptions(options, {}));
    VSIRmdirRecursive(folder.c_str());
    if (written)
        return written;
    std::string message = written.error().message;
    // GDAL names the file in the folder.
    for (std::size_t at = 0; (at = message.find(folder, at)) != std::string::npos;)
    {
        const std::size_t end = message.find("/" + name, at);
        message.replace(at, end == std::string::npos ? end : end + 1 + name.size() - at,
                        output.path);
        at += output.path.size();
    }
    return Error{written.error().code, message};
}

void refuseSameFile(const std::string& input, const std::string& output)
{
    std::error_code ignored;
    if (input == output || std::filesystem::equivalent(input, output, ignored))
        throw CLI::ValidationError("OUTPUT", output + " is the input file: needs another name");
}

void addExposure(CLI::App& app, LightingSettings& settings)
{
    addNumbers(app, "--exposure", "STOPS", {"exposure"},
               "Picture: colours times 2^STOPS before sRGB, -20 ... 20; default 0",
               [&settings](const auto& v) { settings.exposure = v[0]; });
}

void addSun(CLI::App& app, SkyLight& sky)
{
    addNumbers(app, "--sun", "AZ,EL", {"sun-azimuth", "sun-elevation"},
               "Where the sun stands: degrees clockwise from north and above the horizontal; "
               "default " +
                   text(sky.sunAzimuth) + "," + text(sky.sunElevation),
               [&sky](const auto& v)
               {
                   sky.sunAzimuth = v[0];
                   sky.sunElevation = v[1];
               });
}

CLI::Option* addTime(CLI::App& app, const std::string& option, const std::string& help,
                     std::function<void(UtcTime)> set)
{
    const auto read = [=](const std::string& given)
    {
        UtcTime time;
        if (const std::string wrong = readUtcTime(given, time); !wrong.empty())
            throw CLI::ValidationError(option, wrong);
        set(time);
    };
    return app.add_option_function<std::string>(option, read, help)->type_name("TIME");
}

CLI::Option* addPlace(CLI::App& app, SunTime& sun)
{
    const auto read = [&sun](const std::string& given)
    {
        EarthPlace place;
        if (const std::string wrong = readEarthPlace(given, place); !wrong.empty())
            throw CLI::ValidationError("--place", wrong);
        sun.place = place;
    };
    return app
        .add_option_function<std::string>(
            "--place", read,
            "Where on Earth, degrees east and north; default by INPUT's CRS, for its middle")
        ->type_name("LON,LAT");
}

void addSunTime(CLI::App& app, SunTime& sun)
{
    CLI::Option* time = addTime(
        app, "--time",
        "The sun by time instead of --sun: YYYY-MM-DDThh:mm[:ss], UTC or with a zone +hh:mm",
        [&sun](UtcTime given) { sun.time = given; });
    time->excludes("--sun");
    addPlace(app, sun)->needs(time);
}

void addSunRadius(CLI::App& app, SkyLight& sky)
{
    addNumbers(app, "--sun-radius", "DEGREES", {"sun-radius"},
               "Angular radius of the sun's disc, 0.01 ... 10; default " +
                   text(sky.sunAngularRadius),
               [&sky](const auto& v) { sky.sunAngularRadius = v[0]; });
}

void addSky(CLI::App& app, SkyLight& sky, std::string& file)
{
    app.add_option_function<std::string>(
           "--sky",
           [&sky, &file](const std::string& kind)
           {
               LightParameters parameters;
               if (const Status set = setLightParameter(parameters, "sky", kind); !set)
                   throw CLI::ValidationError("--sky", set.error().message);
               sky.skyEnabled = parameters.sky.skyEnabled;
               sky.skyModel = parameters.sky.skyModel;
               file = parameters.skyFile;
           },
           "Light of the sky: uniform, overcast, clear, none, or a panorama's file (OpenEXR, HDR), "
           "with the sun that is found in it; default uniform")
        ->type_name("KIND|FILE");
    addNumbers(app, "--turbidity", "T", {"turbidity"},
               "Of a clear sky's air: 2 clear ... 10 haze; default " + text(sky.turbidity),
               [&sky](const auto& v) { sky.turbidity = v[0]; });
    addNumbers(app, "--sky-heading", "DEGREES", {"sky-heading"},
               "Turns a sky from a file clockwise; default 0",
               [&sky](const auto& v) { sky.environmentHeading = v[0]; });
    addNumbers(app, "--sky-gain", "V", {"sky-gain"},
               "Multiplies the radiance of a sky from a file; default 1",
               [&sky](const auto& v) { sky.environmentGain = v[0]; });
}

Status readSky(const CLI::App& app, SkyLight& sky, const std::string& file, bool mapMayHaveSky)
{
    const auto given = [&app](const char* option)
    {
        const CLI::Option* found = app.get_option_no_throw(option);
        return found && found->count() > 0;
    };
    if (!sky.skyHarmonics.empty() && given("--sky"))
        throw CLI::ValidationError("--sky-harmonics", "is a sky: leave out --sky");
    const bool ofMap = mapMayHaveSky && !given("--sky");
    if (!ofMap && given("--turbidity") && sky.skyModel != SkyModel::Clear)
        throw CLI::ValidationError("--turbidity", "needs --sky clear");
    if (given("--sky-radiance") &&
        (!file.empty() || sky.skyModel == SkyModel::Clear || !sky.skyHarmonics.empty()))
        throw CLI::ValidationError(
            "--sky-radiance", "needs a uniform or an overcast sky: neither --sky clear, a file nor "
                              "--sky-harmonics");
    if (file.empty())
    {
        for (const char* option : {"--sky-heading", "--sky-gain"})
            if (!ofMap && given(option))
                throw CLI::ValidationError(option, "needs --sky FILE");
        return Nothing{};
    }
    for (const char* option : {"--sun", "--sun-radius", "--sun-irradiance", "--time"})
        if (given(option))
            throw CLI::ValidationError(
                option, file + " has its own sun, or none: --sky-heading turns it, --sky-gain "
                               "changes its strength");
    std::string problem;
    const std::shared_ptr<const Environment> environment = readEnvironment(file, problem);
    if (!environment)
        return Error{ErrorCode::Invalid, problem};
    const bool withoutSun = !sky.sunEnabled;
    sky.setEnvironment(environment, sky.environmentHeading, sky.environmentGain);
    sky.sunEnabled = sky.sunEnabled && !withoutSun;
    return Nothing{};
}

void addBodyRadius(CLI::App& app, LightingSettings& settings)
{
    addNumbers(app, "--body-radius", "METRES", {"body-radius"},
               "Radius of the planet, below whose horizon terrain sinks, 1000 or more; Earth "
               "6371000, as light in its air sees it 7323000; default 0: flat",
               [&settings](const auto& v) { settings.bodyRadius = v[0]; });
}

void addAreaLights(CLI::App& app, SkyLight& sky)
{
    app.add_option_function<std::vector<std::string>>(
           "--key-light",
           [&sky](const std::vector<std::string>& given)
           {
               sky.keyLights.clear();
               for (const std::string& text : given)
               {
                   const Result<KeyLight> key = parseKeyLight(text);
                   if (!key)
                       throw CLI::ValidationError("--key-light", key.error().message);
                   sky.keyLights.push_back(*key);
               }
               if (const std::string wrong = complaint(sky); !wrong.empty())
                   throw CLI::ValidationError("--key-light", wrong);
           },
           "Area light: middle of its azimuths and their width, lowest and highest elevation "
           "[degrees], radiance (default 1); may be repeated, up to 8 times")
        ->type_name("AZ,WIDTH,LOW,HIGH[,R,G,B]")
        ->delimiter(';')
        ->allow_extra_args(false);
    app.add_option_function<std::string>(
           "--sky-harmonics",
           [&sky](const std::string& given)
           {
               LightParameters parameters;
               Status set = setLightParameter(parameters, "sky_harmonics", given);
               if (set && parameters.sky.skyHarmonics.empty())
                   set = Error{ErrorCode::Invalid, "needs 1, 4, 9 or 16 coefficients"};
               if (!set)
                   throw CLI::ValidationError("--sky-harmonics", set.error().message);
               sky.skyHarmonics = parameters.sky.skyHarmonics;
           },
           "Radiance of the sky, instead of a uniform one: 1, 4, 9 or 16 coefficients of real "
           "spherical harmonics, each one number or each R,G,B; x east, y north, z up")
        ->type_name("C,C,C,...");
}

void addReadOptions(CLI::App& app, DemReadOptions& read)
{
    app.add_option_function<std::vector<int>>(
           "--srcwin",
           [&read](const std::vector<int>& v) {
               read.window = PixelWindow{v[0], v[1], v[2], v[3]};
           },
           "Part of the input in pixels: left, top, width, height")
        ->expected(4)
        ->type_name("X Y W H");
    app.add_option("--band", read.band, "Band of the input, from 1; default 1")->type_name("N");
    addCellSize(app, [&read](double size) { read.cellSize = size; });
}

void addCellSize(CLI::App& app, std::function<void(double)> set)
{
    addLimitedNumbers(app, "--cell-size", "METRES", {{"cell size", 1e-6, 1e6, false}},
                      "Distance between posts where the input has no geotransform",
                      [set](const auto& v) { set(v[0]); });
}

void addOutputOptions(CLI::App& app, OutputOptions& output)
{
    app.add_option("--of", output.format,
                   "Output format, GDAL's short name; default by OUTPUT's extension")
        ->type_name("FORMAT");
    app.add_option("--co", output.creationOptions, "Creation option of the format; may be repeated")
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false);
    addQuiet(app, output.quiet);
    addConfig(app);
}

void addRasterOptions(CLI::App& app, RasterOptions& options, bool azimuths)
{
    app.add_option("INPUT", options.input, "DEM: any raster that GDAL reads")
        ->required()
        ->type_name("");
    app.add_option("OUTPUT", options.output.path, "File to write")->required()->type_name("");
    addSettings(app, options.settings, azimuths);
    addBodyRadius(app, options.settings);
    addReadOptions(app, options.read);
    addOutputOptions(app, options.output);
}

void addBudget(CLI::App& app, RasterOptions& options)
{
    std::vector<CLI::Option*> budgets = {
        addNumbers(app, "--max-error", "E", {"max-error"},
                   "Instead of azimuths and quality: the cheapest settings whose error is measured "
                   "to be at most E on this terrain, relative root mean square, 0.00001 ... 1",
                   [&options](const auto& v) { options.maxError = v[0]; }),
        addNumbers(app, "--max-ms", "MS", {"max-ms"},
                   "Instead of azimuths and quality: the most exact settings that take at most MS "
                   "milliseconds of GPU time",
                   [&options](const auto& v) { options.maxMilliseconds = v[0]; })};
    budgets[0]->excludes(budgets[1]);
    for (const char* setting : {"--azimuths", "--quality", "--body-radius"})
        if (CLI::Option* option = app.get_option_no_throw(setting))
            for (CLI::Option* budget : budgets)
                budget->excludes(option);
}

Progress::~Progress()
{
    if (!_quiet && _reached >= 0.0 && _reached < 1.0)
        std::cout << std::endl;
}

void Progress::reach(double fraction)
{
    if (_quiet || fraction <= _reached)
        return;
    _reached = std::min(fraction, 1.0);
    GDALTermProgress(_reached, nullptr, nullptr);
}

DeferredSignals::DeferredSignals()
{
    for (std::size_t i = 0; i < 2; ++i)
    {
        _previous[i] = std::signal(signals[i], keepSignal);
        if (_previous[i] == SIG_IGN) // as nohup does, and shells for what runs in the background
            std::signal(signals[i], SIG_IGN);
    }
}

DeferredSignals::~DeferredSignals()
{
    for (std::size_t i = 0; i < 2; ++i)
        std::signal(signals[i], _previous[i]);
    if (waitingSignal != 0)
        std::raise(waitingSignal);
}

Status DeferredSignals::check()
{
    if (waitingSignal != 0)
        return Error{ErrorCode::Failed, "interrupted"};
    return Nothing{};
}

Status Gpu::finish() const
{
    glFinish();
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR)
        return Nothing{};
    if (error == GL_OUT_OF_MEMORY)
        return Error{ErrorCode::Failed, "not enough graphics memory on '" + capabilities.renderer +
                                            "'; fewer azimuths or a smaller -srcwin need less "
                                            "(terrainlight info INPUT says how much)"};
    return Error{ErrorCode::Failed,
                 CPLSPrintf("OpenGL error 0x%04x on '%s'", error, capabilities.renderer.c_str())};
}

Result<Gpu> openGpu(int width, int height)
{
    Result<std::unique_ptr<HeadlessContext>> context = HeadlessContext::create(width, height);
    if (!context)
        return context.error();
    Gpu gpu;
    gpu.context = std::move(*context);
    Result<GpuCapabilities> capabilities = GpuCapabilities::query(gpu.state());
    if (!capabilities)
        return capabilities.error();
    gpu.capabilities = *capabilities;
    return gpu;
}

Status checkFits(const Gpu& gpu, int width, int height)
{
    const int most = gpu.capabilities.maxTextureSize - 2 * HorizonPass::frame;
    if (width > most || height > most)
        return Error{ErrorCode::NotSupported,
                     std::to_string(width) + " x " + std::to_string(height) + " posts; '" +
                         gpu.capabilities.renderer + "' takes " + std::to_string(most) +
                         " a side: needed a smaller -srcwin"};
    return Nothing{};
}

void add(Metadata& metadata, const std::string& name, const std::string& value)
{
    metadata.emplace_back("TERRAINLIGHT_" + name, value);
}

void addSun(Metadata& metadata, const SkyLight& sky)
{
    add(metadata, "SUN_AZIMUTH", text(sky.sunAzimuth));
    add(metadata, "SUN_ELEVATION", text(sky.sunElevation));
    add(metadata, "SUN_RADIUS", text(sky.sunAngularRadius));
}

void addPlace(Metadata& metadata, const EarthPlace& place)
{
    add(metadata, "PLACE", text(place.longitude) + "," + text(place.latitude));
    add(metadata, "CONVERGENCE", text(place.convergence));
}

void addAreaLights(Metadata& metadata, const SkyLight& sky)
{
    if (sky.skyEnabled && sky.environment)
    {
        add(metadata, "SKY_HEADING", text(sky.environmentHeading));
        add(metadata, "SKY_GAIN", text(sky.environmentGain));
    }
    else if (sky.skyEnabled && sky.skyModel == SkyModel::Clear)
        add(metadata, "TURBIDITY", text(sky.turbidity));
    if (sky.skyEnabled && !sky.skyHarmonics.empty())
        add(metadata, "SKY_HARMONICS", textOf(sky.skyHarmonics));
    if (!sky.keyLights.empty())
        add(metadata, "KEY_LIGHTS", textOf(sky.keyLights));
}

Metadata describe(const std::string& mode, const LitTile& lit, bool azimuths)
{
    Metadata metadata = {{"TIFFTAG_SOFTWARE", "osgTerrainLight " OSGTERRAINLIGHT_VERSION}};
    add(metadata, "VERSION", OSGTERRAINLIGHT_VERSION);
    add(metadata, "MODE", mode);
    if (azimuths)
        add(metadata, "AZIMUTHS", std::to_string(lit.settings.azimuths));
    add(metadata, "QUALITY", toString(lit.settings.quality));
    if (lit.settings.bodyRadius > 0.0)
        add(metadata, "BODY_RADIUS", text(lit.settings.bodyRadius));
    if (lit.choice)
        add(metadata, "ERROR_BOUND", text(lit.choice->error));
    return metadata;
}

Result<EarthPlace> placeOf(const RasterOptions& options, const SunTime& sun)
{
    const Result<DemInfo> info = describeDem(options.input, options.read);
    if (!info)
        return info.error();
    const Result<EarthPlace> place = placeInstead(sun.place, osgTerrainLight::placeOf(info->frame));
    if (place)
        return place;
    const bool placeless = place.error().code == ErrorCode::NotFound;
    return Error{place.error().code, options.input + ": " + place.error().message +
                                         (placeless ? ": needs --place LON,LAT" : "")};
}

Status setSun(SkyLight& sky, const RasterOptions& options, const SunTime& sun, Metadata& metadata)
{
    if (!sun.time)
        return Nothing{};
    const Result<EarthPlace> place = placeOf(options, sun);
    if (!place)
        return place.error();
    sky.setSunAt(*sun.time, *place);
    add(metadata, "TIME", toString(*sun.time));
    addPlace(metadata, *place);
    if (!TileLighting::needsSun(sky))
        warn("the sun is " + text(std::round(-100.0 * sky.sunElevation) / 100.0) +
             " degrees below the horizontal at " + toString(*sun.time));
    return Nothing{};
}

RasterWriteOptions writeOptions(const OutputOptions& output, const Metadata& metadata)
{
    RasterWriteOptions options;
    options.driver = output.format;
    options.creationOptions = output.creationOptions;
    options.metadata = metadata;
    return options;
}

/// Terrain sinks along a parabola, which is no sphere where the tile is a part of it.
static Status checkPlanet(const LightingSettings& settings, const DemInfo& info)
{
    const double extent =
        std::hypot(info.eastSpacing * info.window.width, info.northSpacing * info.window.height);
    if (settings.bodyRadius == 0.0 || settings.bodyRadius >= 10.0 * extent)
        return Nothing{};
    return Error{ErrorCode::Invalid, "--body-radius " + text(settings.bodyRadius) +
                                         ": the tile is " + text(std::round(extent)) +
                                         " m across: needs at least ten times that"};
}

Status readTile(const RasterOptions& options, int bands, LitTile& lit, std::size_t& headNotes,
                Progress& progress)
{
    const std::string& path = options.input;
    refuseSameFile(path, options.output.path);
    Result<DemInfo> info = describeDem(path, options.read);
    if (!info)
        return info.error();
    if (Status writable = checkOutput(options.output, bands); !writable)
        return writable;
    if (Status planet = checkPlanet(options.settings, *info); !planet)
        return Error{planet.error().code, path + ": " + planet.error().message};
    for (const std::string& note : info->notes)
        warn(path + ": " + note);
    headNotes = info->notes.size();

    Result<Gpu> gpu = openGpu();
    if (!gpu)
        return gpu.error();
    lit.gpu = std::move(*gpu);
    if (Status fits = checkFits(lit.gpu, info->window.width, info->window.height); !fits)
        return Error{fits.error().code, path + ": " + fits.error().message};

    progress.reach(0.0);
    DemReadOptions read = options.read;
    read.progress = [&progress](double fraction)
    {
        progress.reach(readEnd * fraction);
        return true;
    };
    Result<DemFile> dem = readDem(path, read);
    if (!dem)
        return dem.error();
    lit.dem = std::move(*dem);
    lit.settings = options.settings;
    if (options.albedoFile.empty())
        return Nothing{};
    Result<Raster<Rgb>> albedo = readAlbedo(options.albedoFile, *info);
    if (!albedo)
        return albedo.error();
    lit.albedo = std::move(*albedo);
    return Nothing{};
}

Status process(const std::string& mode, const RasterOptions& options, const SkyLight& sky,
               SettingsTrial::Product product, SkyViewDefinition definition, int bands,
               const std::function<Status(LitTile&, Progress&)>& write)
{
    const std::string& path = options.input;
    LitTile lit;
    std::size_t headNotes = 0;
    Progress progress(options.output.quiet);
    if (Status read = readTile(options, bands, lit, headNotes, progress); !read)
        return read;
    if (Status chosen = choose(lit, options, sky, product, definition, progress); !chosen)
        return Error{chosen.error().code, path + ": " + chosen.error().message};
    if (Status computed = compute(lit, sky, definition, progress); !computed)
        return Error{computed.error().code, path + ": " + computed.error().message};
    if (Status written = write(lit, progress); !written)
        return written;
    progress.reach(1.0);
    sayNotes(path, lit, headNotes);
    if (!options.output.quiet)
        summarise(mode, lit);
    return Nothing{};
}

Status writeBands(const OutputOptions& output, const RasterFrame& frame,
                  const std::vector<BandLabel>& labels, const Metadata& metadata,
                  Progress& progress, const std::function<Raster<float>(int band)>& values)
{
    const DeferredSignals deferred;
    Result<RasterWriter> writer =
        RasterWriter::open(output.path, frame, labels, writeOptions(output, metadata));
    if (!writer)
        return writer.error();
    const int count = static_cast<int>(labels.size());
    for (int band = 1; band <= count; ++band)
    {
        if (Status written = writer->writeBand(band, values(band)); !written)
            return written;
        if (Status going = DeferredSignals::check(); !going)
            return going;
        progress.reach(computeEnd + (1.0 - computeEnd) * band / (count + 1));
    }
    return writer->finish();
}

} // namespace osgTerrainLight::tool
