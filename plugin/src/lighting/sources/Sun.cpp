#include "lighting/sources/Sun.h"

#include "glsl_host.h"

#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;
} // namespace

std::array<MapDirection, 3> sunDirections(const SkyLight& sky)
{
    // SUN_SIDE of the disc's radius to either side, as an azimuth: less than 90 degrees, all around
    // where the disc holds the zenith.
    const double side = static_cast<double>(Glsl<float>::SUN_SIDE) * sky.sunAngularRadius;
    const double turn = std::atan2(std::sin(side * radiansPerDegree),
                                   std::cos(sky.sunElevation * radiansPerDegree)) /
                        radiansPerDegree;
    return {directionOfCompass(sky.sunAzimuth - turn), directionOfCompass(sky.sunAzimuth),
            directionOfCompass(sky.sunAzimuth + turn)};
}

Sun::Sun(const TileInputs& inputs, const TileSurface& surface)
    : _inputs(&inputs),
      _horizon(new HorizonNode("sun", surface, HorizonScheme::ofSun(inputs.settings.quality), 3,
                               [in = _inputs]
                               {
                                   const auto directions = sunDirections(in->sky);
                                   return std::vector<MapDirection>(directions.begin(),
                                                                    directions.end());
                               })),
      _edge(new ShadowEdgeNode(inputs, surface))
{
    _horizon->follows(inputs.settingsValue);
    _horizon->follows(inputs.sunPlace);
    _horizon->neededWhere([in = _inputs] { return in->hasSun(); });
    _edge->follows(inputs.settingsValue);
    _edge->follows(inputs.sunPlace);
    _edge->neededWhere(
        [in = _inputs, width = surface.width(), height = surface.height()]
        { return in->hasSun() && (in->settings.shadowEdges || in->bounces(width, height) > 0); });
}

void Sun::bind(GpuPass& pass, std::vector<std::string>& defines) const
{
    pass.reads("sunHorizon", _horizon->horizon());
    pass.reads("sunEdge", _edge->edge());
    pass.set("sunOff", _inputs->sky.sunEnabled ? 0.0f : 1.0f);
    if (!_inputs->hasSun())
        return;
    defines.emplace_back("SUN");
    const SkyLight sky = _inputs->lightAtGround();
    const std::array<double, 3> direction = sky.sunDirection();
    const Rgb& irradiance = sky.sunIrradiance;
    pass.set("sunIrradiance", osg::Vec3f(irradiance[0], irradiance[1], irradiance[2]));
    pass.set("sunDirection",
             osg::Vec3f(static_cast<float>(direction[0]), static_cast<float>(direction[1]),
                        static_cast<float>(direction[2])));
    pass.set("sunElevation", static_cast<float>(sky.sunElevation * radiansPerDegree));
    pass.set("sunRadius", static_cast<float>(sky.sunAngularRadius * radiansPerDegree));
}

} // namespace osgTerrainLight
