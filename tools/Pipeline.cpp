#include "Pipeline.h"

#include "Parts.h"
#include "Picture.h"
#include "Terrain.h"
#include "Windows.h"
#include "io/AlbedoFile.h"
#include "io/LightParameters.h"
#include "io/MapPlace.h"
#include "lighting/nodes/HorizonNode.h"

#include <cpl_string.h>

#include <osg/GL>
#include <osg/GLObjects>
#include <osg/Math>

#include <chrono>
#include <iostream>
#include <optional>

namespace osgTerrainLight::tool
{
namespace
{

/// For people. azimuths: whether they matter.
std::string named(const LightingSettings& settings, bool azimuths)
{
    return std::string("quality ") + toString(settings.quality) +
           (azimuths ? ", " + std::to_string(settings.azimuths) + " azimuths" : "");
}

} // namespace

osg::ref_ptr<TileLight> LitTile::newLight(const LightingSettings& with, const SkyLight& sky,
                                          SkyViewDefinition definition) const
{
    if (isAlone)
        return new TileLight(tile(), with, sky, definition);
    const osg::ref_ptr<TileLight> light = new TileLight(terrain, with, sky, definition);
    if (farLight)
        light->setFarLight(farLight);
    return light;
}

void LitTile::release()
{
    if (lighting)
        lighting->releaseGLObjects(&state());
    lighting = nullptr;
    osg::flushAllDeletedGLObjects(state().getContextID());
}

Status choose(LitTile& lit, const RasterOptions& options, const Product& product, double share,
              const Fraction& progress)
{
    if (!options.maxError && !options.maxMilliseconds)
        return Nothing{};
    osg::State& state = lit.state();
    const SkyLight& sky = product.sky;
    Result<SettingsTrial> trial =
        SettingsTrial::create(lit.tile(), sky, product.measured, product.definition, progress);
    if (!trial)
        return trial.error();
    const Result<SettingsChoice> choice =
        options.maxError
            ? trial->forMaxError(state, options.settings, *options.maxError)
            : trial->forFrameTime(state, options.settings, share * *options.maxMilliseconds);
    if (!choice)
        return choice.error();
    if (!choice->met && options.maxError)
        return Error{ErrorCode::NotSupported,
                     "--max-error " + text(*options.maxError) +
                         ": the most exact settings tried (" +
                         named(choice->settings, sky.skyEnabled) +
                         CPLSPrintf(") reach %.3g on this terrain", choice->error)};
    if (!choice->met)
        return Error{ErrorCode::NotSupported, "--max-ms " + text(*options.maxMilliseconds) +
                                                  ": the fastest settings tried (" +
                                                  named(choice->settings, sky.skyEnabled) +
                                                  CPLSPrintf(") need %.3g ms for this raster",
                                                             choice->milliseconds / share)};
    lit.lighting = trial->takeLight();
    lit.seconds = 1e-3 * choice->milliseconds;
    lit.choice = *choice;
    lit.settings = choice->settings;
    if (!lit.isAlone || share < 1.0) // of the tile alone
        lit.release();
    return Nothing{};
}

namespace
{
/// What is not shared by all azimuths first, so that progress shows.
Status light(LitTile& lit, const SkyLight& sky, SkyViewDefinition definition,
             const Fraction& progress)
{
    SkyLight first = sky;
    first.sunEnabled = sky.sunEnabled && !sky.skyEnabled;
    LightingSettings direct = lit.settings;
    direct.bounces = 0;
    const bool measured = lit.lighting.valid(); // the choice has computed direct light
    if (!measured)
        lit.lighting = lit.newLight(direct, first, definition);
    lit.lighting->setAlbedo(lit.albedo);
    for (const bool last : {false, true})
    {
        if (last || measured)
        {
            lit.lighting->setSky(sky);
            lit.lighting->setSettings(lit.settings);
        }
        if (Status done = lit.lighting->update(lit.state()); !done)
            return done;
        if (Status done = lit.gpu->finish(); !done)
            return done;
        progress(0.5);
    }
    for (const StageCost& cost : lit.lighting->costs())
        if (cost.dispatches > 0)
            lit.azimuths += cost.name == "horizon" ? lit.settings.azimuths
                            : cost.name == "sun"   ? TileLight::sunAzimuths
                            : cost.name == "key"   ? TileLight::keyAzimuths(sky, lit.settings)
                                                   : 0;
    return Nothing{};
}
} // namespace

Status compute(LitTile& lit, const Product& product, const Fraction& progress)
{
    const auto start = std::chrono::steady_clock::now();
    const Status done = product.compute ? product.compute(lit, progress)
                                        : light(lit, product.sky, product.definition, progress);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    lit.seconds += took.count();
    progress(1.0);
    return done;
}

void summarise(const LitTile& lit, const Product& product, double posts, const std::string& more)
{
    if (lit.choice)
        std::cout << product.mode
                  << ": chosen: " << named(lit.settings, lit.azimuths > TileLight::sunAzimuths)
                  << CPLSPrintf("; measured error at most %.2g, %.3g ms", lit.choice->error,
                                lit.choice->milliseconds)
                  << "\n";
    std::cout << product.mode << CPLSPrintf(": %.0f posts, ", posts);
    if (!product.work.empty())
        std::cout << product.work << ", ";
    else if (lit.azimuths > 0)
        std::cout << lit.azimuths << (lit.azimuths == 1 ? " azimuth, " : " azimuths, ")
                  << CPLSPrintf("%.3g million pixel-azimuths/s, ",
                                posts * lit.azimuths / lit.seconds * 1e-6);
    std::cout << CPLSPrintf("%.3g s", lit.seconds) << more << std::endl;
}

void sayNotes(const std::string& path, const std::vector<std::string>& notes, std::size_t said)
{
    for (std::size_t i = said; i < notes.size(); ++i)
        warn(path + ": " + notes[i]);
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

Metadata describe(const std::string& mode, const LitTile& lit, bool azimuths)
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
    metadata.insert(metadata.end(), lit.extent.begin(), lit.extent.end());
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

LitTile tileFor(const RasterOptions& options, const Setup& setup, std::shared_ptr<Gpu> gpu)
{
    LitTile lit;
    lit.read = options.read;
    lit.settings = setup.settings;
    lit.gpu = std::move(gpu);
    lit.isAlone = !seesOutside(options, setup.info);
    if (!options.extent.surroundings.empty())
        add(lit.extent, "SURROUNDINGS", CLI::detail::join(options.extent.surroundings, ","));
    if (options.extent.isolated)
        add(lit.extent, "ISOLATED", "YES");
    return lit;
}

Status writeBands(const OutputOptions& output, const RasterFrame& frame,
                  const std::vector<BandLabel>& labels, const Metadata& metadata,
                  const BandValues& values, const Fraction& progress)
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
        progress(static_cast<double>(band) / (count + 1));
    }
    return writer->finish();
}

} // namespace osgTerrainLight::tool
