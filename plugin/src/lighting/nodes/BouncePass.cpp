#include "lighting/nodes/BouncePass.h"

#include "core/AzimuthSet.h"
#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "lighting/nodes/AreaLights.h"
#include "lighting/nodes/GridDirection.h"
#include "lighting/nodes/HorizonPass.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace osgTerrainLight
{

namespace
{
constexpr std::size_t maxAzimuths = 256; // the sizes of what bounce.comp declares
constexpr std::size_t maxSamples = 128;
} // namespace

BounceScheme BounceScheme::of(HorizonQuality quality)
{
    switch (quality)
    {
    case HorizonQuality::Draft:
        return {4.0, 4.0};
    case HorizonQuality::Best:
        return {16.0, 8.0};
    default:
        return {8.0, 5.0};
    }
}

std::vector<BounceSample> bounceSamples(const BounceScheme& scheme, int reach, int levelCount)
{
    const auto levelAt = [&](double distance)
    {
        return std::clamp(static_cast<int>(std::floor(std::log2(distance) - scheme.offset + 0.5)),
                          0, levelCount - 1);
    };
    std::vector<BounceSample> samples;
    const double ratio = std::exp2(1.0 / scheme.samplesPerOctave);
    double last = 0.0;
    for (double distance = 1.0; distance <= reach;)
    {
        const int level = levelAt(distance);
        const double place = level == 0 ? std::round(distance) : distance;
        const double between = 0.5 * (last + place);
        // Samples that read posts come first, and all of them read cells.
        samples.push_back({place, level, between, level == 0 ? 0 : std::max(1, levelAt(between))});
        last = place;
        distance = std::max(distance * ratio, place + 1.0);
    }
    if (samples.size() > maxSamples)
        return bounceSamples({scheme.samplesPerOctave * 0.9, scheme.offset}, reach, levelCount);
    return samples;
}

BouncePass::BouncePass(const DemTile& tile, osg::Texture2D* heights, osg::Texture2D* eastSpacings,
                       const BounceScheme& scheme, int azimuths, int stride, GlossPass* gloss)
    : _width(tile.width()), _height(tile.height()), _stride(stride),
      _posts(PyramidLayout::ofPosts(_width, _height)),
      _cells(PyramidLayout::ofCells(_width - 1, _height - 1)), _heights(heights),
      _directRadiance(new GpuPass("radiance", {"DIRECT"})),
      _bouncedRadiance(new GpuPass("radiance")),
      _firstHeights(new GpuPass("pyramid", {"HEIGHTS", "FROM_POSTS"})),
      _nextHeights(new GpuPass("pyramid", {"HEIGHTS"})),
      _firstRadiance(new GpuPass("pyramid", {"FROM_CELLS"})), _nextRadiance(new GpuPass("pyramid")),
      _gloss(gloss)
{
    using Defines = std::vector<std::string>;
    _firstBounce =
        new GpuPass("bounce", stride == 1 ? Defines{"DIRECT"} : Defines{"DIRECT", "NEAR"});
    _nextBounce = new GpuPass("bounce", stride == 1 ? Defines{} : Defines{"NEAR"});
    if (stride > 1)
    {
        _firstFar = new GpuPass("bounce", {"DIRECT", "FAR"});
        _nextFar = new GpuPass("bounce", {"FAR"});
        _farRadiance = createLayeredTarget((_width - 1) / stride + 1, (_height - 1) / stride + 1,
                                           azimuths, GL_RGBA16F_ARB);
    }
    _heightPyramid = createTarget(_posts.width, _posts.height, GL_RG32F);
    _radiancePyramid = createTarget(_cells.width, _cells.height, GL_RGBA16F_ARB);
    _radiance = createTarget(std::max(1, _width - 1), std::max(1, _height - 1), GL_RGBA16F_ARB);
    _light = createTarget(_width, _height, GL_RGBA16F_ARB);

    const AzimuthSet set(azimuths);
    Raster<float> lengths(azimuths, _height);
    std::vector<osg::Vec4f> rays(maxAzimuths + maxSamples); // directions, then samples
    for (int k = 0; k < azimuths; ++k)
    {
        const GridDirection grid(tile, set.direction(k));
        rays[static_cast<std::size_t>(k)].set(static_cast<float>(grid.drift),
                                              static_cast<float>(grid.look),
                                              grid.north ? 1.0f : 0.0f, 0.0f);
        for (int row = 0; row < _height; ++row)
            lengths.at(k, row) =
                static_cast<float>(grid.stepLength(tile.eastSpacing(row), tile.northSpacing));
    }
    _stepLengths = createFloatTexture(lengths);

    const std::vector<BounceSample> samples =
        bounceSamples(scheme, std::max(_width, _height) - 1,
                      static_cast<int>(std::min(_posts.levels.size(), _cells.levels.size())));
    int nearCount = 0;
    for (std::size_t i = 0; i < samples.size(); ++i)
    {
        rays[maxAzimuths + i].set(
            static_cast<float>(samples[i].distance), static_cast<float>(samples[i].level),
            static_cast<float>(samples[i].between), static_cast<float>(samples[i].radianceLevel));
        nearCount += samples[i].level == 0 ? 1 : 0;
    }
    std::vector<osg::ref_ptr<GpuPass>> bounces = {_firstBounce, _nextBounce};
    if (stride > 1)
        bounces.insert(bounces.end(), {_firstFar, _nextFar});
    std::vector<osg::ref_ptr<GpuPass>> scans = bounces; // all that look along the rays
    if (gloss)
        scans.push_back(gloss->gatherPass());
    for (const auto& pass : scans)
    {
        setLevels(*pass, "heightLevels", _posts);
        setLevels(*pass, "radianceLevels", _cells);
    }
    if (stride > 1)
        for (const auto& pass : {_firstFar, _nextFar})
            pass->writes(0, _farRadiance);
    for (const auto& pass : {_firstBounce, _nextBounce})
    {
        pass->writes(1, _light, GpuPass::Access::ReadWrite);
        if (stride > 1)
            pass->reads("farRadiance", _farRadiance);
    }
    const auto exact = std::count_if(samples.begin(), samples.end(),
                                     [&](const BounceSample& sample)
                                     { return sample.level == 0 && sample.distance <= 2.0; });
    std::vector<osg::ref_ptr<GpuPass>> onPosts = bounces; // all that read posts
    onPosts.insert(onPosts.end(), {_directRadiance, _bouncedRadiance});
    for (const auto& pass : onPosts)
    {
        pass->reads("heights", heights);
        pass->set("size", _width, _height);
        pass->set("frame", int(HorizonPass::frame));
    }
    for (const auto& pass : onPosts)
        if (pass != _bouncedRadiance)
        {
            pass->reads("eastSpacings", eastSpacings);
            pass->set("azimuths", azimuths);
            pass->set("northSpacing", static_cast<float>(tile.northSpacing));
        }
    for (const auto& pass : {_directRadiance, _bouncedRadiance})
        pass->writes(0, _radiance);
    _bouncedRadiance->reads("light", _light);
    for (const auto& pass : bounces)
    {
        pass->set("stride", stride);
        pass->set("exact", static_cast<int>(exact));
    }
    for (const auto& pass : scans)
    {
        pass->reads("radiance", _radiance);
        pass->reads("stepLengths", _stepLengths);
        pass->reads("heightPyramid", _heightPyramid);
        pass->reads("radiancePyramid", _radiancePyramid);
        pass->setBlock(rays);
        pass->set("nearCount", nearCount);
        pass->set("sampleCount", static_cast<int>(samples.size()));
    }
}

Status BouncePass::dispatchHeights(osg::State& state)
{
    return reducePyramid(state, _posts, *_firstHeights, _heights, HorizonPass::frame, *_nextHeights,
                         _heightPyramid);
}

void BouncePass::setAreaLights(const AreaLights& lights)
{
    lights.apply(*_directRadiance, {"DIRECT"});
    lights.apply(*_firstBounce, _stride == 1 ? std::vector<std::string>{"DIRECT"}
                                             : std::vector<std::string>{"DIRECT", "NEAR"});
    if (!_firstFar)
        return;
    AreaLights sun; // cells have the rest
    sun.sunHorizon = lights.sunHorizon;
    sun.sky = lights.sky;
    sun.apply(*_firstFar, {"DIRECT", "FAR"});
}

Status BouncePass::dispatch(osg::State& state, int bounces, const SkyLight& sky,
                            osg::Texture2DArray* horizon, osg::Texture2D* albedo,
                            osg::Texture2D* shading)
{
    const GpuPass::Groups groups = {GpuPass::groupsFor(_width, 8), GpuPass::groupsFor(_height, 8),
                                    1};
    for (const auto& pass : {_directRadiance, _firstBounce})
    {
        pass->set("hasSky", sky.skyEnabled);
        const Rgb gain = skyGain(sky);
        pass->set("skyRadiance", osg::Vec3f(gain[0], gain[1], gain[2]));
    }
    std::vector<osg::ref_ptr<GpuPass>> scans = {_firstBounce, _nextBounce};
    for (const auto& pass : scans)
        pass->writes(0, shading, GpuPass::Access::ReadWrite);
    if (_firstFar)
        scans.insert(scans.end(), {_firstFar, _nextFar});
    for (const auto& pass : scans)
    {
        pass->reads("horizon", horizon);
        pass->reads("albedo", albedo);
    }
    _directRadiance->reads("horizon", horizon);
    for (const auto& pass : {_directRadiance, _bouncedRadiance})
        pass->reads("albedo", albedo);
    const GpuPass::Groups blocks = {GpuPass::groupsFor((_width - 1) / _stride + 1, 8),
                                    GpuPass::groupsFor((_height - 1) / _stride + 1, 8), 1};
    Status done = Nothing{};
    for (int bounce = 0; done && bounce < bounces; ++bounce)
    {
        done = (bounce == 0 ? _directRadiance : _bouncedRadiance)->dispatch(state, groups);
        if (done && _gloss)
            done = _gloss->dispatchSent(state, bounce, _posts, _radiance);
        if (done)
            done = reducePyramid(state, _cells, *_firstRadiance, _radiance, 0, *_nextRadiance,
                                 _radiancePyramid);
        if (done && _firstFar)
            done = (bounce == 0 ? _firstFar : _nextFar)->dispatch(state, blocks);
        if (done)
            done = (bounce == 0 ? _firstBounce : _nextBounce)->dispatch(state, groups);
        if (done)
            done = keep(state, _light, bounce);
        if (done && _gloss)
            done = _gloss->dispatchBounce(state, bounce, horizon, shading, _light);
    }
    return done;
}

Result<std::vector<float>> BouncePass::readLight(osg::State& state)
{
    return readFloats(state, *_light, 4);
}

std::vector<osg::Texture*> BouncePass::textures() const
{
    std::vector<osg::Texture*> all = {_stepLengths, _heightPyramid, _radiancePyramid, _radiance,
                                      _light};
    if (_farRadiance)
        all.push_back(_farRadiance);
    return all;
}

std::vector<GpuPass*> BouncePass::passes() const
{
    std::vector<GpuPass*> all = {_directRadiance, _bouncedRadiance, _firstBounce,   _nextBounce,
                                 _firstHeights,   _nextHeights,     _firstRadiance, _nextRadiance};
    if (_firstFar)
        all.insert(all.end(), {_firstFar, _nextFar});
    return all;
}

} // namespace osgTerrainLight
