#include "scene/LitTile.h"

#include "lighting/FarLight.h"
#include "lighting/TileWindows.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

LitTile::LitTile(std::string name, const std::shared_ptr<const TileWindows>& windows,
                 std::shared_ptr<const SceneLight> light, const std::optional<osg::Matrixd>& turn)
    : _name(std::move(name)), _surrounded(true), _hasMargin(light->settings.bounces > 0),
      _turn(turn), _light(std::move(light))
{
    const auto lit = _hasMargin ? withLitMargin(*windows, bounceMargin) : windows;
    _margin = {windows->place.column - lit->place.column, windows->place.row - lit->place.row,
               lit->place.endColumn() - windows->place.endColumn(),
               lit->place.endRow() - windows->place.endRow()};
    _lighting = new TileLight(lit, _light->settings, turned(_light->sky));
}

/// Where the sun and the key lights stand for the tile. An environment keeps its heading.
SkyLight LitTile::turned(const SkyLight& sky) const
{
    if (!_turn)
        return sky;
    constexpr double degrees = 180.0 / 3.14159265358979323846;
    const auto turn = [&](double& azimuth, double& elevation)
    {
        const double a = azimuth / degrees, e = elevation / degrees;
        osg::Vec3d towards(std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), std::sin(e));
        towards = osg::Matrixd::transform3x3(towards, *_turn);
        elevation = degrees * std::asin(std::clamp(towards.z(), -1.0, 1.0));
        azimuth = degrees * std::atan2(towards.x(), towards.y());
        if (azimuth < 0.0)
            azimuth += 360.0;
    };
    SkyLight own = sky;
    turn(own.sunAzimuth, own.sunElevation);
    for (KeyLight& key : own.keyLights) // as wide and as high as before, about another middle
    {
        if (key.width > 180.0) // all around: it has no middle
            continue;
        const double half = 0.5 * (key.highest - key.lowest);
        double middle = 0.5 * (key.highest + key.lowest);
        turn(key.azimuth, middle);
        key.lowest = std::max(middle - half, -90.0);
        key.highest = std::min(middle + half, 90.0);
    }
    return own;
}

osg::Matrixd LitTile::fromDrawn() const
{
    const double columns = _lighting->width() - 1;
    const double rows = _lighting->height() - 1;
    return osg::Matrixd::scale((columns - _margin.west - _margin.east) / columns,
                               (rows - _margin.south - _margin.north) / rows, 1.0) *
           osg::Matrixd::translate(_margin.west / columns, _margin.south / rows, 0.0);
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
            _lighting->setSky(turned(light->sky));
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

void LitTile::meet(unsigned context)
{
    Lock lock(_mutex);
    _stages.try_emplace(context, Stage::Waiting);
}

std::set<unsigned> LitTile::litContexts() const
{
    Lock lock(_mutex);
    std::set<unsigned> lit;
    for (const auto& [context, stage] : _stages)
        if (stage == Stage::Lit)
            lit.insert(context);
    return lit;
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

void LitTile::setFormer(std::optional<std::set<unsigned>> contexts, bool fades)
{
    Lock lock(_mutex);
    _former = std::move(contexts);
    _fades = fades;
}

bool LitTile::isFormerEverywhere() const
{
    Lock lock(_mutex);
    return _former &&
           std::all_of(_stages.begin(), _stages.end(),
                       [this](const auto& each) { return _former->count(each.first) > 0; });
}

void LitTile::forgetFormer(unsigned context)
{
    Lock lock(_mutex);
    if (_former && context == ~0u)
        _former->clear();
    else if (_former)
        _former->erase(context);
}

bool LitTile::isDrawable(unsigned context) const
{
    Lock lock(_mutex);
    const auto found = _stages.find(context);
    const Stage stage = found == _stages.end() ? Stage::Waiting : found->second;
    if (!_former)
        return stage == Stage::Lit;
    return _former->count(context) > 0 &&
           (stage == Stage::Lit || (stage == Stage::Waiting && !_fades));
}

void LitTile::retry()
{
    Lock lock(_mutex);
    for (auto& [context, stage] : _stages)
        if (stage == Stage::Failed)
            stage = Stage::Waiting;
}

} // namespace osgTerrainLight
