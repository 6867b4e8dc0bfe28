#include "Terrain.h"

namespace osgTerrainLight::tool
{

bool seesOutside(const RasterOptions& options, const DemInfo& info)
{
    const bool isPart =
        info.window.width < info.rasterWidth || info.window.height < info.rasterHeight;
    return !options.extent.surroundings.empty() || (isPart && !options.extent.isolated);
}

Result<std::unique_ptr<RasterSource>> openTerrain(const RasterOptions& options,
                                                  std::function<void(double)> progress)
{
    RasterSourceOptions source;
    source.read = options.read;
    source.read.progress = [progress](double fraction)
    {
        progress(fraction);
        return true;
    };
    source.cacheFolder = options.extent.cache;
    source.surroundings = options.extent.surroundings;
    source.beyondWindow = !options.extent.isolated;
    return RasterSource::open(options.input, source);
}

std::shared_ptr<const TileWindows> aloneOf(DemTile tile)
{
    auto windows = std::make_shared<TileWindows>();
    windows->place = windows->near = {0, 0, tile.width(), tile.height()};
    windows->lastColumn = tile.width() - 1;
    windows->lastRow = tile.height() - 1;
    windows->middleColumn = 0.5 * windows->lastColumn;
    windows->middleRow = 0.5 * windows->lastRow;
    windows->tile = std::move(tile);
    return windows;
}

} // namespace osgTerrainLight::tool
