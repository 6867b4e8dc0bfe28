#include "scene/TileSet.h"

#include "gpu/GpuCapabilities.h"

#include <osg/GLExtensions>
#include <osg/Notify>

#include <algorithm>
#include <chrono>

namespace osgTerrainLight
{

namespace
{
using Lock = std::lock_guard<std::mutex>;
} // namespace

std::string whyNotLinked(const osg::Program& program, osg::State& state)
{
    std::string place = program.getName() + " does not link: ";
    std::string log;
    for (unsigned i = 0; log.empty() && i < program.getNumShaders(); ++i)
    {
        const osg::Shader& shader = *program.getShader(i);
        if (shader.getPCS(state)->isCompiled())
            continue;
        shader.getPCS(state)->getInfoLog(log);
        place = "shader " + shader.getName() + " does not compile: ";
    }
    if (log.empty())
        program.getGlProgramInfoLog(state.getContextID(), log);
    log.erase(log.find_last_not_of(" \n\r\t") + 1);
    return place + log;
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

void TileSet::add(LitTile* tile)
{
    Lock lock(_mutex);
    _tiles.emplace_back(tile);
    touch();
}

void TileSet::remove(LitTile* tile)
{
    Lock lock(_mutex);
    _tiles.erase(std::remove(_tiles.begin(), _tiles.end(), tile), _tiles.end());
}

void TileSet::forget(unsigned context)
{
    Lock lock(_mutex);
    for (const auto& tile : _tiles)
        tile->forget(context);
    if (context == ~0u)
        _contexts.clear();
    else
        _contexts.erase(context);
}

void TileSet::setPrograms(osg::Program* plain, osg::Program* glossy)
{
    Lock lock(_mutex);
    _programs.push_back({plain, glossy});
    _programFailure.clear();
}

osg::ref_ptr<osg::Program> TileSet::program(bool glossy) const
{
    Lock lock(_mutex);
    return _programs.empty() ? nullptr : _programs.back()[glossy ? 1 : 0];
}

bool TileSet::isDone(unsigned context) const
{
    if (!enabled)
        return true;
    Lock lock(_mutex);
    const auto found = _contexts.find(context);
    return found == _contexts.end() ? _tiles.empty()
                                    : (found->second.asked && !found->second.supported) ||
                                          found->second.done == _revision;
}

std::string TileSet::failure() const
{
    Lock lock(_mutex);
    for (const auto& tile : _tiles)
        if (const std::string failure = tile->failure(); !failure.empty())
            return tile->name() + ": " + failure;
    return _unsupported.empty() ? _programFailure : _unsupported;
}

void TileSet::programFailed(const std::string& message) const
{
    Lock lock(_mutex);
    if (message != _programFailure)
        OSG_WARN << "osgTerrainLight: " << message << "; drawing unlit" << std::endl;
    _programFailure = message;
}

bool TileSet::supports(osg::State& state, Context& context)
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

void TileSet::compute(osg::State& state)
{
    using Clock = std::chrono::steady_clock;
    const unsigned id = state.getContextID();
    const unsigned revision = _revision;
    std::vector<osg::ref_ptr<LitTile>> tiles;
    std::size_t first = 0;
    {
        Lock lock(_mutex);
        Context& context = _contexts[id];
        if (!supports(state, context))
            return;
        tiles = _tiles;
        first = context.next;
    }

    const double limit = budget;
    const Clock::time_point start = Clock::now();
    bool worked = false;
    bool behind = false;
    std::size_t i = 0;
    for (; i < tiles.size(); ++i)
    {
        LitTile& tile = *tiles[(first + i) % tiles.size()];
        const LitTile::Stage stage = tile.stage(id);
        // What waits may have been computed before a texture of it was bound.
        if (stage == LitTile::Stage::Failed ||
            (stage == LitTile::Stage::Lit && !tile.lighting().isDirty(id)))
            continue;
        const double spent =
            std::chrono::duration<double, std::milli>(Clock::now() - start).count();
        if (limit > 0.0 && worked && spent > limit)
            break;
        worked = true;
        const Status updated = tile.lighting().update(state);
        if (updated)
        {
            tile.setStage(id, LitTile::Stage::Lit);
            behind = behind || tile.lighting().isDirty(id); // bounces that wait for their turn
        }
        else
        {
            tile.fail(id, updated.error().message);
            OSG_WARN << "osgTerrainLight: " << tile.name() << ": " << updated.error().message
                     << "; drawing it unlit" << std::endl;
        }
        if (limit > 0.0)
            glFinish(); // else the clock sees dispatches being queued, not run
    }

    Lock lock(_mutex);
    Context& context = _contexts[id];
    if (i == tiles.size() && !behind)
        context.done = revision;
    else if (i < tiles.size())
        context.next = (first + i) % tiles.size();
}

TileProgram::TileProgram(const TileSet* tiles, const LitTile* tile) : _tiles(tiles), _tile(tile)
{
    setName(tiles->program(false)->getName());
}

void TileProgram::apply(osg::State& state) const
{
    if (_tiles->isLit(*_tile, state.getContextID()))
    {
        const osg::ref_ptr<osg::Program> program = _tiles->program(_tile->glossy);
        program->apply(state);
        if (!program->getPCP(state)->isLinked())
            _tiles->programFailed(whyNotLinked(*program, state));
        return;
    }
    const auto* extensions = state.get<osg::GLExtensions>();
    if (extensions->isGlslSupported)
        extensions->glUseProgram(0);
    state.setLastAppliedProgramObject(nullptr);
}

int TileProgram::compare(const osg::StateAttribute& other) const
{
    // Two tiles' programs look alike to osg::Program, but one may be lit and the other not.
    return this == &other ? 0 : this < &other ? -1 : 1;
}

void TileProgram::compileGLObjects(osg::State& state) const
{
    _tiles->program(_tile->glossy)->compileGLObjects(state);
}

void TileProgram::releaseGLObjects(osg::State* state) const
{
    osg::Program::releaseGLObjects(state);
    for (const bool glossy : {false, true})
        _tiles->program(glossy)->releaseGLObjects(state);
}

void TileProgram::resizeGLObjectBuffers(unsigned size)
{
    osg::Program::resizeGLObjectBuffers(size);
    for (const bool glossy : {false, true})
        _tiles->program(glossy)->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
