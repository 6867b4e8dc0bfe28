#include "gpu/passes/PyramidRays.h"

#include "core/AzimuthSet.h"
#include "gpu/Textures.h"
#include "gpu/passes/GridDirection.h"
#include "gpu/passes/HorizonPass.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace osgTerrainLight
{

osg::ref_ptr<osg::Texture2D> setPyramidRays(GpuPass& pass, const DemTile& tile,
                                            const BounceScheme& scheme, int azimuths,
                                            osg::Texture2D* heights, const PyramidLayout& posts,
                                            osg::Texture2D* heightPyramid)
{
    constexpr std::size_t maxLevels = 16;
    assert(posts.levels.size() <= maxLevels);
    const AzimuthSet set(azimuths);
    Raster<float> lengths(azimuths, tile.height());
    std::vector<osg::Vec4f> directions(256);
    for (int k = 0; k < azimuths; ++k)
    {
        const MapDirection direction = set.direction(k);
        const GridDirection grid(tile, direction);
        const double along = grid.look;
        const double across = grid.look * grid.drift;
        directions[static_cast<std::size_t>(k)].set(static_cast<float>(grid.north ? across : along),
                                                    static_cast<float>(grid.north ? along : across),
                                                    static_cast<float>(direction.east),
                                                    static_cast<float>(direction.north));
        for (int row = 0; row < tile.height(); ++row)
            lengths.at(k, row) =
                static_cast<float>(grid.stepLength(tile.eastSpacing(row), tile.northSpacing));
    }
    osg::ref_ptr<osg::Texture2D> stepLengths = createFloatTexture(lengths);
    osg::ref_ptr<osg::Uniform> levels =
        new osg::Uniform(osg::Uniform::INT_VEC4, "levels", static_cast<int>(maxLevels));
    for (unsigned i = 0; i < posts.levels.size(); ++i)
    {
        const PyramidLayout::Level& level = posts.levels[i];
        levels->setElement(i, level.x, level.y, level.width, level.height);
    }
    const int reach = std::max(tile.width(), tile.height()) - 1;
    pass.reads("heights", heights);
    pass.reads("stepLengths", stepLengths);
    pass.reads("heightPyramid", heightPyramid);
    pass.set("size", tile.width(), tile.height());
    pass.set("frame", int(HorizonPass::frame));
    pass.setBlock(directions);
    pass.set(levels);
    pass.set("levelCount", static_cast<int>(posts.levels.size()));
    pass.set("samplesPerOctave", static_cast<float>(scheme.samplesPerOctave));
    pass.set("offset", static_cast<float>(scheme.offset));
    pass.set("sampleCount",
             reach < 1 ? 0 : 1 + static_cast<int>(scheme.samplesPerOctave * std::log2(reach)));
    return stepLengths;
}

} // namespace osgTerrainLight
