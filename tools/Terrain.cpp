#include "Terrain.h"

#include "Windows.h"

namespace osgTerrainLight::tool
{

Result<std::unique_ptr<Terrain>> Terrain::open(const RasterOptions& options, const DemInfo& info,
                                               std::function<void(double)>)
{
    return std::unique_ptr<Terrain>(new Terrain(options, info));
}

bool Terrain::isSeen(const RasterOptions& options, const DemInfo& info)
{
    const bool isPart =
        info.window.width < info.rasterWidth || info.window.height < info.rasterHeight;
    return !options.extent.surroundings.empty() || (isPart && !options.extent.isolated);
}

// A stand-in until RasterSource and readWindows() exist: a tile that sees nothing but itself.
Result<std::shared_ptr<const TileWindows>> Terrain::read(const PixelWindow& pixels)
{
    const DemInfo part = infoOf(pixels, _info);
    DemReadOptions read = _options.read;
    read.window = part.window;
    Result<DemFile> dem = readDem(_options.input, read);
    auto windows = std::make_shared<TileWindows>();
    if (dem)
        windows->tile = std::move(dem->tile);
    else if (dem.error().message.find("no valid height") != std::string::npos)
        windows->tile = DemTile(pixels.width, pixels.height, _info.northSpacing);
    else
        return dem.error();
    windows->place = postsOf(pixels, _info.frame);
    windows->whole = {0, 0, _info.frame.width, _info.frame.height};
    return std::shared_ptr<const TileWindows>(windows);
}

std::shared_ptr<const TileWindows> aloneOf(DemTile tile)
{
    auto windows = std::make_shared<TileWindows>();
    windows->place = windows->whole = {0, 0, tile.width(), tile.height()};
    windows->tile = std::move(tile);
    return windows;
}

osg::ref_ptr<TileLight> newLight(const std::shared_ptr<const TileWindows>& terrain,
                                 const LightingSettings& settings, const SkyLight& sky,
                                 SkyViewDefinition definition)
{
    return new TileLight(terrain->tile, settings, sky, definition);
}

} // namespace osgTerrainLight::tool
