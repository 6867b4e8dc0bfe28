#include "lighting/methods/Legendre.h"

#include "gpu/GlConstants.h"
#include "lighting/nodes/LegendreDirectNode.h"

namespace osgTerrainLight
{

Legendre::Legendre(const TileInputs& inputs, const TileSurface& surface, SkyTableNode* table)
    : _inputs(&inputs), _surface(&surface), _table(table)
{
}

void Legendre::declareDirect(WorkGraph::Nodes& nodes, Resource* direct, int bounces, Resource*)
{
    _bounces = bounces;
    _bounce = 0;
    _sends = direct;
    const LegendreScheme scheme = LegendreScheme::of(_inputs->settings);
    _pyramid = new PyramidNode(*_surface);
    _pyramid->neededWhere([in = _inputs] { return in->hasLight(); });
    _pyramid->follows(_inputs->settingsValue);
    nodes.emplace_back(_pyramid);
    nodes.emplace_back(new LegendreDirectNode(*_inputs, *_pyramid, scheme, direct));
    if (bounces > 0)
        _gather = new LegendreGather(*_pyramid, scheme);
}

osg::ref_ptr<Resource> Legendre::declareBounce(WorkGraph::Nodes& nodes)
{
    const bool isFirst = _bounce++ == 0;
    const int stride = _gather->scheme().stride;
    const osg::ref_ptr<LegendreSentNode> sent = new LegendreSentNode(
        *_inputs, *_surface, stride, _sends, !isFirst, isFirst && _inputs->isPaced());
    nodes.emplace_back(sent);
    const osg::ref_ptr<Resource> light =
        new Resource("light of a bounce", _surface->perPost(GL_RGBA16F_ARB));
    _sends = nullptr;
    if (_bounce < _bounces)
        _sends = new Resource("light of blocks", blockLayout(*_surface, stride));
    nodes.emplace_back(new LegendreBounceNode(*_pyramid, _gather, sent, light, _sends));
    return light;
}

} // namespace osgTerrainLight
