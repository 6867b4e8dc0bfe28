#pragma once

#include <osgTerrainLight/HorizonMap.h>
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>
#include <osgTerrainLight/SunPosition.h>

#include "core/Raster.h"
#include "core/Result.h"
#include "gpu/GpuCapabilities.h"
#include "gpu/HeadlessContext.h"
#include "io/DemReader.h"
#include "io/RasterWriter.h"
#include "scene/SettingsTrial.h"
#include "scene/TileLighting.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// What the modes of the tool share: options, messages, progress, the way from a DEM to light.
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

using Metadata = std::vector<std::pair<std::string, std::string>>;

/// Shortest of up to 10 significant digits.
std::string text(double value);

std::string text(const Rgb& colour);

/// "terrainlight: …" on stderr.
void complain(const std::string& sentence);
void warn(const std::string& sentence);

/// An option of numbers separated by commas, as many as there are names. Each name is one of
/// ParameterRange, which it is checked against.
CLI::Option* addNumbers(CLI::App& app, const std::string& option, const std::string& typeName,
                        const std::vector<std::string>& names, const std::string& help,
                        std::function<void(const std::vector<double>&)> set);
/// The same for names that the range table does not have.
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
void addSettings(CLI::App& app, LightingSettings& settings, bool azimuths = true);
void addExposure(CLI::App& app, LightingSettings& settings);
void addSun(CLI::App& app, SkyLight& sky);
void addSunRadius(CLI::App& app, SkyLight& sky);
/// --sky, --turbidity, --sky-heading, --sky-gain. file: where the sky is one from a file.
void addSky(CLI::App& app, SkyLight& sky, std::string& file);
/// Reads the sky's file, where there is one, and takes its sun, unless --no-sun or --light said to
/// leave it out. Throws CLI::ValidationError where options contradict each other.
/// mapMayHaveSky: what is asked of without --sky may be the scene's own.
Status readSky(const CLI::App& app, SkyLight& sky, const std::string& file,
               bool mapMayHaveSky = false);
/// --body-radius.
void addBodyRadius(CLI::App& app, LightingSettings& settings);

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
void addReadOptions(CLI::App& app, DemReadOptions& read);

void addCellSize(CLI::App& app, std::function<void(double)> set);

struct OutputOptions
{
    std::string path;
    std::string format;
    std::vector<std::string> creationOptions;
    bool quiet = false;
};
void addOutputOptions(CLI::App& app, OutputOptions& output);

/// True where OpenEXR writes it, not GDAL: by its format, else by its extension.
bool isExr(const OutputOptions& output);

/// Finds out before the work what else would show after it: no such folder, driver or creation
/// option, a driver without floats. bands: of floats; 0 for a picture or EXR file.
Status checkOutput(const OutputOptions& output, int bands);

/// A mistake in the command line where both are one file.
void refuseSameFile(const std::string& input, const std::string& output);

/// What the modes that turn a DEM into a raster have in common.
struct RasterOptions
{
    std::string input;
    DemReadOptions read;
    LightingSettings settings;
    std::string albedoFile;                          ///< a raster; empty: settings.albedo
    std::optional<double> maxError, maxMilliseconds; ///< one of them: settings are chosen by it
    OutputOptions output;
};
/// azimuths: false where the mode computes none but the sun's.
void addRasterOptions(CLI::App& app, RasterOptions& options, bool azimuths = true);
/// --bounces, and what they are made of.
void addBounces(CLI::App& app, RasterOptions& options);
/// --max-error and --max-ms, instead of the settings.
void addBudget(CLI::App& app, RasterOptions& options);

/// GDAL's progress line, 0 … 1; never runs backwards. Ends an unfinished line when it goes.
class Progress
{
public:
    explicit Progress(bool quiet) : _quiet(quiet) {}
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    void reach(double fraction);

private:
    bool _quiet;
    double _reached = -1.0;
};

/// While one lives, SIGINT and SIGTERM wait: a file being written is removed first. Then they act.
class DeferredSignals
{
public:
    DeferredSignals();
    ~DeferredSignals();
    DeferredSignals(const DeferredSignals&) = delete;
    DeferredSignals& operator=(const DeferredSignals&) = delete;
    /// An error where a signal waits.
    static Status check();

private:
    void (*_previous[2])(int);
};

struct Gpu
{
    std::unique_ptr<HeadlessContext> context;
    GpuCapabilities capabilities;

    osg::State& state() const { return context->state(); }
    /// Waits for the GPU; an error where OpenGL has one, out of memory above all.
    Status finish() const;
};
Result<Gpu> openGpu(int width = 16, int height = 16);

/// An error where a raster is larger than the context's textures.
Status checkFits(const Gpu& gpu, int width, int height);

/// A DEM and its light, computed.
struct LitTile
{
    DemFile dem;
    Gpu gpu;
    osg::ref_ptr<TileLighting> lighting;
    LightingSettings settings;
    Raster<Rgb> albedo;                   ///< empty: the settings'
    std::optional<SettingsChoice> choice; ///< where a budget made it
    int azimuths = 0;                     ///< horizons computed per post, the sun's included
    double seconds = 0.0;
};

/// The place that was given or that of the raster; an error names the raster and --place.
Result<EarthPlace> placeOf(const RasterOptions& options, const SunTime& sun);
/// Where a time was given, sets the sun by it, with a warning where it has set, and says so in the
/// metadata: TERRAINLIGHT_TIME, _PLACE and _CONVERGENCE.
Status setSun(SkyLight& sky, const RasterOptions& options, const SunTime& sun, Metadata& metadata);
void addPlace(Metadata& metadata, const EarthPlace& place);

/// Software, version, mode, settings and, where a budget chose them, their measured error.
Metadata describe(const std::string& mode, const LitTile& lit, bool azimuths);
void add(Metadata& metadata, const std::string& name, const std::string& value);
void addSun(Metadata& metadata, const SkyLight& sky);
void addAreaLights(Metadata& metadata, const SkyLight& sky);

/// A DEM whose light is to be computed, read, and the context to do it in. Makes sure before that
/// the output can be written; bands: of floats, 0 for a picture or EXR file. headNotes: notes
/// that have been said.
Status readTile(const RasterOptions& options, int bands, LitTile& lit, std::size_t& headNotes,
                Progress& progress);

/// What only the heights could tell: notes after the first `said`.
void sayNotes(const std::string& path, const LitTile& lit, std::size_t said);

/// Reads, computes, calls write, prints the summary. Before heights are read it makes sure that the
/// output can be written; bands: of floats, 0 for a picture or EXR file. product: what
/// write wants.
Status process(const std::string& mode, const RasterOptions& options, const SkyLight& sky,
               SettingsTrial::Product product, SkyViewDefinition definition, int bands,
               const std::function<Status(LitTile&, Progress&)>& write);

/// Writes band after band from values(band), band = 1 …, called once each, in tile order.
Status writeBands(const OutputOptions& output, const RasterFrame& frame,
                  const std::vector<BandLabel>& labels, const Metadata& metadata,
                  Progress& progress, const std::function<Raster<float>(int band)>& values);

/// The writer's options for an output.
RasterWriteOptions writeOptions(const OutputOptions& output, const Metadata& metadata);

} // namespace osgTerrainLight::tool
