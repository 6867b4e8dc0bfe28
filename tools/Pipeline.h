#pragma once

#include <osgTerrainLight/HorizonMap.h>

#include "Console.h"
#include "Metadata.h"
#include "Options.h"
#include "core/Raster.h"
#include "gpu/GpuCapabilities.h"
#include "io/RasterWriter.h"
#include "lighting/SettingsTrial.h"
#include "lighting/TileLight.h"
#include <osgTerrainLight/HeadlessContext.h>

#include <memory>

/// The way from a DEM to light to a file.
namespace osgTerrainLight::tool
{

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

/// A DEM, and its light that has been computed.
struct LitDem
{
    DemFile dem;
    DemReadOptions read; ///< how the DEM was read
    Gpu gpu;
    osg::ref_ptr<TileLight> lighting;
    LightingSettings settings;
    Raster<Rgb> albedo;                   ///< empty: the settings'
    std::optional<SettingsChoice> choice; ///< where a budget made it
    int azimuths = 0;                     ///< horizons computed per post, the sun's included
    double seconds = 0.0;
};

/// The radius of --body-radius auto. An error where the CRS has none.
Result<double> radiusOfCrs(const DemInfo& info);
/// The place that was given, or that of the raster. An error names the raster and --place.
Result<EarthPlace> placeOf(const RasterOptions& options, const SunTime& sun);
/// Where a time was given, sets the sun by it, with a warning where it has set, and says so in the
/// metadata: TERRAINLIGHT_TIME, _PLACE and _CONVERGENCE.
Status setSun(SkyLight& sky, const RasterOptions& options, const SunTime& sun, Metadata& metadata);

/// Software, version, mode, settings and, where a budget chose them, their measured error.
Metadata describe(const std::string& mode, const LitDem& lit, bool azimuths);

/// An error where PROJ's data cannot be read and a raster, or what it stands for, may need them:
/// its scale and place would be others, or none. A warning where it has no CRS.
Status checkProj(const std::string& path, const Result<DemInfo>& info);

/// A DEM whose light is to be computed, read, and the context to do it in. Makes sure before that
/// the output can be written; bands: of floats, 0 for a picture or EXR file. headNotes: notes
/// that have been said.
Status readTile(const RasterOptions& options, int bands, LitDem& lit, std::size_t& headNotes,
                Progress& progress);

/// What only the heights could tell: notes after the first `said`.
void sayNotes(const std::string& path, const LitDem& lit, std::size_t said);

/// Reads, computes, calls write, prints the summary. Before heights are read it makes sure that the
/// output can be written; bands: of floats, 0 for a picture or EXR file. product: what
/// write wants.
Status process(const std::string& mode, const RasterOptions& options, const SkyLight& sky,
               SettingsTrial::Product product, SkyViewDefinition definition, int bands,
               const std::function<Status(LitDem&, Progress&)>& write);

/// Writes band after band from values(band), band = 1 …, called once each, in tile order.
Status writeBands(const OutputOptions& output, const RasterFrame& frame,
                  const std::vector<BandLabel>& labels, const Metadata& metadata,
                  Progress& progress, const std::function<Raster<float>(int band)>& values);

} // namespace osgTerrainLight::tool
