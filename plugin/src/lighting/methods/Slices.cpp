#include "lighting/methods/Slices.h"

#include "gpu/GlConstants.h"
#include "lighting/nodes/ScreenEdgesNode.h"
#include "lighting/nodes/ShadeNode.h"
#include "lighting/sources/KeyLights.h"
#include "lighting/sources/Sun.h"

namespace osgTerrainLight
{

Slices::Slices(const TileInputs& inputs, const TileSurface& surface, SkyTableNode* table)
    : _inputs(&inputs), _surface(&surface),
      _sky(new Sky(inputs, surface, table)), _lights{_sky, new KeyLights(inputs, surface),
                                                     new Sun(inputs, surface)}
{
}

WorkGraph::Nodes Slices::sources() const
{
    WorkGraph::Nodes nodes;
    for (const auto& light : _lights)
        for (const auto& node : light->nodes())
            nodes.push_back(node);
    return nodes;
}

std::vector<HorizonNode*> Slices::horizons() const
{
    std::vector<HorizonNode*> all;
    for (const auto& light : _lights)
        if (HorizonNode* horizon = light->horizon())
            all.push_back(horizon);
    return all;
}

void Slices::follow(Invalidation stale)
{
    for (const auto& light : _lights)
        light->follow(stale);
}

void Slices::declareDirect(WorkGraph::Nodes& nodes, Resource* direct, int bounces,
                           Resource* lightOfGloss)
{
    _bounces = bounces;
    _bounce = 0;
    _light = direct;
    _lightOfGloss = lightOfGloss;
    _gloss = nullptr;
    _pyramid = nullptr;
    _rays = nullptr;
    _first = _next = nullptr;
    if (bounces > 0)
    {
        const int azimuths = _inputs->settings.azimuths;
        const SweepScratch scratch(*_surface, azimuths);
        _first = new BounceSweep(*_inputs, *_surface, _lights, horizon(), scratch, true);
        _next = new BounceSweep(*_inputs, *_surface, {}, horizon(), scratch, false);
        if (_inputs->isGlossy())
        {
            _pyramid = new PyramidNode(*_surface);
            _pyramid->follows(_inputs->settingsValue);
            nodes.emplace_back(_pyramid);
            _rays = new BounceRays(*_pyramid, BounceScheme::of(_inputs->settings.quality), azimuths,
                                   scratch.stepLengths);
        }
    }
    nodes.emplace_back(new ShadeNode(*_inputs, *_surface, skyView(), _lights, direct));
    if (_inputs->isGlossy())
        declareGloss(nodes);
}

void Slices::declareEdges(WorkGraph::Nodes& nodes, Resource* edges)
{
    nodes.emplace_back(new ScreenEdgesNode(*_inputs, *_surface, _lights, edges));
}

void Slices::declareGloss(WorkGraph::Nodes& nodes)
{
    _gloss = new GlossWork(*_inputs, *_surface, _rays, horizon());
    _glossSoFar = _bounces == 0 ? _lightOfGloss.get() : _gloss->createLight();
    _exit = _gloss->createExit(_bounces > 0);
    LightSources inHarmonics;
    for (const auto& light : _lights)
        if (light->isInHarmonics())
            inHarmonics.push_back(light);
    nodes.emplace_back(
        new GlossNode(*_inputs, _gloss, inHarmonics, horizon(), _light, _glossSoFar, _exit));
}

osg::ref_ptr<Resource> Slices::declareBounce(WorkGraph::Nodes& nodes)
{
    const bool isFirst = _bounce++ == 0;
    _sent = isFirst ? new SentNode(*_inputs, *_surface, _lights, horizon())
                    : new SentNode(*_inputs, *_surface, horizon(), _light);
    if (_gloss)
        _sent->addPyramid(_rays->cells());
    if (_gloss && !_gloss->isVector())
        _sent->addGloss(*_gloss, _exit);
    nodes.emplace_back(_sent);
    const osg::ref_ptr<Resource> light =
        new Resource("light of a bounce", _surface->perPost(GL_RGBA16F_ARB));
    const osg::ref_ptr<BounceNode> bounce =
        new BounceNode(*_surface, isFirst ? _first : _next, _sent, horizon(), _light, light);
    if (isFirst)
        bounce->followsLight(*_inputs, _lights);
    const auto number = static_cast<std::size_t>(_bounce - 1);
    if (_inputs->farLight && number < _inputs->farLight->size() && _surface->farLevels() > 0)
        bounce->addFarLight(_surface->createFarLight((*_inputs->farLight)[number]));
    nodes.emplace_back(bounce);
    _light = _gloss ? declareGlossBounce(nodes, light) : light;
    return _light;
}

/// Returns the light of the bounce with what gloss adds to it.
osg::ref_ptr<Resource> Slices::declareGlossBounce(WorkGraph::Nodes& nodes, Resource* diffuse)
{
    osg::ref_ptr<Resource> bounced = diffuse;
    if (_gloss->isVector())
        bounced = new Resource("light of a bounce", _surface->perPost(GL_RGBA16F_ARB));
    const bool isLast = _bounce == _bounces;
    const osg::ref_ptr<Resource> light = isLast ? _lightOfGloss.get() : _gloss->createLight();
    const osg::ref_ptr<Resource> exit = _gloss->createExit(!isLast);
    nodes.emplace_back(
        new GlossBounceNode(*_surface, *_pyramid, _gloss, _sent, horizon(),
                            {_sent, _exit, exit, _glossSoFar, light, diffuse, bounced}));
    _exit = exit;
    _glossSoFar = light;
    return bounced;
}

} // namespace osgTerrainLight
