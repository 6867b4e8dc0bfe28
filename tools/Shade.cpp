#include "Pipeline.h"

#include "core/SkyRadiance.h"

#include "io/ExrFile.h"

#include <cpl_conv.h>
#include <cpl_string.h>

#include <algorithm>
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

bool isPicture(const OutputOptions& output)
{
    const std::string kind =
        output.format.empty() ? CPLGetExtension(output.path.c_str()) : output.format;
    for (const char* picture : {"png", "jpg", "jpeg", "webp"})
        if (EQUAL(kind.c_str(), picture))
            return true;
    return false;
}

/// 8 bits of a linear value in 0 … 1, encoded as IEC 61966-2-1 has it.
std::uint8_t srgb8(double linear)
{
    const double value = std::clamp(linear, 0.0, 1.0);
    const double encoded =
        value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(255.0 * encoded));
}

Status writeFloats(const Options& options, const Metadata& metadata, const LitDem& lit,
                   const Raster<osg::Vec4f>& shading, Progress& progress)
{
    const auto band = [&](int number)
    {
        const auto channel = static_cast<unsigned>(number - 1);
        Raster<float> values(shading.width(), shading.height());
        for (std::size_t i = 0; i < values.size(); ++i)
            values.values()[i] = lit.dem.tile.validity()[i]
                                     ? shading.values()[i][channel]
                                     : std::numeric_limits<float>::quiet_NaN();
        return values;
    };
    return writeBands(options.output, lit.dem.frame,
                      {{"red: irradiance / pi", ""},
                       {"green: irradiance / pi", ""},
                       {"blue: irradiance / pi", ""},
                       {"visible fraction of the sun", ""}},
                      metadata, progress, band);
}

Status writeExrFile(const Options& options, const Metadata& metadata, const LitDem& lit,
                    const Raster<osg::Vec4f>& shading)
{
    ExrImage image;
    image.width = shading.width();
    image.height = shading.height();
    image.text.insert(metadata.begin(), metadata.end());
    if (!lit.dem.frame.crs.empty())
        image.text["TERRAINLIGHT_CRS"] = lit.dem.frame.crs;
    if (lit.dem.frame.coordinateEpoch > 0.0)
        image.text["TERRAINLIGHT_COORDINATE_EPOCH"] = text(lit.dem.frame.coordinateEpoch);
    for (unsigned c = 0; c < 4; ++c)
    {
        ExrChannel channel = {std::string(1, "RGBA"[c]), {}};
        for (int row = image.height - 1; row >= 0; --row)
            for (int column = 0; column < image.width; ++column)
                channel.values.push_back(shading.at(column, row)[c]);
        image.channels.push_back(std::move(channel));
    }
    const DeferredSignals deferred;
    return writeExr(options.output.path, image);
}

/// Void is transparent; where nothing is void there is no alpha, and in a JPEG void is black.
Status writePicture(const Options& options, const Metadata& metadata, const LitDem& lit,
                    const Raster<osg::Vec4f>& shading)
{
    const std::vector<std::uint8_t>& valid = lit.dem.tile.validity();
    const bool hasAlpha = lit.dem.tile.validCount() < valid.size() &&
                          !EQUAL(options.output.format.c_str(), "JPEG") &&
                          !EQUAL(CPLGetExtension(options.output.path.c_str()), "jpg") &&
                          !EQUAL(CPLGetExtension(options.output.path.c_str()), "jpeg");
    const double gain = std::exp2(options.settings.exposure);
    std::vector<std::uint8_t> pixels;
    pixels.reserve(valid.size() * 4);
    for (std::size_t i = 0; i < valid.size(); ++i)
    {
        for (unsigned c = 0; c < 3; ++c)
            pixels.push_back(srgb8(gain * static_cast<double>(shading.values()[i][c])));
        if (hasAlpha)
            pixels.push_back(valid[i] ? 255 : 0);
    }
    const DeferredSignals deferred;
    return writeRgb8(options.output.path, lit.dem.frame, pixels,
                     writeOptions(options.output, metadata));
}

Metadata metadataOf(const Options& options, const LitDem& lit)
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
    const auto write = [&](LitDem& lit, Progress& progress)
    {
        const Raster<osg::Vec4f> shading = lit.lighting->readShading(lit.gpu.state());
        const Metadata metadata = metadataOf(options, lit);
        if (isExr(options.output))
            return writeExrFile(options, metadata, lit, shading);
        if (isPicture(options.output))
            return writePicture(options, metadata, lit, shading);
        return writeFloats(options, metadata, lit, shading, progress);
    };
    const int bands = isExr(options.output) || isPicture(options.output) ? 0 : 4;
    return process("shade", options, options.sky, SettingsTrial::Product::Shading,
                   SkyViewDefinition::Surface, bands, write);
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
