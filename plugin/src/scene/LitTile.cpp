#include "scene/LitTile.h"

namespace osgTerrainLight
{

namespace
{
using Lock = std::lock_guard<std::mutex>;
} // namespace

LitTile::LitTile(std::string name, const DemTile& dem, std::shared_ptr<const SceneLight> light)
    : _name(std::move(name)), _lighting(new TileLight(dem, light->settings, light->sky)),
      _applied(std::move(light)), _glossLight(_lighting->glossLight())
{
}

template <class F>
void LitTile::note(F&& change)
{
    Lock lock(_mutex);
    change(_changes);
    _changed = true;
}

void LitTile::setHeights(std::vector<float> heights)
{
    note(
        [&](Changes& changes)
        {
            changes.heights = std::move(heights);
            changes.heightTexture = nullptr;
        });
}

void LitTile::setHeightTexture(osg::Texture2D* texture)
{
    note(
        [&](Changes& changes)
        {
            changes.heightTexture = texture;
            changes.heights.reset();
        });
}

void LitTile::touchHeights()
{
    note([](Changes& changes) { changes.heightsTouched = true; });
}

void LitTile::setAlbedo(Raster<Rgb> albedo)
{
    note([&](Changes& changes) { changes.albedo = std::move(albedo); });
}

void LitTile::setGloss(Raster<std::array<float, 2>> gloss)
{
    note([&](Changes& changes) { changes.gloss = std::move(gloss); });
}

void LitTile::setProbes(std::vector<ProbePlace> probes)
{
    note([&](Changes& changes) { changes.probes = std::move(probes); });
}

void LitTile::recompute()
{
    note([](Changes& changes) { changes.recompute = true; });
}

void LitTile::apply(const SceneLight& light)
{
    Changes changes;
    std::shared_ptr<const SceneLight> before;
    {
        Lock lock(_mutex);
        std::swap(changes, _changes);
        _changed = false;
        before = _applied;
    }
    if (before->settingsVersion != light.settingsVersion)
        _lighting->setSettings(light.settings);
    if (before->skyVersion != light.skyVersion)
        _lighting->setSky(light.sky);
    if (changes.heights)
        _lighting->setHeights(*changes.heights);
    if (changes.heightTexture)
        _lighting->setHeightTexture(changes.heightTexture);
    if (changes.heightsTouched)
        _lighting->touchHeights();
    if (changes.albedo)
        _lighting->setAlbedo(std::move(*changes.albedo));
    if (changes.gloss)
        _lighting->setGloss(std::move(*changes.gloss));
    if (changes.probes)
        _lighting->setProbes(std::move(*changes.probes));
    if (changes.recompute)
        _lighting->recompute();
}

Status LitTile::update(osg::State& state, const std::shared_ptr<const SceneLight>& light,
                       const std::function<bool()>& mayContinue)
{
    const unsigned context = state.getContextID();
    bool goesOn = false;
    {
        Lock lock(_mutex);
        goesOn = _unfinished.erase(context) > 0;
    }
    if (!goesOn)
    {
        Lock applying(_applying);
        apply(*light);
        const osg::ref_ptr<osg::Texture2DArray> gloss = _lighting->glossLight();
        Lock lock(_mutex);
        _applied = light;
        _glossLight = gloss;
    }
    const Status updated = _lighting->update(state,
                                             [&]
                                             {
                                                 const bool continues = mayContinue();
                                                 Lock lock(_mutex);
                                                 if (!continues)
                                                     _unfinished.insert(context);
                                                 return continues;
                                             });
    return updated;
}

bool LitTile::isBehind(unsigned context, const std::shared_ptr<const SceneLight>& light) const
{
    {
        Lock lock(_mutex);
        if (_changed || _applied->settingsVersion != light->settingsVersion ||
            _applied->skyVersion != light->skyVersion)
            return true;
    }
    return _lighting->isDirty(context);
}

osg::ref_ptr<osg::Texture2DArray> LitTile::glossLight() const
{
    Lock lock(_mutex);
    return _glossLight;
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
    {
        _stages.clear();
        _unfinished.clear();
    }
    else
    {
        _stages.erase(context);
        _unfinished.erase(context);
    }
}

void LitTile::retry()
{
    Lock lock(_mutex);
    for (auto& [context, stage] : _stages)
        if (stage == Stage::Failed)
            stage = Stage::Waiting;
}

} // namespace osgTerrainLight
