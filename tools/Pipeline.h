#pragma once

#include <osgTerrainLight/HorizonMap.h>

#include "Console.h"
#include "Metadata.h"
#include "Options.h"
#include "core/Raster.h"
#include "gpu/GpuCapabilities.h"
#include "io/RasterWriter.h"
#include "lighting/FarLight.h"
#include "lighting/SettingsTrial.h"
#include "lighting/TileLight.h"
#include "lighting/TileWindows.h"
#include <osgTerrainLight/HeadlessContext.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

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

/// A tile of a DEM, and its light once that has been computed.
struct LitTile
{
    std::shared_ptr<const TileWindows> terrain; ///< the tile, and what it sees
    bool isAlone = true;                        ///< it sees only itself
    RasterFrame frame;                          ///< of the tile
    DemReadOptions read;                        ///< how the DEM is read
    Metadata extent;                            ///< what was asked for of what the tile sees
    std::shared_ptr<Gpu> gpu;
    osg::ref_ptr<TileLight> lighting;
    LightingSettings settings;
    Raster<Rgb> albedo;                       ///< empty: the settings'
    std::shared_ptr<const FarLight> farLight; ///< for bounces, from around the tile; null: none
    std::optional<SettingsChoice> choice;     ///< where a budget made it
    int azimuths = 0;                         ///< horizons computed per post, the sun's included
    double seconds = 0.0;

    const DemTile& tile() const { return terrain->tile; }
    osg::State& state() const { return gpu->state(); }
    /// Light that has not been computed yet.
    osg::ref_ptr<TileLight> newLight(const LightingSettings& with, const SkyLight& sky,
                                     SkyViewDefinition definition) const;
    /// Gives its memory on the GPU back.
    void release();
};

/// Told how much of a work is done, 0 … 1.
using Fraction = std::function<void(double)>;
/// Values of a band, 1 …, in tile order, NaN where void. Asked for once each, in order.
using BandValues = std::function<Raster<float>(int band)>;

/// What a mode makes of a DEM. The rest is the same for all.
struct Product
{
    std::string mode;
    SkyLight sky;
    std::string skyFile; ///< that it is made of; empty: none
    SettingsTrial::Product measured = SettingsTrial::Product::Shading; ///< by a budget
    SkyViewDefinition definition = SkyViewDefinition::Surface;

    std::vector<BandLabel> bands;
    /// How a light that is computed becomes bands.
    std::function<BandValues(LitTile&)> values;
    std::function<Metadata(const LitTile&)> metadata;

    /// Instead of lighting the tile by `sky` once; empty: that.
    std::function<Status(LitTile&, const Fraction&)> compute;
    /// For the summary, in place of azimuths and rate; empty: these.
    std::string work;

    enum class Kind
    {
        Floats,
        Picture, ///< of four bands of light
        Exr
    };
    Kind kind = Kind::Floats;
    double gain = 1.0; ///< of a picture
};

/// The radius of --body-radius auto. An error where the CRS has none.
Result<double> radiusOfCrs(const DemInfo& info);
/// The place that was given, or that of the raster. An error names the raster and --place.
Result<EarthPlace> placeOf(const RasterOptions& options, const SunTime& sun);
/// Where a time was given, sets the sun by it, with a warning where it has set, and says so in the
/// metadata: TERRAINLIGHT_TIME, _PLACE and _CONVERGENCE.
Status setSun(SkyLight& sky, const RasterOptions& options, const SunTime& sun, Metadata& metadata);

/// Software, version, mode, settings and, where a budget chose them, their measured error.
Metadata describe(const std::string& mode, const LitTile& lit, bool azimuths);

/// An error where PROJ's data cannot be read and a raster, or what it stands for, may need them:
/// its scale and place would be others, or none. A warning where it has no CRS.
Status checkProj(const std::string& path, const Result<DemInfo>& info);

/// What is known before any height is read.
struct Setup
{
    DemInfo info;              ///< of the part that is lit
    LightingSettings settings; ///< with the planet's radius
    LightingSettings costs;    ///< the same, for what memory it takes
};

/// Lights a DEM, in one piece or in windows, and writes the result.
Status process(const RasterOptions& options, const Product& product);
/// In windows, of parts that are kept until all are there.
Status processInWindows(const RasterOptions& options, const Product& product, const Setup& setup);
/// Whether windows of the same command wait to be gone on with, or another run makes some for the
/// same output.
bool windowsWait(const RasterOptions& options, const Product& product);

/// All of a tile but its terrain and what is computed.
LitTile tileFor(const RasterOptions& options, const Setup& setup, std::shared_ptr<Gpu> gpu);
/// Where a budget is given: chooses lit.settings by measuring the tile, alone. An error where none
/// meets it. share: part of --max-ms that the tile has.
Status choose(LitTile& lit, const RasterOptions& options, const Product& product, double share,
              const Fraction& progress);
/// Computes the light of a tile.
Status compute(LitTile& lit, const Product& product, const Fraction& progress);
/// "svf: 138632 posts, 32 azimuths, … s".
void summarise(const LitTile& lit, const Product& product, double posts,
               const std::string& more = {});
/// Notes after the first `said`.
void sayNotes(const std::string& path, const std::vector<std::string>& notes, std::size_t said);

/// Writes band after band.
Status writeBands(const OutputOptions& output, const RasterFrame& frame,
                  const std::vector<BandLabel>& labels, const Metadata& metadata,
                  const BandValues& values, const Fraction& progress);

} // namespace osgTerrainLight::tool
