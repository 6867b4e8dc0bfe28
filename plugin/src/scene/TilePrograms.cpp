#include "scene/TilePrograms.h"

#include "scene/ShadingBinding.h"

#include <osg/GLExtensions>
#include <osg/Notify>

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

void TilePrograms::create()
{
    const osg::ref_ptr<osg::Program> plain = createDefaultProgram(false);
    const osg::ref_ptr<osg::Program> glossy = createDefaultProgram(true);
    Lock lock(_mutex);
    _programs.push_back({plain, glossy});
    _failure.clear();
}

osg::ref_ptr<osg::Program> TilePrograms::get(bool glossy) const
{
    Lock lock(_mutex);
    return _programs.empty() ? nullptr : _programs.back()[glossy ? 1 : 0];
}

void TilePrograms::fail(const std::string& message) const
{
    Lock lock(_mutex);
    if (message != _failure)
        OSG_WARN << "osgTerrainLight: " << message << "; drawing unlit" << std::endl;
    _failure = message;
}

std::string TilePrograms::failure() const
{
    Lock lock(_mutex);
    return _failure;
}

TileProgram::TileProgram(const TilePrograms* programs, const Scheduler* scheduler,
                         const LitTile* tile)
    : _programs(programs), _scheduler(scheduler), _tile(tile)
{
    setName(programs->get(false)->getName());
}

void TileProgram::apply(osg::State& state) const
{
    if (_scheduler->isLit(*_tile, state.getContextID()))
    {
        const osg::ref_ptr<osg::Program> program = _programs->get(_tile->glossy);
        program->apply(state);
        if (!program->getPCP(state)->isLinked())
            _programs->fail(whyNotLinked(*program, state));
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
    _programs->get(_tile->glossy)->compileGLObjects(state);
}

void TileProgram::releaseGLObjects(osg::State* state) const
{
    osg::Program::releaseGLObjects(state);
    for (const bool glossy : {false, true})
        _programs->get(glossy)->releaseGLObjects(state);
}

void TileProgram::resizeGLObjectBuffers(unsigned size)
{
    osg::Program::resizeGLObjectBuffers(size);
    for (const bool glossy : {false, true})
        _programs->get(glossy)->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
