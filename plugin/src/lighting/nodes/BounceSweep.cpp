#include "lighting/nodes/BounceSweep.h"

#include "core/AzimuthSet.h"
#include "gpu/GlConstants.h"
#include "lighting/nodes/AzimuthRays.h"

#include <algorithm>

namespace osgTerrainLight
{

namespace
{
constexpr int group = 32; // lines, as bounce_sweep.comp has it
constexpr int mostLevels = 13;
} // namespace

SweepScheme SweepScheme::of(HorizonQuality quality, int steps)
{
    SweepScheme scheme{3, 4, 5};
    if (quality == HorizonQuality::Draft)
        scheme = {2, 2, 5};
    if (quality == HorizonQuality::Best)
        scheme = {4, 8, 5};
    while (scheme.levels < mostLevels && scheme.entries * ((1 << scheme.levels) - 1) < steps)
        ++scheme.levels;
    return scheme;
}

std::vector<std::string> SweepScheme::defines() const
{
    return {"NEAR " + std::to_string(near), "ENTRIES " + std::to_string(entries),
            "LEVELS " + std::to_string(levels)};
}

SweepScratch::SweepScratch(const TileSurface& surface, int azimuths)
    : stepLengths(createStepLengths(surface, azimuths)),
      gradients(new Resource("gradients", surface.perPost(GL_RG32F))),
      sums(new Resource("sums of slices", surface.perPost(GL_RGBA32F_ARB)))
{
}

BounceSweep::BounceSweep(const TileInputs& inputs, const TileSurface& surface,
                         const LightSources& lights, Resource* horizon, const SweepScratch& scratch,
                         bool first)
    : _surface(&surface), _lights(first ? lights : LightSources()),
      _scheme(
          SweepScheme::of(inputs.settings.quality, std::max(surface.width(), surface.height()))),
      _farScheme(SweepScheme::of(inputs.settings.quality, surface.reach())),
      _own(own(new GpuPass("bounce_own"))), _sweep(own(new GpuPass("bounce_sweep"))),
      _finish(own(new GpuPass("bounce_finish")))
{
    own(inputs.albedoTexture.get());
    for (Resource* resource : {scratch.stepLengths, scratch.gradients, scratch.sums})
        own(resource);
    const int azimuths = inputs.settings.azimuths;
    const std::vector<osg::Vec4f> rays = azimuthRays(surface, azimuths);
    const AzimuthSet set(azimuths);
    for (int k = 0; k < azimuths; ++k)
        _lines.push_back({lineCount(surface, rays[static_cast<std::size_t>(k)]),
                          stepsBefore(surface, {surface.tile(), set.direction(k)})});
    for (GpuPass* pass : {_own, _sweep})
    {
        surface.bind(*pass);
        pass->setBlock(rays);
        pass->set("azimuths", azimuths);
        pass->reads("horizon", horizon);
        pass->reads("albedo", inputs.albedoTexture);
        pass->reads("stepLengths", scratch.stepLengths);
        pass->writes(0, scratch.sums, GpuPass::Access::ReadWrite);
    }
    _own->writes(1, scratch.gradients);
    _sweep->reads("gradients", scratch.gradients);
    surface.bind(*_finish);
    _finish->reads("sums", scratch.sums);
}

Status BounceSweep::dispatch(osg::State& state, const SentNode& sent, Resource* before,
                             Resource* far, Resource* light)
{
    const LightSources varying = varyingInCells(_lights);
    bindLights(*_own, varying);
    _own->reads("faces", sent.faces());
    _own->reads("direct", before);
    Status done = _own->dispatch(state, _surface->groups());
    std::vector<std::string> defines = far ? _farScheme.defines() : _scheme.defines();
    if (far)
    {
        for (const std::string& define : _surface->farDefines())
            defines.push_back(define);
        _surface->bindFar(*_sweep);
        _sweep->reads("farLight", far);
    }
    bindLights(*_sweep, varying, defines);
    _sweep->reads("faces", sent.faces());
    for (std::size_t k = 0; done && k < _lines.size(); ++k)
    {
        _sweep->set("azimuth", static_cast<int>(k));
        if (far)
            _sweep->set("walkedBefore", _lines[k].begin & 4095); // not negative
        done = _sweep->dispatch(state, {GpuPass::groupsFor(_lines[k].count, group), 1, 1});
    }
    _finish->writes(0, light);
    return done ? _finish->dispatch(state, _surface->groups()) : done;
}

} // namespace osgTerrainLight
