#include "Pipeline.h"

#include <limits>

namespace osgTerrainLight::tool
{
namespace
{

struct Options : RasterOptions
{
    SkyLight sky;
    SunTime sun;
};

Status run(Options& options)
{
    Metadata sun;
    if (Status placed = setSun(options.sky, options, options.sun, sun); !placed)
        return placed;
    Product product;
    product.mode = "shadow";
    product.sky = options.sky;
    product.measured = SettingsTrial::Product::SunFraction;
    product.bands = {{"visible fraction of the sun at azimuth " + text(options.sky.sunAzimuth) +
                          ", elevation " + text(options.sky.sunElevation) + " degrees",
                      ""}};
    product.values = [](LitTile& lit)
    {
        return [&lit](int)
        {
            const Raster<osg::Vec4f> shading = lit.lighting->readShading(lit.state());
            Raster<float> visible(shading.width(), shading.height());
            for (std::size_t i = 0; i < visible.size(); ++i)
                visible.values()[i] = lit.tile().validity()[i]
                                          ? shading.values()[i].w()
                                          : std::numeric_limits<float>::quiet_NaN();
            return visible;
        };
    };
    product.metadata = [&](const LitTile& lit)
    {
        Metadata metadata = describe("shadow", lit, false);
        metadata.insert(metadata.end(), sun.begin(), sun.end());
        addSun(metadata, options.sky);
        return metadata;
    };
    return process(options, product);
}

} // namespace

Mode addShadow(CLI::App& tool)
{
    CLI::App* app =
        tool.add_subcommand("shadow", "Visible fraction of the sun's disc, from 0 in shadow to 1");
    app->footer("Examples:\n"
                "  terrainlight shadow dem.tif shadow.tif --sun 225,20\n"
                "  terrainlight shadow dem.tif june.tif --time 2024-06-21T06:30+02:00\n"
                "  terrainlight shadow dem.tif soft.tif --sun 225,20 --sun-radius 2");
    const auto options = std::make_shared<Options>();
    options->sky.skyEnabled = false;
    addRasterOptions(*app, *options, false);
    addBudget(*app, *options);
    addSun(*app, options->sky);
    addSunTime(*app, options->sun);
    addSetting(*app, "sun-radius", options->sky);
    return {app, [options] { return run(*options); }};
}

} // namespace osgTerrainLight::tool
