#pragma once

#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>
#include <osgTerrainLight/SunPosition.h>

#include "Output.h"
#include "core/Result.h"
#include "core/SettingsTable.h"
#include "io/DemReader.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

/// The tool's command line: options that modes share.
namespace osgTerrainLight::tool
{

/// A mode: its command line, and what it does once that has been parsed. A mistake in the command
/// line that shows only then is thrown as CLI::ParseError, like those that show while parsing.
struct Mode
{
    CLI::App* app = nullptr;
    std::function<Status()> run;
};

Mode addHorizon(CLI::App& tool);
Mode addSvf(CLI::App& tool);
Mode addShadow(CLI::App& tool);
Mode addShade(CLI::App& tool);
Mode addSunHours(CLI::App& tool);
Mode addRender(CLI::App& tool);
Mode addInfo(CLI::App& tool);
Mode addGenerate(CLI::App& tool);
Mode addBench(CLI::App& tool);

/// The option of a row of the table of settings, which checks and describes it. Null where the mode
/// has it already.
CLI::Option* addRow(CLI::App& app, const SettingRow& row, const std::string& defaultText,
                    std::function<void(const SettingValue&)> set);
template <class Owner>
CLI::Option* addSetting(CLI::App& app, const Setting<Owner>& setting, Owner& owner)
{
    return addRow(app, setting, setting.textOf(owner),
                  [&setting, &owner](const SettingValue& value) { setting.set(owner, value); });
}
template <class Owner>
CLI::Option* addSetting(CLI::App& app, const std::string& name, Owner& owner)
{
    return addSetting(app, *findSetting<Owner>(name), owner);
}
/// Every setting of a topic that is an option and that the mode does not have yet.
template <class Owner>
void addTopic(CLI::App& app, Topic topic, Owner& owner)
{
    for (const Setting<Owner>& setting : settingsOf<Owner>())
        if (setting.topic == topic && setting.isOption)
            addSetting(app, setting, owner);
}

/// A number beside those of the table: its name and range.
struct Limits
{
    std::string name;
    double minimum, maximum;
    bool whole = false;

    std::string complaint(double value) const;
};
CLI::Option* addLimitedNumbers(CLI::App& app, const std::string& option,
                               const std::string& typeName, const std::vector<Limits>& limits,
                               const std::string& help,
                               std::function<void(const std::vector<double>&)> set);

/// --size W[,H].
void addSize(CLI::App& app, int& width, int& height, const std::string& help);
void addConfig(CLI::App& app);
void addQuiet(CLI::App& app, bool& quiet);
void addSun(CLI::App& app, SkyLight& sky);
/// --sky, --turbidity, --sky-heading, --sky-gain. file: where the sky is one from a file.
void addSky(CLI::App& app, SkyLight& sky, std::string& file);
/// Reads the sky's file, where there is one, and takes its sun, unless --no-sun or --light said to
/// leave it out. Throws CLI::ValidationError where options contradict each other.
/// mapMayHaveSky: what is asked of without --sky may be the scene's own.
Status readSky(const CLI::App& app, SkyLight& sky, const std::string& file,
               bool mapMayHaveSky = false);
/// Where the radius of the planet comes from.
enum class BodyRadius
{
    Unsaid, ///< flat, with a hint where that matters
    Given,
    OfCrs ///< of the input
};
/// --body-radius.
void addBodyRadius(CLI::App& app, LightingSettings& settings, BodyRadius& said);

/// The sun by time and place instead of --sun.
struct SunTime
{
    std::optional<UtcTime> time;
    std::optional<EarthPlace> place; ///< else the raster's own
};
/// An option that is a time.
CLI::Option* addTime(CLI::App& app, const std::string& option, const std::string& help,
                     std::function<void(UtcTime)> set);
CLI::Option* addPlace(CLI::App& app, SunTime& sun);
/// --time, which excludes --sun, and --place.
void addSunTime(CLI::App& app, SunTime& sun);
/// --key-light and --sky-harmonics.
void addAreaLights(CLI::App& app, SkyLight& sky);
/// Throws CLI::ValidationError in the name of an option that was given and has no effect.
void refuseIdle(const CLI::App& app, const std::vector<IdleSetting>& settings);
/// Throws CLI::ValidationError in the name of an option where settings and light are refused; warns
/// of what has no effect.
void checkProblems(const LightingSettings& settings, const SkyLight& sky, SettingsUse use,
                   const std::string& option);
void addReadOptions(CLI::App& app, DemReadOptions& read);
/// --unit and --z-factor.
void addHeightOptions(CLI::App& app, DemReadOptions& read);

void addCellSize(CLI::App& app, std::function<void(double)> set);

void addOutputOptions(CLI::App& app, OutputOptions& output);

/// A share of the windows of a raster: number `index` of `count`.
struct Job
{
    int index = 1;
    int count = 1;
};

/// How a raster is lit that does not fit into memory, and what it sees around it.
struct ExtentOptions
{
    std::vector<std::string> surroundings; ///< rasters of terrain around the input
    bool isolated = false;                 ///< terrain outside -srcwin is not seen
    double memory = 0.0;                   ///< bytes; that were given or are sane
    int windowSize = 0;                    ///< posts a side; 0: by memory
    std::optional<Job> job;
    std::string cache; ///< folder of coarse levels; empty: beside the input
};

/// What the modes that turn a DEM into a raster have in common.
struct RasterOptions
{
    const CLI::App* app = nullptr;
    std::string input;
    DemReadOptions read;
    ExtentOptions extent;
    LightingSettings settings;
    BodyRadius bodyRadius = BodyRadius::Unsaid;
    std::string albedoFile;                          ///< a raster; empty: settings.albedo
    std::optional<double> maxError, maxMilliseconds; ///< one of them: settings are chosen by it
    OutputOptions output;
};
/// --surroundings, --isolated, --memory, --window-size and --cache; --job where `jobs`.
void addExtentOptions(CLI::App& app, ExtentOptions& extent, bool jobs);
/// azimuths: false where the mode computes none but the sun's.
void addRasterOptions(CLI::App& app, RasterOptions& options, bool azimuths = true);
/// --bounces, and what they are made of; --albedo may be a raster.
void addBounces(CLI::App& app, RasterOptions& options);
/// --max-error and --max-ms, instead of the settings.
void addBudget(CLI::App& app, RasterOptions& options);

} // namespace osgTerrainLight::tool
