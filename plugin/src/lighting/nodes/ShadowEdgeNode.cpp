#include "lighting/nodes/ShadowEdgeNode.h"

#include "gpu/GlConstants.h"
#include "lighting/nodes/AzimuthRays.h"
#include "lighting/nodes/GridDirection.h"

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;
constexpr double steepest = 89.0; // [degrees]: a shadow is shorter than a 57th of its crest
} // namespace

ShadowEdgeNode::ShadowEdgeNode(const TileInputs& inputs, const TileSurface& surface)
    : Node("shadow"), _inputs(&inputs), _surface(&surface),
      _edge(writes(own(new Resource("edge of the shadow", surface.perPost(GL_RG16F))))),
      _shadows(own(new Resource("shadows along lines",
                                {surface.width() + 1, surface.height() + 1, 0, GL_RG32F}))),
      _lines(own(new GpuPass("shadow_lines", surface.farDefines()))),
      _posts(own(new GpuPass("shadow_edge")))
{
    reads(surface.heights());
    for (GpuPass* pass : {_lines, _posts})
        surface.bind(*pass);
    surface.bindFar(*_lines);
    _lines->writes(0, _shadows);
    _posts->reads("lines", _shadows);
    _posts->writes(0, _edge);
}

Status ShadowEdgeNode::run(osg::State& state)
{
    const SkyLight& sky = _inputs->sky;
    const GridDirection grid(_surface->tile(), directionOfCompass(sky.sunAzimuth));
    const osg::Vec4f direction(static_cast<float>(grid.drift), static_cast<float>(grid.look),
                               grid.north ? 1.0f : 0.0f, 0.0f);
    const double elevation = std::min(sky.sunElevation, steepest) * radiansPerDegree;
    for (GpuPass* pass : {_lines, _posts})
    {
        pass->set("direction", direction);
        pass->set("sunSlope", static_cast<float>(std::tan(elevation)));
    }
    _posts->set("sunElevation", static_cast<float>(elevation));
    _posts->set("sunRadius", static_cast<float>(sky.sunAngularRadius * radiansPerDegree));
    const Status done =
        _lines->dispatch(state, {GpuPass::groupsFor(lineCount(*_surface, direction), 32), 1, 1});
    return done ? _posts->dispatch(state, _surface->groups()) : done;
}

} // namespace osgTerrainLight
