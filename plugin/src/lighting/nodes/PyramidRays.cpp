#include "lighting/nodes/PyramidRays.h"

#include "lighting/nodes/GridDirection.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace osgTerrainLight
{

std::vector<osg::Vec4f> raySteps(double eastSpacing, double northSpacing,
                                 const std::vector<MapDirection>& directions)
{
    std::vector<osg::Vec4f> steps;
    for (const MapDirection& direction : directions)
    {
        const GridDirection grid(eastSpacing, northSpacing, direction);
        const double along = grid.look;
        const double across = grid.look * grid.drift;
        steps.emplace_back(static_cast<float>(grid.north ? across : along),
                           static_cast<float>(grid.north ? along : across),
                           static_cast<float>(direction.east), static_cast<float>(direction.north));
    }
    return steps;
}

std::vector<MapDirection> directionsOf(const AzimuthSet& set)
{
    std::vector<MapDirection> directions;
    for (int k = 0; k < set.count(); ++k)
        directions.push_back(set.direction(k));
    return directions;
}

void setPyramidScan(GpuPass& pass, const DemTile& tile, const BounceScheme& scheme,
                    const HeightPyramid& pyramid, osg::Texture2D* eastSpacings)
{
    const int reach = std::max(tile.width(), tile.height()) - 1;
    pass.reads("heights", pyramid.heights());
    pass.reads("eastSpacings", eastSpacings);
    pass.reads("heightPyramid", pyramid.texture());
    pass.set("northSpacing", static_cast<float>(tile.northSpacing));
    pass.set("size", tile.width(), tile.height());
    pass.set("frame", pyramid.frame());
    pass.set("levelCount", static_cast<int>(pyramid.layout().levels.size()));
    setLevels(pass, "levels", pyramid.layout());
    pass.set("samplesPerOctave", static_cast<float>(scheme.samplesPerOctave));
    pass.set("offset", static_cast<float>(scheme.offset));
    pass.set("sampleCount",
             reach < 1 ? 0 : 1 + static_cast<int>(scheme.samplesPerOctave * std::log2(reach)));
}

} // namespace osgTerrainLight
