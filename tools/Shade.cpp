#include "Picture.h"
#include "Pipeline.h"

#include "core/SkyRadiance.h"

#include <cmath>
#include <limits>

namespace osgTerrainLight::tool
{
namespace
{

struct Options : RasterOptions
{
    SkyLight sky;
    std::string skyFile;
    SunTime sun;
    Metadata sunMetadata; ///< of its time and place
};

Metadata metadataOf(const Options& options, const LitTile& lit)
{
    Metadata metadata =
        describe("shade", lit, options.sky.skyEnabled || !options.sky.keyLights.empty());
    const SkyLight& sky = options.sky;
    add(metadata, "SKY",
        !sky.skyEnabled             ? "none"
        : sky.environment           ? options.skyFile
        : !sky.skyHarmonics.empty() ? "harmonics"
                                    : toString(sky.skyModel));
    addAreaLights(metadata, options.sky);
    if (sky.skyEnabled && !sky.environment && sky.skyHarmonics.empty() &&
        sky.skyModel != SkyModel::Clear)
        addSetting(metadata, "sky-radiance", options.sky);
    addSetting(metadata, "bounces", options.settings);
    if (options.settings.bounces > 0 || options.settings.bounceMethod != BounceMethod::Slices)
    {
        addSetting(metadata, "bounce-method", options.settings);
        addSetting(metadata, "subsampling", options.settings);
    }
    if (options.settings.bounces > 0)
    {
        if (options.albedoFile.empty())
            addSetting(metadata, "albedo", options.settings);
        else
            add(metadata, "ALBEDO", options.albedoFile);
    }
    add(metadata, "SUN", options.sky.sunEnabled ? "yes" : "no");
    if (sky.sunEnabled || (sky.skyEnabled && sky.skyModel == SkyModel::Clear))
    {
        metadata.insert(metadata.end(), options.sunMetadata.begin(), options.sunMetadata.end());
        addSun(metadata, options.sky);
        addSetting(metadata, "sun-irradiance", options.sky);
    }
    if (isPicture(options.output))
        addSetting(metadata, "exposure", options.settings);
    return metadata;
}

Status run(const CLI::App& app, Options options)
{
    if (Status read = readSky(app, options.sky, options.skyFile); !read)
        return read;
    const bool chosen = options.maxError || options.maxMilliseconds;
    refuseIdle(app, idleSettings(options.settings));
    checkProblems(options.settings, options.sky,
                  chosen ? SettingsUse::Choice : SettingsUse::Lighting,
                  options.maxError ? "--max-error"
                  : chosen         ? "--max-ms"
                                   : "SETTINGS");
    refuseInputs({options.skyFile}, options.output);
    // A sun that is off still makes a clear sky.
    const bool clear = options.sky.skyEnabled && options.sky.skyModel == SkyModel::Clear;
    if (!options.sky.sunEnabled && !clear && options.sun.time)
        throw CLI::ValidationError("--time", "needs a sun: leave out --no-sun");
    if (Status placed = setSun(options.sky, options, options.sun, options.sunMetadata); !placed)
        return placed;
    Product product;
    product.mode = "shade";
    product.sky = options.sky;
    product.skyFile = options.skyFile;
    product.kind = isExr(options.output)       ? Product::Kind::Exr
                   : isPicture(options.output) ? Product::Kind::Picture
                                               : Product::Kind::Floats;
    product.gain = std::exp2(options.settings.exposure);
    product.bands = {{"red: irradiance / pi", ""},
                     {"green: irradiance / pi", ""},
                     {"blue: irradiance / pi", ""},
                     {"visible fraction of the sun", ""}};
    product.values = [](LitTile& lit)
    {
        const auto shading =
            std::make_shared<Raster<osg::Vec4f>>(lit.lighting->readShading(lit.state()));
        return [shading, &lit](int band)
        {
            const auto channel = static_cast<unsigned>(band - 1);
            Raster<float> values(shading->width(), shading->height());
            for (std::size_t i = 0; i < values.size(); ++i)
                values.values()[i] = lit.tile().validity()[i]
                                         ? shading->values()[i][channel]
                                         : std::numeric_limits<float>::quiet_NaN();
            return values;
        };
    };
    product.metadata = [&options](const LitTile& lit) { return metadataOf(options, lit); };
    return process(options, product);
}

} // namespace

Mode addShade(CLI::App& tool)
{
    CLI::App* app = tool.add_subcommand(
        "shade",
        "Light on the terrain, as floats or as a picture. Red, green, blue = irradiance / pi "
        "(times albedo it is the colour), "
        "fourth band = visible fraction of the sun. PNG, JPEG, WebP: an exposed sRGB picture. "
        "EXR: R, G, B, A, north first. Else: 4 float bands");
    app->footer("Examples:\n"
                "  terrainlight shade dem.tif shade.tif --sun 315,35\n"
                "  terrainlight shade dem.tif shade.png --sun 315,35 --exposure 0.5\n"
                "  terrainlight shade dem.tif noon.png --time 2024-06-21T12:00Z\n"
                "  terrainlight shade dem.tif glow.png --bounces 2 --albedo photo.tif\n"
                "  terrainlight shade dem.tif key.png --no-sun --key-light 300,30,20,50,6,4,2\n"
                "  terrainlight shade dem.tif sky.exr --no-sun --sky-radiance 1,1,1\n"
                "  terrainlight shade dem.tif day.png --sky clear --turbidity 3 --sun 120,30\n"
                "  terrainlight shade dem.tif studio.png --sky panorama.exr --sky-heading 90\n"
                "  terrainlight shade moon.tif moon.png --sky none --body-radius 1737400\n"
                "  terrainlight shade dem.tif sun.tif --sun 120,10 --sky none "
                "-co COMPRESS=DEFLATE");
    const auto options = std::make_shared<Options>();
    addRasterOptions(*app, *options);
    addBounces(*app, *options);
    addBudget(*app, *options);
    addSun(*app, options->sky);
    addSunTime(*app, options->sun);
    addSetting(*app, "sun-radius", options->sky);
    app->add_flag_function(
        "--no-sun", [options](std::int64_t) { options->sky.sunEnabled = false; }, "Sky light only");
    addSky(*app, options->sky, options->skyFile);
    addSetting(*app, "sun-irradiance", options->sky);
    addSetting(*app, "sky-radiance", options->sky);
    addAreaLights(*app, options->sky);
    addTopic(*app, Topic::Picture, options->settings);
    return {app, [app, options] { return run(*app, *options); }};
}

} // namespace osgTerrainLight::tool
