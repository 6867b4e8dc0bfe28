#include "Common.h"

#include "core/AzimuthSet.h"

#include <limits>

namespace osgTerrainLight::tool
{
namespace
{

Raster<float> bandOf(const HorizonMap& map, int azimuth)
{
    Raster<float> values(map.width(), map.height(), std::numeric_limits<float>::quiet_NaN());
    for (int row = 0; row < map.height(); ++row)
        for (int column = 0; column < map.width(); ++column)
            if (map.isValid(column, row))
                values.at(column, row) = static_cast<float>(map.elevationAt(column, row, azimuth));
    return values;
}

Status run(const RasterOptions& options)
{
    const AzimuthSet azimuths(options.settings.azimuths);
    std::vector<BandLabel> labels;
    for (int band = 0; band < azimuths.count(); ++band)
        labels.push_back({"horizon elevation at azimuth " +
                              text(azimuths.compassDegreesOfBand(band)) +
                              " degrees clockwise from north",
                          "degree"});
    SkyLight sky;
    sky.sunEnabled = false;
    const auto write = [&](LitTile& lit, Progress& progress)
    {
        const HorizonMap map = lit.lighting->readHorizons(lit.gpu.state());
        return writeBands(options.output, lit.dem.frame, labels, describe("horizon", lit, true),
                          progress,
                          [&](int band) { return bandOf(map, azimuths.indexOfBand(band - 1)); });
    };
    return process("horizon", options, sky, SettingsTrial::Product::Shading,
                   SkyViewDefinition::Surface, azimuths.count(), write);
}

} // namespace

Mode addHorizon(CLI::App& tool)
{
    CLI::App* app = tool.add_subcommand(
        "horizon", "Horizon elevation per azimuth. N bands, degrees above the horizontal, negative "
                   "where it lies below; band k looks (k - 1)*360/N degrees clockwise from north");
    app->footer("Examples:\n"
                "  terrainlight horizon dem.tif horizon.tif --azimuths 36\n"
                "  terrainlight horizon dem.tif horizon.tif --azimuths 64 --quality best "
                "-co COMPRESS=DEFLATE\n"
                "  terrainlight horizon /vsizip/N46E009.hgt.zip part.tif -srcwin 100 100 512 512");
    const auto options = std::make_shared<RasterOptions>();
    addRasterOptions(*app, *options);
    return {app, [options] { return run(*options); }};
}

} // namespace osgTerrainLight::tool
