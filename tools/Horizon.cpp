#include "Pipeline.h"

#include "core/AzimuthSet.h"

#include <cmath>
#include <limits>

namespace osgTerrainLight::tool
{
namespace
{

/// Above each post's own horizontal: on a planet it is not the one of the tile's middle, to which
/// the map refers.
Raster<float> bandOf(const HorizonMap& map, int azimuth, const DemTile& tile, double bodyRadius)
{
    constexpr double degreesPerRadian = 180.0 / 3.14159265358979323846;
    const MapDirection direction = AzimuthSet(map.azimuthCount()).direction(azimuth);
    Raster<float> values(map.width(), map.height(), std::numeric_limits<float>::quiet_NaN());
    for (int row = 0; row < map.height(); ++row)
        for (int column = 0; column < map.width(); ++column)
            if (map.isValid(column, row))
            {
                double elevation = map.elevationAt(column, row, azimuth);
                if (bodyRadius > 0.0)
                {
                    const double east = (column - 0.5 * (tile.width() - 1)) * tile.eastSpacing(row);
                    const double north = (row - 0.5 * (tile.height() - 1)) * tile.northSpacing;
                    const double tilt =
                        (east * direction.east + north * direction.north) / bodyRadius;
                    elevation =
                        std::atan(std::tan(elevation / degreesPerRadian) + tilt) * degreesPerRadian;
                }
                values.at(column, row) = static_cast<float>(elevation);
            }
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
    const auto write = [&](LitDem& lit, Progress& progress)
    {
        const HorizonMap map = lit.lighting->readHorizons(lit.gpu.state());
        return writeBands(options.output, lit.dem.frame, labels, describe("horizon", lit, true),
                          progress,
                          [&](int band) {
                              return bandOf(map, azimuths.indexOfBand(band - 1), lit.dem.tile,
                                            lit.settings.bodyRadius);
                          });
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
