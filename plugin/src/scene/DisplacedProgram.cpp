#include "scene/DisplacedProgram.h"

#include "scene/ShadingBinding.h"

namespace osgTerrainLight
{

DisplacedProgram::DisplacedProgram(const TilePrograms* programs, const Scheduler* scheduler,
                                   const LitTile* tile)
    : _programs(programs), _scheduler(scheduler), _tile(tile),
      _lit(tile ? createDisplacedProgram(true) : nullptr),
      _glossy(tile ? createDisplacedProgram(true, true) : nullptr),
      _unlit(createDisplacedProgram(false))
{
    setName((_lit ? _lit : _unlit)->getName());
}

void DisplacedProgram::apply(osg::State& state) const
{
    const bool lit = _lit && _scheduler->isLit(*_tile, state.getContextID());
    const osg::Program& program = !lit ? *_unlit : _tile->glossy ? *_glossy : *_lit;
    program.apply(state);
    if (_programs && !program.getPCP(state)->isLinked())
        _programs->fail(whyNotLinked(program, state));
}

int DisplacedProgram::compare(const osg::StateAttribute& other) const
{
    // As TileProgram: one may be lit and the other not.
    return this == &other ? 0 : this < &other ? -1 : 1;
}

void DisplacedProgram::compileGLObjects(osg::State& state) const
{
    for (const auto& program : {_tile && _tile->glossy ? _glossy : _lit, _unlit})
        if (program)
            program->compileGLObjects(state);
}

void DisplacedProgram::releaseGLObjects(osg::State* state) const
{
    osg::Program::releaseGLObjects(state);
    for (const auto& program : {_lit, _glossy, _unlit})
        if (program)
            program->releaseGLObjects(state);
}

void DisplacedProgram::resizeGLObjectBuffers(unsigned size)
{
    osg::Program::resizeGLObjectBuffers(size);
    for (const auto& program : {_lit, _glossy, _unlit})
        if (program)
            program->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
