#include "lighting/TileLight.h"

#include "core/KeySlices.h"
#include "core/SettingsTable.h"
#include "gpu/GlConstants.h"
#include "lighting/Readback.h"
#include "lighting/TileWindows.h"
#include "lighting/methods/Legendre.h"
#include "lighting/methods/Slices.h"
#include "lighting/nodes/ComposeNode.h"
#include "lighting/nodes/FrameHeightsNode.h"
#include "lighting/nodes/ObjectFactorNode.h"
#include "lighting/nodes/ProbeNode.h"

#include <OpenThreads/ScopedLock>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <tuple>
#include <utility>

namespace osgTerrainLight
{

namespace
{
using Lock = OpenThreads::ScopedLock<OpenThreads::Mutex>;

/// 0, 1, 2, …: tiles made one after another take turns.
unsigned nextTurn()
{
    static std::atomic<unsigned> next{0};
    return next++;
}

/// What the nodes of light transport are made for besides settings that invalidate
/// Invalidation::Transport: where it changes they are made anew.
auto transportKey(const TileValues& values, int width, int height)
{
    return std::make_tuple(values.bounces(width, height), values.isGlossy(), values.isPaced());
}
} // namespace

TileLight::TileLight(const DemTile& tile, const LightingSettings& settings, const SkyLight& sky,
                     SkyViewDefinition definition)
    : TileLight(tile, nullptr, settings, sky, definition)
{
}

TileLight::TileLight(std::shared_ptr<const TileWindows> windows, const LightingSettings& settings,
                     const SkyLight& sky, SkyViewDefinition definition)
    : TileLight(windows->tile, windows, settings, sky, definition)
{
}

TileLight::TileLight(const DemTile& tile, std::shared_ptr<const TileWindows> windows,
                     const LightingSettings& settings, const SkyLight& sky,
                     SkyViewDefinition definition)
    : _tile(tile), _windows(std::move(windows)), _inputs(new TileInputs),
      _shading(new Resource("shading", {tile.width(), tile.height(), 0, GL_RGBA16F_ARB})),
      _glossLight(new Resource("light of gloss",
                               {tile.width(), tile.height(), GlossWork::layers, GL_RGBA16F_ARB})),
      _edges(new Resource("edges on screen", {tile.width(), tile.height(), 0, GL_RGBA16F_ARB})),
      _factor(new Resource("light left by objects", {1, 1, 0, GL_RGBA16F_ARB})), _turn(nextTurn())
{
    _latest.settings = settings;
    _latest.sky = sky;
    _latest.definition = definition;
    static_cast<TileValues&>(*_inputs) = _latest;
    _shading->keepWhole();
    _edges->keepWhole();
    _shading->make();
    declareMethod();
    declareTransport();
    _declared = _graph.declare(nodes());
}

bool TileLight::needsSun(const SkyLight& sky)
{
    TileValues values;
    values.sky = sky;
    return values.hasSun();
}

int TileLight::keyAzimuths(const SkyLight& sky, const LightingSettings& settings)
{
    return static_cast<int>(directionsOf(keySlices(sky, settings.azimuths)).size());
}

void TileLight::setSettings(const LightingSettings& settings)
{
    Lock lock(_mutex);
    _changes.settings = _changes.settings || !(settings == _latest.settings);
    _latest.settings = settings;
}

void TileLight::setSky(const SkyLight& sky)
{
    Lock lock(_mutex);
    _changes.sky = true;
    _latest.sky = sky;
}

void TileLight::setAlbedo(Raster<Rgb> albedo)
{
    assert(albedo.size() == 0 || (albedo.width() == width() && albedo.height() == height()));
    const bool isBlack = std::all_of(albedo.values().begin(), albedo.values().end(),
                                     [](const Rgb& post) { return isBlackAlbedo(post); });
    const auto shared =
        albedo.size() > 0 ? std::make_shared<const Raster<Rgb>>(std::move(albedo)) : nullptr;
    Lock lock(_mutex);
    _changes.albedo = true;
    _latest.albedo = shared;
    _latest.albedoIsBlack = isBlack;
}

void TileLight::setGloss(Raster<std::array<float, 2>> gloss)
{
    assert(gloss.size() == 0 || (gloss.width() == width() && gloss.height() == height()));
    const bool hasGloss =
        std::any_of(gloss.values().begin(), gloss.values().end(),
                    [](const std::array<float, 2>& post) { return post[0] > 0.0f; });
    const auto shared = gloss.size() > 0
                            ? std::make_shared<const Raster<std::array<float, 2>>>(std::move(gloss))
                            : nullptr;
    Lock lock(_mutex);
    _changes.gloss = true;
    _latest.gloss = shared;
    _latest.hasGloss = hasGloss;
}

void TileLight::setFarLight(std::shared_ptr<const FarLight> light)
{
    assert(_windows);
    Lock lock(_mutex);
    _changes.farLight = true;
    _latest.farLight = std::move(light);
}

bool TileLight::setProbes(std::vector<ProbePlace> probes)
{
    Lock lock(_mutex);
    if (probes == _latest.probes)
        return false;
    _changes.probes = true;
    _latest.probes = std::move(probes);
    return true;
}

bool TileLight::setObjects(TileObjects objects)
{
    Lock lock(_mutex);
    if (objects == _latest.objects)
        return false;
    _changes.objects = true;
    _latest.objects = std::move(objects);
    return true;
}

void TileLight::setHeights(const std::vector<float>& heights)
{
    assert(heights.size() == _tile.postCount());
    Lock lock(_mutex);
    if (!_ownPosts)
        _ownPosts = new HeightTexture(width(), height());
    _ownPosts->set(heights.data());
    _latest.posts = _ownPosts;
    _latest.ownsPosts = true;
    _changes.posts = true;
}

void TileLight::setHeightTexture(osg::Texture2D* posts)
{
    assert(posts);
    Lock lock(_mutex);
    _latest.posts = posts;
    _latest.ownsPosts = false;
    _changes.posts = true;
}

void TileLight::touchHeights()
{
    Lock lock(_mutex);
    _changes.posts = true;
}

void TileLight::touch()
{
    Lock lock(_mutex);
    _changes.touched = true;
}

void TileLight::recompute()
{
    Lock lock(_mutex);
    _changes.recompute = true;
}

/// Takes up what setters have set.
Status TileLight::apply()
{
    Lock lock(_mutex);
    if (!_changes.any())
        return _declared;
    const TileValues before = *_inputs;
    static_cast<TileValues&>(*_inputs) = _latest;
    const Invalidation stale =
        changed(before.settings, _inputs->settings) | changed(before.sky, _inputs->sky);
    followValues(stale);
    const bool recompute = _changes.recompute;
    _changes = Changes();
    const bool isNew =
        std::exchange(_resting, false) ||
        meets(stale, Invalidation::Heights | Invalidation::Horizons | Invalidation::Method) ||
        before.posts.valid() != _inputs->posts.valid();
    if (isNew)
        declareMethod();
    else
        _method->follow(stale);
    const bool isOther =
        isNew || before.farLight != _inputs->farLight || meets(stale, Invalidation::Transport) ||
        (_inputs->isGlossy() && meets(stale, Invalidation::GlossTransfer)) ||
        transportKey(before, width(), height()) != transportKey(*_inputs, width(), height());
    if (isOther)
        declareTransport();
    // The node reads the volumes that there are.
    const bool isOtherVolume =
        before.objects.size() != _inputs->objects.size() ||
        !std::equal(before.objects.begin(), before.objects.end(), _inputs->objects.begin(),
                    [](const TileObject& a, const TileObject& b) { return a.volume == b.volume; });
    if (isOther)
        _objectRadiosities.clear();
    if (isOther || isOtherVolume)
        _objectFactor = nullptr;
    if (isOther || isOtherVolume || before.probes.empty() != _inputs->probes.empty())
        _declared = _graph.declare(nodes());
    if (recompute)
        _graph.forget(~0u);
    return _declared;
}

/// Touches the values that have changed.
void TileLight::followValues(Invalidation stale)
{
    using I = Invalidation;
    const TileInputs& now = *_inputs;
    const auto renew = [](Resource& texture)
    {
        texture.drop();
        texture.touch();
    };
    if (_changes.albedo || meets(stale, I::Albedo))
        renew(*now.albedoTexture);
    if (_changes.gloss || meets(stale, I::Gloss))
        renew(*now.materialTexture);
    if (_changes.posts)
        now.postsValue->touch();
    if (_changes.probes)
        now.probePlaces->touch();
    if (_changes.objects)
    {
        // Another texture: the one there was is drawn with its own places until this is computed.
        _factor->drop();
        _factor->setLayout(ObjectFactorNode::layoutOf(now.objects));
        _factorContexts.clear();
        ++_objectsRevision;
        now.objectsValue->touch();
    }
    if (_changes.touched)
        now.settingsValue->touch();
    const bool isLitAnew = meets(stale, I::Light);
    if (isLitAnew || _changes.touched)
        now.light->touch();
    // A clear sky follows its sun.
    const bool isClear = now.sky.skyModel == SkyModel::Clear;
    if (meets(stale, I::SkyShape) || (isClear && isLitAnew))
        now.skyValue->touch();
    if (meets(stale, I::SunPlace))
        now.sunPlace->touch();
    if (isLitAnew)
        ++_lightChanges;
    const unsigned interval = static_cast<unsigned>(now.settings.bounceInterval);
    if (meets(stale, I::Pace) || (isLitAnew && (_lightChanges + _turn) % interval == 0))
        now.bouncesDue->touch();
}

/// Makes the surface, and what computes direct light and bounces on it.
void TileLight::declareMethod()
{
    const TileInputs& now = *_inputs;
    const bool bySlices = now.bySlices();
    const bool isSurrounded = _windows && bySlices;
    const int frame = !bySlices      ? int(Legendre::frame)
                      : isSurrounded ? TileSurface::frameOf(*_windows, Slices::frame)
                                     : int(Slices::frame);
    const double radius = now.settings.bodyRadius;
    const bool changing = now.posts.valid();
    if (!_surface || frame != _surface->frame() || radius != _surface->bodyRadius() ||
        changing != _surface->isChanging())
    {
        assert(!_windows || !changing);
        _surface = isSurrounded ? new TileSurface(_windows, frame, radius)
                                : new TileSurface(_tile, frame, radius, changing);
        _heights = changing ? new FrameHeightsNode(now, *_surface) : nullptr;
    }
    _probe = nullptr;
    _table = new SkyTableNode(now, now.settings.azimuths);
    if (bySlices)
        _method = new Slices(now, *_surface, _table);
    else
        _method = new Legendre(now, *_surface, _table);
    const bool forGround = _method->readsSkyTable();
    _table->neededWhere(
        [in = _inputs, forGround] {
            return in->hasSkyTable() && (forGround || !in->probes.empty() || !in->objects.empty());
        });
}

/// Makes the nodes of direct light and bounces.
void TileLight::declareTransport()
{
    _transport.clear();
    const int bounces = _inputs->bounces(width(), height());
    _direct = _shading;
    if (bounces > 0)
        _direct = new Resource("direct light", _surface->perPost(GL_RGBA16F_ARB));
    _method->declareDirect(_transport, _direct, bounces, _glossLight);
    if (_inputs->settings.shadowEdges)
        _method->declareEdges(_transport, _edges);
    else
        _edges->drop();
    _bounces.clear();
    for (int bounce = 0; bounce < bounces; ++bounce)
        _bounces.push_back(_method->declareBounce(_transport));
    if (bounces > 0)
        _transport.emplace_back(
            new ComposeNode(*_surface, _direct, _bounces, _shading, _method->mayUndershoot()));
}

/// All that there are now, in the order in which they run.
WorkGraph::Nodes TileLight::nodes()
{
    WorkGraph::Nodes all;
    if (_heights)
        all.push_back(_heights);
    for (const auto& source : _method->sources())
        all.push_back(source);
    all.insert(all.end(), _transport.begin(), _transport.end());
    if (_inputs->probes.empty())
        _probe = nullptr;
    else if (!_probe)
        _probe = new ProbeNode(*_inputs, *_surface, _shading, _table->picture());
    if (_probe)
        all.push_back(_probe);
    declareObjects();
    all.insert(all.end(), _objectRadiosities.begin(), _objectRadiosities.end());
    if (_objectFactor)
        all.push_back(_objectFactor);
    return all;
}

/// Makes the nodes of objects that are missing. A volume that stays keeps what its objects send
/// until that is computed anew.
void TileLight::declareObjects()
{
    const ObjectSurroundings light{_direct, _shading, _method->skyHorizon(), _table->picture()};
    const auto before = std::exchange(_objectRadiosities, {});
    const auto isOn = [&](const TileObject& object)
    {
        const glm::dvec2 end = object.spacing * glm::dvec2(width() - 1, height() - 1);
        return object.high.x >= 0.0 && object.high.y >= 0.0 && object.low.x <= end.x &&
               object.low.y <= end.y;
    };
    for (const TileObject& object : _inputs->objects)
        // Those beside the tile only cast their shadows on it.
        if (_inputs->settings.bounces > 0 && isOn(object))
        {
            const auto same =
                std::find_if(before.begin(), before.end(),
                             [&](const auto& node) { return node->volume() == object.volume; });
            if (same != before.end())
                _objectRadiosities.push_back(*same);
            else
                _objectRadiosities.emplace_back(
                    new ObjectRadiosityNode(*_inputs, *_surface, light, object));
        }
    if (_inputs->objects.empty())
        _objectFactor = nullptr;
    else if (!_objectFactor)
        _objectFactor =
            new ObjectFactorNode(*_inputs, *_surface, light, _objectRadiosities, _factor);
}

Status TileLight::update(osg::State& state, WorkPace* pace)
{
    Lock computing(_computing);
    const unsigned context = state.getContextID();
    const bool goesOn = _unfinished.erase(context) > 0;
    if (Status applied = goesOn ? _declared : apply(); !applied)
        return applied;
    // Light stands still: bounces follow it at last.
    if (_graph.isStale(context))
        _inputs->bouncesDue->touch(context);
    Status done = _graph.run(state, pace);
    if (pace && pace->isStopped())
        _unfinished.insert(context);
    else if (done)
    {
        Lock lock(_mutex);
        if (_objectFactor && _factorContexts.insert(context).second)
            ++_objectsRevision;
    }
    return done;
}

bool TileLight::isDirty(unsigned contextID) const
{
    Lock lock(_mutex);
    return _changes.any() || _graph.isDirty(contextID);
}

void TileLight::rest()
{
    Lock computing(_computing);
    Lock lock(_mutex);
    if (_resting || _changes.any() || !_unfinished.empty() || _inputs->isGlossy() ||
        _inputs->hasEdges() || !_inputs->probes.empty() || !_inputs->objects.empty() ||
        _inputs->posts.valid())
        return;
    // What is drawn stays: nodes own it.
    const osg::ref_ptr<osg::Texture> drawn = _shading->texture();
    _graph.declare({});
    _shading->set(drawn);
    _transport.clear();
    _method = nullptr;
    _table = nullptr;
    _surface = nullptr;
    _resting = true;
}

bool TileLight::isResting() const
{
    Lock lock(_mutex);
    return _resting;
}

osg::Texture2D* TileLight::shading() const
{
    return static_cast<osg::Texture2D*>(_shading->texture());
}

osg::ref_ptr<osg::Texture2DArray> TileLight::glossLight() const
{
    Lock lock(_mutex);
    return _inputs->isGlossy() ? static_cast<osg::Texture2DArray*>(_glossLight->make()) : nullptr;
}

std::optional<TileLight::DrawnObjects>
TileLight::drawnObjects(const std::set<unsigned>& contexts) const
{
    Lock lock(_mutex);
    if (_inputs->objects.empty())
        return DrawnObjects();
    if (!std::includes(_factorContexts.begin(), _factorContexts.end(), contexts.begin(),
                       contexts.end()))
        return std::nullopt;
    return DrawnObjects{static_cast<osg::Texture2D*>(_factor->texture()), _inputs->objects};
}

TileLight::ObjectRadiosity TileLight::objectRadiosity(const Resource& volume,
                                                      const std::set<unsigned>& contexts) const
{
    Lock lock(_mutex);
    for (const auto& node : _objectRadiosities)
        if (node->volume() == &volume && !contexts.empty() &&
            std::all_of(contexts.begin(), contexts.end(),
                        [&](unsigned context) { return node->written().has(context); }))
            return {node->radiosity()->texture(), node->groundShare()->texture()};
    return {};
}

unsigned TileLight::objectsRevision() const
{
    Lock lock(_mutex);
    return _objectsRevision;
}

osg::ref_ptr<osg::Texture2D> TileLight::shadowEdges() const
{
    Lock lock(_mutex);
    return _inputs->hasEdges() ? static_cast<osg::Texture2D*>(_edges->make()) : nullptr;
}

std::vector<float> TileLight::readGlossLight(osg::State& state) const
{
    return readColourValues(state, *_glossLight);
}

Raster<osg::Vec4f> TileLight::readShading(osg::State& state) const
{
    return readColours(state, *_shading);
}

Raster<osg::Vec4f> TileLight::readDirect(osg::State& state) const
{
    return readColours(state, *_direct);
}

Raster<osg::Vec4f> TileLight::readBounce(osg::State& state, int bounce) const
{
    assert(bounce >= 1 && bounce <= static_cast<int>(_bounces.size()));
    return readColours(state, *_bounces[static_cast<std::size_t>(bounce - 1)]);
}

Raster<float> TileLight::readSkyView(osg::State& state) const
{
    assert(_method->skyView());
    return osgTerrainLight::readSkyView(state, *_method->skyView());
}

HorizonMap TileLight::readHorizons(osg::State& state) const
{
    assert(!_method->horizons().empty());
    return osgTerrainLight::readHorizons(state, *_method->horizons().front()->horizon());
}

unsigned TileLight::readDroppedVertices(osg::State& state) const
{
    unsigned count = 0;
    for (const HorizonNode* node : _method->horizons())
        count += readCounter(state, *node->dropped());
    return count;
}

std::vector<StageCost> TileLight::costs() const
{
    Lock lock(_mutex);
    return _graph.costs();
}

std::size_t TileLight::bytes() const
{
    Lock lock(_mutex);
    std::size_t bytes = _resting ? _shading->bytes() : _surface->bytes() + _graph.bytes();
    if (_resting && !_bounces.empty())
        bytes += _direct->bytes();
    for (const auto& bounce : _bounces)
        bytes += _resting ? bounce->bytes() : 0;
    return bytes;
}

void TileLight::releaseGLObjects(osg::State* state) const
{
    Lock computing(_computing);
    if (state)
        _unfinished.erase(state->getContextID());
    else
        _unfinished.clear();
    {
        Lock lock(_mutex);
        if (state)
            _factorContexts.erase(state->getContextID());
        else
            _factorContexts.clear();
        for (const auto& node : _objectRadiosities)
            node->forget(state ? state->getContextID() : ~0u);
    }
    if (isResting())
    {
        // What is left of the light goes as well: it is computed anew.
        _shading->releaseGLObjects(state);
        Lock lock(_mutex);
        _changes.recompute = true;
        return;
    }
    _surface->releaseGLObjects(state);
    _graph.releaseGLObjects(state);
}

void TileLight::resizeGLObjectBuffers(unsigned size)
{
    Lock computing(_computing);
    if (_surface)
        _surface->resizeGLObjectBuffers(size);
    _graph.resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
