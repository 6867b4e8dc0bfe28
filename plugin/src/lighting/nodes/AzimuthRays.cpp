#include "lighting/nodes/AzimuthRays.h"

#include "core/AzimuthSet.h"
#include "gpu/Textures.h"
#include "lighting/nodes/GridDirection.h"

#include <cmath>

namespace osgTerrainLight
{

std::vector<osg::Vec4f> azimuthRays(const DemTile& tile, int azimuths)
{
    const AzimuthSet set(azimuths);
    std::vector<osg::Vec4f> rays(maxAzimuths);
    for (int k = 0; k < azimuths; ++k)
    {
        const GridDirection grid(tile, set.direction(k));
        rays[static_cast<std::size_t>(k)].set(static_cast<float>(grid.drift),
                                              static_cast<float>(grid.look),
                                              grid.north ? 1.0f : 0.0f, 0.0f);
    }
    return rays;
}

int lineCount(const DemTile& tile, const osg::Vec4f& ray)
{
    const bool north = ray.z() != 0.0f;
    const int steps = north ? tile.height() : tile.width();
    const int breadth = north ? tile.width() : tile.height();
    return 2 + breadth + static_cast<int>(std::abs(ray.x()) * static_cast<float>(steps));
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
