#include "Pipeline.h"

#include "core/AzimuthSet.h"

#include <cmath>
#include <limits>

namespace osgTerrainLight::tool
{
namespace
{

/// Above each post's own horizontal: on a planet it is not the one of the middle of all that is
/// lit, to which the map refers.
Raster<float> bandOf(const HorizonMap& map, int azimuth, const TileWindows& terrain,
                     double bodyRadius)
{
    const DemTile& tile = terrain.tile;
    const PostRect& place = terrain.place;
    const double middleColumn = terrain.middleColumn - place.column;
    const double middleRow = terrain.middleRow - place.row;
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
                    const double east = (column - middleColumn) * tile.eastSpacing(row);
                    const double north = (row - middleRow) * tile.northSpacing;
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
    Product product;
    product.mode = "horizon";
    product.sky.sunEnabled = false;
    for (int band = 0; band < azimuths.count(); ++band)
        product.bands.push_back({"horizon elevation at azimuth " +
                                     text(azimuths.compassDegreesOfBand(band)) +
                                     " degrees clockwise from north",
                                 "degree"});
    product.values = [&azimuths](LitTile& lit)
    {
        const auto map = std::make_shared<HorizonMap>(lit.lighting->readHorizons(lit.state()));
        return [map, &lit, &azimuths](int band) {
            return bandOf(*map, azimuths.indexOfBand(band - 1), *lit.terrain,
                          lit.settings.bodyRadius);
        };
    };
    product.metadata = [](const LitTile& lit) { return describe("horizon", lit, true); };
    return process(options, product);
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
