#include "lighting/nodes/AreaLights.h"

#include "core/SkyRadiance.h"

#include <array>
#include <cassert>
#include <cmath>

namespace osgTerrainLight
{

Rgb skyGain(const SkyLight& sky)
{
    return !sky.skyEnabled ? Rgb{} : skyHasTable(sky) ? Rgb{1.0f, 1.0f, 1.0f} : sky.skyRadiance;
}

osg::ref_ptr<osg::Uniform> harmonicsUniform(const std::vector<Rgb>& harmonics)
{
    assert(harmonics.size() <= 16);
    osg::ref_ptr<osg::Uniform> uniform =
        new osg::Uniform(osg::Uniform::FLOAT_VEC3, "harmonics", 16);
    for (unsigned i = 0; i < 16; ++i)
    {
        const Rgb c = i < harmonics.size() ? harmonics[i] : Rgb{};
        uniform->setElement(i, osg::Vec3f(c[0], c[1], c[2]));
    }
    return uniform;
}

void AreaLights::apply(GpuPass& pass, std::vector<std::string> defines) const
{
    if (skyTable)
        defines.push_back("SKY_TABLE");
    if (keyHorizon)
        defines.push_back("KEY_LIGHTS");
    if (sunHorizon)
        defines.push_back("SUN");
    pass.setDefines(std::move(defines));
    pass.reads("skyTable", skyTable);
    pass.reads("keyHorizon", keyHorizon);
    pass.reads("sunHorizon", sunHorizon);
    constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;
    if (sunHorizon)
    {
        const std::array<double, 3> direction = sky.sunDirection();
        const Rgb& irradiance = sky.sunIrradiance;
        pass.set("sunIrradiance", osg::Vec3f(irradiance[0], irradiance[1], irradiance[2]));
        pass.set("sunDirection",
                 osg::Vec3f(static_cast<float>(direction[0]), static_cast<float>(direction[1]),
                            static_cast<float>(direction[2])));
        pass.set("sunElevation", static_cast<float>(sky.sunElevation * radiansPerDegree));
        pass.set("sunRadius", static_cast<float>(sky.sunAngularRadius * radiansPerDegree));
    }
    if (!keyHorizon)
        return;
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

} // namespace osgTerrainLight
