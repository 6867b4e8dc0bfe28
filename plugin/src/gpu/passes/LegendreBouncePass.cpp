#include "gpu/passes/LegendreBouncePass.h"

#include "core/AzimuthSet.h"
#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "gpu/passes/GridDirection.h"
#include "gpu/passes/HorizonPass.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr std::size_t maxLevels = 16;
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
    assert(_posts.levels.size() <= maxLevels);
    _heightPyramid = createTarget(_posts.width, _posts.height, GL_RG32F);
    _radiancePyramid = createTarget(_posts.width, _posts.height, GL_RGBA16F_ARB);
    _radiance = createTarget(_width, _height, GL_RGBA16F_ARB);
    _light = createTarget(_width, _height, GL_RGBA16F_ARB);

    const AzimuthSet set(azimuths);
    Raster<float> lengths(azimuths, _height);
    osg::ref_ptr<osg::Uniform> directions =
        new osg::Uniform(osg::Uniform::FLOAT_VEC4, "directions", 256);
    for (int k = 0; k < azimuths; ++k)
    {
        const MapDirection direction = set.direction(k);
        const GridDirection grid(tile, direction);
        const double along = grid.look;
        const double across = grid.look * grid.drift;
        directions->setElement(static_cast<unsigned>(k),
                               osg::Vec4f(static_cast<float>(grid.north ? across : along),
                                          static_cast<float>(grid.north ? along : across),
                                          static_cast<float>(direction.east),
                                          static_cast<float>(direction.north)));
        for (int row = 0; row < _height; ++row)
            lengths.at(k, row) =
                static_cast<float>(grid.stepLength(tile.eastSpacing(row), tile.northSpacing));
    }
    _stepLengths = createFloatTexture(lengths);

    osg::ref_ptr<osg::Uniform> levels =
        new osg::Uniform(osg::Uniform::INT_VEC4, "levels", static_cast<int>(maxLevels));
    for (unsigned i = 0; i < _posts.levels.size(); ++i)
    {
        const PyramidLayout::Level& level = _posts.levels[i];
        levels->setElement(i, level.x, level.y, level.width, level.height);
    }
    for (const auto& pass : {_postRadiance, _bounce})
    {
        pass->reads("heights", heights);
        pass->set("size", _width, _height);
        pass->set("frame", int(HorizonPass::frame));
    }
    _postRadiance->writes(0, _radiance);
    const std::array<double, 4> even = WedgeMatrices(2.0 * pi / azimuths).weights(blend).even;
    _bounce->reads("eastSpacings", eastSpacings);
    _bounce->reads("stepLengths", _stepLengths);
    _bounce->reads("radiance", _radiance);
    _bounce->reads("heightPyramid", _heightPyramid);
    _bounce->reads("radiancePyramid", _radiancePyramid);
    _bounce->writes(1, _light);
    _bounce->set("azimuths", azimuths);
    _bounce->set("northSpacing", static_cast<float>(tile.northSpacing));
    _bounce->set("orderWeights",
                 osg::Vec4f(static_cast<float>(even[0]), static_cast<float>(even[1]),
                            static_cast<float>(even[2]), static_cast<float>(even[3])));
    _bounce->set(directions);
    _bounce->set(levels);
    _bounce->set("levelCount", static_cast<int>(_posts.levels.size()));
    _bounce->set("samplesPerOctave", static_cast<float>(scheme.samplesPerOctave));
    _bounce->set("offset", static_cast<float>(scheme.offset));
    const int reach = std::max(_width, _height) - 1;
    _bounce->set("sampleCount",
                 reach < 1 ? 0 : 1 + static_cast<int>(scheme.samplesPerOctave * std::log2(reach)));
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

std::size_t LegendreBouncePass::bytes() const
{
    std::size_t sum = 0;
    for (const osg::Texture2D* texture : textures())
        sum += textureBytes(*texture);
    return sum;
}

void LegendreBouncePass::releaseGLObjects(osg::State* state) const
{
    for (const GpuPass* pass : passes())
        pass->releaseGLObjects(state);
    for (const osg::Texture2D* texture : textures())
        texture->releaseGLObjects(state);
}

void LegendreBouncePass::resizeGLObjectBuffers(unsigned size)
{
    for (GpuPass* pass : passes())
        pass->resizeGLObjectBuffers(size);
    for (osg::Texture2D* texture : textures())
        texture->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
