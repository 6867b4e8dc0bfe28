#include "Pipeline.h"

#include "core/SyntheticTerrain.h"

#include <limits>

namespace osgTerrainLight::tool
{
namespace
{

struct Options
{
    std::string kind;
    OutputOptions output;
    int width = 1024, height = 1024;
    double spacing = 30.0;
    std::uint32_t seed = 1;
};

Status run(const Options& options)
{
    TerrainKind kind = TerrainKind::Fractal;
    fromString(options.kind, kind);
    RasterFrame frame;
    frame.width = options.width;
    frame.height = options.height;
    frame.hasGeoTransform = true;
    frame.geoTransform = {0.0, options.spacing, 0.0, options.height * options.spacing,
                          0.0, -options.spacing};
    if (Status writable = checkOutput(options.output, 0, frame); !writable)
        return writable;
    Progress progress(options.output.quiet);
    progress.reach(0.0);
    Result<DemTile> tile =
        generateTerrain(kind, options.width, options.height, options.spacing, options.seed);
    if (!tile)
        throw CLI::ValidationError("generate", tile.error().message);

    Metadata metadata = {{"TIFFTAG_SOFTWARE", "osgTerrainLight " OSGTERRAINLIGHT_VERSION}};
    add(metadata, "VERSION", OSGTERRAINLIGHT_VERSION);
    add(metadata, "MODE", "generate");
    add(metadata, "KIND", options.kind);
    add(metadata, "SPACING", text(options.spacing));
    add(metadata, "SEED", std::to_string(options.seed));
    const auto heights = [&](int)
    {
        Raster<float> values(tile->width(), tile->height());
        for (std::size_t i = 0; i < values.size(); ++i)
            values.values()[i] =
                static_cast<float>(tile->heightOrigin + static_cast<double>(tile->heights()[i]));
        return values;
    };
    const auto fraction = [&progress](double done) { progress.reach(0.8 + 0.2 * done); };
    if (Status written = writeBands(options.output, frame, {{options.kind + " terrain", "m"}},
                                    metadata, heights, fraction);
        !written)
        return written;
    progress.reach(1.0);
    return Nothing{};
}

} // namespace

Mode addGenerate(CLI::App& tool)
{
    CLI::App* app = tool.add_subcommand(
        "generate", "A synthetic DEM. Float32 metres, without CRS; the same arguments give the "
                    "same heights everywhere");
    app->footer("Examples:\n"
                "  terrainlight generate fractal mountains.tif\n"
                "  terrainlight generate cliffs cliffs.tif --size 512,256 --spacing 10 --seed 7");
    const auto options = std::make_shared<Options>();
    std::vector<std::string> kinds;
    for (const TerrainKind kind : allTerrainKinds())
        kinds.emplace_back(toString(kind));
    app->add_option("KIND", options->kind, "fractal, crater, cliffs or spikes")
        ->required()
        ->check(CLI::IsMember(kinds))
        ->type_name("");
    app->add_option("OUTPUT", options->output.path, "File to write")->required()->type_name("");
    addSize(*app, options->width, options->height, "Posts; one number: a square; default 1024");
    addLimitedNumbers(*app, "--spacing", "METRES", {{"spacing", 0.001, 10000.0, false}},
                      "Distance between posts, 0.001 ... 10000; default 30",
                      [options](const auto& v) { options->spacing = v[0]; });
    addLimitedNumbers(*app, "--seed", "N", {{"seed", 0.0, 4294967295.0, true}},
                      "Which of the terrains of a kind; default 1",
                      [options](const auto& v)
                      { options->seed = static_cast<std::uint32_t>(v[0]); });
    addOutputOptions(*app, options->output);
    return {app, [options] { return run(*options); }};
}

} // namespace osgTerrainLight::tool
