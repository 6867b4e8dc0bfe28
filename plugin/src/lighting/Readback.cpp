#include "lighting/Readback.h"

#include "gpu/Textures.h"

#include <cassert>
#include <limits>

namespace osgTerrainLight
{

std::vector<float> readColourValues(osg::State& state, const Resource& light)
{
    assert(light.texture());
    return readFloats(state, *light.texture(), 4);
}

Raster<osg::Vec4f> readColours(osg::State& state, const Resource& light)
{
    const std::vector<float> values = readColourValues(state, light);
    Raster<osg::Vec4f> colours(light.layout().width, light.layout().height);
    for (std::size_t i = 0; i < colours.size(); ++i)
        colours.values()[i] =
            osg::Vec4f(values[4 * i], values[4 * i + 1], values[4 * i + 2], values[4 * i + 3]);
    return colours;
}

Raster<float> readSkyView(osg::State& state, const Resource& view)
{
    assert(view.texture());
    Raster<float> factors(view.layout().width, view.layout().height);
    factors.values() = readFloats(state, *view.texture(), 1);
    for (float& factor : factors.values())
        if (factor <= -1.0f) // void
            factor = std::numeric_limits<float>::quiet_NaN();
    return factors;
}

HorizonMap readHorizons(osg::State& state, const Resource& horizon)
{
    assert(horizon.texture());
    const TextureLayout& layout = horizon.layout();
    HorizonMap map(layout.width, layout.height, layout.layers);
    map.codes() = readUnorm16(state, *horizon.texture());
    return map;
}

unsigned readCounter(osg::State& state, const Resource& counter)
{
    return counter.texture() ? readUints(state, *counter.texture()).front() : 0;
}

} // namespace osgTerrainLight
