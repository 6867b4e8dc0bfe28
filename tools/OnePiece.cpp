#include "Pipeline.h"

#include "Picture.h"
#include "Terrain.h"
#include "Windows.h"
#include "io/AlbedoFile.h"
#include "lighting/nodes/HorizonNode.h"

#include <cpl_string.h>

#include <osg/Math>

#include <algorithm>
#include <cmath>

namespace osgTerrainLight::tool
{
namespace
{

// Where reading and computing end on the progress line.
constexpr double readEnd = 0.1;
constexpr double trialEnd = 0.4;
constexpr double computeEnd = 0.8;

} // namespace

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

/// Of all that what is lit may see.
double seenOf(const RasterOptions& options, const DemInfo& info)
{
    constexpr double reach = 500e3; // RasterSourceOptions
    double seen = extentOf(info);
    if (!options.extent.isolated)
        seen = std::max(seen, std::hypot(info.eastSpacing * info.rasterWidth,
                                         info.northSpacing * info.rasterHeight));
    for (const std::string& file : options.extent.surroundings)
        if (const Result<DemInfo> far = describeDem(file))
            seen = std::max(seen, extentOf(*far));
    return std::min(seen, 2.0 * reach);
}

/// Over a distance d the ground sinks by d²/2R, an angle of d/2R.
void hintAtCurvature(const RasterOptions& options, const DemInfo& info)
{
    constexpr double tellable = 0.1; // [degrees]
    if (options.bodyRadius != BodyRadius::Unsaid || !(info.bodyRadius > 0.0))
        return;
    const double sinking = osg::RadiansToDegrees(0.5 * seenOf(options, info) / info.bodyRadius);
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

Result<Setup> prepare(const RasterOptions& options, const Product& product)
{
    const std::string& path = options.input;
    std::vector<std::string> inputs = options.extent.surroundings;
    inputs.insert(inputs.begin(), {path, options.albedoFile});
    refuseInputs(inputs, options.output);
    Result<DemInfo> info = describeDem(path, options.read);
    if (Status known = checkProj(path, info); !known)
        return known.error();
    if (!info)
        return info.error();
    const int bands =
        product.kind == Product::Kind::Floats ? static_cast<int>(product.bands.size()) : 0;
    if (Status writable = checkOutput(options.output, bands, info->frame); !writable)
        return writable.error();
    const Result<double> radius = chooseRadius(options, *info);
    if (!radius)
        return Error{radius.error().code, path + ": " + radius.error().message};
    sayNotes(path, info->notes, 0);
    hintAtCurvature(options, *info);
    Setup setup = {*info, options.settings, options.settings};
    setup.settings.bodyRadius = *radius;
    const SkyLight& sky = product.sky;
    if (setup.settings.bounceMethod != BounceMethod::Slices && seesOutside(options, *info))
        return Error{ErrorCode::NotSupported,
                     "--bounce-method " + std::string(toString(setup.settings.bounceMethod)) +
                         ": sees nothing beyond what is lit: needs slices, or --isolated without "
                         "--surroundings"};
    if (!sky.skyEnabled && sky.keyLights.empty() && options.settings.bounces == 0)
        setup.costs.azimuths = TileLight::sunAzimuths + 1; // the sun's are all that there are
    return setup;
}

/// Bounces from beyond what is lit need coarser levels that are lit first, as windows do.
bool isOnePiece(const RasterOptions& options, const Product& product, const Setup& setup)
{
    const PixelWindow& part = setup.info.window;
    const bool bouncesAround = setup.settings.bounces > 0 && seesOutside(options, setup.info);
    return !bouncesAround && !options.extent.job && !windowsWait(options, product) &&
           fitsInOnePiece(part.width, part.height, setup.costs,
                          static_cast<int>(product.bands.size()), options.extent);
}

/// notes: what only the heights could tell.
Status read(LitTile& lit, const RasterOptions& options, const Setup& setup, Progress& progress,
            std::vector<std::string>& notes)
{
    const DemInfo& info = setup.info;
    const auto fraction = [&progress](double done)
    {
        progress.reach(readEnd * done);
        return true;
    };
    if (lit.isAlone)
    {
        DemReadOptions reading = options.read;
        reading.progress = fraction;
        Result<DemFile> dem = readDem(options.input, reading);
        if (!dem)
            return dem.error();
        lit.terrain = aloneOf(std::move(dem->tile));
        notes = dem->notes;
    }
    else
    {
        Result<std::unique_ptr<RasterSource>> terrain = openTerrain(options, fraction);
        if (!terrain)
            return terrain.error();
        Result<std::shared_ptr<const TileWindows>> tile = readWindows(
            **terrain, 0, {0, 0, info.window.width, info.window.height}, setup.settings.quality);
        if (!tile)
            return tile.error();
        lit.terrain = *tile;
        notes = (*terrain)->notes();
    }
    lit.frame = info.frame;
    if (options.albedoFile.empty())
        return Nothing{};
    Result<Raster<Rgb>> albedo = readAlbedo(options.albedoFile, info);
    if (!albedo)
        return albedo.error();
    lit.albedo = std::move(*albedo);
    return Nothing{};
}

Status write(LitTile& lit, const RasterOptions& options, const Product& product,
             const Fraction& progress)
{
    const Metadata metadata = product.metadata(lit);
    const BandValues values = product.values(lit);
    if (product.kind == Product::Kind::Floats)
        return writeBands(options.output, lit.frame, product.bands, metadata, values, progress);
    std::vector<Raster<float>> bands;
    for (int band = 1; band <= 4; ++band)
        bands.push_back(values(band));
    const auto rows = [&](int row, std::vector<float>& line) -> Status
    {
        line.clear();
        for (const Raster<float>& band : bands)
            for (int column = 0; column < band.width(); ++column)
                line.push_back(band.at(column, band.height() - 1 - row));
        return Nothing{};
    };
    if (product.kind == Product::Kind::Exr)
        return writeLightExr(options.output, lit.frame, metadata, rows);
    return writePicture(options.output, lit.frame, lit.tile().validCount() < lit.tile().postCount(),
                        product.gain, metadata, rows);
}

Status processInOnePiece(const RasterOptions& options, const Product& product, const Setup& setup)
{
    const std::string& path = options.input;
    const auto named = [&path](const Status& failed) {
        return Error{failed.error().code, path + ": " + failed.error().message};
    };
    Result<Gpu> gpu = openGpu();
    if (!gpu)
        return gpu.error();
    LitTile lit = tileFor(options, setup, std::make_shared<Gpu>(std::move(*gpu)));
    if (Status fits = checkFits(*lit.gpu, setup.info.window.width, setup.info.window.height); !fits)
        return named(fits);
    Progress progress(options.output.quiet);
    progress.reach(0.0);
    double start = readEnd;
    double end = trialEnd;
    const auto fraction = [&](double done) { progress.reach(start + (end - start) * done); };
    std::vector<std::string> notes;
    if (Status done = read(lit, options, setup, progress, notes); !done)
        return done;
    if (Status chosen = choose(lit, options, product, 1.0, fraction); !chosen)
        return named(chosen);
    start = lit.choice ? trialEnd : readEnd;
    end = computeEnd;
    if (Status computed = compute(lit, product, fraction); !computed)
        return named(computed);
    start = computeEnd;
    end = 1.0;
    if (Status written = write(lit, options, product, fraction); !written)
        return written;
    progress.reach(1.0);
    sayNotes(path, notes, setup.info.notes.size());
    if (options.output.quiet)
        return Nothing{};
    const unsigned dropped = lit.lighting ? lit.lighting->readDroppedVertices(lit.state()) : 0;
    summarise(lit, product, static_cast<double>(lit.tile().postCount()),
              dropped > 0 ? ", " + std::to_string(dropped) + " hull vertices dropped" : "");
    return Nothing{};
}

} // namespace

Status process(const RasterOptions& options, const Product& product)
{
    const Result<Setup> setup = prepare(options, product);
    if (!setup)
        return setup.error();
    return isOnePiece(options, product, *setup) ? processInOnePiece(options, product, *setup)
                                                : processInWindows(options, product, *setup);
}

} // namespace osgTerrainLight::tool
