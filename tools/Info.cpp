#include "Pipeline.h"

#include "Windows.h"

#include "core/AzimuthSet.h"
#include "core/SyntheticTerrain.h"
#include "gpu/Textures.h"
#include "lighting/nodes/HorizonNode.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal.h>
#include <osg/GL>
#include <osg/Version>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <limits>

namespace osgTerrainLight::tool
{
namespace
{

struct Options
{
    std::string input;
    DemReadOptions read;
    LightingSettings settings;
    ExtentOptions extent;
    bool rate = false;
};

void line(const std::string& name, const std::string& value)
{
    std::cout << CPLSPrintf("%-18s ", (name + ":").c_str()) << value << "\n";
}

std::string mebibytes(double bytes)
{
    return CPLSPrintf("%.2f MiB", bytes / (1024.0 * 1024.0));
}

std::string size(int width, int height)
{
    return std::to_string(width) + " x " + std::to_string(height);
}

void printGpu(const Gpu& gpu)
{
    const GpuCapabilities& found = gpu.capabilities;
    line("OpenGL vendor", found.vendor);
    line("OpenGL renderer", found.renderer + (found.isSoftware() ? " (software)" : " (hardware)"));
    line("OpenGL version", found.version);
    line("Platform", gpu.context->platform());
    line("Largest texture", size(found.maxTextureSize, found.maxTextureSize) + ", " +
                                std::to_string(found.maxArrayLayers) + " layers");
}

/// What the textures of one tile take; sky and sun on.
void printMemory(int width, int height, const LightingSettings& settings)
{
    const TileBytes bytes(width, height, settings);
    std::cout << "\nGraphics memory for " << size(width, height) << " posts, " << settings.azimuths
              << " azimuths, quality " << toString(settings.quality) << "\n";
    line("Heights", mebibytes(bytes.heights));
    line("Horizon map", mebibytes(bytes.map));
    line("Working space", mebibytes(bytes.working));
    line("Sky view", mebibytes(bytes.sky));
    line("Sun's horizon", mebibytes(bytes.sun));
    line("Shading", mebibytes(bytes.shading));
    line("All", mebibytes(bytes.all()));
}

void printRaster(const std::string& path, const DemInfo& info)
{
    std::cout << "\n";
    line("Raster", path);
    line("Format", info.driver + ", " + info.dataType + ", " + std::to_string(info.bandCount) +
                       (info.bandCount == 1 ? " band" : " bands"));
    line("Size", size(info.rasterWidth, info.rasterHeight));
    if (info.window.width != info.rasterWidth || info.window.height != info.rasterHeight)
        line("Window", size(info.window.width, info.window.height) + " at " +
                           std::to_string(info.window.column) + ", " +
                           std::to_string(info.window.row));
    line("CRS", info.crsName.empty() ? "unknown"
                                     : info.crsName + (info.geographic ? " (geographic)" : ""));
    line("Spacing", text(info.eastSpacing) + " m east, " + text(info.northSpacing) +
                        " m north, in the middle");
    line("Height unit", (info.heightUnit.empty() ? "not said: metres" : info.heightUnit) +
                            (info.depths ? ", downwards" : ""));
    if (info.scale != 1.0 || info.offset != 0.0)
        line("Stored as", "height = stored * " + text(info.scale) + " + " + text(info.offset));
    line("Nodata", info.noData ? text(*info.noData) : "none");
    if (info.statistics)
        line("Statistics", text((*info.statistics)[0]) + " ... " + text((*info.statistics)[1]) +
                               ", as stored in the file");
    for (const std::string& note : info.notes)
        line("Note", note);
}

void printHeights(const DemFile& dem, std::size_t notesPrinted)
{
    const DemTile& tile = dem.tile;
    line("Heights", text(dem.lowest) + " ... " + text(dem.highest) + " m");
    line("Void posts", std::to_string(tile.postCount() - tile.validCount()) + " of " +
                           std::to_string(tile.postCount()));
    for (std::size_t i = notesPrinted; i < dem.notes.size(); ++i)
        line("Note", dem.notes[i]);
}

/// Seconds that the sky-view factor of a tile takes, shaders compiled before.
Result<double> measureSkyView(const Gpu& gpu, const DemTile& tile, const LightingSettings& settings)
{
    SkyLight sky;
    sky.sunEnabled = false;
    const osg::ref_ptr<TileLight> light = new TileLight(tile, settings, sky);
    double seconds = 0.0;
    for (int run = 0; run < 2; ++run)
    {
        const auto start = std::chrono::steady_clock::now();
        light->touch();
        if (Status done = light->update(gpu.state()); !done)
            return done.error();
        if (Status done = gpu.finish(); !done)
            return done.error();
        seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    light->releaseGLObjects(&gpu.state());
    return seconds;
}

std::string duration(double seconds)
{
    return seconds < 100.0    ? CPLSPrintf("%.2g s", seconds)
           : seconds < 6000.0 ? CPLSPrintf("%.0f min", seconds / 60.0)
                              : CPLSPrintf("%.1f h", seconds / 3600.0);
}

/// A part in the middle, or a fractal of its size where no height in it is valid.
Result<DemTile> partOf(const Options& options, const DemInfo& info, int side)
{
    const PixelWindow& window = info.window;
    DemReadOptions read = options.read;
    PixelWindow part = {0, 0, std::min(side, window.width), std::min(side, window.height)};
    part.column = window.column + (window.width - part.width) / 2;
    part.row = window.row + (window.height - part.height) / 2;
    read.window = part;
    Result<DemFile> dem = readDem(options.input, read);
    if (dem)
        return std::move(dem->tile);
    return generateTerrain(TerrainKind::Fractal, part.width, part.height,
                           std::max(info.eastSpacing, 1e-3), 1);
}

/// What lighting all of a raster takes. Time: of the sky-view factor, by a short measurement.
Status printPlan(const Gpu& gpu, const Options& options, const DemInfo& info, bool onePiece)
{
    const PixelWindow& part = info.window;
    const double posts = double(part.width) * part.height;
    const ExtentOptions& extent = options.extent;
    const int side = onePiece                ? std::max(part.width, part.height)
                     : extent.windowSize > 0 ? extent.windowSize
                                             : windowSide(extent.memory, options.settings, 1);
    const WindowGrid grid(part.width, part.height, side);
    const int width = std::min(grid.windowWidth(), part.width);
    const int height = std::min(grid.windowHeight(), part.height);
    std::cout << "\nLighting it, " << options.settings.azimuths << " azimuths, quality "
              << toString(options.settings.quality) << ", with --memory "
              << text(std::floor(extent.memory / (1024.0 * 1024.0))) << "\n";
    line("Windows",
         onePiece ? "none: in one piece"
                  : std::to_string(grid.count()) + " of at most " + size(width, height) + " posts");
    line("Memory", mebibytes(runBytes(width, height, options.settings, 1)));
    if (!onePiece)
    {
        line("Disk for windows", "up to " + mebibytes(4.0 * posts) + " per band, until joined");
        line("Disk for levels",
             mebibytes(8.0 / 3.0 * double(info.rasterWidth) * info.rasterHeight) + ", kept");
    }
    const Result<DemTile> tile = partOf(options, info, 256);
    if (!tile)
        return tile.error();
    const Result<double> seconds = measureSkyView(gpu, *tile, options.settings);
    if (!seconds)
        return seconds.error();
    line("Time", "about " + duration(*seconds * posts / static_cast<double>(tile->postCount())) +
                     " for the sky-view factor, by " + size(tile->width(), tile->height()) +
                     " posts of it");
    return Nothing{};
}

/// Runs the horizons alone, at each quality: a warm-up, then the best of three.
Status printRates(const Gpu& gpu, const DemTile& tile, LightingSettings settings)
{
    std::cout << "\nHorizons of " << size(tile.width(), tile.height()) << " posts, "
              << settings.azimuths << " azimuths, best of 3 runs\n"
              << "quality   milliseconds   million pixel-azimuths/s   texture MiB\n";
    const AzimuthSet azimuths(settings.azimuths);
    std::vector<MapDirection> directions;
    for (int index = 0; index < azimuths.count(); ++index)
        directions.push_back(azimuths.direction(index));
    for (const auto quality : {HorizonQuality::Draft, HorizonQuality::Normal, HorizonQuality::Best})
    {
        settings.quality = quality;
        if (Status fits = checkFits(gpu, tile.width(), tile.height()); !fits)
            return fits;
        const HorizonScheme scheme = HorizonScheme::of(quality);
        const osg::ref_ptr<TileSurface> surface = new TileSurface(tile, HorizonNode::frame);
        const osg::ref_ptr<HorizonNode> node = new HorizonNode(
            "horizon", *surface, scheme, azimuths.count(), [&directions] { return directions; });
        double best = std::numeric_limits<double>::infinity();
        for (int run = 0; run < 4; ++run)
        {
            const auto start = std::chrono::steady_clock::now();
            if (Status done = node->run(gpu.state()); !done)
                return done;
            if (Status done = gpu.finish(); !done)
                return done;
            const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
            if (run > 0)
                best = std::min(best, took.count());
        }
        const double bytes =
            static_cast<double>(surface->heights()->bytes() + node->bytes() + node->workingBytes());
        std::cout << CPLSPrintf("%-9s %12.1f   %24.1f   %11.2f", toString(quality), best * 1e3,
                                static_cast<double>(tile.postCount()) * azimuths.count() / best *
                                    1e-6,
                                bytes / (1024.0 * 1024.0))
                  << std::endl;
        node->releaseGLObjects(&gpu.state());
        surface->releaseGLObjects(&gpu.state());
    }
    return Nothing{};
}

Status run(const Options& options)
{
    line("terrainlight", OSGTERRAINLIGHT_VERSION);
    line("GDAL", GDALVersionInfo("RELEASE_NAME"));
    line("OpenSceneGraph", osgGetVersion());
    const Result<Gpu> gpu = openGpu();
    if (gpu)
        printGpu(*gpu);

    DemTile tile;
    if (!options.input.empty())
    {
        const Result<DemInfo> info = describeDem(options.input, options.read);
        if (Status known = checkProj(options.input, info); !known)
            return known;
        if (!info)
            return info.error();
        printRaster(options.input, *info);
        for (const std::string& file : options.extent.surroundings)
        {
            const Result<DemInfo> far = describeDem(file);
            if (!far)
                return far.error();
            line("Surroundings", file + ", " + std::to_string(far->rasterWidth) + " x " +
                                     std::to_string(far->rasterHeight) + " posts");
        }
        const int width = info->window.width;
        const int height = info->window.height;
        const bool onePiece = fitsInOnePiece(width, height, options.settings, 1, options.extent);
        if (onePiece)
        {
            printMemory(width, height, options.settings);
            std::cout << std::endl;
            Result<DemFile> dem = readDem(options.input, options.read);
            if (!dem)
                return dem.error();
            printHeights(*dem, info->notes.size());
            tile = std::move(dem->tile);
        }
        else
        {
            Result<DemTile> part = partOf(options, *info, 1024);
            if (!part)
                return part.error();
            tile = std::move(*part);
        }
        if (gpu)
            if (Status planned = printPlan(*gpu, options, *info, onePiece); !planned)
                return planned;
    }
    else
        printMemory(1024, 1024, options.settings);
    std::cout << std::flush;
    if (!gpu)
        return gpu.error();
    if (!options.rate)
        return Nothing{};
    if (options.input.empty())
    {
        Result<DemTile> fractal = generateTerrain(TerrainKind::Fractal, 1024, 1024, 30.0, 1);
        if (!fractal)
            return fractal.error();
        tile = std::move(*fractal);
    }
    return printRates(*gpu, tile, options.settings);
}

} // namespace

Mode addInfo(CLI::App& tool)
{
    CLI::App* app = tool.add_subcommand(
        "info",
        "What there is: OpenGL, GDAL, a raster, and what lighting it takes: windows, memory, time. "
        "Also what the settings cost in graphics memory, and with --rate how fast horizons "
        "come");
    app->footer("Examples:\n"
                "  terrainlight info\n"
                "  terrainlight info dem.tif --azimuths 64\n"
                "  terrainlight info --rate\n"
                "  terrainlight info dem.tif -srcwin 0 0 1024 1024 --rate");
    const auto options = std::make_shared<Options>();
    app->add_option("INPUT", options->input, "DEM: any raster that GDAL reads")->type_name("");
    addTopic(*app, Topic::Horizons, options->settings);
    addReadOptions(*app, options->read);
    addExtentOptions(*app, options->extent, false);
    app->add_flag("--rate", options->rate,
                  "Times horizons at the three qualities, on INPUT or else a generated 1024 x 1024 "
                  "fractal");
    addConfig(*app);
    return {app, [options] { return run(*options); }};
}

} // namespace osgTerrainLight::tool
