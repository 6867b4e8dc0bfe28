#include "Pipeline.h"

#include "io/AlbedoFile.h"
#include "io/LightParameters.h"
#include "io/MapPlace.h"
#include "lighting/nodes/HorizonNode.h"

#include <cpl_string.h>

#include <osg/GL>
#include <osg/Math>

#include <chrono>
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

/// For people. azimuths: whether they matter.
std::string named(const LightingSettings& settings, bool azimuths)
{
    return std::string("quality ") + toString(settings.quality) +
           (azimuths ? ", " + std::to_string(settings.azimuths) + " azimuths" : "");
}

/// Where a budget is given: chooses lit.settings by measurement. An error where none meets it.
Status choose(LitDem& lit, const RasterOptions& options, const SkyLight& sky,
              SettingsTrial::Product product, SkyViewDefinition definition, Progress& progress)
{
    if (!options.maxError && !options.maxMilliseconds)
        return Nothing{};
    osg::State& state = lit.gpu.state();
    Result<SettingsTrial> trial =
        SettingsTrial::create(lit.dem.tile, sky, product, definition,
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
    lit.lighting = trial->takeLight();
    lit.seconds = 1e-3 * choice->milliseconds;
    lit.choice = *choice;
    lit.settings = choice->settings;
    return Nothing{};
}

/// Computes the light of lit.dem: what is not shared by all azimuths first, so that progress shows.
Status compute(LitDem& lit, const SkyLight& sky, SkyViewDefinition definition, Progress& progress)
{
    const auto start = std::chrono::steady_clock::now();
    SkyLight first = sky;
    first.sunEnabled = sky.sunEnabled && !sky.skyEnabled;
    LightingSettings direct = lit.settings;
    direct.bounces = 0;
    const bool measured = lit.lighting.valid(); // the choice has computed direct light
    if (!measured)
        lit.lighting = new TileLight(lit.dem.tile, direct, first, definition);
    lit.lighting->setAlbedo(lit.albedo);
    for (const bool last : {false, true})
    {
        if (last || measured)
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
    lit.seconds += took.count();
    for (const StageCost& cost : lit.lighting->costs())
        if (cost.dispatches > 0)
            lit.azimuths += cost.name == "horizon" ? lit.settings.azimuths
                            : cost.name == "sun"   ? TileLight::sunAzimuths
                            : cost.name == "key"   ? TileLight::keyAzimuths(sky, lit.settings)
                                                   : 0;
    progress.reach(computeEnd);
    return Nothing{};
}

void summarise(const std::string& mode, const LitDem& lit)
{
    const double posts = static_cast<double>(lit.dem.tile.postCount());
    if (lit.choice)
        std::cout << mode
                  << ": chosen: " << named(lit.settings, lit.azimuths > TileLight::sunAzimuths)
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

void sayNotes(const std::string& path, const LitDem& lit, std::size_t said)
{
    for (std::size_t i = said; i < lit.dem.notes.size(); ++i)
        warn(path + ": " + lit.dem.notes[i]);
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
    Gpu gpu;
    std::string problem;
    gpu.context = HeadlessContext::create(width, height, problem);
    if (!gpu.context)
        return Error{ErrorCode::NotSupported, problem};
    Result<GpuCapabilities> capabilities = GpuCapabilities::query(gpu.state());
    if (!capabilities)
        return capabilities.error();
    gpu.capabilities = *capabilities;
    return gpu;
}

Status checkFits(const Gpu& gpu, int width, int height)
{
    const int most = gpu.capabilities.maxTextureSize - 2 * HorizonNode::frame;
    if (width > most || height > most)
        return Error{ErrorCode::NotSupported,
                     std::to_string(width) + " x " + std::to_string(height) + " posts; '" +
                         gpu.capabilities.renderer + "' takes " + std::to_string(most) +
                         " a side: needed a smaller -srcwin"};
    return Nothing{};
}

Metadata describe(const std::string& mode, const LitDem& lit, bool azimuths)
{
    Metadata metadata = {{"TIFFTAG_SOFTWARE", "osgTerrainLight " OSGTERRAINLIGHT_VERSION}};
    add(metadata, "VERSION", OSGTERRAINLIGHT_VERSION);
    add(metadata, "MODE", mode);
    if (azimuths)
        addSetting(metadata, "azimuths", lit.settings);
    addSetting(metadata, "quality", lit.settings);
    if (lit.settings.bodyRadius > 0.0)
        addSetting(metadata, "body-radius", lit.settings);
    addReading(metadata, lit.read);
    if (lit.choice)
        add(metadata, "ERROR_BOUND", text(lit.choice->error));
    return metadata;
}

Result<EarthPlace> placeOf(const RasterOptions& options, const SunTime& sun)
{
    const Result<DemInfo> info = describeDem(options.input, options.read);
    if (!info)
        return info.error();
    const RasterFrame& frame = info->frame;
    const Result<EarthPlace> place = placeInstead(sun.place, frame.hasGeoTransform ? frame.crs : "",
                                                  osgTerrainLight::placeOf(frame));
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
    if (!TileLight::needsSun(sky))
        warn("the sun is " + text(std::round(-100.0 * sky.sunElevation) / 100.0) +
             " degrees below the horizontal at " + toString(*sun.time));
    return Nothing{};
}

Result<double> radiusOfCrs(const DemInfo& info)
{
    if (info.bodyRadius > 0.0)
        return info.bodyRadius;
    return Error{ErrorCode::NotFound,
                 "--body-radius auto: the CRS names no planet: needs a radius in metres"};
}

namespace
{
double extentOf(const DemInfo& info)
{
    return std::hypot(info.eastSpacing * info.window.width, info.northSpacing * info.window.height);
}

/// The radius to compute with. Terrain sinks along a parabola, which is no sphere where the tile is
/// a large part of it.
Result<double> chooseRadius(const RasterOptions& options, const DemInfo& info)
{
    double radius = options.settings.bodyRadius;
    if (options.bodyRadius == BodyRadius::OfCrs)
    {
        const Result<double> own = radiusOfCrs(info);
        if (!own)
            return own.error();
        radius = *own;
    }
    const double extent = extentOf(info);
    if (radius == 0.0 || radius >= 10.0 * extent)
        return radius;
    return Error{ErrorCode::Invalid, "--body-radius " + text(radius) + ": the tile is " +
                                         text(std::round(extent)) +
                                         " m across: needs at least ten times that"};
}

/// Over a distance d the ground sinks by d²/2R, an angle of d/2R.
void hintAtCurvature(const RasterOptions& options, const DemInfo& info)
{
    constexpr double tellable = 0.1; // [degrees]
    if (options.bodyRadius != BodyRadius::Unsaid || !(info.bodyRadius > 0.0))
        return;
    const double sinking = osg::RadiansToDegrees(0.5 * extentOf(info) / info.bodyRadius);
    if (sinking <= tellable)
        return;
    const char* budget = options.maxError          ? "--max-error"
                         : options.maxMilliseconds ? "--max-ms"
                                                   : nullptr;
    const std::string radius = "--body-radius auto (" + text(info.bodyRadius) + " m)";
    warn(options.input + ": is lit as flat, but the planet's curvature lowers the far edge by " +
         CPLSPrintf("%.2g", sinking) + " degrees: " +
         (budget ? std::string(budget) + " knows flat ground only; " + radius +
                       " instead of it follows the curvature"
                 : radius + " follows it, --body-radius 0 stays flat"));
}
} // namespace

Status checkProj(const std::string& path, const Result<DemInfo>& info)
{
    const std::string broken = projComplaint();
    if (broken.empty())
        return Nothing{};
    if (!info || !info->frame.crs.empty())
        return Error{ErrorCode::Failed, path + ": " + broken};
    warn(path + ": a CRS that it may have is not known: " + broken);
    return Nothing{};
}

Status readTile(const RasterOptions& options, int bands, LitDem& lit, std::size_t& headNotes,
                Progress& progress)
{
    const std::string& path = options.input;
    refuseInputs({path, options.albedoFile}, options.output);
    Result<DemInfo> info = describeDem(path, options.read);
    if (Status known = checkProj(path, info); !known)
        return known;
    if (!info)
        return info.error();
    if (Status writable = checkOutput(options.output, bands, info->frame); !writable)
        return writable;
    const Result<double> radius = chooseRadius(options, *info);
    if (!radius)
        return Error{radius.error().code, path + ": " + radius.error().message};
    for (const std::string& note : info->notes)
        warn(path + ": " + note);
    hintAtCurvature(options, *info);
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
    lit.read = options.read;
    lit.settings = options.settings;
    lit.settings.bodyRadius = *radius;
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
               const std::function<Status(LitDem&, Progress&)>& write)
{
    const std::string& path = options.input;
    LitDem lit;
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
