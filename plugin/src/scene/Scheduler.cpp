#include "scene/Scheduler.h"

#include "gpu/GpuCapabilities.h"

#include <osg/Notify>

#include <algorithm>
#include <limits>

namespace osgTerrainLight
{

namespace
{
using Lock = std::lock_guard<std::mutex>;
} // namespace

void Scheduler::add(LitTile* tile)
{
    Lock lock(_mutex);
    _tiles.emplace_back(tile);
    touch();
    _alone += tile->isSurrounded() ? 0 : 1;
    _updatesAlone = 0;
}

void Scheduler::tellAlone()
{
    Lock lock(_mutex);
    _updatesAlone = _alone >= 2 ? _updatesAlone + 1 : 0;
    if (_updatesAlone < updatesToTellAlone || _saidAlone)
        return;
    _saidAlone = true;
    OSG_WARN << "osgTerrainLight: the scene has several terrain tiles that touch no other one. "
                "Each of them is lit alone, so its shadows end at its edge. Tiles of osgTerrain "
                "whose edges meet light one another, and so do tiles of addTile() that say where "
                "they lie on the map."
             << std::endl;
}

void Scheduler::remove(LitTile* tile)
{
    Lock lock(_mutex);
    const auto gone = std::remove(_tiles.begin(), _tiles.end(), tile);
    if (gone != _tiles.end() && !tile->isSurrounded())
        --_alone;
    _tiles.erase(gone, _tiles.end());
    for (auto& [id, context] : _contexts)
    {
        context.sights.erase(tile);
        if (context.begun == tile)
            context.begun = nullptr;
    }
}

void Scheduler::setSettings(const LightingSettings& settings)
{
    Lock lock(_mutex);
    auto light = std::make_shared<SceneLight>(*_light);
    light->settings = settings;
    ++light->settingsVersion;
    _light = std::move(light);
    touch();
}

void Scheduler::setSky(const SkyLight& sky)
{
    Lock lock(_mutex);
    auto light = std::make_shared<SceneLight>(*_light);
    light->sky = sky;
    ++light->skyVersion;
    _light = std::move(light);
    touch();
}

std::shared_ptr<const SceneLight> Scheduler::light() const
{
    Lock lock(_mutex);
    return _light;
}

void Scheduler::forget(unsigned context)
{
    Lock lock(_mutex);
    for (const auto& tile : _tiles)
    {
        tile->forget(context);
        tile->forgetFormer(context);
    }
    if (context == ~0u)
        _contexts.clear();
    else
        _contexts.erase(context);
}

bool Scheduler::isDone(unsigned context) const
{
    if (!enabled)
        return true;
    Lock lock(_mutex);
    const auto found = _contexts.find(context);
    return found == _contexts.end() ? _tiles.empty() : isDone(found->second);
}

bool Scheduler::isDone() const
{
    Lock lock(_mutex);
    return !_contexts.empty() &&
           std::all_of(_contexts.begin(), _contexts.end(),
                       [this](const auto& each) { return isDone(each.second); });
}

std::string Scheduler::failure() const
{
    Lock lock(_mutex);
    for (const auto& tile : _tiles)
        if (const std::string failure = tile->failure(); !failure.empty())
            return tile->name() + ": " + failure;
    return _unsupported.empty() ? _objectsFailure : _unsupported;
}

bool Scheduler::supports(osg::State& state, Context& context)
{
    if (context.asked)
        return context.supported;
    context.asked = true;
    const Result<GpuCapabilities> found = GpuCapabilities::query(state);
    context.supported = found.ok();
    if (!found && _unsupported.empty())
    {
        _unsupported = found.error().message;
        OSG_WARN << "osgTerrainLight: " << _unsupported << "; drawing unlit" << std::endl;
    }
    return context.supported;
}

void Scheduler::see(const osgUtil::CullVisitor& visitor)
{
    // Its questions to the culling set are not const.
    osgUtil::CullVisitor& cull = const_cast<osgUtil::CullVisitor&>(visitor);
    const osg::State* state = cull.getState();
    if (!state || isDone(state->getContextID()))
        return;
    const unsigned frame = cull.getFrameStamp() ? cull.getFrameStamp()->getFrameNumber() : 0;
    const osg::Vec3d eye = cull.getEyeLocal();
    Lock lock(_mutex);
    Context& context = _contexts[state->getContextID()];
    for (const auto& tile : _tiles)
    {
        const osg::BoundingSphere& bound = tile->bound();
        if (!bound.valid())
            continue;
        const double rank = cull.isCulled(bound)
                                ? -(osg::Vec3d(bound.center()) - eye).length()
                                : static_cast<double>(cull.clampedPixelSize(bound));
        Sight& sight = context.sights[tile];
        sight.rank = sight.frame == frame ? std::max(sight.rank, rank) : rank;
        sight.frame = frame;
    }
}

std::vector<osg::ref_ptr<LitTile>> Scheduler::inOrder(const Context& context) const
{
    std::vector<osg::ref_ptr<LitTile>> tiles = _tiles;
    const auto rankOf = [&](const LitTile* tile)
    {
        const auto seen = context.sights.find(tile);
        return seen == context.sights.end() ? -std::numeric_limits<double>::infinity()
                                            : seen->second.rank;
    };
    std::stable_sort(tiles.begin(), tiles.end(),
                     [&](const auto& a, const auto& b) { return rankOf(a) > rankOf(b); });
    // What is begun is ended: else a camera that moves begins everything and ends nothing.
    const auto begun = std::find(tiles.begin(), tiles.end(), context.begun);
    if (begun != tiles.end())
        std::rotate(tiles.begin(), begun, begun + 1);
    return tiles;
}

void Scheduler::compute(osg::State& state)
{
    const unsigned id = state.getContextID();
    const unsigned revision = _revision;
    std::vector<osg::ref_ptr<LitTile>> tiles;
    std::shared_ptr<WorkClock> clock;
    {
        Lock lock(_mutex);
        Context& context = _contexts[id];
        if (!supports(state, context))
            return;
        tiles = inOrder(context);
        if (!context.clock)
            context.clock = std::make_shared<WorkClock>(_now);
        clock = context.clock;
    }
    for (const auto& tile : tiles)
        tile->meet(id);
    clock->begin(state);
    FramePace pace(*clock, state, budget);
    bool done = updateObjects(state, pace);
    const LitTile* last = nullptr;
    for (std::size_t i = 0; i < tiles.size() && !pace.isStopped(); ++i)
    {
        last = tiles[i];
        done = update(*tiles[i], state, pace) && done;
    }
    const double spent = clock->spent();
    clock->end();
    const std::shared_ptr<const SceneLight> light = this->light();
    Lock lock(_mutex);
    _contexts[id].milliseconds = spent;
    // It may have been removed meanwhile.
    const bool isThere = std::find(_tiles.begin(), _tiles.end(), last) != _tiles.end();
    _contexts[id].begun = pace.isStopped() && isThere ? last : nullptr;
    if (_contexts.size() == 1)
        restBehind(tiles, light);
    if (done && !pace.isStopped())
        _contexts[id].done = revision;
}

/// Those that are seen best keep what their light is computed from.
void Scheduler::restBehind(const std::vector<osg::ref_ptr<LitTile>>& inOrder,
                           const std::shared_ptr<const SceneLight>& light)
{
    const unsigned id = _contexts.begin()->first;
    std::size_t awake = 0;
    for (const auto& tile : inOrder)
        if (tile->isSurrounded() && !tile->lighting().isResting() && ++awake > mostAwake &&
            tile->stage(id) == LitTile::Stage::Lit && !tile->isBehind(id, light))
            tile->lighting().rest();
}

void Scheduler::rest(unsigned context)
{
    Lock lock(_mutex);
    if (const auto found = _contexts.find(context); found != _contexts.end())
        found->second.milliseconds = 0.0;
}

double Scheduler::milliseconds() const
{
    Lock lock(_mutex);
    double most = 0.0;
    for (const auto& [id, context] : _contexts)
        most = std::max(most, context.milliseconds);
    return most;
}

/// Whether they are up to date, or will never be.
bool Scheduler::updateObjects(osg::State& state, FramePace& pace)
{
    {
        Lock lock(_mutex);
        if (!_objectsFailure.empty())
            return true;
    }
    if (!_objects->isDirty(state.getContextID()))
        return true;
    if (!pace.goesOn())
        return false;
    const Status updated = _objects->update(state, &pace);
    if (updated)
        return !pace.isStopped();
    OSG_WARN << "osgTerrainLight: objects are drawn without what they do to light: "
             << updated.error().message << std::endl;
    Lock lock(_mutex);
    _objectsFailure = updated.error().message;
    return true;
}

/// Whether the tile is up to date; not where the pace has stopped.
bool Scheduler::update(LitTile& tile, osg::State& state, FramePace& pace)
{
    const unsigned id = state.getContextID();
    const std::shared_ptr<const SceneLight> light = this->light();
    const LitTile::Stage stage = tile.stage(id);
    // What waits may have been computed before a texture of it was bound.
    if (stage == LitTile::Stage::Failed ||
        (stage == LitTile::Stage::Lit && !tile.isBehind(id, light)))
        return true;
    if (!pace.goesOn())
        return false;
    const osg::ref_ptr<osg::Texture2DArray> gloss = tile.lighting().glossLight();
    const osg::ref_ptr<osg::Texture2D> edges = tile.lighting().shadowEdges();
    const unsigned objects = tile.lighting().objectsRevision();
    const Status updated = tile.update(state, light, &pace);
    if (tile.lighting().glossLight() != gloss || tile.lighting().shadowEdges() != edges ||
        tile.lighting().objectsRevision() != objects)
        ++_textureRevision;
    if (!updated)
    {
        tile.fail(id, updated.error().message);
        OSG_WARN << "osgTerrainLight: " << tile.name() << ": " << updated.error().message
                 << "; drawing it unlit" << std::endl;
        return true;
    }
    if (pace.isStopped())
        return false; // what was lit keeps its light until the rest has been computed
    tile.setStage(id, LitTile::Stage::Lit);
    return !tile.isBehind(id, light); // bounces may wait for their turn, changes for this one
}

} // namespace osgTerrainLight
