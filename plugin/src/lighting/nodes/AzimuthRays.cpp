#include "lighting/nodes/AzimuthRays.h"

#include "core/AzimuthSet.h"
#include "gpu/Textures.h"
#include "lighting/TileWindows.h"

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{

std::vector<osg::Vec4f> azimuthRays(const TileSurface& surface, int azimuths)
{
    const AzimuthSet set(azimuths);
    std::vector<osg::Vec4f> rays(maxAzimuths);
    for (int k = 0; k < azimuths; ++k)
    {
        const GridDirection grid(surface.tile(), set.direction(k));
        rays[static_cast<std::size_t>(k)].set(
            static_cast<float>(grid.drift), static_cast<float>(grid.look), grid.north ? 1.0f : 0.0f,
            static_cast<float>(lineShift(surface, grid, 1)));
    }
    return rays;
}

int lineCount(const TileSurface& surface, const osg::Vec4f& ray)
{
    const bool north = ray.z() != 0.0f;
    const int steps = north ? surface.height() : surface.width();
    const int breadth = north ? surface.width() : surface.height();
    return 2 + breadth + static_cast<int>(std::abs(ray.x()) * static_cast<float>(steps)) +
           (surface.windows() ? 1 : 0);
}

namespace
{
/// Steps along the major axis between the terrain's end towards + and the tile's.
double stepsBeyond(const TileSurface& surface, const GridDirection& grid)
{
    const TileWindows& windows = *surface.windows();
    return grid.north ? windows.lastRow - (windows.place.endRow() - 1)
                      : windows.lastColumn - (windows.place.endColumn() - 1);
}

int stepsBelow(const TileSurface& surface, const GridDirection& grid)
{
    const PostRect& place = surface.windows()->place;
    return grid.north ? place.row : place.column;
}
} // namespace

double lineShift(const TileSurface& surface, const GridDirection& grid, int linesPerPost)
{
    if (!surface.windows())
        return 0.0;
    const double shift =
        std::max(grid.drift, 0.0) * (stepsBeyond(surface, grid) + stepsBelow(surface, grid)) -
        grid.drift * stepsBelow(surface, grid);
    const double between = 1.0 / linesPerPost;
    return shift - between * std::floor(shift / between);
}

int stepsBefore(const TileSurface& surface, const GridDirection& grid)
{
    if (!surface.windows())
        return 0;
    return grid.look > 0 ? static_cast<int>(std::floor(stepsBeyond(surface, grid)))
                         : stepsBelow(surface, grid);
}

osg::ref_ptr<Resource> createStepLengths(const TileSurface& surface, int azimuths)
{
    const osg::ref_ptr<const TileSurface> held = &surface;
    return new Resource("step lengths",
                        [held, azimuths]() -> osg::ref_ptr<osg::Texture>
                        {
                            const DemTile& tile = held->tile();
                            const AzimuthSet set(azimuths);
                            Raster<float> lengths(azimuths, tile.height());
                            for (int k = 0; k < azimuths; ++k)
                            {
                                const GridDirection grid(tile, set.direction(k));
                                for (int row = 0; row < tile.height(); ++row)
                                    lengths.at(k, row) = static_cast<float>(
                                        grid.stepLength(tile.eastSpacing(row), tile.northSpacing));
                            }
                            return createFloatTexture(lengths);
                        });
}

} // namespace osgTerrainLight
