#include "lighting/nodes/LegendreBouncePass.h"

#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "lighting/nodes/PyramidRays.h"

#include <limits>

namespace osgTerrainLight
{

LegendreBouncePass::LegendreBouncePass(const DemTile& tile, const HeightPyramid& pyramid,
                                       osg::Texture2D* eastSpacings, const LegendreScheme& scheme,
                                       int bounces)
    : _width(tile.width()), _height(tile.height()), _blocksAcross((_width - 1) / scheme.stride + 1),
      _blocksUp((_height - 1) / scheme.stride + 1),
      _blocks(PyramidLayout::ofPosts(_blocksAcross, _blocksUp)),
      _groups(legendreGroups(_width, _height, scheme.stride)),
      _radiance(createTarget(_blocksAcross, _blocksUp, GL_RGBA16F_ARB)),
      _radiancePyramid(createTarget(_blocks.width, _blocks.height, GL_RGBA16F_ARB)),
      _postRadiance(new GpuPass("post_radiance")),
      _reduceRadiance(new GpuPass("pyramid", {"ON_POSTS"})),
      _last(createLegendreLight({}, tile, pyramid, eastSpacings, scheme))
{
    if (bounces > 1)
    {
        _light = createTarget(_blocksAcross, _blocksUp, GL_RGBA16F_ARB);
        _other = createLegendreLight({"SENDS_ON"}, tile, pyramid, eastSpacings, scheme);
    }
    _postRadiance->reads("heights", pyramid.heights());
    _postRadiance->set("size", _width, _height);
    _postRadiance->set("frame", pyramid.frame());
    _postRadiance->set("stride", scheme.stride);
    _postRadiance->writes(0, _radiance);
    std::vector<osg::Vec4f> rays = raySteps(tile.nominalEastSpacing(), tile.northSpacing,
                                            directionsOf(AzimuthSet(scheme.azimuths)));
    rays.resize(256);
    for (const auto& pass : {_last, _other})
        if (pass)
        {
            pass->setBlock(rays);
            pass->set("azimuths", scheme.azimuths);
            setLevels(*pass, "radianceLevels", _blocks);
            pass->set("radianceLevelCount", static_cast<int>(_blocks.levels.size()));
            pass->reads("radiance", _radiance);
            pass->reads("radiancePyramid", _radiancePyramid);
        }
    if (_other)
        _other->writes(1, _light);
}

Status LegendreBouncePass::dispatch(osg::State& state, int bounces, const SkyLight&,
                                    osg::Texture2DArray*, osg::Texture2D* albedo,
                                    osg::Texture2D* shading)
{
    _postRadiance->reads("albedo", albedo);
    Status done = Nothing{};
    for (int bounce = 0; done && bounce < bounces; ++bounce)
    {
        _postRadiance->reads("light", bounce == 0 ? shading : _light.get());
        _postRadiance->set("byBlock", bounce > 0);
        done = _postRadiance->dispatch(
            state, {GpuPass::groupsFor(_blocksAcross, 8), GpuPass::groupsFor(_blocksUp, 8), 1});
        if (done)
            done = reducePyramid(state, _blocks, *_reduceRadiance, _radiance, 0, *_reduceRadiance,
                                 _radiancePyramid);
        GpuPass& pass = bounce + 1 < bounces ? *_other : *_last;
        aim(pass, shading, false, false);
        if (done)
            done = pass.dispatch(state, _groups);
        if (done && sum())
        {
            // Its light is stored nowhere: what is kept of it is gathered once more.
            aim(pass, sum()->texture(), true, bounce == 0);
            done = pass.dispatch(state, _groups);
        }
    }
    return done;
}

void LegendreBouncePass::aim(GpuPass& pass, osg::Texture2D* target, bool signedLight, bool fresh)
{
    pass.writes(0, target, GpuPass::Access::ReadWrite);
    pass.set("darkest", signedLight ? std::numeric_limits<float>::lowest() : 0.0f);
    pass.set("fresh", fresh);
}

Result<std::vector<float>> LegendreBouncePass::readLight(osg::State& state)
{
    // What it was gathered from is still there.
    const osg::ref_ptr<osg::Texture2D> light = createTarget(_width, _height, GL_RGBA16F_ARB);
    aim(*_last, light, true, true);
    if (Status done = _last->dispatch(state, _groups); !done)
        return done.error();
    return readFloats(state, *light, 4);
}

std::vector<osg::Texture*> LegendreBouncePass::textures() const
{
    std::vector<osg::Texture*> all = {_radiance, _radiancePyramid};
    if (_light)
        all.push_back(_light);
    return all;
}

std::vector<GpuPass*> LegendreBouncePass::passes() const
{
    std::vector<GpuPass*> all = {_postRadiance, _reduceRadiance, _last};
    if (_other)
        all.push_back(_other);
    return all;
}

} // namespace osgTerrainLight
