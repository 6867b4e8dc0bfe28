#include "Options.h"

#include "Console.h"

#include <osgTerrainLight/Environment.h>

#include "io/LightParameters.h"
#include "io/MapPlace.h"

#include <cpl_conv.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
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

/// What stands for the value in help.
std::string typeNameOf(const ValueForm& form)
{
    if (form.kind == ValueForm::Kind::Name)
        return CLI::detail::join(form.names, "|");
    if (form.kind == ValueForm::Kind::Harmonics)
        return "C,C,C,...";
    if (form.count == 3)
        return "V|R,G,B";
    std::string unit = form.unit == "m" ? "metres" : form.unit;
    std::transform(unit.begin(), unit.end(), unit.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return !unit.empty() ? unit : form.kind == ValueForm::Kind::Real ? "V" : "N";
}

} // namespace

std::string Limits::complaint(double value) const
{
    if (value >= minimum && value <= maximum && (!whole || value == std::floor(value)))
        return {};
    return name + " = " + text(value) + ": needs " + (whole ? "a whole number, " : "") +
           text(minimum) + " ... " + text(maximum);
}

CLI::Option* addRow(CLI::App& app, const SettingRow& row, const std::string& defaultText,
                    std::function<void(const SettingValue&)> set)
{
    const std::string option = "--" + row.name;
    if (app.get_option_no_throw(option))
        return nullptr;
    const auto read = [&row, option, set](const std::string& given)
    {
        const Result<SettingValue> value = row.read(given, row.name);
        if (!value)
            throw CLI::ValidationError(option, value.error().message);
        set(*value);
    };
    std::string needs = row.needs();
    if (row.form.kind == ValueForm::Kind::Name) // which is read as it is written
        needs = "One of " + needs;
    else
        needs[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(needs[0])));
    return app
        .add_option_function<std::string>(
            option, read,
            row.meaning + " " + needs + (defaultText.empty() ? "" : "; default " + defaultText) +
                ".")
        ->type_name(typeNameOf(row.form));
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

void addBounces(CLI::App& app, RasterOptions& options)
{
    addSetting(app, "bounces", options.settings);
    const Setting<LightingSettings>& albedo = *findSetting<LightingSettings>("albedo");
    app.add_option_function<std::string>(
           "--albedo",
           [&options, &albedo](const std::string& given)
           {
               if (given.empty())
                   throw CLI::ValidationError("--albedo", "needs one number, three, or a raster");
               if (numbersIn(given).empty())
               {
                   options.albedoFile = given;
                   return;
               }
               const Result<SettingValue> value = albedo.read(given, albedo.name);
               if (!value)
                   throw CLI::ValidationError("--albedo", value.error().message + ", or a raster");
               albedo.set(options.settings, *value);
           },
           albedo.meaning + " " +
               "One number or three, 0 ... 1; or a raster of the DEM's size, "
               "whose bytes are sRGB colours, and other types linear; default "
               "0.5.")
        ->type_name("V|R,G,B|RASTER")
        ->needs("--bounces");
    addTopic(app, Topic::Bounces, options.settings);
}

