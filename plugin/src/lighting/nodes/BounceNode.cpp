#include "lighting/nodes/BounceNode.h"

namespace osgTerrainLight
{

BounceNode::BounceNode(const TileSurface& surface, BounceSweep* sweep, SentNode* sent,
                       Resource* horizon, Resource* before, Resource* light)
    : Node("bounce"), _sent(sent), _sweep(own(sweep)), _before(before), _light(light)
{
    reads(surface.heights());
    reads(horizon);
    reads(sent->faces());
    writes(own(light));
}

void BounceNode::followsLight(const TileInputs& inputs, const LightSources& lights)
{
    Node::followsLight(_before, inputs.isPaced());
    Node::followsLight(inputs.light, inputs.isPaced());
    for (const auto& light : lights)
        for (Resource* value : light->values())
            Node::followsLight(value, inputs.isPaced());
}

Status BounceNode::run(osg::State& state)
{
    return _sweep->dispatch(state, *_sent, _before, _far, _light);
}

} // namespace osgTerrainLight
