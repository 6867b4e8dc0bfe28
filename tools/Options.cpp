#include "Options.h"

#include "Console.h"

#include <osgTerrainLight/Environment.h>

#include "io/LightParameters.h"
#include "io/MapPlace.h"

#include <cpl_conv.h>

#include <charconv>
#include <optional>

namespace osgTerrainLight::tool
{
namespace
{

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

} // namespace

std::string Limits::complaint(double value) const
{
    if (value >= minimum && value <= maximum && (!whole || value == std::floor(value)))
        return {};
    return name + " = " + text(value) + ": needs " + (whole ? "a whole number, " : "") +
           text(minimum) + " ... " + text(maximum);
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
                   const Result<KeyLight> key = readKeyLight(text);
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
    addHeightOptions(app, read);
}

void addCellSize(CLI::App& app, std::function<void(double)> set)
{
    addLimitedNumbers(app, "--cell-size", "METRES", {{"cell size", 1e-6, 1e6, false}},
                      "Distance between posts where the input has no geotransform",
                      [set](const auto& v) { set(v[0]); });
}

void addHeightOptions(CLI::App& app, DemReadOptions& read)
{
    app.add_option_function<std::string>(
           "--unit",
           [&read](const std::string& name)
           {
               if (!metresPerHeightUnit(name))
                   throw CLI::ValidationError("--unit", "'" + name +
                                                            "': needs a unit of length such as m, "
                                                            "ft or us-ft");
               read.heightUnit = name;
           },
           "Unit of the heights, instead of what the input says")
        ->type_name("NAME");
    addLimitedNumbers(app, "--z-factor", "F", {{"z factor", -1e6, 1e6, false}},
                      "Heights are multiplied by F, not 0; below 0 turns depths into heights; "
                      "default 1",
                      [&read](const auto& v)
                      {
                          if (v[0] == 0.0)
                              throw CLI::ValidationError("--z-factor", "0: needs another number");
                          read.heightFactor = v[0];
                      });
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

} // namespace osgTerrainLight::tool
