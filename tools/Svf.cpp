#include "Pipeline.h"

namespace osgTerrainLight::tool
{
namespace
{

struct Options : RasterOptions
{
    std::string definition = "surface";
};

SkyViewDefinition definitionOf(const std::string& name)
{
    return name == "horizontal"    ? SkyViewDefinition::Horizontal
           : name == "solid-angle" ? SkyViewDefinition::SolidAngle
                                   : SkyViewDefinition::Surface;
}

Status run(const Options& options)
{
    Product product;
    product.mode = "svf";
    product.sky.sunEnabled = false;
    product.measured = SettingsTrial::Product::SkyView;
    product.definition = definitionOf(options.definition);
    product.bands = {{"sky-view factor (" + options.definition + ")", ""}};
    product.values = [](LitTile& lit)
    { return [&lit](int) { return lit.lighting->readSkyView(lit.state()); }; };
    product.metadata = [&options](const LitTile& lit)
    {
        Metadata metadata = describe("svf", lit, true);
        add(metadata, "DEFINITION", options.definition);
        return metadata;
    };
    return process(options, product);
}

} // namespace

Mode addSvf(CLI::App& tool)
{
    CLI::App* app =
        tool.add_subcommand("svf", "Sky-view factor, 0 to 1. There are three definitions in "
                                   "use; each is 1 on an open plane");
    app->footer("Examples:\n"
                "  terrainlight svf dem.tif svf.tif\n"
                "  terrainlight svf dem.tif svf.tif --definition solid-angle --azimuths 64\n"
                "  terrainlight svf dem.tif svf.tif -of COG -co COMPRESS=DEFLATE -q");
    const auto options = std::make_shared<Options>();
    addRasterOptions(*app, *options);
    addBudget(*app, *options);
    app->add_option("--definition", options->definition,
                    "surface (cosine to the surface normal: what lights the terrain), horizontal "
                    "(cosine to the zenith) or solid-angle (part of the hemisphere); default "
                    "surface")
        ->check(CLI::IsMember({"surface", "horizontal", "solid-angle"}))
        ->type_name("NAME");
    return {app, [options] { return run(*options); }};
}

} // namespace osgTerrainLight::tool
