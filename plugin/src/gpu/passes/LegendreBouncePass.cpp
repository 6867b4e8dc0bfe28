#include "gpu/passes/LegendreBouncePass.h"

#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "gpu/passes/HorizonPass.h"
#include "gpu/passes/PyramidRays.h"

#include <array>

namespace osgTerrainLight
{

namespace
{
constexpr double pi = 3.14159265358979323846;
} // namespace

BounceScheme legendreScheme(HorizonQuality quality)
{
    switch (quality)
    {
    case HorizonQuality::Draft:
        return {4.0, 2.0};
    case HorizonQuality::Best:
        return {8.0, 8.0};
    default:
        return {8.0, 4.0};
    }
}

LegendreBouncePass::LegendreBouncePass(const DemTile& tile, osg::Texture2D* heights,
                                       osg::Texture2D* eastSpacings, const BounceScheme& scheme,
                                       int azimuths, AzimuthBlend blend)
    : _width(tile.width()), _height(tile.height()), _posts(PyramidLayout::ofPosts(_width, _height)),
      _heights(heights), _postRadiance(new GpuPass("post_radiance")),
      _bounce(new GpuPass("legendre_bounce")),
      _firstHeights(new GpuPass("pyramid", {"HEIGHTS", "FROM_POSTS"})),
      _nextHeights(new GpuPass("pyramid", {"HEIGHTS"})),
      _reduceRadiance(new GpuPass("pyramid", {"ON_POSTS"}))
{
    _heightPyramid = createTarget(_posts.width, _posts.height, GL_RG32F);
    _radiancePyramid = createTarget(_posts.width, _posts.height, GL_RGBA16F_ARB);
    _radiance = createTarget(_width, _height, GL_RGBA16F_ARB);
    _light = createTarget(_width, _height, GL_RGBA16F_ARB);

    _stepLengths =
        setPyramidRays(*_bounce, tile, scheme, azimuths, _heights, _posts, _heightPyramid);
    _postRadiance->reads("heights", heights);
    _postRadiance->set("size", _width, _height);
    _postRadiance->set("frame", int(HorizonPass::frame));
    _postRadiance->writes(0, _radiance);
    const std::array<double, 4> even = WedgeMatrices(2.0 * pi / azimuths).weights(blend).even;
    _bounce->reads("eastSpacings", eastSpacings);
    _bounce->reads("radiance", _radiance);
    _bounce->reads("radiancePyramid", _radiancePyramid);
    _bounce->writes(1, _light);
    _bounce->set("azimuths", azimuths);
    _bounce->set("northSpacing", static_cast<float>(tile.northSpacing));
    _bounce->set("orderWeights",
                 osg::Vec4f(static_cast<float>(even[0]), static_cast<float>(even[1]),
                            static_cast<float>(even[2]), static_cast<float>(even[3])));
}

Status LegendreBouncePass::dispatchHeights(osg::State& state)
{
    return reducePyramid(state, _posts, *_firstHeights, _heights, HorizonPass::frame, *_nextHeights,
                         _heightPyramid);
}

Status LegendreBouncePass::dispatch(osg::State& state, int bounces, const SkyLight&,
                                    osg::Texture2DArray*, osg::Texture2D* albedo,
                                    osg::Texture2D* shading)
{
    const GpuPass::Groups groups = {GpuPass::groupsFor(_width, 8), GpuPass::groupsFor(_height, 8),
                                    1};
    _postRadiance->reads("albedo", albedo);
    _bounce->writes(0, shading, GpuPass::Access::ReadWrite);
    Status done = Nothing{};
    for (int bounce = 0; done && bounce < bounces; ++bounce)
    {
        _postRadiance->reads("light", bounce == 0 ? shading : _light.get());
        done = _postRadiance->dispatch(state, groups);
        if (done)
            done = reducePyramid(state, _posts, *_reduceRadiance, _radiance, 0, *_reduceRadiance,
                                 _radiancePyramid);
        if (done)
            done = _bounce->dispatch(state, groups);
        if (done)
            done = keep(state, bounce);
    }
    return done;
}

std::vector<osg::Texture2D*> LegendreBouncePass::textures() const
{
    return {_stepLengths, _heightPyramid, _radiancePyramid, _radiance, _light};
}

std::vector<GpuPass*> LegendreBouncePass::passes() const
{
    return {_postRadiance, _bounce, _firstHeights, _nextHeights, _reduceRadiance};
}

} // namespace osgTerrainLight
