#include "scene/LitTile.h"

namespace osgTerrainLight
{

namespace
{
using Lock = std::lock_guard<std::mutex>;
} // namespace

LitTile::LitTile(std::string name, const DemTile& dem, std::shared_ptr<const SceneLight> light)
    : _name(std::move(name)), _lighting(new TileLight(dem, light->settings, light->sky)),
      _light(std::move(light))
{
}

Status LitTile::update(osg::State& state, const std::shared_ptr<const SceneLight>& light,
                       WorkPace* pace)
{
    {
        // Threads of several contexts may be frames apart: only newer light is handed on.
        Lock lock(_mutex);
        if (_light->settingsVersion < light->settingsVersion)
            _lighting->setSettings(light->settings);
        if (_light->skyVersion < light->skyVersion)
            _lighting->setSky(light->sky);
        if (isNewer(*light))
            _light = light;
    }
    return _lighting->update(state, pace);
}

/// Precondition: _mutex is held.
bool LitTile::isNewer(const SceneLight& light) const
{
    return _light->settingsVersion < light.settingsVersion || _light->skyVersion < light.skyVersion;
}

bool LitTile::isBehind(unsigned context, const std::shared_ptr<const SceneLight>& light) const
{
    {
        Lock lock(_mutex);
        if (isNewer(*light))
            return true;
    }
    return _lighting->isDirty(context);
}

LitTile::Stage LitTile::stage(unsigned context) const
{
    Lock lock(_mutex);
    const auto found = _stages.find(context);
    return found == _stages.end() ? Stage::Waiting : found->second;
}

void LitTile::setStage(unsigned context, Stage stage)
{
    Lock lock(_mutex);
    _stages[context] = stage;
}

void LitTile::fail(unsigned context, const std::string& message)
{
    Lock lock(_mutex);
    _stages[context] = Stage::Failed;
    _failures[context] = message;
}

std::string LitTile::failure() const
{
    Lock lock(_mutex);
    for (const auto& [context, stage] : _stages)
        if (stage == Stage::Failed)
            return _failures.at(context);
    return {};
}

TileState LitTile::state() const
{
    TileState state;
    state.stage = TileState::Stage::Waiting;
    state.reason = failure();
    if (!state.reason.empty())
        state.stage = TileState::Stage::Failed;
    Lock lock(_mutex);
    bool lit = !_stages.empty();
    for (const auto& [context, stage] : _stages)
        lit = lit && stage == Stage::Lit;
    if (lit)
        state.stage = TileState::Stage::Lit;
    return state;
}

void LitTile::forget(unsigned context)
{
    Lock lock(_mutex);
    if (context == ~0u)
        _stages.clear();
    else
        _stages.erase(context);
}

void LitTile::retry()
{
    Lock lock(_mutex);
    for (auto& [context, stage] : _stages)
        if (stage == Stage::Failed)
            stage = Stage::Waiting;
}

} // namespace osgTerrainLight
