#include "lighting/sources/KeyLights.h"

#include "core/KeySlices.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;

int layersFor(const TileInputs& inputs)
{
    const auto count = directionsOf(keySlices(inputs.sky, inputs.settings.azimuths)).size();
    return std::max(1, static_cast<int>(count)); // an array without layers is none
}

/// What has horizons of its own is the slices' places; their light is read when it is needed.
std::vector<std::array<double, 3>> placesOf(const TileInputs& inputs)
{
    std::vector<std::array<double, 3>> found;
    for (const KeySlices& key : keySlices(inputs.sky, inputs.settings.azimuths))
        found.push_back({key.first, key.width, double(key.count)});
    return found;
}
} // namespace

KeyLights::KeyLights(const TileInputs& inputs, const TileSurface& surface)
    : _inputs(&inputs),
      _horizon(new HorizonNode(
          "key", surface, HorizonScheme::of(inputs.settings.quality), layersFor(inputs),
          [in = _inputs] { return directionsOf(keySlices(in->sky, in->settings.azimuths)); })),
      _places(placesOf(inputs))
{
    _horizon->follows(inputs.settingsValue);
    _horizon->follows(inputs.keyPlaces);
    _horizon->neededWhere([in = _inputs] { return in->hasKeyLights(); });
}

void KeyLights::bind(GpuPass& pass, std::vector<std::string>& defines) const
{
    pass.reads("keyHorizon", _horizon->horizon());
    const std::vector<KeySlices> keys = keySlices(_inputs->sky, _inputs->settings.azimuths);
    if (keys.empty())
        return;
    defines.emplace_back("KEY_LIGHTS");
    osg::ref_ptr<osg::Uniform> places =
        new osg::Uniform(osg::Uniform::FLOAT_VEC4, "keyPlaces", static_cast<int>(maxKeyLights));
    osg::ref_ptr<osg::Uniform> radiances =
        new osg::Uniform(osg::Uniform::FLOAT_VEC4, "keyRadiances", static_cast<int>(maxKeyLights));
    for (std::size_t i = 0; i < keys.size(); ++i)
    {
        const KeySlices& key = keys[i];
        const MapDirection first = directionOfCompass(key.first);
        places->setElement(static_cast<unsigned>(i),
                           osg::Vec4f(static_cast<float>(std::atan2(first.north, first.east)),
                                      static_cast<float>(key.width * radiansPerDegree),
                                      static_cast<float>(key.lowest * radiansPerDegree),
                                      static_cast<float>(key.highest * radiansPerDegree)));
        radiances->setElement(static_cast<unsigned>(i),
                              osg::Vec4f(key.radiance[0], key.radiance[1], key.radiance[2],
                                         static_cast<float>(key.count)));
    }
    pass.set(places);
    pass.set(radiances);
    pass.set("keyCount", static_cast<int>(keys.size()));
}

void KeyLights::follow(Invalidation stale)
{
    if (!meets(stale, Invalidation::Keys))
        return;
    const std::vector<std::array<double, 3>> places = placesOf(*_inputs);
    if (places == _places)
        return;
    _places = places;
    _horizon->setDirectionCount(layersFor(*_inputs));
    _inputs->keyPlaces->touch();
}

} // namespace osgTerrainLight
