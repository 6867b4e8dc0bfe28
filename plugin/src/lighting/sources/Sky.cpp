#include "lighting/sources/Sky.h"

#include "lighting/nodes/PyramidRays.h"

namespace osgTerrainLight
{

Sky::Sky(const TileInputs& inputs, const TileSurface& surface, SkyTableNode* table)
    : _inputs(&inputs),
      _horizon(new HorizonNode(
          "horizon", surface, HorizonScheme::of(inputs.settings.quality), inputs.settings.azimuths,
          [in = _inputs] { return directionsOf(AzimuthSet(in->settings.azimuths)); })),
      _table(table), _view(new SkyViewNode(inputs, surface, _horizon->horizon(), table->table()))
{
    _horizon->follows(inputs.settingsValue);
    const int width = surface.width();
    const int height = surface.height();
    _horizon->neededWhere([in = _inputs, width, height]
                          { return in->hasSky() || in->bounces(width, height) > 0; });
    _view->neededWhere([in = _inputs] { return in->hasSky(); });
}

void Sky::bind(GpuPass& pass, std::vector<std::string>& defines) const
{
    if (_inputs->hasSkyTable())
        defines.emplace_back("SKY_TABLE");
    pass.reads("skyTable", _table->table());
    const Rgb gain = skyGain(_inputs->sky);
    pass.set("skyRadiance", osg::Vec3f(gain[0], gain[1], gain[2]));
    pass.set("hasSky", _inputs->hasSky());
}

void Sky::follow(Invalidation)
{
    _view->followFormat();
}

} // namespace osgTerrainLight
