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

void setPyramidScan(GpuPass& pass, const BounceScheme& scheme, const PyramidNode& pyramid)
{
    const TileSurface& surface = pyramid.surface();
    const int reach = std::max(surface.width(), surface.height()) - 1;
    surface.bind(pass);
    pass.reads("heightPyramid", pyramid.pyramid());
    pass.set("levelCount", static_cast<int>(pyramid.layout().levels.size()));
    setLevels(pass, "levels", pyramid.layout());
    pass.set("samplesPerOctave", static_cast<float>(scheme.samplesPerOctave));
    pass.set("offset", static_cast<float>(scheme.offset));
    pass.set("sampleCount",
             reach < 1 ? 0 : 1 + static_cast<int>(scheme.samplesPerOctave * std::log2(reach)));
}

} // namespace osgTerrainLight
