#include "lighting/TileLight.h"

#include "glsl_host.h"
#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "lighting/nodes/BouncePass.h"
#include "lighting/nodes/LegendreBouncePass.h"

#include <OpenThreads/ScopedLock>
#include <osg/GLExtensions>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>

namespace osgTerrainLight
{

namespace
{
using Lock = OpenThreads::ScopedLock<OpenThreads::Mutex>;

constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;

bool isBlack(const Rgb& albedo)
{
    return std::all_of(albedo.begin(), albedo.end(), [](float a) { return a <= 0.0f; });
}

/// 0, 1, 2, …: tiles made one after another take turns.
unsigned nextTurn()
{
    static std::atomic<unsigned> next{0};
    return next++;
}

osg::Vec3f vec3(const Rgb& c)
{
    return {c[0], c[1], c[2]};
}
} // namespace

TileLight::TileLight(const DemTile& tile, const LightingSettings& settings, const SkyLight& sky,
                     SkyViewDefinition definition)
    : _tile(tile), _settings(settings), _sky(sky), _definition(definition), _turn(nextTurn()),
      _skyPass(new GpuPass("sky_view")), _shadePass(new GpuPass("shade"))
{
    _shading = createTarget(_tile.width(), _tile.height(), GL_RGBA16F_ARB);
    _nothing = createFloatTexture(Raster<float>(1, 1));
    _eastSpacings = createSpacingTexture(_tile);
    createHeights();
    for (const auto& pass : {_skyPass, _shadePass})
    {
        pass->reads("eastSpacings", _eastSpacings);
        pass->set("size", _tile.width(), _tile.height());
        pass->set("northSpacing", static_cast<float>(_tile.northSpacing));
    }
    _shadePass->writes(0, _shading);

    _heightsValue = _chain.addSource();
    _settingsValue = _chain.addSource();
    _harmonicsValue = _chain.addSource();
    _sunPlaceValue = _chain.addSource();
    _keyPlaceValue = _chain.addSource();
    _lightValue = _chain.addSource();
    _bounceValue = _chain.addSource();
    _probeValue = _chain.addSource();
    const auto heights = _chain.addStage({"heights",
                                          {_heightsValue},
                                          [this] { return _posts.valid(); },
                                          [this](osg::State& state) { return runHeights(state); },
                                          [] { return 0; }, // bytes() counts them always
                                          [] {}});
    const auto horizon = _chain.addStage(
        {"horizon",
         {_settingsValue, heights},
         [this] { return horizonNeeded(); },
         [this](osg::State& state) { return runHorizon(state); },
         [this]
         {
             return _horizon ? textureBytes(*_horizon->horizon()) +
                                   HorizonPass::workingBytes(width(), height(),
                                                             HorizonScheme::of(_settings.quality),
                                                             _settings.azimuths)
                             : 0;
         },
         [this] { _horizon = nullptr; }});
    const auto table = _chain.addStage({"table",
                                        {_settingsValue, _harmonicsValue},
                                        [this] { return tableNeeded(); },
                                        [this](osg::State& state) { return runTable(state); },
                                        [this] { return _table ? _table->bytes() : 0; },
                                        [this] { _table = nullptr; }});
    const auto skyView = _chain.addStage({"sky",
                                          {horizon, table},
                                          [this] { return skyNeeded() && bySlices(); },
                                          [this](osg::State& state) { return runSky(state); },
                                          [this] { return _skyView ? textureBytes(*_skyView) : 0; },
                                          [this] { _skyView = nullptr; }});
    const auto sun = _chain.addStage(
        {"sun",
         {_settingsValue, _sunPlaceValue, heights},
         [this] { return sunNeeded() && bySlices(); },
         [this](osg::State& state) { return runSun(state); },
         [this]
         {
             return _sun ? textureBytes(*_sun->horizon()) +
                               HorizonPass::workingBytes(width(), height(),
                                                         HorizonScheme::ofSun(_settings.quality),
                                                         sunAzimuths)
                         : 0;
         },
         [this] { _sun = nullptr; }});
    const auto key = _chain.addStage(
        {"key",
         {_settingsValue, _keyPlaceValue, heights},
         [this] { return keyNeeded() && bySlices(); },
         [this](osg::State& state) { return runKey(state); },
         [this]
         {
             return _key ? textureBytes(*_key->horizon()) +
                               HorizonPass::workingBytes(width(), height(),
                                                         HorizonScheme::of(_settings.quality),
                                                         _key->horizon()->getTextureDepth())
                         : 0;
         },
         [this] { _key = nullptr; }});
    const auto pyramid = _chain.addStage({"pyramid",
                                          {_settingsValue, _bounceValue, heights},
                                          [this] { return bounceNeeded() || legendreNeeded(); },
                                          [this](osg::State& state) { return runPyramid(state); },
                                          [this] { return _pyramid ? _pyramid->bytes() : 0; },
                                          [this] { _pyramid = nullptr; }});
    _shadeOutput = _chain.addStage(
        {"shade",
         // Bounces are added to what this writes, so it runs before each.
         {skyView, sun, key, pyramid, _settingsValue, _lightValue, _bounceValue, heights},
         [] { return true; },
         [this](osg::State& state) { return runShade(state); },
         [this] { return textureBytes(*_shading) + (_direct ? _direct->bytes() : 0); },
         [] {}});
    const auto gloss =
        _chain.addStage({"gloss",
                         {horizon, _shadeOutput},
                         [this] { return glossNeeded(); },
                         [this](osg::State& state) { return runGloss(state); },
                         [this]
                         {
                             return textureBytes(*_glossLight) +
                                    (_glossPass ? _glossPass->bytes() : 0) +
                                    (_materialTexture ? textureBytes(*_materialTexture) : 0);
                         },
                         [this]
                         {
                             _glossPass = nullptr;
                             _materialTexture = nullptr;
                         }});
    const auto bounce =
        _chain.addStage({"bounce",
                         {horizon, pyramid, _shadeOutput, gloss},
                         [this] { return bounceNeeded(); },
                         [this](osg::State& state) { return runBounce(state); },
                         [this] {
                             return (_bounce ? _bounce->bytes() : 0) +
                                    (_albedoTexture ? textureBytes(*_albedoTexture) : 0);
                         },
                         [this]
                         {
                             _bounce = nullptr;
                             if (_probes.empty())
                                 _albedoTexture = nullptr;
                         },
                         [this](unsigned contextID) { return bounceTurn(contextID); }});
    const auto indirect = _chain.addStage(
        {"indirect",
         {_shadeOutput, bounce},
         [this] { return sumNeeded(); },
         [this](osg::State& state) { return _sum->addTo(state, _shading); },
         [this] { return _sum ? textureBytes(*_sum->texture()) : 0; },
         [this] { _sum = nullptr; },
         // Bounces that have just been computed are in the shading.
         [this](unsigned contextID)
         { return _paces[contextID].waits ? PassChain::Turn::Run : PassChain::Turn::Skip; }});
    _chain.addStage({"probe",
                     {_shadeOutput, bounce, indirect, table, _probeValue},
                     [this] { return !_probes.empty(); },
                     [this](osg::State& state) { return runProbe(state); },
                     [this]
                     {
                         // The albedo is the bounces' where there are some.
                         return (_probePass ? _probePass->bytes() : 0) +
                                (_albedoTexture && !bounceNeeded() ? textureBytes(*_albedoTexture)
                                                                   : 0);
                     },
                     [this] { _probePass = nullptr; }});
    followGloss();
}

bool TileLight::needsSun(const SkyLight& sky)
{
    return sky.sunEnabled && sky.sunElevation + sky.sunAngularRadius > 0.0;
}

int TileLight::keyAzimuths(const SkyLight& sky, const LightingSettings& settings)
{
    int count = 0;
    for (const KeySlices& key : keySlices(sky, settings.azimuths))
        count += key.count;
    return count;
}

void TileLight::setSettings(const LightingSettings& settings)
{
    Lock lock(_mutex);
    const bool changed = settings.azimuths != _settings.azimuths ||
                         settings.quality != _settings.quality ||
                         settings.bodyRadius != _settings.bodyRadius ||
                         settings.bounceMethod != _settings.bounceMethod;
    if (settings.subsampling != _settings.subsampling)
    {
        _direct = nullptr;
        _bounce = nullptr;
        _chain.touch(_bounceValue);
    }
    if (settings.bounceInterval != _settings.bounceInterval)
        _chain.touch(_bounceValue);
    const bool otherGloss =
        settings.gloss != _settings.gloss || settings.glossExponent != _settings.glossExponent ||
        settings.glossTransfer != _settings.glossTransfer ||
        settings.glossViewer != _settings.glossViewer || settings.bounces != _settings.bounces;
    if (_glossLight && otherGloss)
        forgetGloss();
    if (settings.bounces != _settings.bounces || settings.albedo != _settings.albedo)
    {
        _albedoTexture = nullptr;
        if (!bySlices())
            _bounce = nullptr; // what it has depends on how many there are
        _chain.touch(_bounceValue);
    }
    const int before = frame();
    const double radiusBefore = _settings.bodyRadius;
    _settings = settings;
    followGloss();
    if (!changed)
        return;
    _horizon = nullptr;
    _sun = nullptr;
    _pyramid = nullptr;
    _direct = nullptr;
    _key = nullptr;
    _table = nullptr;
    _bounce = nullptr;
    _glossPass = nullptr;
    _chain.touch(_settingsValue);
    if (frame() != before || _settings.bodyRadius != radiusBefore)
    {
        createHeights();
        _chain.touch(_heightsValue);
    }
}

bool TileLight::legendreNeeded() const
{
    return !bySlices() && (skyNeeded() || sunNeeded() || keyNeeded());
}

int TileLight::frame() const
{
    // A sweep reads far beyond the last post; a normal, one post.
    return bySlices() ? HorizonPass::frame : 1;
}

void TileLight::createHeights()
{
    if (_posts)
    {
        // They are written by a pass: a texture with an image would be loaded from it.
        _heights = createTarget(width() + 2 * frame(), height() + 2 * frame(), GL_R32F);
        _framePass->reads("eastSpacings", _eastSpacings);
        _framePass->set("northSpacing", static_cast<float>(_tile.northSpacing));
        _framePass->set(
            "curvature",
            static_cast<float>(_settings.bodyRadius > 0.0 ? 1.0 / _settings.bodyRadius : 0.0));
        _framePass->set("frame", frame());
        _framePass->writes(0, _heights);
    }
    else
        _heights = createHeightTexture(_tile, frame(), _settings.bodyRadius);
    for (const auto& pass : {_skyPass, _shadePass})
    {
        pass->reads("heights", _heights);
        pass->set("frame", frame());
    }
}

bool TileLight::bounceNeeded() const
{
    // Less than two posts a side have no cell between them to send light.
    return _settings.bounces > 0 && (skyNeeded() || sunNeeded() || keyNeeded()) && width() > 1 &&
           height() > 1 &&
           (glossNeeded() || !(_albedo.empty() ? isBlack(_settings.albedo) : _albedoIsBlack));
}

void TileLight::setGloss(Raster<std::array<float, 2>> gloss)
{
    Lock lock(_mutex);
    assert(gloss.size() == 0 || (gloss.width() == width() && gloss.height() == height()));
    _gloss = std::move(gloss);
    _hasGloss = std::any_of(_gloss.values().begin(), _gloss.values().end(),
                            [](const std::array<float, 2>& post) { return post[0] > 0.0f; });
    forgetGloss();
    followGloss();
}

void TileLight::forgetGloss()
{
    _materialTexture = nullptr;
    _glossPass = nullptr;
    _bounce = nullptr; // it holds the pass
    _chain.touch(_bounceValue);
}

void TileLight::followGloss()
{
    if (!glossNeeded())
        _glossLight = nullptr;
    else if (!_glossLight)
    {
        _glossLight = createLayeredTarget(width(), height(), GlossPass::layers, GL_RGBA16F_ARB);
        forgetGloss();
    }
}

osg::ref_ptr<osg::Texture2DArray> TileLight::glossLight() const
{
    Lock lock(_mutex);
    return _glossLight;
}

void TileLight::setAlbedo(Raster<Rgb> albedo)
{
    Lock lock(_mutex);
    assert(albedo.size() == 0 || (albedo.width() == width() && albedo.height() == height()));
    _albedo = std::move(albedo);
    _albedoIsBlack = std::all_of(_albedo.values().begin(), _albedo.values().end(), isBlack);
    _albedoTexture = nullptr;
    _chain.touch(_bounceValue);
}

bool TileLight::setProbes(std::vector<ProbePlace> probes)
{
    Lock lock(_mutex);
    if (probes == _probes)
        return false;
    _probes = std::move(probes);
    _chain.touch(_probeValue);
    return true;
}

void TileLight::setSky(const SkyLight& sky)
{
    Lock lock(_mutex);
    if (sky.sunAzimuth != _sky.sunAzimuth || sky.sunElevation != _sky.sunElevation ||
        sky.sunAngularRadius != _sky.sunAngularRadius)
        _chain.touch(_sunPlaceValue);
    if (!sameSky(sky, _sky))
        _chain.touch(_harmonicsValue);
    // What has horizons of its own is the slices' places; their light is read when it is needed.
    const auto places = [this](const SkyLight& light)
    {
        std::vector<std::array<double, 3>> found;
        for (const KeySlices& key : keySlices(light, _settings.azimuths))
            found.push_back({key.first, key.width, double(key.count)});
        return found;
    };
    if (places(sky) != places(_sky))
    {
        _key = nullptr;
        _chain.touch(_keyPlaceValue);
    }
    _sky = sky;
    followGloss();
    _chain.touch(_lightValue);
}

void TileLight::setHeights(const std::vector<float>& heights)
{
    assert(heights.size() == _tile.postCount());
    Lock lock(_mutex);
    if (!_ownHeights)
        _ownHeights = new HeightTexture(width(), height());
    _ownHeights->set(heights.data());
    setPosts(_ownHeights);
}

void TileLight::setHeightTexture(osg::Texture2D* posts)
{
    Lock lock(_mutex);
    setPosts(posts);
}

void TileLight::touchHeights()
{
    Lock lock(_mutex);
    _chain.touch(_heightsValue);
}

void TileLight::setPosts(osg::Texture2D* posts)
{
    assert(posts);
    _chain.touch(_heightsValue);
    const bool first = !_posts;
    _posts = posts;
    if (first)
    {
        _framePass = new GpuPass("frame_heights");
        _framePass->set("size", width(), height());
        createHeights();
        _horizon = nullptr;
        _sun = nullptr;
        _pyramid = nullptr;
        _direct = nullptr;
        _key = nullptr;
        _bounce = nullptr;
        _glossPass = nullptr;
    }
    _framePass->reads("posts", _posts);
}

void TileLight::touch()
{
    Lock lock(_mutex);
    _chain.touch(_settingsValue);
    _chain.touch(_lightValue);
}

void TileLight::recompute()
{
    Lock lock(_mutex);
    _chain.forget(~0u);
}

Status TileLight::update(osg::State& state, const std::function<bool()>& mayContinue)
{
    Lock lock(_mutex);
    const unsigned id = state.getContextID();
    Pace& pace = _paces[id];
    if (pace.waits && sumNeeded() && !_chain.isDirty(id, _shadeOutput))
    {
        // Light stands still. The shading holds earlier bounces: it begins anew, too.
        pace.due = true;
        _chain.forget(id, _shadeOutput);
    }
    return _chain.run(state, mayContinue);
}

PassChain::Turn TileLight::bounceTurn(unsigned contextID)
{
    Pace& pace = _paces[contextID];
    ++pace.updates;
    const unsigned interval = static_cast<unsigned>(_settings.bounceInterval);
    pace.waits = sumNeeded() && !pace.due && (pace.updates + _turn) % interval != 0;
    pace.due = false;
    return pace.waits ? PassChain::Turn::Wait : PassChain::Turn::Run;
}

bool TileLight::isDirty(unsigned contextID) const
{
    Lock lock(_mutex);
    return _chain.isDirty(contextID);
}

Status TileLight::runHeights(osg::State& state)
{
    // A pass of the host may have written the posts: OSG issues no barrier after it.
    state.get<osg::GLExtensions>()->glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    return _framePass->dispatch(state, {GpuPass::groupsFor(width() + 2 * frame(), 8),
                                        GpuPass::groupsFor(height() + 2 * frame(), 8), 1});
}

Status TileLight::runHorizon(osg::State& state)
{
    if (!_horizon)
    {
        const AzimuthSet set(_settings.azimuths);
        std::vector<MapDirection> directions;
        for (int k = 0; k < set.count(); ++k)
            directions.push_back(set.direction(k));
        _horizon =
            new HorizonPass(_tile, _heights, HorizonScheme::of(_settings.quality), set.count());
        _horizon->setDirections(directions);
    }
    return _horizon->dispatch(state);
}

Status TileLight::runTable(osg::State& state)
{
    if (!_table)
        _table = new SkyTablePass(_settings.azimuths);
    return _table->dispatch(state, _sky);
}

SkyLight TileLight::lightAtGround() const
{
    SkyLight light = _sky;
    light.sunIrradiance = sunAtGround(_sky);
    return light;
}

SkyLight TileLight::lightInHarmonics() const
{
    SkyLight light = lightAtGround();
    if (skyHasTable(_sky))
        light.skyHarmonics = harmonicsOf(_sky);
    return light;
}

AreaLights TileLight::areaLights() const
{
    return {_table ? _table->table() : nullptr, _key ? _key->horizon() : nullptr,
            keySlices(_sky, _settings.azimuths), _sun ? _sun->horizon() : nullptr, lightAtGround()};
}

Status TileLight::runSky(osg::State& state)
{
    const GLint format = tableNeeded() ? GL_RGBA16F_ARB : GL_R32F;
    if (!_skyView || _skyView->getInternalFormat() != format)
    {
        _skyView = createTarget(width(), height(), format);
        _skyPass->writes(0, _skyView);
    }
    AreaLights sky;
    sky.skyTable = areaLights().skyTable;
    sky.apply(*_skyPass);
    _skyPass->reads("horizon", _horizon->horizon());
    _skyPass->set("azimuths", _settings.azimuths);
    _skyPass->set("definition", static_cast<int>(_definition));
    return _skyPass->dispatch(state,
                              {GpuPass::groupsFor(width(), 8), GpuPass::groupsFor(height(), 8), 1});
}

Status TileLight::runSun(osg::State& state)
{
    if (!_sun)
        _sun =
            new HorizonPass(_tile, _heights, HorizonScheme::ofSun(_settings.quality), sunAzimuths);
    const std::array<MapDirection, 3> directions = sunDirections();
    _sun->setDirections({directions.begin(), directions.end()});
    return _sun->dispatch(state);
}

std::array<MapDirection, 3> TileLight::sunDirections() const
{
    // SUN_SIDE of the disc's radius to either side, as an azimuth: less than 90 degrees, all around
    // where the disc holds the zenith.
    const double side = static_cast<double>(Glsl<float>::SUN_SIDE) * _sky.sunAngularRadius;
    const double turn = std::atan2(std::sin(side * radiansPerDegree),
                                   std::cos(_sky.sunElevation * radiansPerDegree)) /
                        radiansPerDegree;
    return {directionOfCompass(_sky.sunAzimuth - turn), directionOfCompass(_sky.sunAzimuth),
            directionOfCompass(_sky.sunAzimuth + turn)};
}

Status TileLight::runKey(osg::State& state)
{
    const std::vector<MapDirection> directions = directionsOf(keySlices(_sky, _settings.azimuths));
    if (!_key)
        _key = new HorizonPass(_tile, _heights, HorizonScheme::of(_settings.quality),
                               static_cast<int>(directions.size()));
    _key->setDirections(directions);
    return _key->dispatch(state);
}

Status TileLight::runShade(osg::State& state)
{
    if (legendreNeeded())
    {
        if (!_direct)
            _direct = new LegendreDirectPass(_tile, *_pyramid, _eastSpacings,
                                             LegendreScheme::of(_settings));
        return _direct->dispatch(state, lightInHarmonics(), _shading);
    }
    _direct = nullptr;
    GpuPass& pass = *_shadePass;
    areaLights().apply(pass);
    pass.reads("skyView", skyNeeded() ? _skyView.get() : _nothing.get());
    pass.set("hasSky", skyNeeded());
    pass.set("skyRadiance", vec3(skyGain(_sky)));
    pass.set("sunOff", _sky.sunEnabled ? 0.0f : 1.0f);
    return pass.dispatch(state,
                         {GpuPass::groupsFor(width(), 8), GpuPass::groupsFor(height(), 8), 1});
}

void TileLight::createGlossPass()
{
    if (!_materialTexture)
    {
        Raster<Rgb> material(1, 1,
                             {static_cast<float>(_settings.gloss),
                              static_cast<float>(_settings.glossExponent), 0.0f});
        if (_gloss.size())
        {
            material = Raster<Rgb>(width(), height());
            for (std::size_t i = 0; i < material.size(); ++i)
                material.values()[i] = {_gloss.values()[i][0], _gloss.values()[i][1], 0.0f};
        }
        _materialTexture = createColourTexture(material);
    }
    if (!_glossPass)
    {
        _glossPass = new GlossPass(_tile, _heights, _eastSpacings, _materialTexture, _glossLight,
                                   _settings.azimuths, bounceNeeded() ? _settings.bounces : 0,
                                   _settings.glossTransfer, _settings.glossViewer);
    }
}

Status TileLight::runGloss(osg::State& state)
{
    createGlossPass();
    SkyLight sky = lightInHarmonics();
    sky.sunEnabled = sunNeeded();
    return _glossPass->dispatchDirect(state, sky, areaLights(),
                                      _horizon ? _horizon->horizon() : nullptr, _shading);
}

Status TileLight::runPyramid(osg::State& state)
{
    // It runs where anything but light has changed that bounces depend on.
    _paces[state.getContextID()].due = true;
    if (!bySlices())
    {
        if (!_pyramid)
            _pyramid = new HeightPyramid(_tile, _heights, frame());
        return _pyramid->dispatch(state);
    }
    if (glossNeeded())
        createGlossPass(); // bounces hold it
    if (!_bounce)
        _bounce =
            new BouncePass(_tile, _heights, _eastSpacings, BounceScheme::of(_settings.quality),
                           _settings.azimuths, _settings.subsampling, _glossPass);
    return _bounce->dispatchHeights(state);
}

Status TileLight::runBounce(osg::State& state)
{
    if (!_bounce)
        _bounce = new LegendreBouncePass(_tile, *_pyramid, _eastSpacings,
                                         LegendreScheme::of(_settings), _settings.bounces);
    createAlbedo();
    _bounce->setAreaLights(areaLights());
    if (sumNeeded() && !_sum)
        _sum = new LightSum(width(), height());
    _bounce->keepSum(sumNeeded() ? _sum.get() : nullptr);
    Status done =
        _bounce->dispatch(state, _settings.bounces, _sky, _horizon ? _horizon->horizon() : nullptr,
                          _albedoTexture, _shading);
    if (!done) // some of it may have been added: shade anew before the next try
        _chain.touch(_bounceValue);
    return done;
}

void TileLight::createAlbedo()
{
    if (!_albedoTexture)
        _albedoTexture =
            createColourTexture(_albedo.size() ? _albedo : Raster<Rgb>(1, 1, _settings.albedo));
}

Status TileLight::runProbe(osg::State& state)
{
    if (!_probePass)
        _probePass = new ProbePass(_tile);
    createAlbedo();
    ProbePass::Light light;
    light.heights = _heights;
    light.frame = frame();
    light.shading = _shading;
    light.albedo = _albedoTexture;
    light.sky = tableNeeded() ? _table->picture() : nullptr;
    light.light = _sky;
    light.hasSun = sunNeeded();
    light.sun = sunDirections();
    for (const ProbePlace& place : _probes)
        if (Status done = _probePass->dispatch(state, place, light); !done)
            return done;
    return Nothing{};
}

Raster<osg::Vec4f> TileLight::coloursOf(const std::vector<float>& values) const
{
    Raster<osg::Vec4f> colours(width(), height());
    for (std::size_t i = 0; i < colours.size(); ++i)
        colours.values()[i] =
            osg::Vec4f(values[4 * i], values[4 * i + 1], values[4 * i + 2], values[4 * i + 3]);
    return colours;
}

std::vector<float> TileLight::readGlossLight(osg::State& state) const
{
    assert(_glossLight);
    return readFloats(state, *_glossLight, 4);
}

Raster<osg::Vec4f> TileLight::readShading(osg::State& state) const
{
    return coloursOf(readFloats(state, *_shading, 4));
}

Raster<osg::Vec4f> TileLight::readLastBounce(osg::State& state) const
{
    assert(_bounce);
    const Result<std::vector<float>> light = _bounce->readLight(state);
    assert(light.ok()); // its shaders have just run
    return coloursOf(light.value());
}

Raster<float> TileLight::readSkyView(osg::State& state) const
{
    assert(_skyView);
    Raster<float> view(width(), height());
    view.values() = readFloats(state, *_skyView, 1);
    for (std::size_t i = 0; i < view.size(); ++i)
        if (view.values()[i] <= -1.0f) // void
            view.values()[i] = std::numeric_limits<float>::quiet_NaN();
    return view;
}

HorizonMap TileLight::readHorizons(osg::State& state) const
{
    assert(_horizon);
    HorizonMap map(width(), height(), _settings.azimuths);
    map.codes() = readUnorm16(state, *_horizon->horizon());
    return map;
}

unsigned TileLight::readDroppedVertices(osg::State& state) const
{
    unsigned count = 0;
    for (const auto& pass : {_horizon, _sun, _key})
        if (pass)
            count += readUints(state, *pass->dropped()).front();
    return count;
}

std::vector<StageCost> TileLight::costs() const
{
    Lock lock(_mutex);
    std::vector<StageCost> costs = _chain.costs();
    if (!_posts)
        costs.erase(costs.begin()); // heights that nothing changes have no stage
    if (_probes.empty() && costs.back().dispatches == 0)
        costs.pop_back(); // nor have probes that there are none of
    const auto indirect = std::find_if(
        costs.begin(), costs.end(), [](const StageCost& cost) { return cost.name == "indirect"; });
    if (!sumNeeded() && indirect->dispatches == 0)
        costs.erase(indirect); // nor have bounces that are never kept
    return costs;
}

std::size_t TileLight::bytes() const
{
    std::size_t sum = textureBytes(*_heights) + textureBytes(*_eastSpacings) +
                      (_ownHeights ? textureBytes(*_ownHeights) : 0);
    for (const StageCost& cost : costs())
        sum += cost.bytes;
    return sum;
}

void TileLight::releaseGLObjects(osg::State* state) const
{
    Lock lock(_mutex);
    _chain.forget(state ? state->getContextID() : ~0u);
    for (const auto& pass : {_horizon, _sun, _key})
        if (pass)
            pass->releaseGLObjects(state);
    if (_table)
        _table->releaseGLObjects(state);
    for (const auto& pass : {_skyPass, _shadePass, _framePass})
        if (pass)
            pass->releaseGLObjects(state);
    if (_ownHeights)
        _ownHeights->releaseGLObjects(state);
    if (_pyramid)
        _pyramid->releaseGLObjects(state);
    if (_direct)
        _direct->releaseGLObjects(state);
    if (_bounce)
        _bounce->releaseGLObjects(state);
    if (_sum)
        _sum->releaseGLObjects(state);
    if (_glossPass)
        _glossPass->releaseGLObjects(state);
    if (_probePass)
        _probePass->releaseGLObjects(state);
    for (const osg::Texture* texture :
         {static_cast<osg::Texture*>(_glossLight), static_cast<osg::Texture*>(_materialTexture)})
        if (texture)
            texture->releaseGLObjects(state);
    for (const auto& texture :
         {_heights, _eastSpacings, _skyView, _shading, _albedoTexture, _nothing})
        if (texture)
            texture->releaseGLObjects(state);
}

void TileLight::resizeGLObjectBuffers(unsigned size)
{
    Lock lock(_mutex);
    for (const auto& pass : {_horizon, _sun, _key})
        if (pass)
            pass->resizeGLObjectBuffers(size);
    if (_table)
        _table->resizeGLObjectBuffers(size);
    for (const auto& pass : {_skyPass, _shadePass, _framePass})
        if (pass)
            pass->resizeGLObjectBuffers(size);
    if (_posts)
        _posts->resizeGLObjectBuffers(size);
    if (_pyramid)
        _pyramid->resizeGLObjectBuffers(size);
    if (_direct)
        _direct->resizeGLObjectBuffers(size);
    if (_bounce)
        _bounce->resizeGLObjectBuffers(size);
    if (_sum)
        _sum->resizeGLObjectBuffers(size);
    if (_glossPass)
        _glossPass->resizeGLObjectBuffers(size);
    if (_probePass)
        _probePass->resizeGLObjectBuffers(size);
    for (osg::Texture* texture :
         {static_cast<osg::Texture*>(_glossLight), static_cast<osg::Texture*>(_materialTexture)})
        if (texture)
            texture->resizeGLObjectBuffers(size);
    for (const auto& texture :
         {_heights, _eastSpacings, _skyView, _shading, _albedoTexture, _nothing})
        if (texture)
            texture->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