void addSun(CLI::App& app, SkyLight& sky)
{
    const std::array<const Setting<SkyLight>*, 2> places = {findSetting<SkyLight>("sun-azimuth"),
                                                            findSetting<SkyLight>("sun-elevation")};
    addCheckedNumbers(
        app, "--sun", "AZ,EL", 2, 2,
        "Azimuth of the sun, clockwise from north, and its elevation above the horizontal, in "
        "degrees; default " +
            places[0]->textOf(sky) + "," + places[1]->textOf(sky) + ".",
        [places](std::size_t i, double value) { return places[i]->complaint(value); },
        [&sky, places](const auto& v)
        {
            for (std::size_t i = 0; i < 2; ++i)
                places[i]->set(sky, std::vector<double>{v[i]});
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
    for (const char* name : {"turbidity", "sky-heading", "sky-gain"})
        addSetting(app, name, sky);
}

void refuseIdle(const CLI::App& app, const std::vector<IdleSetting>& settings)
{
    for (const IdleSetting& idle : settings)
    {
        const std::string option = "--" + idle.name;
        const CLI::Option* found = app.get_option_no_throw(option);
        if (found && found->count() > 0)
            throw CLI::ValidationError(option, idle.sentence);
    }
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
    if (file.empty())
    {
        if (!mapMayHaveSky || given("--sky"))
            refuseIdle(app, idleSettings(sky));
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
    refuseIdle(app, idleSettings(sky));
    return Nothing{};
}

void addBodyRadius(CLI::App& app, LightingSettings& settings, BodyRadius& said)
{
    const auto set = [&settings, &said](const std::string& given)
    {
        // Mean radii; those of the working group of the IAU.
        static const std::pair<const char*, double> bodies[] = {
            {"earth", 6371000.0}, {"moon", 1737400.0}, {"mars", 3389500.0}};
        const bool ofCrs = EQUAL(given.c_str(), "auto");
        said = ofCrs ? BodyRadius::OfCrs : BodyRadius::Given;
        std::optional<double> radius = ofCrs ? 0.0 : number(given);
        for (const auto& [name, metres] : bodies)
            if (EQUAL(given.c_str(), name))
                radius = metres;
        if (!radius)
            throw CLI::ValidationError("--body-radius", "'" + given +
                                                            "': needs metres, earth, moon, mars "
                                                            "or auto");
        if (const std::string wrong = ParameterRange::find("body-radius")->complaint(*radius);
            !wrong.empty())
            throw CLI::ValidationError("--body-radius", wrong);
        settings.bodyRadius = *radius;
    };
    app.add_option_function<std::string>("--body-radius", set,
                                         "Radius of the planet in metres, 1000 or more, or earth, "
                                         "moon, mars, or auto: that of the "
                                         "input's CRS. Distant terrain is lowered by its "
                                         "curvature; 7323000 is the Earth as light "
                                         "in its air sees it; default 0: flat")
        ->type_name("METRES|NAME");
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
    const Setting<SkyLight>& harmonics = *findSetting<SkyLight>("sky-harmonics");
    addRow(app, harmonics, "",
           [&sky, &harmonics](const SettingValue& value)
           {
               harmonics.set(sky, value);
               if (sky.skyHarmonics.empty())
                   throw CLI::ValidationError("--sky-harmonics", "needs " + harmonics.needs());
           });
}

void checkProblems(const LightingSettings& settings, const SkyLight& sky, SettingsUse use,
                   const std::string& option)
{
    for (const SettingsProblem& problem : problems(settings, sky, use))
    {
        if (problem.refused)
            throw CLI::ValidationError(option, problem.sentence);
        warn(problem.sentence);
    }
}

void addReadOptions(CLI::App& app, DemReadOptions& read)
{
    app.add_option_function<std::vector<int>>(
           "--srcwin,--window",
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
    options.app = &app;
    app.add_option("INPUT", options.input, "DEM: any raster that GDAL reads")
        ->required()
        ->type_name("");
    app.add_option("OUTPUT", options.output.path, "File to write")->required()->type_name("");
    if (azimuths)
        addSetting(app, "azimuths", options.settings);
    addSetting(app, "quality", options.settings);
    addBodyRadius(app, options.settings, options.bodyRadius);
    addReadOptions(app, options.read);
    addExtentOptions(app, options.extent, true);
    addOutputOptions(app, options.output);
}

void addBudget(CLI::App& app, RasterOptions& options)
{
    std::vector<CLI::Option*> budgets;
    for (const SettingRow& row : budgetRows())
    {
        std::optional<double>& target =
            row.name == "max-error" ? options.maxError : options.maxMilliseconds;
        budgets.push_back(addRow(app, row, "",
                                 [&target](const SettingValue& value)
                                 { target = std::get<std::vector<double>>(value).front(); }));
    }
    budgets[0]->excludes(budgets[1]);
    for (const char* setting : {"--azimuths", "--quality", "--body-radius"})
        if (CLI::Option* option = app.get_option_no_throw(setting))
            for (CLI::Option* budget : budgets)
                budget->excludes(option);
}

} // namespace osgTerrainLight::tool
